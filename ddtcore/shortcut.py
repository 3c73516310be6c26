# SPDX-License-Identifier: GPL-2.0-or-later
"""Shortcuts across the notches and spikes of hidden borders.

A border that follows its shape into a notch and out again, under what is painted later,
may as well pass the notch: where a hidden border turns outwards, the triangle between the
corner and its neighbours is added to the shape if all of it is painted no earlier.  Where
it turns inwards, the triangle is taken away if all of it is painted later.  And a corner
that is none, or nearly, may go anyway.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .loops import begins, ranges
from .rankmap import RankMap

_LONGEST = 80.0
"""Triangles with longer sides are not tried, px."""

_LOOKS = ((1, 1.4, _LONGEST), (0, 0.5, 10.0))
"""Levels of the rank map on which triangles are looked at, the distance between samples on each, and the longest
side, px.  The finer level sees room beside narrow things, but leaves no margin to the shape itself."""

_FLAT, _SHORT = 0.1, 20.0
"""Corners nearer than this to the line between their neighbours may go where these are not farther apart, px."""


def take_shortcuts(starts: np.ndarray, points: np.ndarray, rank: np.ndarray,
                   ranks: RankMap) -> Tuple[np.ndarray, np.ndarray]:
    """Leave out corners of polylines that nobody would miss.

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
        triangles = points[inner[:, None] + (-1, 0, 1)]
        gone = inner[_needless(triangles, rank[owner[inner]], ranks)]
        untried[gone - 1] = untried[gone + 1] = True
        left = np.ones(len(points), bool)
        left[gone] = False
        points, owner, untried = points[left], owner[left], untried[left]
        parity, idle = 1 - parity, 0 if len(gone) else idle + 1
    return begins(np.bincount(owner, minlength=len(rank))), points


def _needless(triangles: np.ndarray, rank: np.ndarray, ranks: RankMap) -> np.ndarray:
    """Which corners, each in the middle of a triangle (T, 3, 2), shapes with some ranks (T,) can do without."""
    before, corner, after = np.moveaxis(triangles, 1, 0)
    turn, base = _cross(corner - before, after - corner), np.hypot(*(after - before).T)
    edges = triangles - np.roll(triangles, 1, axis=1)
    longest = np.hypot(edges[..., 0], edges[..., 1]).max(axis=1, initial=0)
    needless = (np.abs(turn) <= _FLAT * base) & (longest <= _SHORT)
    for level, spacing, most in _LOOKS:
        some = np.flatnonzero(~needless & (longest <= most) & ((level > 0) | (turn < 0)))
        least = rank[some] + (turn[some] >= 0)
        needless[some] = _free(triangles[some], longest[some], least, ranks, level, spacing)
    return np.asarray(needless)


def _free(triangles: np.ndarray, longest: np.ndarray, least: np.ndarray, ranks: RankMap, level: int,
          spacing: float) -> np.ndarray:
    """In which triangles (T, 3, 2) nothing is painted before the rank `least` (T,)."""
    steps = np.ceil(longest / spacing).astype(np.int64) + 1
    which = np.repeat(np.arange(len(steps)), (steps + 1) ** 2)
    u, v = np.divmod(ranges(np.zeros(len(steps), np.int64), (steps + 1) ** 2), (steps + 1)[which])
    inside = u + v <= steps[which]
    u, v, which = u[inside], v[inside], which[inside]
    weights = np.stack([steps[which] - u - v, u, v], axis=1) / steps[which][:, None]
    seen = ranks.lowest(np.einsum("nk,nkd->nd", weights, triangles[which]), level)
    return np.asarray(np.bincount(which, seen < least[which], minlength=len(steps)) == 0)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
