# SPDX-License-Identifier: GPL-2.0-or-later
"""The gradient that explains the colours of a region, if one pays for its bytes.

A gradient costs what it leaves unexplained and a price for its size in the file, as in
the minimum description length principle (Rissanen, Automatica 14, 1978).  The cheapest
of none, a linear, a radial and an elliptic one is taken.
"""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from .field import Field, Samples, refined, squares, total_error, unexplained, weighted_quantile
from .model import Gradient
from .parallels import Parallels, first_field, parallels, slopes
from .stops import BINS, choose_stops, profile

PRICE = 16.0
"""What a byte of the file must save, squared levels of a channel times px."""

BYTES = 150
"""Size of a gradient with two stops, and of what refers to it."""

STOP_BYTES = 35
"""Size of each further stop."""

ELLIPSE_BYTES = 40
"""What an ellipse needs beyond a circle."""

_KINDS = (("linear", False), ("radial", False), ("radial", True))

_EXACT = 0.25
"""Mean squared error per channel that no other gradient need try to lower, squared levels."""

_STRAY = 0.005
"""Share of pixels far from the gradient from which on it is fitted again without them."""

_CELLS, _COARSE = 2000, 700
"""Pixels are averaged in squares until there are about this many at most; fewer do to find the field."""

_SQUARE = 3.0
"""Smallest squares in which slopes of the colour are measured, px."""

_REACH = 0.75
"""How far a gradient reaches beyond the outermost pixel centres, px."""


def fit_gradient(samples: Samples, reach: np.ndarray, straight: bool = False) -> Optional[Gradient]:
    """Find the cheapest gradient for a region.

    Parameters
    ----------
    samples : Samples
        Colours well inside the region.
    reach : ndarray of shape (m, 2)
        Points up to which the gradient must go on.
    straight : bool
        Whether only linear gradients are considered.

    Returns
    -------
    Gradient or None
        None where the mean colour is the cheapest.
    """
    middle = np.average(samples.points, axis=0, weights=samples.count)
    size = np.sqrt(np.average((samples.points - middle) ** 2, axis=0, weights=samples.count).sum())
    if size == 0:
        return None
    cells = _averaged(samples, _CELLS)
    best, least = None, _error(cells, np.average(cells.colour, axis=0, weights=cells.count))
    exact = _EXACT * samples.count.sum() * cells.colour.shape[1]
    if least <= exact + PRICE * BYTES:
        return None
    unit = _Unit(middle, size)
    slope = slopes(samples, max(_SQUARE, np.sqrt(len(samples.points)) / 8))
    known = parallels(slope._replace(points=unit.local(slope.points)))
    local, coarse = (some._replace(points=unit.local(some.points)) for some in (cells, _averaged(cells, _COARSE)))
    region = _Region(cells, local, coarse, unit.local(reach), unit)
    for candidate in _candidates(known, region, straight, exact):
        if candidate.least >= least:
            continue
        gradient = _fitted(candidate, region)
        cost = _error(cells, colours_at(gradient, cells.points)) + price(gradient)
        if cost < least:
            best, least = gradient, cost
    return best


class _Unit(NamedTuple):
    """Coordinates in which a region lies about the origin and has the size 1."""

    middle: np.ndarray
    size: float

    def local(self, points: np.ndarray) -> np.ndarray:
        return np.asarray((points - self.middle) / self.size)

    def back(self, points: np.ndarray) -> np.ndarray:
        return self.middle + self.size * points


class _Region(NamedTuple):
    cells: Samples       # in the coordinates of the picture
    local: Samples       # the same in those of `unit`
    coarse: Samples      # fewer, likewise
    reach: np.ndarray    # (m, 2) up to where the gradient must go on, likewise
    unit: _Unit


class _Candidate(NamedTuple):
    field: Field
    off: np.ndarray      # (n, C) what even free colours along it leave of the local samples
    least: float         # what its gradient costs at least


def _candidates(known: Tuple[Parallels, Parallels], region: _Region, straight: bool,
                exact: float) -> List[_Candidate]:
    """The best field of each kind, up to the first that explains all; the most promising kind comes first.

    It is the stops that take long, and other kinds seldom need them then.
    """
    found = []
    for kind, elliptic in _KINDS[:1] if straight else _KINDS:
        field = first_field(known, region.coarse, kind, elliptic)
        if field is not None:
            field = refined(field, region.coarse)
            off = unexplained(field, region.local)
            error = total_error(off, region.local.count)
            found.append(_Candidate(field, off, error + PRICE * (BYTES + elliptic * ELLIPSE_BYTES)))
            if error <= exact:
                break
    kinds = [candidate.field.kind for candidate in sorted(found, key=lambda one: one.least)]
    return sorted(found, key=lambda one: one.field.kind != kinds[0])


def _fitted(candidate: _Candidate, region: _Region) -> Gradient:
    """The best gradient like a field."""
    field, off, _ = candidate
    samples = region.local
    square = (off ** 2).sum(axis=1)
    trust = 1 / (1 + square / (9 * weighted_quantile(square, samples.count, 0.7) + 9)) ** 2
    if np.average(trust < 0.5, weights=samples.count) > _STRAY:
        samples = samples._replace(count=samples.count * trust)
        field = refined(field, samples)
    return _with_stops(field, region, samples)


