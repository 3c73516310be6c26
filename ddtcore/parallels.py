# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the search for a field begins: with slopes that are parallel to those of the colour.

The lines of equal colour of a gradient are those of a polynomial q: a plane for a
linear gradient, a circular or elliptic paraboloid for a radial one.  Wherever the
colour has a slope, q's own is parallel to it and the cross product of the two
vanishes; that is an eigenvalue problem for the coefficients of q, whatever the stops
may be.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence, Tuple

import numpy as np

from .field import STRIP, Fields, unexplained
from .samples import Batch, Samples, squares, total_errors, weighted_quantile

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


def first_fields(known: Sequence[Tuple[Parallels, Parallels]], batch: Batch, kind: str,
                 elliptic: bool = False) -> Tuple[Fields, np.ndarray]:
    """The field of each region whose slopes are most nearly parallel to those of the colour.

    Parameters
    ----------
    known : sequence of (Parallels, Parallels)
    batch : Batch
        With as many regions.
    kind : {'linear', 'radial'}
    elliptic : bool
        Of radial fields: whether their lines are ellipses.

    Returns
    -------
    fields : Fields
    sound : ndarray of shape (R,) and dtype bool
        False where the lines of equal colour are not of this kind.
    """
    found = [_parallel([pair[k] for pair in known], kind, elliptic) for k in (0, 1)]
    if kind == "linear":
        found.append(_tilted(batch))
    errors = []
    for fields in found:
        sound = fields.sound
        # What is no field gives no numbers either.
        fields.values[~sound] = 0
        errors.append(np.where(sound, total_errors(unexplained(fields, batch), batch), np.inf))
    best = np.argmin(errors, axis=0)
    values = np.stack([fields.values for fields in found])[best, np.arange(len(best))]
    return Fields(kind, values), np.isfinite(np.min(errors, axis=0))


def _tilted(batch: Batch) -> Fields:
    """The linear fields along which the plane that fits all colours best is steepest.

    In a narrow, bent region the slopes of squares tell little of what changes along it.
    """
    points, colour, count = batch.samples
    weight = count / batch.sums(count)[batch.region]
    points, colour = (values.T - batch.sums(weight * values.T)[:, batch.region] for values in (points, colour))
    spread = np.moveaxis(batch.sums(weight * points * points[:, None]), 2, 0) + 1e-6 * np.eye(2)
    rise = np.linalg.solve(spread, np.moveaxis(batch.sums(weight * colour * points[:, None]), 2, 0))
    steepest = np.linalg.eigh(np.matmul(rise, rise.swapaxes(1, 2)))[1][:, :, -1]
    return Fields("linear", np.arctan2(steepest[:, 1:], steepest[:, :1]))


def _parallel(known: Sequence[Parallels], kind: str, elliptic: bool) -> Fields:
    """The fields that lie nearest to being parallel to the slopes, however far their centres are."""
    terms = 2 if kind == "linear" else 5 if elliptic else 3
    q = _least(*(np.stack(matrices)[:, :terms, :terms] for matrices in zip(*known)))
    if kind == "linear":
        return Fields("linear", np.arctan2(q[:, 1:], q[:, :1]))
    size = np.where(q[:, 2:3] == 0, 1e-12, q[:, 2:3])
    e, f = np.concatenate([q[:, 3:] / size, np.zeros((len(q), 5 - terms))], axis=1).T
    # Of what is no ellipse, the matrix has no inverse: whatever its centre is, the field is not sound.
    det = np.where(np.hypot(e, f) < STRIP, 1 - e * e - f * f, 1)
    x, y = q[:, :2].T / (-2 * size[:, 0] * det)
    centre = np.stack([(1 - e) * x - f * y, (1 + e) * y - f * x], axis=1)
    return Fields("radial", np.concatenate([centre, q[:, 3:] / size], axis=1))


def _least(matrix: np.ndarray, norm: np.ndarray) -> np.ndarray:
    """The vectors v (R, n) that make v·matrix·v / v·norm·v least, of matrices (R, n, n)."""
    trace = np.einsum("rkk->r", norm)
    norm = norm + (1e-9 * trace + 1e-300)[:, None, None] * np.eye(norm.shape[1])
    half = np.linalg.inv(np.linalg.cholesky(norm))
    least = np.linalg.eigh(np.matmul(np.matmul(half, matrix), half.swapaxes(1, 2)))[1][:, None, :, 0]
    return np.asarray(np.matmul(least, half)[:, 0])
