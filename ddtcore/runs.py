# SPDX-License-Identifier: GPL-2.0-or-later
"""Arcs cut at their corners: runs of points between knots.

A *knot* is where a run begins or ends: a junction, a corner, or any point of a
ring that has no corner.  The pixels at junctions and corners see more than two
sides, so the points there are left out, and the knot is placed where the runs
that meet in it point to.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .arclength import Arclength
from .corner import Corners
from .model import PlanarMap, Polylines

CLEAR = 1.5
"""Length left out of a run beside a junction or a corner, px."""

_FAR = 1e7


class Runs(NamedTuple):
    """Runs of points, in the order of their arcs.

    Attributes
    ----------
    points : ndarray of shape (N, 2)
        Points of the arcs; those of rings twice over, for runs that pass their beginning.
    weight : ndarray of shape (N,)
    low, high : ndarray of shape (R,) and dtype int64
        Range of `points` that may be used for estimates near each run.
    first, last : ndarray of shape (R,) and dtype int64
        Points ``first[r]:last[r]`` belong to run r, the knots not among them.
    knots : ndarray of shape (R, 2) and dtype int64
        Where each run begins and ends.
    arc : ndarray of shape (R,) and dtype int64
    smooth : ndarray of shape (R,) and dtype bool
        Runs that are whole rings without a corner.
    places : ndarray of shape (K, 2)
        Position of each knot: junctions first, then corners, then beginnings of smooth rings.
    """

    points: np.ndarray
    weight: np.ndarray
    low: np.ndarray
    high: np.ndarray
    first: np.ndarray
    last: np.ndarray
    knots: np.ndarray
    arc: np.ndarray
    smooth: np.ndarray
    places: np.ndarray


def cut_at_knots(planar: PlanarMap, lines: Polylines, along: Arclength, corners: Corners,
                 size: Tuple[float, float]) -> Runs:
    """Cut arcs into runs and place the knots.

    Parameters
    ----------
    planar, lines, along, corners
        `along` belongs to `lines`.
    size : (float, float)
        Width and height of the picture: junctions on its border stay there.

    Returns
    -------
    Runs
    """
    arc, begin, end, knots, smooth, places = _knots(planar, lines, along, corners)
    keys, index, heads = _doubled(planar, lines, along)
    gap = np.where(smooth, 1e-6, np.minimum(CLEAR, 0.22 * (end - begin)))
    gap[planar.left[arc] == 0] = 1e-6
    first = np.searchsorted(keys, arc * _FAR + begin + gap)
    last = np.maximum(np.searchsorted(keys, arc * _FAR + end - gap), first)
    low = np.where(smooth, heads[arc], first)
    high = np.where(smooth, heads[arc + 1], last)
    points, weight = lines.points.take(index, axis=0), lines.weight[index]
    runs = Runs(points, weight, low, high, first, last, knots, arc, smooth, places)
    return runs._replace(places=_place_junctions(runs, len(planar.junctions), size))


def _knots(planar: PlanarMap, lines: Polylines, along: Arclength,
           corners: Corners) -> Tuple[np.ndarray, ...]:
    """Runs by arc, begin, end (distances along the arc), their knots; positions of the knots."""
    frame_arc, frame_length, frame_points = _frame_knots(planar, lines, along)
    open_ = np.flatnonzero(~planar.rings)
    n = len(planar.junctions)
    inner = np.concatenate([corners.arc, frame_arc])
    bare = np.setdiff1d(np.flatnonzero(planar.rings), inner)
    arc = np.concatenate([open_, open_, inner, bare])
    length = np.concatenate([np.zeros(len(open_)), along.total[open_], corners.length, frame_length,
                             np.zeros(len(bare))])
    knot = np.concatenate([planar.tail[open_], planar.head[open_],
                           n + np.arange(len(inner) + len(bare))]).astype(np.int64)
    places = np.concatenate([np.zeros((n, 2)), corners.point, frame_points, lines.points[lines.starts[bare]]])
    places[planar.tail[open_]] = lines.points[lines.starts[open_]]
    places[planar.head[open_]] = lines.points[lines.starts[open_ + 1] - 1]
    length = np.where(planar.rings[arc], np.mod(length, np.maximum(along.total[arc], 1e-9)), length)
    # The head of an open arc comes last even if the arc has no length.
    is_head = np.zeros(len(arc), bool)
    is_head[len(open_):2 * len(open_)] = True
    order = np.lexsort((is_head, length, arc))
    arc, length, knot = arc[order], length[order], knot[order]
    final = np.append(arc[1:] != arc[:-1], True) if len(arc) else np.zeros(0, bool)
    following = np.arange(1, len(arc) + 1)
    head = np.searchsorted(arc, arc[final])
    following[final] = head
    end = length[following % max(len(arc), 1)].copy() if len(arc) else length
    end[final] += along.total[arc[final]]
    is_run = ~final | planar.rings[arc]
    smooth = np.isin(arc, bare)
    pair = np.stack([knot, knot[following % max(len(arc), 1)]], axis=1)
    return arc[is_run], length[is_run], end[is_run], pair[is_run], smooth[is_run], places


def _frame_knots(planar: PlanarMap, lines: Polylines, along: Arclength) -> Tuple[np.ndarray, ...]:
    """Every inner point of the arcs along the picture's border, and of angular ones, is a knot."""
    count = np.diff(lines.starts)
    arc = np.repeat(np.arange(len(count)), count)
    offset = np.arange(len(arc)) - lines.starts[arc]
    inner = ((planar.left == 0) | lines.corners())[arc]
    inner &= planar.rings[arc] | ((offset > 0) & (offset < count[arc] - 1))
    return arc[inner], along.at_point[inner], lines.points[inner]


