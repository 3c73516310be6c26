# SPDX-License-Identifier: GPL-2.0-or-later
"""Ramps that run into one another, parted where one gradient does not explain them.

A highlight that fades into the flat colour under it leaves no edge to cut along, and
two soft areas whose border fades out are connected.  What tells them apart is that no
single gradient explains both.  So from a seed, the widest part of the ramp, a surface
is fitted and grown as long as it explains what it meets, and the rest is treated
alike (Besl and Jain, "Segmentation through variable-order surface fitting", IEEE
Transactions on Pattern Analysis and Machine Intelligence 10, 1988).
"""

from __future__ import annotations

from typing import Callable, List, NamedTuple, Optional, Tuple

import numpy as np

from .canvas import Canvas
from .components import label_components
from .field import Samples
from .gradient import colours_at, fit_gradient
from .model import Gradient

FIT = 4.0
"""A pixel that is farther than this from a surface does not belong to it, levels of a channel."""

STRANGE = 0.03
"""Share of a ramp that may be unexplained by its gradient before it is parted."""

AREA = 24
"""Smallest surface, px²."""

MOST = 12
"""Most surfaces of one ramp."""

REACH = 32
"""How far beyond its rows and columns a ramp may go on in narrow strips, px."""

_CELLS = 1 << 15
"""A ramp with more pixels than this is parted at a lower resolution."""

_FITTED = 1 << 14
"""A gradient is fitted to this many pixels of a ramp at most."""

_FITS, _COMPARED = 250, 1 << 25
"""Gradients that are fitted to part ramps, and pixels that are compared with them at most: the largest
ramps come first, and those for which nothing is left stay in one piece."""

_WORK = 1 << 24
"""The windows in which ramps are extended have this area at most, px²."""

_STRIP = 1 << 20
"""Pixels times surfaces that are compared at a time."""

_BEYOND = 1.5
"""How far beyond its ramp a gradient goes on, px."""

_NEAR = 3
"""How near ramps come that a stop may lie between, px."""

_CONTACT, _TRIES = 8, 64
"""Fewest pixels where they do so, and how many pairs are tried at most."""

_SEEDS = 72
_DEEP = 12
_ROUNDS = 8
_SMOOTH = 3


class _Ramp(NamedTuple):
    """A ramp, or every n-th row and column of it, in a window of the picture."""

    mask: np.ndarray     # (h, w)
    points: np.ndarray   # (h, w, 2)
    colour: np.ndarray   # (h, w, C), premultiplied


class Surface(NamedTuple):
    """The colours of a ramp.

    Attributes
    ----------
    colours : callable
        Premultiplied colours (n, C) at points (n, 2).
    gradient : Gradient, optional
        None for one colour.
    """

    colours: Callable[[np.ndarray], np.ndarray]
    gradient: Optional[Gradient] = None


def separate(canvas: Canvas, ramps: np.ndarray, count: int, free: np.ndarray) -> Tuple[np.ndarray, List[Surface]]:
    """Part the ramps that no single gradient explains, and extend all to free pixels.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W) and dtype int32
        Number of the ramp of each pixel, -1 where there is none.
    count : int
        How many there are.
    free : ndarray of shape (H, W) and dtype bool
        Pixels that may come to ramps they touch, if they have the colours of those there.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int32
        Likewise; pixels that no surface explains, and surfaces of one flat colour,
        belong to no ramp.
    surfaces : list of Surface
        One for each ramp.
    """
    out = np.full(ramps.shape, -1, np.int32)
    surfaces: List[Surface] = []
    fits, compared = _FITS, _COMPARED
    for cells in sorted(_members(ramps, count), key=len, reverse=True):
        whole, good = _whole(canvas, cells)
        window = _window(cells, ramps.shape, 0)
        area = (window[0].stop - window[0].start) * (window[1].stop - window[1].start)
        parts, some = np.zeros(cells.size, int), [whole]
        if not good and fits > 0 and area * MOST <= compared:
            parts, some, tried = _parted(canvas, cells, window, whole)
            fits, compared = fits - tried, compared - area * len(some)
        for k, surface in enumerate(some):
            if (parts == k).any():
                out.ravel()[cells[parts == k]] = len(surfaces)
                surfaces.append(surface)
    out, surfaces = _joined(canvas, out, surfaces)
    _extend(canvas, out, surfaces, free)
    return out, surfaces


