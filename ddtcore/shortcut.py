# SPDX-License-Identifier: GPL-2.0-or-later
"""Shortcuts across the notches of hidden borders.

A border that follows its shape into a notch and out again, under what is painted later,
may as well pass the notch: where a hidden border turns outwards, the triangle between the
corner and its neighbours is added to the shape if all of it is painted no earlier.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .loops import begins, ranges
from .rankmap import RankMap

_SPACING = 1.4
"""Distance between samples, px: each looks one pixel round itself."""

_LONGEST = 40.0
"""Triangles with longer sides are not tried, px."""

_LEVEL = 1


def take_shortcuts(starts: np.ndarray, points: np.ndarray, rank: np.ndarray,
                   ranks: RankMap) -> Tuple[np.ndarray, np.ndarray]:
    """Leave out corners of polylines that may end farther out.

    Parameters
    ----------
    starts : ndarray of shape (R + 1,) and dtype int64
    points : ndarray of shape (N, 2) and dtype float64
        Polylines with their shapes on the right.
    rank : ndarray of shape (R,)
        When each shape is painted.
    ranks : RankMap

    Returns
    -------
    starts, points : ndarray
        The same with fewer points.  Each polyline keeps its ends.
    """
    owner = np.repeat(np.arange(len(rank)), np.diff(starts))
    untried = np.ones(len(points), bool)
    parity, idle = 0, 0
    while idle < 2:
        inner = np.flatnonzero((owner[1:-1] == owner[:-2]) & (owner[1:-1] == owner[2:])) + 1
        # Of two neighbours only one may go at a time, or the triangles would overlap.
        inner = inner[untried[inner] & (inner % 2 == parity)]
        untried[inner] = False
        before, corner, after = points[inner - 1], points[inner], points[inner + 1]
        outwards = _cross(corner - before, after - corner) < 0
        inner = inner[outwards]
        triangles = np.stack([before, corner, after], axis=1)[outwards]
        gone = inner[_free(triangles, rank[owner[inner]], ranks)]
        untried[gone - 1] = untried[gone + 1] = True
        left = np.ones(len(points), bool)
        left[gone] = False
        points, owner, untried = points[left], owner[left], untried[left]
        parity, idle = 1 - parity, 0 if len(gone) else idle + 1
    return begins(np.bincount(owner, minlength=len(rank))), points


def _free(triangles: np.ndarray, rank: np.ndarray, ranks: RankMap) -> np.ndarray:
    """In which triangles (T, 3, 2) nothing is painted earlier than `rank` (T,)."""
    edges = triangles - np.roll(triangles, 1, axis=1)
    longest = np.hypot(edges[..., 0], edges[..., 1]).max(axis=1, initial=0)
    steps = np.ceil(np.minimum(longest, _LONGEST) / _SPACING).astype(np.int64) + 1
    which = np.repeat(np.arange(len(steps)), (steps + 1) ** 2)
    u, v = np.divmod(ranges(np.zeros(len(steps), np.int64), (steps + 1) ** 2), (steps + 1)[which])
    inside = u + v <= steps[which]
    u, v, which = u[inside], v[inside], which[inside]
    weights = np.stack([steps[which] - u - v, u, v], axis=1) / steps[which][:, None]
    seen = ranks.lowest(np.einsum("nk,nkd->nd", weights, triangles[which]), _LEVEL)
    taken = np.bincount(which, seen < rank[which], minlength=len(steps))
    return np.asarray((taken == 0) & (longest <= _LONGEST))


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
