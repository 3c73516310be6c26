# SPDX-License-Identifier: GPL-2.0-or-later
"""Surfaces that grow from seeds: the parts of a ramp that one gradient each explains.

From a seed, the widest part of the ramp, a surface is fitted and grown as long as it
explains what it meets, and the rest is treated alike (Besl and Jain, "Segmentation
through variable-order surface fitting", IEEE Transactions on Pattern Analysis and
Machine Intelligence 10, 1988).
"""

from __future__ import annotations

from typing import Callable, Iterable, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from .canvas import Canvas, planes
from .components import mask_areas
from .gradient import Wanted, colours_at, fit_gradients
from .model import Gradient
from .samples import Samples

FIT = 4.0
"""A pixel that is farther than this from a surface does not belong to it, levels of a channel."""

MOST = 12
"""Most surfaces of one ramp."""

_FITTED = 1 << 14
"""A gradient is fitted to this many pixels of a ramp at most."""

_BEYOND = 1.5
"""How far beyond its ramp a gradient goes on, px."""

_SEEDS = 72
_DEEP = 12
_ROUNDS = 8


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


class Ramp(NamedTuple):
    """A ramp, or every n-th row and column of it, in a window of the picture."""

    mask: np.ndarray     # (h, w)
    points: np.ndarray   # (n, 2) the pixels of the mask, in reading order
    colour: np.ndarray   # (n, C), premultiplied

    @classmethod
    def of(cls, canvas: Canvas, mask: np.ndarray, window: Tuple[slice, slice], step: int = 1) -> Ramp:
        """Every `step`-th row and column of a ramp in a window."""
        mask = mask[::step, ::step]
        row, col = np.nonzero(mask)
        colour = planes(canvas.bare(canvas.keys)[window][::step, ::step][mask], canvas.opaque).T
        return cls(mask, np.stack([col * step + window[1].start, row * step + window[0].start], axis=1) + 0.5, colour)

    def off(self, surface: Surface) -> np.ndarray:
        """How far pixels (h, w) are from a surface, levels of a channel; infinite outside of the ramp."""
        off = np.full(self.mask.shape, np.inf)
        off[self.mask] = distance(surface, self.points, self.colour)
        return off


def distance(surface: Surface, points: np.ndarray, colour: np.ndarray) -> np.ndarray:
    """How far colours (n, C) at points (n, 2) are from those of a surface, levels of a channel."""
    return np.asarray(np.abs(surface.colours(points) - colour).max(axis=1))


def grown_surfaces(ramp: Ramp, area: float, fit: float = FIT) -> Tuple[List[Surface], int]:
    """Surfaces that together explain most of a ramp, as far as they are wide, and the gradients fitted.

    Parameters
    ----------
    ramp : Ramp
    area : float
        Fewest pixels of a surface.
    fit : float
        A pixel that is farther than this from a surface does not belong to it, levels.
    """
    left = ramp.mask.copy()
    found: List[Surface] = []
    fits = 0
    while len(found) < MOST and fits < _SEEDS:
        seed = _widest(left)
        if seed is None:
            break
        surface, part, tried = _grown(ramp, left, seed, fit)
        fits += tried
        if np.count_nonzero(part) >= area:
            found.append(surface)
        left &= ~(part | seed)
    return found, fits


def _widest(mask: np.ndarray) -> Optional[np.ndarray]:
    """A square in the widest part of a mask; None where it is nowhere five pixels wide."""
    inner, depth = np.pad(mask, 1, mode="constant"), 0
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


def _grown(ramp: Ramp, left: np.ndarray, seed: np.ndarray, fit: float) -> Tuple[Surface, np.ndarray, int]:
    """The surface of a seed, all pixels connected with the seed that it explains, and the gradients fitted."""
    part = seed
    for _ in range(_ROUNDS):
        before, part = part, _reached(ramp, left, seed, _polynomial(ramp, part), fit)
        if np.count_nonzero(part) < 1.05 * np.count_nonzero(before):
            break
    fits = 0
    while fits < 3:
        fits += 1
        own = part[ramp.mask]
        surface, = fitted_surfaces([(ramp.points[own], ramp.colour[own])])
        before, part = part, _reached(ramp, left, seed, surface, fit)
        if np.count_nonzero(part) < 1.02 * np.count_nonzero(before):
            break
    return surface, part, fits


def _reached(ramp: Ramp, left: np.ndarray, seed: np.ndarray, surface: Surface, fit: float) -> np.ndarray:
    """The pixels that a surface explains and that are connected with the seed."""
    fits = left & (ramp.off(surface) < fit)
    areas = mask_areas(fits)
    inside = areas.at(np.flatnonzero(seed & fits))
    size = np.bincount(inside[inside >= 0])
    if not size.size:
        return np.asarray(fits & seed)
    reached = np.zeros(fits.shape, bool)
    areas.put(reached.ravel(), np.where(np.arange(areas.size.size) == size.argmax(), 1, -1))
    return reached


def _polynomial(ramp: Ramp, part: np.ndarray) -> Surface:
    """The colours of some pixels as polynomials of the second degree."""
    own = part[ramp.mask]
    points, colour = ramp.points[own], ramp.colour[own]
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


def fitted_surfaces(ramps: Iterable[Tuple[np.ndarray, np.ndarray]], beyond: float = _BEYOND) -> List[Surface]:
    """The gradients of some ramps, or else their median colours, by the centres and colours of their pixels.

    They go on for so many px `beyond` these.
    """
    middles = []

    def wanted() -> Iterator[Wanted]:
        for points, colour in ramps:
            middles.append(np.median(colour, axis=0))
            reach = np.concatenate([points - beyond, points + beyond])
            some = np.linspace(0, len(points) - 1, min(len(points), _FITTED)).astype(int)
            count = np.full(some.size, len(points) / some.size)
            yield Wanted(Samples(points[some], colour[some].astype(np.float64), count), reach)

    return [_surface(gradient, middle) for gradient, middle in zip(fit_gradients(wanted()), middles)]


def _surface(gradient: Optional[Gradient], middle: np.ndarray) -> Surface:
    """A gradient, or else a colour (C,), as a surface."""
    if gradient is None:
        return Surface(lambda at: np.broadcast_to(middle, (len(at), len(middle))))
    return gradient_surface(gradient, len(middle))


def gradient_surface(gradient: Gradient, channels: int) -> Surface:
    """A gradient as a surface, with 3 or 4 channels."""
    return Surface(lambda at: colours_at(gradient, at)[:, :channels], gradient)
