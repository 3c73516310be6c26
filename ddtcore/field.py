# SPDX-License-Identifier: GPL-2.0-or-later
"""Along which lines, circles or ellipses the colour of a region is constant.

Gauss-Newton steps fit the direction or the centre to the colours themselves, with the
colours along the gradient eliminated (variable projection: Golub and Pereyra, SIAM
Journal on Numerical Analysis 10, 1973).  These are free at some places along the field,
and all sums over the samples are taken interval by interval between them.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

_FAR = 30.0
"""Greatest distance of a centre from the middle of the region, in units of the region's size."""

STRIP = 0.98
"""An ellipse more oblong than this has no use (0 for a circle, 1 for a strip)."""

_WRONG = 1024.0
"""Squared error of a pixel that belongs to something else, levels."""

_KNOTS = 12
"""Places along a field where the free colours can bend."""

_STEPS = 8
"""Most Gauss-Newton steps."""

_GAINED = 0.005
"""Share of the error that a step must promise to lower it by."""

_SPAN = 1 << 17
"""Up to so many codes are counted in a table of all, for that is quicker than to sort them."""

_ENDS = np.repeat(np.eye(_KNOTS), 2, axis=0)[1:-1]
"""Which knot lies at each end of each interval between two."""

_BEND = np.diff(np.eye(_KNOTS), 2, axis=0)
_STIFF = 1e-4 * _BEND.T.dot(_BEND) + 1e-9 * np.eye(_KNOTS)
"""What keeps free colours from bending where nothing tells them."""


class Samples(NamedTuple):
    """Colours of a region.

    Attributes
    ----------
    points : ndarray of shape (n, 2)
    colour : ndarray of shape (n, C)
        RGB, or premultiplied RGBA, 0 to 255.
    count : ndarray of shape (n,)
        Pixels that each sample stands for.
    """

    points: np.ndarray
    colour: np.ndarray
    count: np.ndarray  # type: ignore[assignment]


class Field(NamedTuple):
    """How far along a gradient each point lies: the length along an axis, or the distance from a centre.

    Attributes
    ----------
    kind : {'linear', 'radial'}
    values : ndarray of shape (1,), (2,) or (4,)
        Linear: the angle of the axis.  Radial: x and y of the centre and, if distances are
        elliptic, e and f of the matrix ((1 + e, f), (f, 1 - e)) that measures their squares.
    """

    kind: str
    values: np.ndarray

    @property
    def matrix(self) -> np.ndarray:
        """What measures squared distances from the centre."""
        e, f = self.values[2:] if len(self.values) == 4 else (0.0, 0.0)
        return np.array([[1 + e, f], [f, 1 - e]])

    @property
    def axis(self) -> np.ndarray:
        """Direction of a linear field."""
        return np.array([np.cos(self.values[0]), np.sin(self.values[0])])

    def places(self, points: np.ndarray) -> np.ndarray:
        """How far along each point (n, 2) lies, (n,)."""
        if self.kind == "linear":
            return np.asarray(points.dot(self.axis))
        offset = points - self.values[:2]
        return np.asarray(np.sqrt(np.maximum(np.einsum("ni,ni->n", offset.dot(self.matrix), offset), 0)))

    def changes(self, points: np.ndarray, places: np.ndarray) -> np.ndarray:
        """Derivatives (n, P) of the places (n,) of points by the values."""
        if self.kind == "linear":
            return np.asarray(points.dot([[-self.axis[1]], [self.axis[0]]]))
        x, y = offset = (points - self.values[:2]).T
        changes = np.stack([*-self.matrix.dot(offset), (x * x - y * y) / 2, x * y], axis=1)
        return np.asarray(changes[:, :len(self.values)] / np.maximum(places, 1e-6)[:, None])

    @property
    def sound(self) -> bool:
        """Whether a radial field has a centre in reach and is no strip."""
        return self.kind == "linear" or bool(
            np.hypot(*self.values[:2]) < _FAR and np.hypot(*self.matrix[0] - (1, 0)) < STRIP)


def squares(points: np.ndarray, side: float, most: float = np.inf) -> Tuple[np.ndarray, int, float]:
    """Number of the square that each point (n, 2) lies in, how many have points, and their side.

    Where more than `most` had points, as in a narrow region or a sparse sample, squares are larger than asked for.
    """
    offset = points - points.min(axis=0)
    while True:
        column, row = np.floor(offset / side).astype(np.int64).T
        number, count = _ranks(row * (column.max() + 1) + column)
        if count <= most:
            return number, count, side
        # One and a half times as many are too many by chance.
        side *= float(np.sqrt(max(count / most, 1.5)))


