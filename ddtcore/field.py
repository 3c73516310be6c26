# SPDX-License-Identifier: GPL-2.0-or-later
"""Along which lines, circles or ellipses the colour of a region is constant.

The lines of equal colour of a gradient are those of a polynomial q: a plane for a
linear gradient, a circular or elliptic paraboloid for a radial one.  Wherever the
colour has a slope, q's own is parallel to it and the cross product of the two
vanishes; that is an eigenvalue problem for the coefficients of q, whatever the stops
may be.  Gauss-Newton steps then fit the direction or the centre to the colours
themselves, with the colours along the gradient eliminated (variable projection: Golub
and Pereyra, SIAM Journal on Numerical Analysis 10, 1973).
"""

from __future__ import annotations

from typing import NamedTuple, Optional, Tuple

import numpy as np

from .stops import hats

_FAR = 30.0
"""Greatest distance of a centre from the middle of the region, in units of the region's size."""

_STRIP = 0.98
"""An ellipse more oblong than this has no use (0 for a circle, 1 for a strip)."""

_WRONG = 1024.0
"""Squared error of a pixel that belongs to something else, levels."""

_KNOTS = 12
"""Places along a field where the free colours can bend."""

_STEPS = 8
"""Most Gauss-Newton steps."""


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

    def changes(self, points: np.ndarray) -> np.ndarray:
        """Derivatives (n, P) of the places by the values."""
        if self.kind == "linear":
            return np.asarray(points.dot([[-self.axis[1]], [self.axis[0]]]))
        x, y = offset = (points - self.values[:2]).T
        changes = np.stack([*-self.matrix.dot(offset), (x * x - y * y) / 2, x * y], axis=1)
        return np.asarray(changes[:, :len(self.values)] / np.maximum(self.places(points), 1e-6)[:, None])

    @property
    def sound(self) -> bool:
        """Whether a radial field has a centre in reach and is no strip."""
        return self.kind == "linear" or bool(
            np.hypot(*self.values[:2]) < _FAR and np.hypot(*self.matrix[0] - (1, 0)) < _STRIP)


def squares(points: np.ndarray, side: float) -> Tuple[np.ndarray, int]:
    """Number of the square that each point (n, 2) lies in, and how many have points."""
    column, row = np.floor((points - points.min(axis=0)) / side).astype(np.int64).T
    _, number = np.unique(row * (column.max() + 1) + column, return_inverse=True)
    return number, int(number.max()) + 1


class Slopes(NamedTuple):
    """How the colour changes, square by square: where, by how much, and from how many pixels."""

    points: np.ndarray   # (m, 2)
    slope: np.ndarray    # (m, 2, C)
    count: np.ndarray    # type: ignore[assignment]  # (m,)


def slopes(samples: Samples, side: float) -> Slopes:
    """Fit a plane to the colours in each square of a grid."""
    number, cells = squares(samples.points, side)

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


def first_field(known: Slopes, samples: Samples, kind: str, elliptic: bool = False) -> Optional[Field]:
    """The field whose slopes are most nearly parallel to those of the colour.

    Parameters
    ----------
    known : Slopes
    samples : Samples
    kind : {'linear', 'radial'}
    elliptic : bool
        Of a radial field: whether its lines are ellipses.

    Returns
    -------
    Field or None
        None where the lines of equal colour are not of this kind.
    """
    # An edge that got into the region is steep: it should not outvote all slopes.
    steep = (known.slope ** 2).sum(axis=(1, 2))
    calm = known.count / (1 + steep / (9 * weighted_quantile(steep, known.count, 0.5) + 1e-9))
    found = [_parallel(known._replace(count=count), kind, elliptic) for count in (known.count, calm)]
    if kind == "linear":
        found.append(_tilted(samples))
    fields = [field for field in found if field is not None and field.sound]
    return min(fields, key=lambda field: _linearise(field, samples).error) if fields else None


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


def weighted_quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    """The value below which a share of all the weight lies."""
    order = np.argsort(values)
    return float(values[order[np.searchsorted(np.cumsum(weight[order]), share * weight.sum())]])