def _members(ramps: np.ndarray, count: int) -> List[np.ndarray]:
    """The pixels of each ramp, in reading order."""
    if not count:
        return []
    cells = np.flatnonzero(ramps >= 0)
    number = ramps.ravel()[cells]
    size = np.bincount(number, minlength=count)
    return np.split(cells[np.argsort(number, kind="stable")], np.cumsum(size)[:-1])


def _window(cells: np.ndarray, shape: Tuple[int, int], margin: int) -> Tuple[slice, slice]:
    """Rows and columns within which pixels lie, and some more on all sides."""
    row, col = np.divmod(cells, shape[1])
    return (slice(max(int(row.min()) - margin, 0), min(int(row.max()) + 1 + margin, shape[0])),
            slice(max(int(col.min()) - margin, 0), min(int(col.max()) + 1 + margin, shape[1])))


def _whole(canvas: Canvas, cells: np.ndarray, limit: float = FIT) -> Tuple[Surface, bool]:
    """The gradient of a ramp, and whether nearly all pixels are nearer to it than a limit."""
    points, colour = _pixels(canvas, cells[::-(-cells.size // _CELLS)])
    surface = _gradient(points, colour)
    return surface, bool(np.mean(np.abs(surface.colours(points) - colour).max(axis=1) > limit) < STRANGE)


def _pixels(canvas: Canvas, cells: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and premultiplied colours (n, C) of pixels numbered without a rim."""
    row, col = np.divmod(cells, canvas.shape[1])
    return np.stack([col, row], axis=1) + 0.5, canvas.colours(canvas.numbers(row, col)).T


def _joined(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface]) -> Tuple[np.ndarray, List[Surface]]:
    """Join ramps that meet without a jump, where one gradient explains both: a stop lies between them."""
    members = _members(ramps, len(surfaces))
    into = list(range(len(surfaces)))
    for one, other, points in _contacts(ramps, len(surfaces)):
        one, other = into[one], into[other]
        off = surfaces[one].colours(points) - surfaces[other].colours(points)
        if one == other or np.median(np.abs(off).max(axis=1)) > 2 * FIT:
            continue
        both = np.concatenate([members[one], members[other]])
        surface, good = _whole(canvas, both, FIT / 2)
        if good and surface.gradient is not None:
            members[one], surfaces[one] = both, surface
            into = [one if k == other else k for k in into]
    kept = sorted(set(into))
    number = np.append([kept.index(k) for k in into], -1).astype(np.int32)
    return number[ramps], [surfaces[k] for k in kept]


def _contacts(ramps: np.ndarray, count: int) -> List[Tuple[int, int, np.ndarray]]:
    """Pairs of ramps that come near each other, those that do so longest first, and points between them."""
    codes, points = [], []
    for axis in (0, 1):
        for step in range(1, _NEAR + 1):
            a, b = ((ramps[step:], ramps[:-step]), (ramps[:, step:], ramps[:, :-step]))[axis]
            row, col = np.nonzero((a != b) & (a >= 0) & (b >= 0))
            low, high = np.sort([a[row, col], b[row, col]], axis=0).astype(np.int64)
            codes.append(low * count + high)
            points.append(np.stack([col, row], axis=1) + 0.5 + np.eye(2)[1 - axis] * step / 2)
    code, place = np.concatenate(codes), np.concatenate(points)
    order = np.argsort(code, kind="stable")
    values, first, size = np.unique(code[order], return_index=True, return_counts=True)
    longest = np.argsort(-size, kind="stable")[:_TRIES]
    return [(*divmod(int(values[k]), count), place[order[first[k]:first[k] + size[k]]])
            for k in longest.tolist() if size[k] >= _CONTACT]


def _extend(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface], free: np.ndarray) -> None:
    """Extend ramps to the free pixels connected with them that have their colours, in place."""
    work = _WORK
    for number, cells in enumerate(_members(ramps, len(surfaces))):
        window = _window(cells, ramps.shape, REACH)
        here = ramps[window]
        work -= here.size
        row, col = np.nonzero(free[window] & (here < 0))
        if work < 0 or not row.size:
            continue
        points, colour = _pixels(canvas, (row + window[0].start) * ramps.shape[1] + col + window[1].start)
        fits = np.abs(surfaces[number].colours(points) - colour).max(axis=1) < FIT
        if not fits.any():
            continue
        own = here == number
        more = own.copy()
        more[row[fits], col[fits]] = True
        area = label_components(more)
        held = np.zeros(int(area.max()) + 1, bool)
        held[area[own]] = True
        here[more & held[area]] = number


def _parted(canvas: Canvas, cells: np.ndarray, window: Tuple[slice, slice],
            whole: Surface) -> Tuple[np.ndarray, List[Surface], int]:
    """Number of the surface of each pixel of a ramp, -1 for none, the surfaces, and the gradients fitted."""
    row, col = np.divmod(cells, canvas.shape[1])
    mask = np.zeros([part.stop - part.start for part in window], bool)
    mask[row - window[0].start, col - window[1].start] = True
    step = int(np.ceil(np.sqrt(max(cells.size / _CELLS, mask.size / (8 * _CELLS)))))
    surfaces, fits = _surfaces(_ramp(canvas, mask, window, step), AREA / step**2)
    if not surfaces:
        return np.zeros(cells.size, int), [whole], fits
    parts = _assigned(canvas, mask, window, surfaces)
    _drop_flat(parts, canvas.bare(canvas.keys)[window], surfaces)
    return parts[mask], surfaces, fits


def _ramp(canvas: Canvas, mask: np.ndarray, window: Tuple[slice, slice], step: int) -> _Ramp:
    """Every `step`-th row and column of a ramp."""
    rows, cols = (np.arange(part.start, part.stop, step) for part in window)
    row, col = np.meshgrid(rows, cols, indexing="ij")
    colour = canvas.colours(canvas.numbers(row, col))
    return _Ramp(mask[::step, ::step], np.stack([col, row], axis=-1) + 0.5, np.moveaxis(colour, 0, -1))


def _off(ramp: _Ramp, surface: Surface) -> np.ndarray:
    """How far pixels (h, w) are from a surface, levels of a channel; infinite outside of the ramp."""
    off = np.full(ramp.mask.shape, np.inf)
    off[ramp.mask] = np.abs(surface.colours(ramp.points[ramp.mask]) - ramp.colour[ramp.mask]).max(axis=1)
    return off


def _surfaces(ramp: _Ramp, area: float) -> Tuple[List[Surface], int]:
    """Surfaces that together explain most of a ramp, as far as they are wide, and the gradients fitted."""
    left = ramp.mask.copy()
    found: List[Surface] = []
    fits = 0
    while len(found) < MOST and fits < _SEEDS:
        seed = _widest(left)
        if seed is None:
            break
        surface, part, tried = _grown(ramp, left, seed)
        fits += tried
        if np.count_nonzero(part) >= area:
            found.append(surface)
        left &= ~(part | seed)
    return found, fits


def _widest(mask: np.ndarray) -> Optional[np.ndarray]:
    """A square in the widest part of a mask; None where it is nowhere five pixels wide."""
    inner, depth = np.pad(mask, 1), 0
    while depth < _DEEP:
        less = _eroded(inner)
        if not less.any():
            break
        inner, depth = less, depth + 1
    if depth < 2:
        return None
    row, col = (place[place.size // 2] - 1 for place in np.nonzero(inner))
    seed = np.zeros_like(mask)
    seed[max(row - depth, 0):row + depth + 1, max(col - depth, 0):col + depth + 1] = True
    return np.asarray(seed & mask)


def _eroded(mask: np.ndarray) -> np.ndarray:
    """The pixels whose eight neighbours are all set; the outermost ones are not."""
    rows = mask[:, 1:-1] & mask[:, 2:] & mask[:, :-2]
    out = np.zeros_like(mask)
    out[1:-1, 1:-1] = rows[1:-1] & rows[2:] & rows[:-2]
    return out


def _grown(ramp: _Ramp, left: np.ndarray, seed: np.ndarray) -> Tuple[Surface, np.ndarray, int]:
    """The surface of a seed, all pixels connected with the seed that it explains, and the gradients fitted."""
    part = seed
    for _ in range(_ROUNDS):
        before, part = part, _reached(ramp, left, seed, _polynomial(ramp, part))
        if np.count_nonzero(part) < 1.05 * np.count_nonzero(before):
            break
    fits = 0
    while fits < 3:
        fits += 1
        surface = _gradient(ramp.points[part], ramp.colour[part])
        before, part = part, _reached(ramp, left, seed, surface)
        if np.count_nonzero(part) < 1.02 * np.count_nonzero(before):
            break
    return surface, part, fits


def _reached(ramp: _Ramp, left: np.ndarray, seed: np.ndarray, surface: Surface) -> np.ndarray:
    """The pixels that a surface explains and that are connected with the seed."""
    fits = left & (_off(ramp, surface) < FIT)
    area = label_components(fits)
    inside = area[seed & fits]
    return np.asarray(fits & (area == np.bincount(inside).argmax()) if inside.size else fits & seed)


def _polynomial(ramp: _Ramp, part: np.ndarray) -> Surface:
    """The colours of some pixels as polynomials of the second degree."""
    points, colour = ramp.points[part], ramp.colour[part]
    middle = points.mean(axis=0)
    size = np.abs(points - middle).max()

    def terms(at: np.ndarray) -> np.ndarray:
        x, y = ((at - middle) / size).T
        return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)

    basis = terms(points)
    # A little stiffness, or the rounding of few pixels bends the surface far away from them.
    matrix = basis.T.dot(basis) + np.diag([0, 0, 0, 1, 1, 1]) * (1e-3 * len(points)) + 1e-9 * np.eye(6)
    values = np.linalg.solve(matrix, basis.T.dot(colour))
    return Surface(lambda at: terms(at).dot(values))


def _gradient(points: np.ndarray, colour: np.ndarray) -> Surface:
    """The gradient of some pixels, or else their median colour, as a surface."""
    reach = np.concatenate([points - _BEYOND, points + _BEYOND])
    some = np.linspace(0, len(points) - 1, min(len(points), _FITTED)).astype(int)
    count = np.full(some.size, len(points) / some.size)
    gradient = fit_gradient(Samples(points[some], colour[some].astype(np.float64), count), reach)
    if gradient is None:
        middle = np.median(colour, axis=0)
        return Surface(lambda at: np.broadcast_to(middle, (len(at), len(middle))))
    return Surface(lambda at: colours_at(gradient, at)[:, :colour.shape[1]], gradient)


def _assigned(canvas: Canvas, mask: np.ndarray, window: Tuple[slice, slice], surfaces: List[Surface]) -> np.ndarray:
    """The number of the surface that explains each pixel of a ramp best, -1 for none."""
    parts = np.full(mask.shape, -1, np.int32)
    rows = max(8 * _SMOOTH, _STRIP // (mask.shape[1] * len(surfaces)))
    for first in range(0, len(mask), rows):
        start, stop = max(first - _SMOOTH, 0), min(first + rows + _SMOOTH, len(mask))
        strip = slice(window[0].start + start, window[0].start + stop), window[1]
        nearest = _nearest(_ramp(canvas, mask[start:stop], strip, 1), surfaces)
        parts[first:first + rows] = nearest[first - start:first - start + rows]
    area = label_components(parts)
    parts[np.bincount(area.ravel())[area] < AREA] = -1
    return parts


def _nearest(ramp: _Ramp, surfaces: List[Surface]) -> np.ndarray:
    """The number of the surface that explains each pixel best, -1 for none.

    Where several explain it alike, its surroundings decide.
    """
    off = np.stack([_off(ramp, surface) for surface in surfaces])
    cost = np.minimum(off, 3 * FIT) ** 2
    cost[:, ~ramp.mask] = 0
    alike = cost < cost.min(axis=0) + FIT**2
    smooth = np.stack([_blurred(plane) for plane in cost])
    parts: np.ndarray = np.where(alike, smooth, np.inf).argmin(axis=0)
    parts[~ramp.mask | (off.min(axis=0) > 2 * FIT)] = -1
    return parts


def _drop_flat(parts: np.ndarray, keys: np.ndarray, surfaces: List[Surface]) -> None:
    """Take the surfaces out, in place, most of whose pixels have one and the same colour."""
    for k, surface in enumerate(surfaces):
        some = parts == k
        if surface.gradient is None and some.any():
            _, counts = np.unique(keys[some], return_counts=True)
            if 2 * counts.max() > counts.sum():
                parts[some] = -1


def _blurred(values: np.ndarray) -> np.ndarray:
    """Sums over squares round each pixel."""
    wide = 2 * _SMOOTH + 1
    total = np.pad(values, _SMOOTH + 1, mode="edge").cumsum(axis=0).cumsum(axis=1)
    sums: np.ndarray = total[wide:, wide:] - total[:-wide, wide:] - total[wide:, :-wide] + total[:-wide, :-wide]
    return sums[:-1, :-1]