def _ranks(codes: np.ndarray) -> Tuple[np.ndarray, int]:
    """Numbers from 0 on for the different codes (n,), in their order, and how many there are."""
    span = int(codes.max()) + 1
    if span > _SPAN:
        values, number = np.unique(codes, return_inverse=True)
        return number, len(values)
    used = np.zeros(span, bool)
    used[codes] = True
    rank = np.cumsum(used)
    return rank[codes] - 1, int(rank[-1])


def weighted_quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    """The value below which a share of all the weight lies."""
    order = np.argsort(values)
    return float(values[order[np.searchsorted(np.cumsum(weight[order]), share * weight.sum())]])


def refined(field: Field, samples: Samples) -> Field:
    """Move a field until it explains the colours best, with free colours along it."""
    free = _Free.along(field, samples)
    damping = 1e-3
    matrix, pull = free.step()
    for _ in range(_STEPS):
        diagonal = np.diag(np.diag(matrix) * damping + 1e-12)
        step = np.linalg.solve(matrix + diagonal, pull)
        if pull.dot(step) < _GAINED * free.error:
            break
        moved = Field(field.kind, field.values + step)
        ahead = _Free.along(moved, samples) if moved.sound else None
        if ahead is None or ahead.error >= free.error:
            damping *= 30
            continue
        field, free, damping = moved, ahead, damping / 10
        matrix, pull = free.step()
    return field


def unexplained(field: Field, samples: Samples) -> np.ndarray:
    """What the best free colours along a field leave of the colours (n, C)."""
    return _Free.along(field, samples).off


def total_error(off: np.ndarray, count: np.ndarray) -> float:
    """Sum of the squared differences (n, C) of colours, none counting more than a wrong pixel."""
    return float(count.dot(np.minimum(np.einsum("nc,nc->n", off, off), _WRONG)))


class _Free(NamedTuple):
    """Free colours at knots along a field, between which they are mixed."""

    field: Field
    samples: Samples
    place: np.ndarray    # (n,)
    share: np.ndarray    # (n, 2 (K - 1)) of the two knots round each sample, interval by interval
    held: np.ndarray     # the same, times the pixels
    inner: np.ndarray    # (K, K) products of the shares of two knots
    matrix: np.ndarray   # (K, K) the same, and what keeps the colours from bending too much
    steep: np.ndarray    # (K - 1, C) change of the colours in each interval
    off: np.ndarray      # (n, C) what they leave unexplained
    error: float

    @classmethod
    def along(cls, field: Field, samples: Samples) -> _Free:
        """The colours that explain the samples best."""
        place = field.places(samples.points)
        low = place.min()
        wide = (place.max() + 1e-9 - low) / (_KNOTS - 1)
        at = (place - low) / wide
        interval = np.minimum(at.astype(np.intp), _KNOTS - 2)
        at -= interval
        share = np.zeros((len(place), 2 * _KNOTS - 2))
        first = np.arange(0, share.size, 2 * _KNOTS - 2) + 2 * interval
        share.ravel()[first], share.ravel()[first + 1] = 1 - at, at
        held = share * samples.count[:, None]
        inner = _ENDS.T.dot(held.T.dot(share)).dot(_ENDS)
        matrix = inner + samples.count.sum() * _STIFF
        values = np.linalg.solve(matrix, _ENDS.T.dot(held.T.dot(samples.colour)))
        off = samples.colour - share.dot(_ENDS.dot(values))
        steep = (values[1:] - values[:-1]) / wide
        return cls(field, samples, place, share, held, inner, matrix, steep, off, total_error(off, samples.count))

    def step(self) -> Tuple[np.ndarray, np.ndarray]:
        """The normal equations of a step of the field's values that lowers the error."""
        changes = self.field.changes(self.samples.points, self.place)
        count = self.samples.count[:, None]
        size = changes.shape[1]
        # How the colours move is the steepness of an interval times the change of the place.
        steep = np.repeat(self.steep, 2, axis=0)
        slope = np.asarray(self.share.dot(steep))
        moves = (steep[:, :, None] * self.held.T.dot(changes)[:, None]).reshape(len(steep), -1)
        moves = _ENDS.T.dot(moves)
        weighted = count * changes
        matrix = (weighted * np.einsum("nc,nc->n", slope, slope)[:, None]).T.dot(changes)
        pull = weighted.T.dot(np.einsum("nc,nc->n", slope, self.off))
        # Of what a step changes, the free colours take up all that is the same along a line.
        taken = np.linalg.solve(self.matrix, moves)
        shared = 2 * moves.T.dot(taken) - taken.T.dot(self.inner).dot(taken)
        left = _ENDS.T.dot(self.held.T.dot(self.off))
        for channel in range(self.off.shape[1]):
            own = slice(channel * size, (channel + 1) * size)
            matrix -= shared[own, own]
            pull -= taken[:, own].T.dot(left[:, channel])
        return matrix, pull