def _doubled(planar: PlanarMap, lines: Polylines, along: Arclength) -> Tuple[np.ndarray, ...]:
    """Rising keys (arc and distance), point numbers and heads, with rings gone round twice."""
    count = np.diff(lines.starts)
    times = np.where(planar.rings, 2, 1)
    heads = np.concatenate([[0], np.cumsum(count * times)])
    arc = np.repeat(np.arange(len(count)), count * times)
    offset = np.arange(heads[-1]) - heads[arc]
    index = lines.starts[arc] + offset % np.maximum(count, 1)[arc]
    length = along.at_point[index] + np.where(offset >= count[arc], along.total[arc], 0)
    return arc * _FAR + length, index, heads


def end_lines(runs: Runs) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where each run points at both of its ends, from a parabola through its nearest points.

    Returns
    -------
    point, tangent : ndarray of shape (R, 2, 2)
        The nearest point of the parabola and the unit tangent there, into the run.
    trust : ndarray of shape (R, 2)
        0 for a run too short to say, 1 for one of 4 points or more.
    """
    reach = np.arange(6)
    sides = []
    for end in (0, 1):
        index = runs.first[:, None] + reach if end == 0 else runs.last[:, None] - 1 - reach
        valid = (index >= runs.first[:, None]) & (index < runs.last[:, None])
        index = np.clip(index, 0, max(len(runs.points) - 1, 0))
        sides.append(_one_side(runs, index, valid, runs.places[runs.knots[:, end]],
                               runs.places[runs.knots[:, 1 - end]]))
    point, tangent, trust = (np.stack(part, axis=1) for part in zip(*sides))
    return point, tangent, trust


def _one_side(runs: Runs, index: np.ndarray, valid: np.ndarray, knot: np.ndarray,
              other: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    points = runs.points.take(index, axis=0)
    weight = np.where(valid, runs.weight[index], 0)
    count = valid.sum(axis=1)
    side = parabolas(points, weight, 0.3)
    few = count < 2
    point, tangent = side[:, 0], side[:, 1]
    point[few] = knot[few]
    tangent[few] = (other - knot)[few]
    length = np.hypot(*tangent.T)
    tangent = np.where(length[:, None] > 1e-9, tangent / np.maximum(length, 1e-9)[:, None], [1.0, 0.0])
    return point, tangent, np.where(few, 0, np.minimum(count / 4.0, 1)) ** 2


def parabolas(points: np.ndarray, weight: np.ndarray, firmness: float, origin: int = 0) -> np.ndarray:
    """Coefficients (R, 3, 2) of parabolas through points (R, K, 2) with weights (R, K).

    They go by the way along the points from the one numbered `origin`; `firmness` keeps them from bending.
    """
    piece = np.hypot(*np.moveaxis(np.diff(points, axis=1), 2, 0))
    u = np.concatenate([np.zeros((len(points), 1)), np.cumsum(piece, axis=1)], axis=1)
    u -= u[:, origin:origin + 1].copy()
    design = np.stack([np.ones_like(u), u, u * u], axis=-1)
    weighted = (design * weight[..., np.newaxis]).transpose(0, 2, 1)
    normal = weighted @ design
    normal[:, [0, 1, 2], [0, 1, 2]] += [1e-6, 1e-6, firmness]
    return np.linalg.solve(normal, weighted @ points)


def _place_junctions(runs: Runs, n: int, size: Tuple[float, float]) -> np.ndarray:
    """Move junctions to where the arcs that meet there point to, by least squares."""
    places = runs.places.copy()
    point, tangent, trust = end_lines(runs)
    normal, right = np.zeros((n, 2, 2)), np.zeros((n, 2))
    at = runs.knots.ravel()
    mine = at < n
    across = np.stack([-tangent[..., 1], tangent[..., 0]], axis=-1).reshape(-1, 2)[mine]
    at, weight = at[mine], trust.ravel()[mine]
    offset = np.einsum("ed,ed->e", across, point.reshape(-1, 2)[mine])
    for i in (0, 1):
        right[:, i] = np.bincount(at, weight * across[:, i] * offset, n)
        for j in (0, 1):
            normal[:, i, j] = np.bincount(at, weight * across[:, i] * across[:, j], n)
    raw = runs.places[:n]
    firm = np.where((raw == 0) | (raw == np.asarray(size)), 1e6, 0.02)
    normal[:, [0, 1], [0, 1]] += firm
    move = np.linalg.solve(normal, (right + firm * raw)[..., None])[..., 0] - raw
    far = np.maximum(np.hypot(*move.T) / 2.5, 1)
    places[:n] = np.clip(raw + move / far[:, None], 0, size)
    places[:n] = np.where(firm > 1, raw, places[:n])
    return places
