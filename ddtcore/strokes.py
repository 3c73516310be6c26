# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes too thin to have a fully covered pixel.

Across an anti-aliased edge the colour runs straight from one side to the other, so
a pixel lies on the line between its neighbours' colours.  On a thin stroke, in a thin
gap or at the tip of a wedge it lies beside that line; how far and in which
direction tells the colour of the stroke, whatever the colours at its two sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from .canvas import Canvas, planes, unpack
from .components import next_among, places_among
from .mixes import dot, excess, length, segment_distance, third_share
from .noise import ROUNDING
from .parts import in_parts
from .sides import window

LEAST = 12.0
"""Smallest distance of a stroke's pixel from the mixes of its two sides, levels."""

FAINT = 0.16
"""Smallest coverage of a stroke's pixel."""

FAINTER = 0.09
"""Smallest coverage of a pixel that continues a stroke."""

PURE = 8
"""How far from black or white the fullest pixel of a black or white stroke may be, levels."""

TWIN = 8.0
"""How far a new colour has to be from those known, levels."""

PALE = 0.25
"""Share of another colour in the fullest pixel of a stroke, in a picture that isn't clean, at most."""

DEEP = 0.4
"""Smallest share of black or white in the fullest pixel of a stroke of a blurred picture that may be such."""

COLOURS = 32
"""How many colours are weighed for strokes."""

_DIRECTIONS = [(0, 1), (1, 0), (1, 1), (1, -1)]
_STRAIGHT = 14.0
_TRIES = 32
_REACH = 24
_ROUNDS = 8


@dataclass(frozen=True)
class Ridges:
    """Pixels whose colour stands out from both sides.

    Attributes
    ----------
    cells : ndarray of shape (R,) and dtype int32
        Pixel numbers, rising.
    colour : ndarray of shape (C, R) and dtype float32
        Their colours.
    one, other : ndarray of shape (C, R) and dtype float32
        Colours at the two sides.
    off : ndarray of shape (C, R) and dtype float32
        Vector from the nearest mix of the two sides to the colour.
    """

    cells: np.ndarray
    colour: np.ndarray
    one: np.ndarray
    other: np.ndarray
    off: np.ndarray

    @property
    def height(self) -> np.ndarray:
        """How far the pixels stand out, float32 (R,)."""
        return length(self.off)

    def some(self, which: np.ndarray) -> Ridges:
        """A part of the ridge pixels."""
        return Ridges(self.cells[which], self.colour[:, which], self.one[:, which], self.other[:, which],
                      self.off[:, which])


def find_ridges(canvas: Canvas, cells: np.ndarray, noise: float) -> Ridges:
    """Find the pixels among `cells` that no monotone edge explains, the crests of strokes.

    They stand out by more than ripples of the given `noise` (levels) do.
    """
    least = LEAST + 2 * (noise - ROUNDING)
    here = canvas.colours(cells)
    height = np.zeros(cells.size, np.float32)
    one, other = here.copy(), here.copy()
    for row, col in _DIRECTIONS:
        step = np.int32(row * canvas.stride + col)
        before, after, a, b, off = _across(canvas, cells, here, step, least)
        size = length(off)
        peak = (size > least) & (size > height) & canvas.holds(cells - step) & canvas.holds(cells + step)
        # Only a neighbour that stands out to the same side belongs to the same stroke.
        peak &= (size >= size[before]) | (before < 0) | (dot(off, off.take(before, axis=1)) <= 0)
        peak &= (size > size[after]) | (after < 0) | (dot(off, off.take(after, axis=1)) <= 0)
        for known, new in ((height, size), (one, a), (other, b)):
            np.copyto(known, new, where=peak)
    kept = np.flatnonzero(height > 0)
    here, one, other = (part.take(kept, axis=1) for part in (here, one, other))
    return Ridges(cells[kept], here, one, other, excess(here, one, other))


def _across(canvas: Canvas, cells: np.ndarray, here: np.ndarray, step: np.int32,
            least: float) -> Tuple[np.ndarray, ...]:
    """Numbers of the pixels before and after each in one direction, and its `_two_sides`."""
    after = next_among(cells, int(step))
    before = np.full(cells.size, -1)
    before[after[after >= 0]] = np.flatnonzero(after >= 0)
    return (before, after, *in_parts(
        lambda part: _two_sides(canvas, cells[part], here[:, part], before[part], after[part], step, least),
        cells.size, axis=1))


