# SPDX-License-Identifier: GPL-2.0-or-later
"""The gradients that explain the colours of regions, where one pays for its bytes.

A gradient costs what it leaves unexplained and a price for its size in the file, as in
the minimum description length principle (Rissanen, Automatica 14, 1978).  The cheapest
of none, a linear, a radial and an elliptic one is taken.  What takes long is done for
many regions at a time.
"""

from __future__ import annotations

from typing import Iterable, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from .field import Field, Fields, refined, unexplained
from .model import Gradient
from .parallels import Parallels, first_fields, parallels, slopes
from .prolonged import Unit, with_stops
from .samples import Batch, Samples, squares, total_error, total_errors, weighted_quantile

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

_MANY = 64
"""Regions that are worked on at a time."""


class Wanted(NamedTuple):
    """A region for which a gradient is looked for.

    Attributes
    ----------
    samples : Samples
        Colours well inside the region.
    reach : ndarray of shape (m, 2)
        Points up to which the gradient must go on.
    kinds : int
        1 if only linear gradients are considered, 2 if circular ones are, too, or all 3.
    """

    samples: Samples
    reach: np.ndarray
    kinds: int = 3


def fit_gradients(regions: Iterable[Wanted]) -> List[Optional[Gradient]]:
    """Find the cheapest gradient for each of some regions, all with as many channels.

    Returns
    -------
    list of Gradient or None
        None where the mean colour is the cheapest.
    """
    found: List[Optional[Gradient]] = []
    known, places = [], []
    for wanted in regions:
        region = _Region.of(wanted)
        if region is not None:
            known.append(region)
            places.append(len(found))
        found.append(None)
        if len(known) == _MANY:
            _fit(known, places, found)
            known, places = [], []
    if known:
        _fit(known, places, found)
    return found


class _Region(NamedTuple):
    cells: Samples       # in the coordinates of the picture
    local: Samples       # the same in those of `unit`
    coarse: Samples      # fewer, likewise
    reach: np.ndarray    # (m, 2) up to where the gradient must go on, likewise
    unit: Unit
    known: Tuple[Parallels, Parallels]
    kinds: int           # as wanted
    least: float         # what the mean colour costs
    exact: float         # what need not be lowered

    @classmethod
    def of(cls, wanted: Wanted) -> Optional[_Region]:
        """What is to be known of a region; None if no gradient pays."""
        samples = wanted.samples
        middle = np.average(samples.points, axis=0, weights=samples.count)
        size = np.sqrt(np.average((samples.points - middle) ** 2, axis=0, weights=samples.count).sum())
        if size == 0:
            return None
        cells = _averaged(samples, _CELLS)
        least = _error(cells, np.average(cells.colour, axis=0, weights=cells.count))
        exact = _EXACT * samples.count.sum() * cells.colour.shape[1]
        if least <= exact + PRICE * BYTES:
            return None
        unit = Unit(middle, size)
        slope = slopes(samples, max(_SQUARE, np.sqrt(len(samples.points)) / 8))
        known = parallels(slope._replace(points=unit.local(slope.points)))
        local, coarse = (some._replace(points=unit.local(some.points)) for some in (cells, _averaged(cells, _COARSE)))
        return cls(cells, local, coarse, unit.local(wanted.reach), unit, known, wanted.kinds, least, exact)


class _Candidate(NamedTuple):
    kind: int            # of `_KINDS`
    field: Field
    off: np.ndarray      # (n, C) what even free colours along it leave of the local samples
    least: float         # what its gradient costs at least


def _fit(regions: Sequence[_Region], places: Sequence[int], found: List[Optional[Gradient]]) -> None:
    """Put the cheapest gradients of regions at their places among those that are found."""
    least = [region.least for region in regions]
    waiting = _candidates(regions)
    while any(waiting):
        tried = [k for k, some in enumerate(waiting) if some and some[0].least < least[k]]
        fields = [waiting[k][0] for k in tried]
        for k, gradient in zip(tried, _fitted(fields, [regions[k] for k in tried])):
            cells = regions[k].cells
            cost = _error(cells, colours_at(gradient, cells.points)) + price(gradient)
            if cost < least[k]:
                found[places[k]], least[k] = gradient, cost
        waiting = [some[1:] for some in waiting]


def _candidates(regions: Sequence[_Region]) -> List[List[_Candidate]]:
    """The best field of each kind, up to the first that explains all; the most promising kind comes first.

    It is the stops that take long, and other kinds seldom need them then.
    """
    found: List[List[_Candidate]] = [[] for _ in regions]
    left = np.arange(len(regions))
    for kind, (name, elliptic) in enumerate(_KINDS):
        left = left[[regions[k].kinds > kind for k in left.tolist()]]
        if not left.size:
            break
        some = [regions[k] for k in left.tolist()]
        coarse, local = (Batch.of(samples) for samples in zip(*((each.coarse, each.local) for each in some)))
        fields, sound = first_fields([each.known for each in some], coarse, name, elliptic)
        fields = refined(fields, coarse)
        off = unexplained(fields, local)
        errors = total_errors(off, local)
        parts = np.split(off, local.starts[1:])
        costs = errors + PRICE * (BYTES + elliptic * ELLIPSE_BYTES)
        for number in np.flatnonzero(sound).tolist():
            found[left[number]].append(_Candidate(kind, fields.of(number), parts[number], costs[number]))
        left = left[~sound | (errors > [each.exact for each in some])]
    return [_in_order(candidates) for candidates in found]


def _in_order(candidates: List[_Candidate]) -> List[_Candidate]:
    """Candidates with those of the most promising one's kind first."""
    kinds = [candidate.field.kind for candidate in sorted(candidates, key=lambda one: one.least)]
    return sorted(candidates, key=lambda one: one.field.kind != kinds[0])


def _fitted(candidates: Sequence[_Candidate], regions: Sequence[_Region]) -> Iterator[Gradient]:
    """The best gradient like the field of each candidate for a region."""
    fields = [candidate.field for candidate in candidates]
    samples = [_trusted(candidate.off, region.local) for candidate, region in zip(candidates, regions)]
    for kind in range(len(_KINDS)):
        some = [k for k, candidate in enumerate(candidates)
                if candidate.kind == kind and samples[k] is not regions[k].local]
        if some:
            better = refined(Fields(_KINDS[kind][0], np.stack([fields[k].values for k in some])),
                             Batch.of([samples[k] for k in some]))
            for number, k in enumerate(some):
                fields[k] = better.of(number)
    return with_stops(fields, samples, [region.reach for region in regions], [region.unit for region in regions],
                      PRICE * STOP_BYTES)


def _trusted(off: np.ndarray, samples: Samples) -> Samples:
    """Samples, those that are far from what explains them counting less, if there are such."""
    square = np.einsum("nc,nc->n", off, off)
    trust = 1 / (1 + square / (9 * weighted_quantile(square, samples.count, 0.7) + 9)) ** 2
    if np.average(trust < 0.5, weights=samples.count) <= _STRAY:
        return samples
    return samples._replace(count=samples.count * trust)


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
