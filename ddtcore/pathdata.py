# SPDX-License-Identifier: GPL-2.0-or-later
"""Path data: Bézier loops as the shortest text that says the same.

Positions are rounded to the grid of the last digit first and only then
differenced, so that errors never add up however long the path.  On that grid
everything is whole numbers: the commands are chosen and the numbers joined for
all paths of a drawing at once, and no number is formatted twice.  The grammar
is that of SVG 1.1, section 8.3 (relative and repeated commands, ``s`` and ``t``
with their implied control points, separators only where two numbers would merge).

Smooth quadratics (the paper's curves, section V) need care: the control point that
``t`` implies is the mirror image of the one the reader has, not of the one meant, and
rounding errors would double and alternate from segment to segment.  So each joint
is placed where the reader's next control point comes out nearest to the one meant;
both stay within one unit of the last digit.
"""

from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .model import CUBIC, LINE, QUADRATIC, Loop

_LETTERS = "MmlHhVvcsqtz"
(_MOVE, _MOVE_BY, _LINE_BY, _H, _H_BY, _V, _V_BY, _CUBIC, _SMOOTH_CUBIC, _QUADRATIC,
 _SMOOTH_QUADRATIC, _CLOSE) = range(len(_LETTERS))
_COUNTS = np.array([2, 2, 2, 1, 1, 1, 1, 6, 4, 4, 2, 0])


class _Segments(NamedTuple):
    """The segments of all loops, in grid units."""

    exact: np.ndarray    # (S, 4, 2) float64
    points: np.ndarray   # (S, 4, 2) int64, `exact` rounded
    degree: np.ndarray   # (S,)
    loop: np.ndarray     # (S,) number of the loop
    path: np.ndarray     # (S,) number of the path


class _Commands(NamedTuple):
    """One row per path command; of the six `numbers` the first ones count."""

    letter: np.ndarray   # (R,) index into _LETTERS
    numbers: np.ndarray  # (R, 6) int64
    path: np.ndarray     # (R,)


def path_data(loops: Sequence[Loop], decimals: int) -> str:
    """The text of a ``d`` attribute.

    Parameters
    ----------
    loops : sequence of Loop
        The closed loops of one path.
    decimals : int
        Digits after the point, 0 to 6.

    Returns
    -------
    str
        Empty if every loop vanishes at this precision.

    Raises
    ------
    ValueError
        If a control point isn't finite.

    Examples
    --------
    >>> corners = np.array([[0, 0], [4, 0], [4, 2.5], [0, 2.5]])
    >>> control = np.stack([corners, corners, corners, np.roll(corners, -1, axis=0)], axis=1)
    >>> path_data([Loop(control, np.full(4, LINE))], 1)
    'M0 0h4v2.5H0z'
    """
    return path_texts([loops], 10**decimals, decimals)[0]


def path_texts(paths: Sequence[Sequence[Loop]], scale: int, decimals: int) -> List[str]:
    """The ``d`` attributes of many paths.

    Parameters
    ----------
    paths : sequence of sequences of Loop
    scale : int
        Units per pixel: positions are rounded to whole units.
    decimals : int
        Digits of the whole units that are written after the point.

    Returns
    -------
    list of str
        One text for each path, as `path_data` gives it.
    """
    if not any(len(loops) for loops in paths):
        return [""] * len(paths)
    segments = _drop_vanished(_on_grid(paths, scale))
    if not len(segments.loop):
        return [""] * len(paths)
    smooth = _join_quadratics(segments)
    return _join(_commands(segments, smooth, decimals), len(paths), decimals)


def _on_grid(paths: Sequence[Sequence[Loop]], scale: int) -> _Segments:
    loops = [loop for path in paths for loop in path]
    exact = np.concatenate([loop.control for loop in loops]) * float(scale)
    if not np.isfinite(exact).all():
        raise ValueError("path data: every control point must be finite")
    loop = np.repeat(np.arange(len(loops)), [len(loop.degree) for loop in loops])
    path = np.repeat(np.arange(len(paths)), [len(path) for path in paths])[loop]
    points = np.rint(exact).astype(np.int64)
    degree = np.concatenate([loop.degree for loop in loops])
    degree = np.where((degree == CUBIC) & _straight(points), LINE, degree)
    return _Segments(exact, points, degree, loop, path)