def _two_sides(canvas: Canvas, cells: np.ndarray, here: np.ndarray, before: np.ndarray, after: np.ndarray,
               step: np.int32, least: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours at both sides of each pixel in one direction, and how it stands out: those from which it does most.

    A stroke that covers two pixels in part is seen past its other half, where the colour
    runs straight from the pixel through that half to the far side, or where the other half
    stands out in the same direction.
    """
    best = np.stack([canvas.colours(cells - step), canvas.colours(cells + step)])
    sides, out = best.copy(), excess(here, *best)
    square = dot(out, out)
    for far, sign, next_ in ((1, 2, after), (0, -2, before)):
        near, half = sides[1 - far], sides[far]
        beyond = canvas.colours(cells + sign * step)
        off = excess(here, near, beyond)
        size = dot(off, off) * np.float32(0.998)
        # Few stand out more, and enough to matter.
        more = np.flatnonzero(size > np.maximum(square, np.float32(0.99 * least * least)))
        more = more[_is_passed(here[:, more], near[:, more], half[:, more], beyond[:, more], off[:, more],
                               next_[more] >= 0)]
        best[far][:, more], best[1 - far][:, more] = beyond[:, more], near[:, more]
        square[more] = size[more]
        out[:, more] = excess(here[:, more], *best[:, :, more])
    return best[0], best[1], out


def _is_passed(here: np.ndarray, near: np.ndarray, half: np.ndarray, beyond: np.ndarray, off: np.ndarray,
               beside: np.ndarray) -> np.ndarray:
    """Whether pixels are seen past their other half: it stands out likewise, or lies on the way to the far side."""
    twin = excess(half, near, beyond)
    agree = dot(off, twin)
    size = dot(off, off) * np.float32(0.998)
    passed = beside & (agree > 0) & (agree * agree > 0.5 * size * dot(twin, twin))
    return np.asarray(passed | (segment_distance(half, here, beyond)[0] < _STRAIGHT))


def new_colours(canvas: Canvas, cells: np.ndarray, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
                noise: float, blurred: bool = False) -> np.ndarray:
    """Colours that occur in thin strokes only, packed, uint32.

    The ridge pixel that stands out most among those no colour explains has nearly the
    colour of its stroke; it is taken if it explains others near it as well and the
    colours round it do not mix to it.  Exact is a frequent value close to it.

    Parameters
    ----------
    cells : ndarray of shape (N,)
        All pixels that are no plateaus.
    colours : ndarray of shape (C, K) and dtype float32
        The palette so far.
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    noise : float
        How much flat areas vary, levels.
    blurred : bool
        Whether no pixel of a stroke need be full, as in a scan.
    """
    doubt = noise - ROUNDING
    ridges = unexplained(ridges, colours, doubt)
    found, around = np.zeros(0, np.uint32), canvas.colours(cells) if ridges.cells.size else None
    for _ in range(_TRIES):
        if ridges.cells.size < 4:
            break
        highest = np.argmax(ridges.height)
        cell, colour = ridges.cells[highest], ridges.colour[:, highest, None]
        beside, share = third_share(ridges.colour, ridges.one, ridges.other, colour)
        fits = (beside[:, 0] < 12 + doubt) & (share[:, 0] > 0.3)
        fits[highest] = True
        fit_near = np.count_nonzero(fits & _within_reach(canvas, ridges.cells, cell))
        if fit_near >= 4 + doubt and not _mixed_near(canvas, cell, colours, labels, found.size):
            like = canvas.keys[cells[np.abs(around - colour).max(axis=0) < 10 + doubt]]
            key = _extreme(canvas, like, ridges.off[:, highest], canvas.keys[cell])
            key = _pure(key, PURE + min(8 * doubt, 3 * PURE))
            if blurred:
                key = _black(canvas, ridges.some(np.flatnonzero(fits)), beside[fits, 0] + doubt, key)
            exact = planes(key, canvas.opaque)
            if (np.abs(exact - colours).max(axis=0) >= TWIN + 2 * doubt).all():
                found, colours = np.append(found, key), np.append(colours, exact, axis=1)
        ridges = ridges.some(np.flatnonzero(~fits))
    return found[_fullest(colours, found.size)] if doubt > 0 and found.size > 1 else found


def _black(canvas: Canvas, ridges: Ridges, beside: np.ndarray, key: np.ndarray) -> np.ndarray:
    """The packed ink (1,) of some ridge pixels: black or white if mixes with that are nearer than `beside` (R,)."""
    for end in (0, 255):
        rgba = np.full((1, 4), (end, end, end, 255), np.uint8).view(np.uint32)[:, 0]
        off, share = third_share(ridges.colour, ridges.one, ridges.other, planes(rgba, canvas.opaque))
        if off.mean() <= beside.mean() and share.max() > DEEP:
            return rgba
    return key


def _fullest(colours: np.ndarray, count: int) -> np.ndarray:
    """Which of the last `count` colours (C, K) are not another one of them with a little of a third, bool (count,).

    Where pixels vary, those that stand out most need not be those that their stroke covers most.
    """
    inks = colours[:, -count:]
    kept = np.ones(count, bool)
    for k, other in np.ndindex(count, count):
        if k != other and kept[other]:
            ink, full = (np.broadcast_to(inks[:, n, None], colours.shape) for n in (k, other))
            off, share = segment_distance(ink, full, colours)
            kept[k] &= not ((off < LEAST) & (share > 0) & (share < PALE)).any()
    return kept


def unexplained(ridges: Ridges, colours: np.ndarray, doubt: float) -> Ridges:
    """The ridge pixels that mixes with no known colour explain: the better, the surer their two sides are."""
    if not colours.shape[1]:
        return ridges
    beside, _ = third_share(ridges.colour, ridges.one, ridges.other, colours)
    trust = np.where(_is_any(ridges.one, colours) & _is_any(ridges.other, colours), 0.2, 0.4)
    return ridges.some(np.flatnonzero(beside.min(axis=1) >= np.maximum(trust * ridges.height, 30 + 2 * doubt)))


def _pure(keys: np.ndarray, margin: float) -> np.ndarray:
    """Packed colours with those that are nearly black or white made so: no pixel of a thin stroke is full."""
    rgba = unpack(keys).copy()
    for end in (0, 255):
        rgba[(np.abs(rgba[:, :3].astype(int) - end) <= margin).all(axis=1), :3] = end
    return rgba.view(np.uint32)[:, 0]


def _extreme(canvas: Canvas, keys: np.ndarray, away: np.ndarray, default: np.uint32) -> np.ndarray:
    """Of several like pixels the packed value (1,) that stands out most among the frequent ones."""
    values, counts = np.unique(keys, return_counts=True)
    values = values[counts > max(2, 0.3 * counts.max())]
    best = values[np.argmax(away @ planes(values, canvas.opaque))] if values.size else default
    return np.array([best], np.uint32)


def _is_any(points: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Which points (C, N) are, but for rounding, one of the colours (C, K), bool (N,)."""
    square = dot(points, points)[:, None] - 2 * points.T @ colours + dot(colours, colours)
    return np.asarray(square.min(axis=1) < (2 * ROUNDING) ** 2)


def _within_reach(canvas: Canvas, cells: np.ndarray, cell: int) -> np.ndarray:
    """Which pixels lie near one of them."""
    row, col = canvas.places(cells)
    own_row, own_col = canvas.places(np.asarray(cell))
    return np.asarray(np.abs(row - own_row) + np.abs(col - own_col) <= _REACH)


def _mixed_near(canvas: Canvas, cell: int, colours: np.ndarray, labels: np.ndarray, inks: int) -> bool:
    """Whether a pixel's colour is a mix of two or three of the known colours within 7 x 7 and the last, the `inks`."""
    near = np.unique(labels[cell + window(canvas.stride, 1, 3)])
    count = colours.shape[1]
    near = colours[:, np.append(near[(near >= 0) & (near < count - inks)], np.arange(count - inks, count))]
    first, second = (near[:, side] for side in np.triu_indices(near.shape[1]))
    here = np.broadcast_to(canvas.colours(np.array([cell])), first.shape)
    beside, _ = third_share(here, first, second, near)
    return bool((beside < 14).any())


def stroke_labels(canvas: Canvas, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
                  noise: float) -> Tuple[np.ndarray, np.ndarray]:
    """The colour of each ridge pixel's stroke.

    Neighbours along the stroke decide together: the colour has to explain them all.

    Parameters
    ----------
    colours : ndarray of shape (C, K) and dtype float32
        Premultiplied palette.
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    noise : float
        How much flat areas vary, levels: the more, the less a faint stroke is believed.

    Returns
    -------
    label : ndarray of shape (R,) and dtype int32
        Label of the stroke, -1 where no colour explains the pixel.
    share : ndarray of shape (R,) and dtype float32
        Coverage of the stroke.
    """
    if not ridges.cells.size or not colours.shape[1]:
        return np.full(ridges.cells.size, -1, np.int32), np.zeros(ridges.cells.size, np.float32)
    chosen = _frequent(ridges, colours)
    colours = colours[:, chosen]
    beside, share = third_share(ridges.colour, ridges.one, ridges.other, colours)
    height = ridges.height
    cost = np.minimum(beside, 60) + 5 * ~_near(canvas, ridges.cells, labels, chosen)
    base = ridges.colour - ridges.off
    cost += 40 * (dot(base, base)[:, None] - 2 * base.T @ colours + dot(colours, colours) < 400)
    vote = _along_strokes(canvas, ridges, cost * np.minimum(height, 120)[:, None])
    choice = np.argmin(vote + 0.3 * beside, axis=1)
    rows = np.arange(choice.size)
    beside, share = beside[rows, choice], share[rows, choice]
    doubt = (noise - ROUNDING) / 100
    clear = (length(ridges.one - ridges.other) < LEAST) & (height > 2 * LEAST)
    good = (beside < 0.25 * height + 10) & (share > np.where(clear, FAINTER, FAINT) + doubt)
    label = np.where(good, chosen[choice], -1).astype(np.int32)
    strong = share > FAINT + doubt
    label[~strong & ~_continuing(canvas, ridges.cells, label, strong, labels)] = -1
    return label, share


def _continuing(canvas: Canvas, cells: np.ndarray, label: np.ndarray, strong: np.ndarray,
                labels: np.ndarray) -> np.ndarray:
    """Which ridge pixels lead to strong ones through others of the same label, away from areas of it, bool (R,)."""
    ring = window(canvas.stride, 1, 1)[:, None]
    weak = np.flatnonzero(~strong & (label >= 0))
    weak = weak[(labels[cells[weak] + ring] != label[weak]).all(axis=0)]
    beside = places_among(cells, cells[weak] + ring)
    # The last one stands for pixels that are no ridges.
    stroke = np.append(np.where(strong, label, -1), -1)
    for _ in range(_ROUNDS):
        led = (stroke[beside] == label[weak]).any(axis=0)
        stroke[weak[led]] = label[weak[led]]
        weak, beside = weak[~led], beside[:, ~led]
    return stroke[:-1] >= 0


def lone_corners(labels: np.ndarray, thin: np.ndarray, cells: np.ndarray, stride: int) -> np.ndarray:
    """Which stroke pixels neither connect nor continue anything: mere corners of an area.

    Round them their label appears in one run or not at all, and no neighbour is a pixel of
    the same stroke that connects something.
    """
    ring = np.array([-stride - 1, -stride, -stride + 1, 1, stride + 1, stride, stride - 1, -1])
    near = cells + ring[:, None]
    connecting = thin[near] & (labels[near] == labels[cells])
    # Two pixels that touch across a corner are connected without the one between them.
    connecting[connecting] = _runs(labels, near[connecting], ring, True) > 1
    return np.asarray((_runs(labels, cells, ring, False) <= 1) & ~connecting.any(axis=0))


def _runs(labels: np.ndarray, cells: np.ndarray, ring: np.ndarray, diagonal: bool) -> np.ndarray:
    """In how many runs the label of each pixel appears in the ring of its neighbours, which begins at a corner.

    With `diagonal` a run goes on across a corner of another label.
    """
    same = labels[cells + ring[:, None]] == labels[cells]
    if diagonal:
        same[::2] |= np.roll(same[1::2], 1, axis=0) & same[1::2]
    return np.asarray((same & ~np.roll(same, 1, axis=0)).sum(axis=0))


def _frequent(ridges: Ridges, colours: np.ndarray) -> np.ndarray:
    """Numbers of at most `COLOURS` colours, those that explain most of a sample of ridge pixels best."""
    count = colours.shape[1]
    if count <= COLOURS:
        return np.arange(count)
    sample = ridges.some(np.arange(0, ridges.cells.size, max(1, ridges.cells.size // 4096)))
    beside, _ = third_share(sample.colour, sample.one, sample.other, colours)
    wins = np.bincount(beside.argmin(axis=1), minlength=count)
    return np.sort(np.argsort(-wins, kind="stable")[:COLOURS])


def _near(canvas: Canvas, cells: np.ndarray, labels: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Which of the labels `chosen` occur within 5 x 5 of pixels, bool (N, K)."""
    place = np.full(max(int(labels.max()), int(chosen.max())) + 2, chosen.size)
    place[chosen] = np.arange(chosen.size)
    near = np.zeros((cells.size, chosen.size + 1), bool)
    rows = np.arange(cells.size)
    for step in window(canvas.stride, 1, 2):
        near[rows, place[labels[cells + step]]] = True
    return near[:, :-1]


def _along_strokes(canvas: Canvas, ridges: Ridges, vote: np.ndarray) -> np.ndarray:
    """Average votes (R, K) over neighbouring ridge pixels that stand out in the same direction."""
    unit = ridges.off / ridges.height
    total = np.ones((len(vote), 1), np.float32)
    links = []
    for step in window(canvas.stride, 1, 1):
        other = next_among(ridges.cells, step)
        agree = dot(unit, unit[:, other])
        rows = np.flatnonzero((other >= 0) & (agree > 0))
        weight = (agree[rows] ** 2)[:, None]
        total[rows] += weight
        links.append((rows, other[rows], weight))
    for _ in range(_ROUNDS):
        mean = vote.copy()
        for rows, other, weight in links:
            mean[rows] += weight * vote[other]
        vote = mean / total
    return vote
