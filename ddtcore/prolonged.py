# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradients in the coordinates of the picture, from their fields and their stops."""

from __future__ import annotations

from typing import Iterator, NamedTuple, Sequence, Tuple

import numpy as np

from .field import Field
from .model import Gradient
from .samples import Samples
from .stops import BINS, choose_stops, profile

_REACH = 0.75
"""How far a gradient reaches beyond the outermost pixel centres, px."""


class Unit(NamedTuple):
    """Coordinates in which a region lies about the origin and has the size 1."""

    middle: np.ndarray
    size: float

    def local(self, points: np.ndarray) -> np.ndarray:
        return np.asarray((points - self.middle) / self.size)

    def back(self, points: np.ndarray) -> np.ndarray:
        return self.middle + self.size * points


def with_stops(fields: Sequence[Field], samples: Sequence[Samples], reaches: Sequence[np.ndarray],
               units: Sequence[Unit], price: float) -> Iterator[Gradient]:
    """The gradient along the field of each of some regions.

    Parameters
    ----------
    fields : sequence of Field
    samples : sequence of Samples
        The colours of each region, in its coordinates.
    reaches : sequence of ndarray of shape (m, 2)
        Points up to which it must go on, likewise.
    units : sequence of Unit
        These coordinates.
    price : float
        What a stop must save, see `choose_stops`.
    """
    profiles, spans = [], []
    for field, some in zip(fields, samples):
        place = field.places(some.points)
        low, length = place.min(), max(np.ptp(place), 1e-9)
        profiles.append(profile((place - low) / length, some.colour, some.count))
        spans.append((low, length))
    stops = choose_stops(profiles, price) if profiles else []
    for field, reach, unit, (low, length), (knots, values) in zip(fields, reaches, units, spans, stops):
        begins, ends = knots[0] < 1.5 / BINS, knots[-1] > 1 - 1.5 / BINS
        knots = low + knots * length
        place, margin = field.places(reach), _REACH / unit.size
        if begins:
            least = 0.0 if field.kind == "radial" else -np.inf
            knots, values = _prolonged(knots, values, max(place.min() - margin, least))
        if ends:
            knots, values = (a[::-1] for a in _prolonged(knots[::-1], values[::-1], place.max() + margin))
        yield _gradient(field, unit, knots, values)


def _gradient(field: Field, unit: Unit, knots: np.ndarray, values: np.ndarray) -> Gradient:
    """The gradient with some stops along a field."""
    if field.kind == "linear":
        start, end = (_pair(unit.back(knot * field.axis)) for knot in (knots[0], knots[-1]))
        return Gradient("linear", start, end, _stops(knots, values, knots[0]))
    measure, axes = np.linalg.eigh(field.matrix)
    centre = field.values[:2]
    end, across = (_pair(unit.back(centre + knots[-1] * axis / np.sqrt(square)))
                   for axis, square in zip(axes.T, measure))
    return Gradient("radial", _pair(unit.back(centre)), end, _stops(knots, values, 0.0),
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