def _straight(points: np.ndarray) -> np.ndarray:
    """Which segments have both handles on their chord and so are lines, bool (S,)."""
    arms = (points[:, 1:] - points[:, :1]).astype(np.float64)
    chord = arms[:, 2:]
    cross = arms[..., 0] * chord[..., 1] - arms[..., 1] * chord[..., 0]
    along = (arms * chord).sum(axis=-1)
    inside = (cross == 0) & (along >= 0) & (along <= along[:, 2:])
    straight: np.ndarray = inside.all(axis=1) & (chord.any(axis=(1, 2)) | ~arms.any(axis=(1, 2)))
    return straight


def _drop_vanished(segments: _Segments) -> _Segments:
    """Without segments of no length, and without loops that enclose nothing."""
    arms = segments.points[:, 1:] - segments.points[:, :1]
    is_line = segments.degree == LINE
    keep = np.where(is_line, arms[:, 2].any(axis=1), arms.any(axis=(1, 2)))
    loops = segments.loop.max() + 1
    size = np.bincount(segments.loop[keep], minlength=loops)
    curves = np.bincount(segments.loop[keep & ~is_line], minlength=loops)
    keep &= ((size > 2) | (curves > 0))[segments.loop]
    return _Segments(*(values[keep] for values in segments))


def _join_quadratics(segments: _Segments) -> np.ndarray:
    """Find the quadratics whose control point the reader can imply, bool (S,).

    Moves the joints before them, in place, by up to one unit, so that he implies it well.
    """
    exact, points, degree, loop, _ = segments
    joint = np.zeros(len(degree), dtype=bool)
    mirrored = 2 * exact[:-1, 3] - exact[:-1, 1]
    joint[1:] = ((degree[1:] == QUADRATIC) & (degree[:-1] == QUADRATIC) & (loop[1:] == loop[:-1])
                 & (np.abs(mirrored - exact[1:, 1]) <= 0.1).all(axis=1))
    where = np.flatnonzero(joint)
    meant = exact[where, 1].tolist()
    known = points[np.maximum(where - 1, 0), 1].tolist()
    ends: List[Tuple[int, int]] = []
    controls: List[Tuple[int, int]] = []
    before = -1
    for k, (want_x, want_y), (x, y) in zip(where.tolist(), meant, known):
        if k - 1 == before:
            x, y = controls[-1]
        end = round((want_x + x) / 2), round((want_y + y) / 2)
        ends.append(end)
        controls.append((2 * end[0] - x, 2 * end[1] - y))
        before = k
    if len(where):
        points[where - 1, 3] = points[where, 0] = ends
        points[where, 1] = points[where, 2] = controls
    return joint


def _commands(segments: _Segments, smooth: np.ndarray, decimals: int) -> _Commands:
    """The rows of a move, the segments and a closing, loop by loop."""
    _, points, degree, loop, path = segments
    letter, numbers = _draw(points, degree, loop, smooth, decimals)
    changes = np.flatnonzero(loop[1:] != loop[:-1])
    first, last = np.append(0, changes + 1), np.append(changes, len(loop) - 1)
    move_letter, move_numbers = _move(
        points[first, 0], path[first], (letter[first] == _LINE_BY) & (numbers[first, 0] < 0), decimals)
    # A line back to the start is what closing draws anyway.
    drawn = np.ones(len(loop), dtype=bool)
    drawn[last[degree[last] == LINE]] = False

    place = np.arange(len(loop)) * 3
    order = np.argsort(np.concatenate([place[first], place[drawn] + 1, place[last] + 2]))
    return _Commands(
        np.concatenate([move_letter, letter[drawn], np.full(len(last), _CLOSE)])[order],
        np.concatenate([move_numbers, numbers[drawn], np.zeros((len(last), 6), np.int64)])[order],
        np.concatenate([path[first], path[drawn], path[last]])[order])


def _draw(points: np.ndarray, degree: np.ndarray, loop: np.ndarray, smooth: np.ndarray,
          decimals: int) -> Tuple[np.ndarray, np.ndarray]:
    """Letter and numbers of every segment."""
    relative = points[:, 1:] - points[:, :1]
    numbers = relative.reshape(-1, 6).copy()
    letter = np.full(len(degree), _CUBIC)

    implied = np.zeros((len(degree), 2), dtype=np.int64)
    mirrors = (degree[1:] == CUBIC) & (degree[:-1] == CUBIC) & (loop[1:] == loop[:-1])
    implied[1:][mirrors] = (points[:-1, 3] - points[:-1, 2])[mirrors]
    short = (degree == CUBIC) & (relative[:, 0] == implied).all(axis=1)
    letter[short] = _SMOOTH_CUBIC
    numbers[short, :4] = numbers[short, 2:]

    quadratic = degree == QUADRATIC
    letter[quadratic] = _QUADRATIC
    numbers[quadratic, 2:4] = relative[quadratic, 2]
    letter[smooth] = _SMOOTH_QUADRATIC
    numbers[smooth, :2] = relative[smooth, 2]

    line = degree == LINE
    letter[line] = _LINE_BY
    numbers[line, :2] = relative[line, 2]
    for axis, to, by in ((0, _H, _H_BY), (1, _V, _V_BY)):
        along = line & (relative[:, 2, 1 - axis] == 0)
        goal, step = points[:, 3, axis], relative[:, 2, axis]
        absolute = _width(goal, decimals) < _width(step, decimals)
        letter[along] = np.where(absolute, to, by)[along]
        numbers[along, 0] = np.where(absolute, goal, step)[along]
    return letter, numbers


