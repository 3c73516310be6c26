# SPDX-License-Identifier: GPL-2.0-or-later
"""Along which lines, circles or ellipses the colour of a region is constant.

Gauss-Newton steps fit the direction or the centre to the colours themselves, with the
colours along the gradient eliminated (variable projection: Golub and Pereyra, SIAM
Journal on Numerical Analysis 10, 1973).  These are free at some places along the field,
and all sums over the samples are taken interval by interval between them.  The fields of
many regions are fitted at a time: each alone is little work, but many calls.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .samples import Batch, total_errors

_FAR = 30.0
"""Greatest distance of a centre from the middle of the region, in units of the region's size."""

STRIP = 0.98
"""An ellipse more oblong than this has no use (0 for a circle, 1 for a strip)."""

_KNOTS = 12
"""Places along a field where the free colours can bend."""

_STEPS = 8
"""Most Gauss-Newton steps."""

_GAINED = 0.005
"""Share of the error that a step must promise to lower it by."""

_BEND = np.diff(np.eye(_KNOTS), 2, axis=0)
_STIFF = 1e-4 * _BEND.T.dot(_BEND) + 1e-9 * np.eye(_KNOTS)
"""What keeps free colours from bending where nothing tells them."""


class Field(NamedTuple):
    """How far along a gradient each point lies: the length along an axis, or the distance from a centre.

    Attributes
    ----------
    kind : {'linear', 'radial'}
    values : ndarray of shape (1,), (2,) or (4,)
        Linear: the angle of the axis.  Radial: x and y of the centre and, if distances are
        elliptic, e and f of the matrix ((1 + e, f), (f, 1 - e)) that measures their squares.
        Likewise (P, n), for fields of each of n points.
    """

    kind: str
    values: np.ndarray

    @property
    def shape(self) -> np.ndarray:
        """e and f of the matrix that measures squared distances from the centre."""
        return np.asarray(self.values[2:] if len(self.values) == 4 else np.zeros(2))

    @property
    def matrix(self) -> np.ndarray:
        """What measures squared distances from the centre."""
        e, f = self.shape
        return np.array([[1 + e, f], [f, 1 - e]])

    @property
    def axis(self) -> np.ndarray:
        """Direction of a linear field."""
        return np.array([np.cos(self.values[0]), np.sin(self.values[0])])

    def places(self, points: np.ndarray) -> np.ndarray:
        """How far along each point (n, 2) lies, (n,)."""
        if self.kind == "linear":
            return np.asarray(points[:, 0] * np.cos(self.values[0]) + points[:, 1] * np.sin(self.values[0]))
        (x, y), (e, f) = (points[:, axis] - self.values[axis] for axis in (0, 1)), self.shape
        return np.asarray(np.sqrt(np.maximum(((1 + e) * x + 2 * f * y) * x + (1 - e) * y * y, 0)))

    def changes(self, points: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Derivatives (P, n) of the places (n,) of points by the values."""
        if self.kind == "linear":
            return np.asarray(points[None, :, 1] * np.cos(self.values[0]) - points[None, :, 0] * np.sin(self.values[0]))
        (x, y), (e, f) = (points[:, axis] - self.values[axis] for axis in (0, 1)), self.shape
        changes = [-(1 + e) * x - f * y, -f * x - (1 - e) * y]
        if len(self.values) == 4:
            changes += [(x * x - y * y) / 2, x * y]
        return np.asarray(np.stack(changes) / np.maximum(places, 1e-6))

    @property
    def sound(self) -> bool:
        """Whether a radial field has a centre in reach and is no strip."""
        return bool(Fields(self.kind, self.values[None]).sound[0])


class Fields(NamedTuple):
    """The fields of some regions, all of one kind, see `Field`."""

    kind: str
    values: np.ndarray   # (R, P)

    def of(self, region: int) -> Field:
        """That of one of the regions."""
        return Field(self.kind, self.values[region])

    def some(self, chosen: np.ndarray) -> Fields:
        """Those of the regions that are chosen."""
        return Fields(self.kind, self.values[chosen])

    @property
    def sound(self) -> np.ndarray:
        """Which radial fields have a centre in reach and are no strips, (R,)."""
        if self.kind == "linear":
            return np.ones(len(self.values), bool)
        sound = np.hypot(self.values[:, 0], self.values[:, 1]) < _FAR
        if self.values.shape[1] == 4:
            sound &= np.hypot(self.values[:, 2], self.values[:, 3]) < STRIP
        return np.asarray(sound)


def refined(fields: Fields, batch: Batch) -> Fields:
    """Move fields until they explain the colours of their regions best, with free colours along them.

    Parameters
    ----------
    fields : Fields
    batch : Batch
        With as many regions.
    """
    values, damping = fields.values.copy(), np.full(len(fields.values), 1e-3)
    error, matrix, pull = _Free.along(fields, batch).steps()
    left = np.arange(len(values))
    for _ in range(_STEPS):
        diagonal = np.einsum("rpp->rp", matrix) * damping[:, None] + 1e-12
        step = _solved(matrix + diagonal[..., None] * np.eye(values.shape[1]), pull)
        some = np.einsum("rp,rp->r", pull, step) >= _GAINED * error
        if not some.any():
            break
        left, batch, damping = left[some], batch.some(some), damping[some]
        error, matrix, pull = error[some], matrix[some], pull[some]
        moved = Fields(fields.kind, values[left] + step[some])
        sound = moved.sound
        moved.values[~sound] = values[left[~sound]]
        ahead = _Free.along(moved, batch).steps()
        better = sound & (ahead[0] < error)
        values[left[better]] = moved.values[better]
        for now, then in zip((error, matrix, pull), ahead):
            now[better] = then[better]
        damping *= np.where(better, 0.1, 30)
    return Fields(fields.kind, values)


def unexplained(fields: Fields, batch: Batch) -> np.ndarray:
    """What the best free colours along fields leave of the colours (n, C)."""
    return _Free.along(fields, batch).off.T


class _Free(NamedTuple):
    """Free colours at knots along the field of each region, between which they are mixed."""

    fields: Fields
    batch: Batch
    place: np.ndarray    # (n,)
    share: np.ndarray    # (n,) of the latter of the two knots round each sample
    cell: np.ndarray     # (n,) number of the interval between these, region by region
    inner: np.ndarray    # (R, K, K) sums of the products of the shares of two knots
    matrix: np.ndarray   # (R, K, K) the same, and what keeps the colours from bending too much
    steep: np.ndarray    # (C, R, K - 1) change of the colours in each interval
    left: np.ndarray     # (C, R, K) sums of the shares of knots times what is unexplained
    off: np.ndarray      # (C, n) what the colours leave unexplained

    @classmethod
    def along(cls, fields: Fields, batch: Batch) -> _Free:
        """The colours that explain the samples best."""
        samples, region, count = batch.samples, batch.region, batch.samples.count
        place = Field(fields.kind, np.take(fields.values.T, region, axis=1)).places(samples.points)
        low = np.minimum.reduceat(place, batch.starts)
        wide = (np.maximum.reduceat(place, batch.starts) + 1e-9 - low) / (_KNOTS - 1)
        share = (place - low[region]) / wide[region]
        interval = np.minimum(share.astype(np.intp), _KNOTS - 2)
        share -= interval
        cell = region * (_KNOTS - 1) + interval
        later = share * count
        one, two, square = (_by_cell(values, cell, len(low)) for values in (count, later, later * share))
        inner = _banded(one - 2 * two + square, two - square, square)
        matrix = inner + batch.sums(count)[:, None, None] * _STIFF
        aim = _ends(*np.swapaxes([(_by_cell(count * channel, cell, len(low)), _by_cell(later * channel, cell, len(low)))
                                  for channel in samples.colour.T], 0, 1))
        values = np.moveaxis(np.linalg.solve(matrix, np.moveaxis(aim, 0, 2)), 2, 0)
        rise = values[..., 1:] - values[..., :-1]
        off = samples.colour.T - np.take(values[..., :-1].reshape(len(aim), -1), cell, axis=1)
        off -= share * np.take(rise.reshape(len(aim), -1), cell, axis=1)
        left = aim - np.einsum("rkl,crl->crk", inner, values)
        return cls(fields, batch, place, share, cell, inner, matrix, rise / wide[:, None], left, off)

    def steps(self) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The errors (R,), and the normal equations of steps of the fields' values that lower them."""
        batch, cell, count = self.batch, self.cell, self.batch.samples.count
        field = Field(self.fields.kind, np.take(self.fields.values.T, batch.region, axis=1))
        changes = field.changes(batch.samples.points, self.place)
        # How the colours move is the steepness of an interval times the change of the place.
        slope = np.take(self.steep.reshape(len(self.steep), -1), cell, axis=1)
        weighted = count * changes
        turned = weighted * np.einsum("cn,cn->n", slope, slope)
        matrix = np.moveaxis(batch.sums(turned[:, None] * changes), 2, 0)
        pull = batch.sums(weighted * np.einsum("cn,cn->n", slope, self.off)).T
        one, two = np.swapaxes([(_by_cell(change, cell, len(pull)), _by_cell(self.share * change, cell, len(pull)))
                                for change in weighted], 0, 1)
        moves = _ends(self.steep[:, None] * one, self.steep[:, None] * two)
        # Of what a step changes, the free colours take up all that is the same along a line.
        channels, size, regions, knots = moves.shape
        right = np.moveaxis(moves, 2, 0).reshape(regions, -1, knots).swapaxes(1, 2)
        taken = np.linalg.solve(self.matrix, right)
        taken = taken.swapaxes(1, 2).reshape(regions, channels, size, knots)
        shared = 2 * np.moveaxis(moves, 2, 0) - np.matmul(taken, self.inner[:, None])
        matrix -= np.einsum("rcpk,rcqk->rpq", shared, taken)
        pull -= np.einsum("rcpk,crk->rp", taken, self.left)
        return total_errors(self.off.T, batch), matrix, pull


def _solved(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions (R, P) for as many matrices."""
    return np.linalg.solve(matrices, right[..., None])[..., 0]


def _by_cell(values: np.ndarray, cell: np.ndarray, regions: int) -> np.ndarray:
    """Sums (R, K - 1) over the samples in each interval."""
    return np.bincount(cell, values, regions * (_KNOTS - 1)).reshape(regions, _KNOTS - 1)


def _ends(one: np.ndarray, later: np.ndarray) -> np.ndarray:
    """What each knot (..., K) has of the intervals (..., K - 1) on both its sides: of one, less that of the latter."""
    out = np.zeros(one.shape[:-1] + (_KNOTS,))
    out[..., :-1] = one - later
    out[..., 1:] += later
    return out


def _banded(first: np.ndarray, both: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Symmetric matrices (R, K, K) of what two knots each (R, K - 1) share: of the former, of both, of the latter."""
    out = np.zeros((len(both), _KNOTS * _KNOTS))
    out[:, :-1:_KNOTS + 1] += first
    out[:, _KNOTS + 1::_KNOTS + 1] += last
    out[:, 1::_KNOTS + 1] = out[:, _KNOTS::_KNOTS + 1] = both
    return out.reshape(-1, _KNOTS, _KNOTS)
