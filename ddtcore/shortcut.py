# SPDX-License-Identifier: GPL-2.0-or-later
"""Shortcuts across the notches and spikes of hidden borders.

A border that follows its shape into a notch and out again, under what is painted later,
may as well pass the notch: where a hidden border turns outwards, the triangle between the
corner and its neighbours is added to the shape if all of it is painted no earlier.  Where
it turns inwards, the triangle is taken away if all of it is painted later.  And a corner
that is none, or nearly, may go anyway.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Tuple

import numpy as np

from .loops import begins, ranges
from .rankmap import RankMap

_LONGEST = 80.0
"""Triangles with longer sides are not tried, px."""

_LOOKS = ((1, 1.4, _LONGEST), (0, 0.5, 10.0))
"""Levels of the rank map on which triangles are looked at, the distance between samples on each, and the longest
side, px.  The finer level sees room beside narrow things, but leaves no margin to the shape itself."""

_FEW = 8
"""Samples of a triangle that are looked at before all others."""

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
        steps = np.ceil(np.append(longest[some], most) / spacing).astype(np.int64) + 1
        needless[some] = _free(triangles[some], steps[:-1], int(steps[-1]), least, ranks, level)
    return np.asarray(needless)


def _free(triangles: np.ndarray, steps: np.ndarray, most: int, least: np.ndarray, ranks: RankMap,
          level: int) -> np.ndarray:
    """In which triangles (T, 3, 2), with so many steps along their sides, nothing is painted before `least` (T,)."""
    begin, weights = _samples(most)
    first, count = begin[steps], np.diff(begin)[steps]
    # Most that are not free show it at once.
    few = first[:, None] + count[:, None] * (2 * np.arange(_FEW) + 1) // (2 * _FEW)
    free = np.ones(len(steps), bool)
    for which, some in ((np.repeat(np.arange(len(steps)), _FEW), few.ravel()),
                        (np.repeat(np.arange(len(steps)), count), ranges(first, count))):
        kept = free[which]
        which, some = which[kept], some[kept]
        places = np.einsum("nk,nkd->nd", weights[some], triangles[which])
        free[which[ranks.lowest(places, level) < least[which]]] = False
    return free


@lru_cache(maxsize=None)
def _samples(most: int) -> Tuple[np.ndarray, np.ndarray]:
    """Where those for each number of steps begin, of weights (N, 3) of a triangle's corners at places all over it.

    The steps are those along its sides, from 0 to `most`.
    """
    side = np.arange(most + 1)
    steps, u, v = np.nonzero(side[:, None] + side <= side[:, None, None])
    return begins(np.bincount(steps)), np.stack([steps - u - v, u, v], axis=1) / np.maximum(steps, 1)[:, None]


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