def _move(start: np.ndarray, path: np.ndarray, leads: np.ndarray,
          decimals: int) -> Tuple[np.ndarray, np.ndarray]:
    """Letter and numbers of every move: absolute, or from the start of the loop before.

    `leads` says where a line follows whose first number can stand without a space: pairs
    after a relative move are relative lines, and need no letter.
    """
    step = start.copy()
    inner = path[1:] == path[:-1]
    step[1:][inner] -= start[:-1][inner]
    cost = _width(step, decimals).sum(axis=1) - (step[:, 1] < 0) - leads
    by = cost < _width(start, decimals).sum(axis=1) - (start[:, 1] < 0)
    numbers = np.zeros((len(start), 6), dtype=np.int64)
    numbers[:, :2] = np.where(by[:, None], step, start)
    return np.where(by, _MOVE_BY, _MOVE), numbers


def _width(values: np.ndarray, decimals: int) -> np.ndarray:
    """How many characters a number of grid units takes."""
    size = np.abs(values)
    whole = np.searchsorted(10 ** np.arange(decimals, 18), size, side="right")
    digits = sum((size % 10**k != 0).astype(np.int64) for k in range(1, decimals + 1))
    width: np.ndarray = (values < 0) + np.where(digits > 0, whole + 1 + digits, np.maximum(whole, 1))
    return width


def _join(commands: _Commands, paths: int, decimals: int) -> List[str]:
    """The texts of all paths; every different number is formatted once."""
    letter, numbers, path = commands
    shown = _shown(letter)
    used = np.arange(6) < _COUNTS[letter][:, None]
    values, place = np.unique(numbers[used], return_inverse=True)
    texts = [number_text(value, decimals) for value in values.tolist()]
    words = list(_LETTERS) + texts + [" " + text for text in texts]

    # A number begins a new one by its sign, by its point after a fraction, or after a letter.
    after_letter = np.zeros(used.shape, dtype=bool)
    after_letter[:, 0] = shown
    after_fraction = np.append(False, (values % 10**decimals != 0)[place][:-1])
    starts_with_point = ((values > 0) & (values < 10**decimals))[place]
    joined = after_letter[used] | (values < 0)[place] | (after_fraction & starts_with_point)

    stream = np.full((len(letter), 7), -1)
    stream[shown, 0] = letter[shown]
    stream[:, 1:][used] = len(_LETTERS) + place + np.where(joined, 0, len(texts))
    written = stream >= 0
    chosen = list(map(words.__getitem__, stream[written].tolist()))
    lengths = np.bincount(path, weights=written.sum(axis=1), minlength=paths)
    stops = np.cumsum(lengths).astype(int).tolist()
    return ["".join(chosen[start:stop]) for start, stop in zip([0, *stops], stops)]


def _shown(letter: np.ndarray) -> np.ndarray:
    """Which letters must be written, bool (R,): not those that the reader knows to come."""
    shown = np.ones(len(letter), dtype=bool)
    repeated = (letter[1:] == letter[:-1]) & (letter[1:] != _CLOSE)
    line_after_move = (letter[1:] == _LINE_BY) & (letter[:-1] == _MOVE_BY)
    shown[1:] = ~(repeated | line_after_move)
    return shown


def number_text(units: int, decimals: int) -> str:
    """The shortest text of ``units * 10**-decimals``.

    Examples
    --------
    >>> number_text(-50, 2), number_text(1200, 2), number_text(0, 2)
    ('-.5', '12', '0')
    """
    digits = str(abs(units)).zfill(decimals + 1)
    whole, fraction = digits[:len(digits) - decimals], digits[len(digits) - decimals:].rstrip("0")
    text = whole if not fraction else whole.lstrip("0") + "." + fraction
    return "-" + text if units < 0 else text