def _parallel(known: Slopes, kind: str, elliptic: bool) -> Optional[Field]:
    """The field that lies nearest to being parallel to the slopes, however far its centre is."""
    x, y = known.points.T
    one, none = np.ones_like(x), np.zeros_like(x)
    terms = [(one, none), (none, one)]
    if kind == "radial":
        terms += [(2 * x, 2 * y), (2 * x, -2 * y), (2 * y, 2 * x)][:3 if elliptic else 1]
    basis = np.moveaxis(np.array(terms), 2, 0)
    cross = basis[:, :, :1] * known.slope[:, None, 1] - basis[:, :, 1:] * known.slope[:, None, 0]
    steep = known.count * (known.slope ** 2).sum(axis=(1, 2))
    q = _least(np.einsum("m,mpc,mqc->pq", known.count, cross, cross),
               np.einsum("m,mpi,mqi->pq", steep, basis, basis))
    if kind == "linear":
        return Field("linear", np.arctan2(q[1:], q[:1]))
    size = q[2] or 1e-12
    shape = np.concatenate([q[3:], np.zeros(5 - len(q))]) / size
    if np.hypot(*shape) > _STRIP:
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


def refined(field: Field, samples: Samples) -> Tuple[Field, np.ndarray]:
    """Move a field until it explains the colours best, with free colours along it.

    Returns
    -------
    field : Field
    off : ndarray of shape (n, C)
        What it leaves unexplained.
    """
    state = _linearise(field, samples)
    damping = 1e-3
    for _ in range(_STEPS):
        diagonal = np.diag(np.diag(state.matrix) * damping + 1e-12)
        step = np.linalg.solve(state.matrix + diagonal, state.pull)
        moved = Field(field.kind, field.values + step)
        ahead = _linearise(moved, samples) if moved.sound else None
        if ahead is None or ahead.error >= state.error:
            damping *= 30
            continue
        done = ahead.error > 0.99 * state.error
        field, state, damping = moved, ahead, damping / 10
        if done:
            break
    return field, state.off


def unexplained(field: Field, samples: Samples) -> np.ndarray:
    """What the best free colours along a field leave of the colours (n, C)."""
    return _linearise(field, samples).off


def total_error(off: np.ndarray, count: np.ndarray) -> float:
    """Sum of the squared differences (n, C) of colours, none counting more than a wrong pixel."""
    return float(count.dot(np.minimum((off ** 2).sum(axis=1), _WRONG)))


class _State(NamedTuple):
    off: np.ndarray      # (n, C)
    error: float
    matrix: np.ndarray   # (P, P)
    pull: np.ndarray     # (P,)


def _linearise(field: Field, samples: Samples) -> _State:
    """What a field leaves unexplained, and the normal equations of a step that lowers it."""
    place = field.places(samples.points)
    knots = np.linspace(place.min(), place.max() + 1e-9, _KNOTS)
    share = hats(place, knots)
    weighted = share * samples.count[:, None]
    bend = np.diff(np.eye(_KNOTS), 2, axis=0)
    total = samples.count.sum()
    matrix = weighted.T.dot(share) + total * (1e-4 * bend.T.dot(bend) + 1e-9 * np.eye(_KNOTS))
    values = np.linalg.solve(matrix, weighted.T.dot(samples.colour))
    off = samples.colour - share.dot(values)
    steep = np.diff(values, axis=0) / (knots[1] - knots[0])
    interval = np.minimum(((place - knots[0]) / (knots[1] - knots[0])).astype(np.intp), _KNOTS - 2)
    moves = (steep[interval][:, :, None] * field.changes(samples.points)[:, None]).reshape(len(place), -1)
    # Of what a step changes, the free colours take up all that is the same along a line.
    moves -= share.dot(np.linalg.solve(matrix, weighted.T.dot(moves)))
    root = np.sqrt(samples.count)[:, None]
    moves = (moves * root).reshape(off.size, -1)
    return _State(off, total_error(off, samples.count), moves.T.dot(moves), moves.T.dot((off * root).ravel()))