def price(gradient: Gradient) -> float:
    """What a gradient must save to be worth its bytes, squared levels times px."""
    size = BYTES + STOP_BYTES * (len(gradient.stops) - 2) + (ELLIPSE_BYTES if gradient.across else 0)
    return PRICE * size


def _error(samples: Samples, colour: np.ndarray) -> float:
    """By how much samples differ from a colour, or each from one, (C,) or (n, C or more)."""
    return total_error(samples.colour - colour[..., :samples.colour.shape[1]], samples.count)


def _averaged(samples: Samples, most: int) -> Samples:
    """Fewer samples, each the mean over a small square."""
    side = np.ceil(np.sqrt(samples.count.sum() / most))
    if side <= 1:
        return samples
    number, cells, _ = squares(samples.points, side, most)
    count = np.bincount(number, samples.count, cells)

    def mean(values: np.ndarray) -> np.ndarray:
        return np.stack([np.bincount(number, samples.count * v, cells) / count for v in values.T], axis=1)

    return Samples(mean(samples.points), mean(samples.colour), count)


def _with_stops(field: Field, region: _Region, samples: Samples) -> Gradient:
    """The gradient along a field, in the coordinates of the picture."""
    place = field.places(samples.points)
    low, length = place.min(), max(np.ptp(place), 1e-9)
    bins = profile((place - low) / length, samples.colour, samples.count)
    knots, values = choose_stops(bins, PRICE * STOP_BYTES)
    begins, ends = knots[0] < 1.5 / BINS, knots[-1] > 1 - 1.5 / BINS
    knots = low + knots * length
    reach, margin = field.places(region.reach), _REACH / region.unit.size
    radial = field.kind == "radial"
    if begins:
        knots, values = _prolonged(knots, values, max(reach.min() - margin, 0.0 if radial else -np.inf))
    if ends:
        knots, values = (a[::-1] for a in _prolonged(knots[::-1], values[::-1], reach.max() + margin))
    stops = _stops(knots, values, 0.0 if radial else knots[0])
    if not radial:
        start, end = (_pair(region.unit.back(knot * field.axis)) for knot in (knots[0], knots[-1]))
        return Gradient("linear", start, end, stops)
    measure, axes = np.linalg.eigh(field.matrix)
    centre = field.values[:2]
    end, across = (_pair(region.unit.back(centre + knots[-1] * axis / np.sqrt(square)))
                   for axis, square in zip(axes.T, measure))
    return Gradient("radial", _pair(region.unit.back(centre)), end, stops,
                    across if len(field.values) == 4 else None)


def _prolonged(knots: np.ndarray, values: np.ndarray, end: float) -> Tuple[np.ndarray, np.ndarray]:
    """The first stop moved out to `end` along the slope that it begins, as far as its colour allows."""
    knots, values = knots.copy(), values.copy()
    step = values[0] - values[1]
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.where(step > 0, (255 - values[0]) / step, np.where(step < 0, values[0] / -step, np.inf))
    share = min((end - knots[0]) / (knots[0] - knots[1]), room.min(), 1.0)
    if share > 0:
        knots[0] += share * (knots[0] - knots[1])
        values[0] += share * step
    return knots, values


def _stops(knots: np.ndarray, values: np.ndarray,
           begin: float) -> Tuple[Tuple[float, Tuple[int, int, int], float], ...]:
    """Stops of a gradient whose offset 0 lies at `begin`."""
    offsets = (knots - begin) / (knots[-1] - begin)
    levels = np.clip(np.rint(values), 0, 255).astype(int).tolist()
    return tuple((round(offset, 4), (r, g, b), round(alpha[0] / 255, 4) if alpha else 1.0)
                 for offset, (r, g, b, *alpha) in zip(offsets.tolist(), levels))


def _pair(point: np.ndarray) -> Tuple[float, float]:
    x, y = np.round(point, 2).tolist()
    return x, y


def colours_at(gradient: Gradient, points: np.ndarray) -> np.ndarray:
    """Colours of a gradient.

    Parameters
    ----------
    gradient : Gradient
    points : ndarray of shape (n, 2)

    Returns
    -------
    ndarray of shape (n, 4) and dtype float64
        Premultiplied RGBA, 0 to 255.
    """
    offsets = np.array([stop[0] for stop in gradient.stops])
    stops = np.array([(*stop[1], 255 * stop[2]) for stop in gradient.stops], float)
    place = offsets_at(gradient, points)
    colour = np.empty((len(points), 4))
    for channel in range(4):
        same = (stops[:, channel] == stops[0, channel]).all()
        colour[:, channel] = stops[0, channel] if same else np.interp(place, offsets, stops[:, channel])
    if (stops[:, 3] < 255).any():
        colour[:, :3] *= colour[:, 3:] / 255
    return colour


def offsets_at(gradient: Gradient, points: np.ndarray) -> np.ndarray:
    """How far along each point lies, 0 at the start and 1 at the end."""
    start = np.array(gradient.start)
    along = np.array(gradient.end) - start
    offset = points - start
    if gradient.kind == "linear":
        return np.asarray(offset.dot(along) / max(along.dot(along), 1e-12))
    across = np.array(gradient.across) - start if gradient.across else np.array([-along[1], along[0]])
    share = offset.dot(np.linalg.inv(np.stack([along, across])))
    return np.asarray(np.sqrt(np.einsum("nk,nk->n", share, share)))
