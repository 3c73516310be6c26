# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the search for a field begins: with slopes that are parallel to those of the colour.

The lines of equal colour of a gradient are those of a polynomial q: a plane for a
linear gradient, a circular or elliptic paraboloid for a radial one.  Wherever the
colour has a slope, q's own is parallel to it and the cross product of the two
vanishes; that is an eigenvalue problem for the coefficients of q, whatever the stops
may be.
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Tuple

import numpy as np

from .field import STRIP, Field, Samples, squares, total_error, unexplained, weighted_quantile

_FILLED, _MANY = 4, 64
"""Fewest samples in a square from which slopes are measured, on average, unless there are few squares."""


class Slopes(NamedTuple):
    """How the colour changes, square by square: where, by how much, and from how many pixels."""

    points: np.ndarray   # (m, 2)
    slope: np.ndarray    # (m, 2, C)
    count: np.ndarray    # type: ignore[assignment]  # (m,)


def slopes(samples: Samples, side: float) -> Slopes:
    """Fit a plane to the colours in each square of a grid, of this side at least."""
    number, cells, side = squares(samples.points, side, max(len(samples.points) / _FILLED, _MANY))

    def total(values: np.ndarray) -> np.ndarray:
        return np.bincount(number, samples.count * values, cells)

    size = total(np.ones(len(number)))
    middle = np.stack([total(p) / size for p in samples.points.T], axis=1)
    x, y = (samples.points - middle[number]).T
    spread = np.array([[total(x * x), total(x * y)], [total(x * y), total(y * y)]])
    # What is nearly a line tells nothing about the slope across it.
    spread += 0.01 * side**2 * size * np.eye(2)[..., None]
    rise = np.array([[total(v * c) for c in samples.colour.T] for v in (x, y)])
    slope = np.linalg.solve(np.moveaxis(spread, 2, 0), np.moveaxis(rise, 2, 0))
    return Slopes(middle, slope, size)


class Parallels(NamedTuple):
    """How far the slopes of polynomials are from being parallel to those of the colour, and how steep they are.

    The terms of the polynomials are x, y, x² + y², x² - y² and 2xy.
    """

    cross: np.ndarray    # (5, 5) products of what two terms contribute
    steep: np.ndarray    # (5, 5)


def parallels(known: Slopes) -> Tuple[Parallels, Parallels]:
    """Compare slopes, all alike, and the calm ones more than the steep ones.

    An edge that got into the region is steep: it should not outvote all slopes.
    """
    x, y = known.points.T
    one, none = np.ones_like(x), np.zeros_like(x)
    along = np.stack([one, none, 2 * x, 2 * x, 2 * y])
    down = np.stack([none, one, 2 * y, -2 * y, 2 * x])
    square = np.einsum("mic,mic->m", known.slope, known.slope)
    calm = known.count / (1 + square / (9 * weighted_quantile(square, known.count, 0.5) + 1e-9))

    def compared(count: np.ndarray) -> Parallels:
        cross = np.zeros((5, 5))
        for to_right, to_bottom in np.moveaxis(known.slope, 0, 2).swapaxes(0, 1):
            term = along * to_bottom - down * to_right
            cross += (count * term).dot(term.T)
        steep = count * square
        return Parallels(cross, (steep * along).dot(along.T) + (steep * down).dot(down.T))

    return compared(known.count), compared(calm)


def first_field(known: Tuple[Parallels, Parallels], samples: Samples, kind: str,
                elliptic: bool = False) -> Optional[Field]:
    """The field whose slopes are most nearly parallel to those of the colour.

    Parameters
    ----------
    known : (Parallels, Parallels)
    samples : Samples
    kind : {'linear', 'radial'}
    elliptic : bool
        Of a radial field: whether its lines are ellipses.

    Returns
    -------
    Field or None
        None where the lines of equal colour are not of this kind.
    """
    found = [_parallel(each, kind, elliptic) for each in known]
    if kind == "linear":
        found.append(_tilted(samples))
    fields = [field for field in found if field is not None and field.sound]
    return min(fields, key=lambda field: total_error(unexplained(field, samples), samples.count)) if fields else None


def _tilted(samples: Samples) -> Field:
    """The linear field along which the plane that fits all colours best is steepest.

    In a narrow, bent region the slopes of squares tell little of what changes along it.
    """
    weight = samples.count / samples.count.sum()
    points = samples.points - weight.dot(samples.points)
    spread = (points.T * weight).dot(points) + 1e-6 * np.eye(2)
    rise = np.linalg.solve(spread, (points.T * weight).dot(samples.colour - weight.dot(samples.colour)))
    steepest = np.linalg.eigh(rise.dot(rise.T))[1][:, -1]
    return Field("linear", np.arctan2(steepest[1:], steepest[:1]))


def _parallel(known: Parallels, kind: str, elliptic: bool) -> Optional[Field]:
    """The field that lies nearest to being parallel to the slopes, however far its centre is."""
    terms = 2 if kind == "linear" else 5 if elliptic else 3
    q = _least(known.cross[:terms, :terms], known.steep[:terms, :terms])
    if kind == "linear":
        return Field("linear", np.arctan2(q[1:], q[:1]))
    size = q[2] or 1e-12
    shape = np.concatenate([q[3:], np.zeros(5 - len(q))]) / size
    if np.hypot(*shape) > STRIP:
        return None
    field = Field("radial", np.concatenate([np.zeros(2), shape]))
    centre = np.linalg.solve(field.matrix, q[:2]) / (-2 * size)
    return Field("radial", np.concatenate([centre, shape]) if elliptic else centre)


def _least(matrix: np.ndarray, norm: np.ndarray) -> np.ndarray:
    """The vector v that makes v·matrix·v / v·norm·v least."""
    norm = norm + (1e-9 * np.trace(norm) + 1e-300) * np.eye(len(norm))
    half = np.linalg.inv(np.linalg.cholesky(norm))
    least = np.linalg.eigh(half.dot(matrix).dot(half.T))[1][:, 0]
    return np.asarray(least.dot(half))
