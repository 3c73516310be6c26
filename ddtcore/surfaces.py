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

_BEYOND = 1.5
"""How far beyond its ramp a gradient goes on, px."""

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
    """Part the ramps that no single gradient explains.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W) and dtype int32
        Number of the ramp of each pixel, -1 where there is none.
    count : int
        How many there are.

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
    for number, window in enumerate(_windows(ramps, count)):
        mask = ramps[window] == number
        parts, some = _parted(canvas, mask, window)
        here = out[window]
        for k, surface in enumerate(some):
            if (parts == k).any():
                here[parts == k] = len(surfaces)
                surfaces.append(surface)
    for number, window in enumerate(_windows(out, len(surfaces), REACH)):
        _grow(canvas, out[window], free[window], window, number, surfaces[number])
    return out, surfaces


def _grow(canvas: Canvas, ramps: np.ndarray, free: np.ndarray, window: Tuple[slice, slice], number: int,
          surface: Surface) -> None:
    """Extend a ramp to the free pixels connected with it that have its colours, in place."""
    row, col = np.nonzero(free & (ramps < 0))
    if not row.size:
        return
    row_there, col_there = row + window[0].start, col + window[1].start
    off = surface.colours(np.stack([col_there, row_there], axis=1) + 0.5) - canvas.colours(
        canvas.numbers(row_there, col_there)).T
    fits = np.abs(off).max(axis=1) < FIT
    more = ramps == number
    more[row[fits], col[fits]] = True
    area = label_components(more)
    own = np.zeros(int(area.max()) + 1, bool)
    own[area[ramps == number]] = True
    ramps[more & own[area]] = number


def _windows(ramps: np.ndarray, count: int, margin: int = 0) -> List[Tuple[slice, slice]]:
    """Rows and columns within which each ramp lies, and some more on all sides."""
    row, col = np.nonzero(ramps >= 0)
    number = ramps[row, col]
    low, high = np.full((2, count), max(ramps.shape)), np.zeros((2, count), int)
    for axis, place in enumerate((row, col)):
        np.minimum.at(low[axis], number, place)
        np.maximum.at(high[axis], number, place)
    return [tuple(slice(max(a - margin, 0), b + 1 + margin) for a, b in zip(*ends)) for ends in zip(low.T, high.T)]


def _parted(canvas: Canvas, mask: np.ndarray,
            window: Tuple[slice, slice]) -> Tuple[np.ndarray, List[Surface]]:
    """Number of the surface of each pixel, -1 for none, and the surfaces."""
    full = _ramp(canvas, mask, window, 1)
    step = int(np.ceil(np.sqrt(np.count_nonzero(mask) / _CELLS)))
    coarse = full if step == 1 else _ramp(canvas, mask, window, step)
    whole = _gradient(coarse, coarse.mask)
    off = _off(coarse, whole)[coarse.mask]
    if np.mean(off > FIT) < STRANGE:
        return np.where(mask, 0, -1), [whole]
    surfaces = _surfaces(coarse, AREA / step**2)
    if not surfaces:
        return np.where(mask, 0, -1), [whole]
    return _assigned(full, canvas.bare(canvas.keys)[window], surfaces), surfaces


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


def _surfaces(ramp: _Ramp, area: float) -> List[Surface]:
    """Surfaces that together explain most of a ramp, as far as they are wide."""
    left = ramp.mask.copy()
    found = []
    while len(found) < MOST:
        seed = _widest(left)
        if seed is None:
            break
        surface, part = _grown(ramp, left, seed)
        if np.count_nonzero(part) >= area:
            found.append(surface)
        left &= ~(part | seed)
    return found


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
    return seed & mask


def _eroded(mask: np.ndarray) -> np.ndarray:
    """The pixels whose eight neighbours are all set; the outermost ones are not."""
    rows = mask[:, 1:-1] & mask[:, 2:] & mask[:, :-2]
    out = np.zeros_like(mask)
    out[1:-1, 1:-1] = rows[1:-1] & rows[2:] & rows[:-2]
    return out


def _grown(ramp: _Ramp, left: np.ndarray, seed: np.ndarray) -> Tuple[Surface, np.ndarray]:
    """The surface of a seed, and all pixels connected with the seed that it explains."""
    part = seed
    for _ in range(_ROUNDS):
        before, part = part, _reached(ramp, left, seed, _polynomial(ramp, part))
        if np.count_nonzero(part) < 1.05 * np.count_nonzero(before):
            break
    for _ in range(3):
        surface = _gradient(ramp, part)
        before, part = part, _reached(ramp, left, seed, surface)
        if np.count_nonzero(part) < 1.02 * np.count_nonzero(before):
            break
    return surface, part


def _reached(ramp: _Ramp, left: np.ndarray, seed: np.ndarray, surface: Surface) -> np.ndarray:
    """The pixels that a surface explains and that are connected with the seed."""
    fits = left & (_off(ramp, surface) < FIT)
    area = label_components(fits)
    inside = area[seed & fits]
    return fits & (area == np.bincount(inside).argmax()) if inside.size else fits & seed


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


def _gradient(ramp: _Ramp, part: np.ndarray) -> Surface:
    """The gradient of some pixels, or else their median colour, as a surface."""
    points, colour = ramp.points[part], ramp.colour[part].astype(np.float64)
    reach = np.concatenate([points + step for step in ((-_BEYOND, -_BEYOND), (_BEYOND, _BEYOND))])
    gradient = fit_gradient(Samples(points, colour, np.ones(len(points))), reach)
    if gradient is None:
        middle = np.median(colour, axis=0)
        return Surface(lambda at: np.broadcast_to(middle, (len(at), len(middle))))
    return Surface(lambda at: colours_at(gradient, at)[:, :colour.shape[1]], gradient)


def _assigned(ramp: _Ramp, keys: np.ndarray,
              surfaces: List[Surface]) -> np.ndarray:
    """The number of the surface that explains each pixel best, -1 for none.

    Where several explain it alike, its surroundings decide.
    """
    if not surfaces:
        return np.full(ramp.mask.shape, -1)
    off = np.stack([_off(ramp, surface) for surface in surfaces])
    cost = np.minimum(off, 3 * FIT) ** 2
    cost[:, ~ramp.mask] = 0
    smooth = np.stack([_blurred(c) for c in cost])
    best = cost.argmin(axis=0)
    least = np.take_along_axis(cost, best[None], 0)[0]
    tied = (cost < least + FIT**2).sum(axis=0) > 1
    near = np.where(cost < least + FIT**2, smooth, np.inf).argmin(axis=0)
    parts = np.where(tied, near, best)
    parts[~ramp.mask | (off.min(axis=0) > 2 * FIT)] = -1
    area = label_components(parts)
    parts[np.bincount(area.ravel())[area] < AREA] = -1
    for k, surface in enumerate(surfaces):
        some = parts == k
        if surface.gradient is None and some.any():
            _, counts = np.unique(keys[some], return_counts=True)
            if 2 * counts.max() > counts.sum():
                parts[some] = -1
    return parts


def _blurred(values: np.ndarray) -> np.ndarray:
    """Sums over squares round each pixel."""
    wide = 2 * _SMOOTH + 1
    total = np.pad(values, _SMOOTH + 1, mode="edge").cumsum(axis=0).cumsum(axis=1)
    return (total[wide:, wide:] - total[:-wide, wide:] - total[wide:, :-wide] + total[:-wide, :-wide])[:-1, :-1]
