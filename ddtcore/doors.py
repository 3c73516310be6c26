# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the hidden borders of shapes may run.

Each sample of a hidden border gets a *door*: a short line that leads outwards, under
what is painted later.  The shape may end anywhere between a least depth, so that it
reaches under its neighbour far enough, and a greatest, so that it comes out nowhere::

        later    |   |   |   |   hi      A border that passes all doors in their order
               - |.- | - |  .|- -        encloses the shape and, beyond it, only what
                 |  .|. .|.  |           the doors sweep over.
               - | - | - | - |- -  lo
            =====o===o===o===o=====      fitted border, hidden
                      shape
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .rankmap import REACH, RankMap

MARGIN = 1.2
"""How far a shape reaches under its neighbour wherever there is room, px: half the
diagonal of a pixel, so that no anti-aliased pixel of the edge sees the shape's end."""

_PROBES = ((0.3, 0), (0.6, 0), (0.9, 0), (1.2, 0), (1.5, 0), (1.8, 0), (2.1, 0),
           (3.0, 1), (4.5, 1), (6.0, 1), (7.5, 1), (9.0, 1),
           (12.0, 2), (15.0, 2), (18.0, 2), (21.0, 2), (24.0, 2))
"""Depths at which doors are probed, px, and on which level of the rank map."""

_SLOPE = 0.6
"""How steeply a hidden border may leave the visible one it continues."""


class Hidden(NamedTuple):
    """Stretches of loops that later shapes hide.

    Attributes
    ----------
    starts : ndarray of shape (R + 1,) and dtype int64
        Where each stretch begins in `points`.
    points : ndarray of shape (N, 2) and dtype float64
        Samples, the shape on their right; a closed stretch repeats its first point.
    rank : ndarray of shape (R,) and dtype int32
        When the shape is painted.
    closed : ndarray of shape (R,) and dtype bool
        Whether the stretch is a whole loop.
    """

    starts: np.ndarray
    points: np.ndarray
    rank: np.ndarray
    closed: np.ndarray

    def spread(self, values: np.ndarray) -> np.ndarray:
        """A value per stretch, repeated for each of its points."""
        return np.repeat(values, np.diff(self.starts), axis=0)

    def neighbours(self) -> Tuple[np.ndarray, np.ndarray]:
        """Indices of the points before and after each one; ends of open stretches stay."""
        index = np.arange(len(self.points))
        before, after = index - 1, index + 1
        first, last = self.starts[:-1], self.starts[1:] - 1
        before[first] = np.where(self.closed, last - 1, first)
        after[last] = np.where(self.closed, first + 1, last)
        return before, after


class Doors(NamedTuple):
    """One door per point of `Hidden`.

    Attributes
    ----------
    outwards : ndarray of shape (N, 2) and dtype float64
        Unit vector along which depth is measured.
    low, high : ndarray of shape (N,) and dtype float64
        Least and greatest depth, px.
    """

    outwards: np.ndarray
    low: np.ndarray
    high: np.ndarray


def pinched(hidden: Hidden, ranks: RankMap) -> np.ndarray:
    """Which stretches (R,) have next to no room under what hides them, most of the way."""
    if not len(hidden.rank):
        return np.zeros(0, bool)
    seen = ranks.lowest(hidden.points + 0.6 * _normals(hidden), 0)
    stuck = np.add.reduceat((seen < hidden.spread(hidden.rank)).astype(np.int64), hidden.starts[:-1])
    return 2 * stuck > np.diff(hidden.starts)


def open_doors(hidden: Hidden, ranks: RankMap) -> Doors:
    """Find out how deep each shape may end at each point.

    Parameters
    ----------
    hidden : Hidden
    ranks : RankMap

    Returns
    -------
    Doors
    """
    outwards = _directions(hidden)
    room = _room(hidden, outwards, ranks)
    low = np.minimum(MARGIN, 0.35 * room)
    # Keep off the far side of what covers the shape, where its edge would tint that one's.
    high = np.maximum(room - 1, np.maximum(0.6 * room, 0.12))
    for other in hidden.neighbours():
        high = np.minimum(high, _meeting(hidden.points, outwards, other))
    low = np.minimum(low, np.where(hidden.spread(hidden.closed), MARGIN, _SLOPE * _from_end(hidden)))
    return Doors(outwards, np.minimum(low, high), high)


def _normals(hidden: Hidden) -> np.ndarray:
    """Outward unit vectors across the border, (N, 2)."""
    before, after = hidden.neighbours()
    tangent = _unit(hidden.points - hidden.points[before]) + _unit(hidden.points[after] - hidden.points)
    return _unit(np.stack([tangent[:, 1], -tangent[:, 0]], axis=1))


def _directions(hidden: Hidden) -> np.ndarray:
    """Outward unit vectors (N, 2) that turn slowly from point to point.

    In a notch of the shape that is narrower than the smoothing, all doors come to point out of it.
    """
    before, after = hidden.neighbours()
    first, last = hidden.starts[:-1], hidden.starts[1:] - 1
    normal = _normals(hidden)
    # As complex numbers, and with neighbours beside each other but for the ends, in a third of the time.
    smooth, pull = normal.view(np.complex128)[:, 0].copy(), 0.1 * normal
    total = np.zeros_like(smooth)
    turned, sums = (values.view(np.float64).reshape(-1, 2) for values in (smooth, total))
    for _ in range(16):
        np.add(smooth[:-2], smooth[2:], out=total[1:-1])
        for ends in (first, last):
            total[ends] = smooth[before[ends]] + smooth[after[ends]]
        sums += pull
        np.divide(sums, np.maximum(np.hypot(total.real, total.imag), 1e-12)[:, None], out=turned)
    return np.where((np.einsum("nd,nd->n", turned, normal) > 0.25)[:, None], turned, normal)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return np.asarray(vectors / np.maximum(np.hypot(vectors[:, 0], vectors[:, 1]), 1e-12)[:, None])


def _room(hidden: Hidden, outwards: np.ndarray, ranks: RankMap) -> np.ndarray:
    """How far (N,) everything along each door is painted no earlier than the shape, px."""
    rank = hidden.spread(hidden.rank)
    room = np.zeros(len(rank))
    free = np.arange(len(rank))
    for depth, level in _PROBES:
        seen = ranks.lowest(hidden.points[free] + depth * outwards[free], level)
        free = free[seen >= rank[free]]
        room[free] = depth + REACH[level]
    return room


def _meeting(points: np.ndarray, outwards: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Depth (N,) up to which a door neither meets the other one nor leaves an unprobed gap."""
    step, turn = points[other] - points, outwards[other] - outwards
    bend = _cross(outwards, outwards[other])
    with np.errstate(divide="ignore", invalid="ignore"):
        here, there = _cross(step, outwards[other]) / bend, _cross(step, outwards) / bend
        size = np.hypot(*turn.T)
        # Where doors part slowly, the coarse levels of the rank map watch the gap.
        gap = np.where(size < 0.38, 2, 0.8) / size
        return np.asarray(np.where((here > 0) & (there > 0), 0.8 * here, gap))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])


def _from_end(hidden: Hidden) -> np.ndarray:
    """How far (N,) each point is from the nearer end of its stretch, along it, px."""
    before, _ = hidden.neighbours()
    length = np.hypot(*(hidden.points - hidden.points[before]).T)
    length[hidden.starts[:-1]] = 0
    along = np.cumsum(length)
    first, last = along[hidden.starts[:-1]], along[hidden.starts[1:] - 1]
    return np.asarray(np.minimum(along - hidden.spread(first), hidden.spread(last) - along))
