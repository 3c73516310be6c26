# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines of pictures without anti-aliasing: the curve that a staircase stands for.

Where no pixel is a mix, an outline runs along the sides of pixels, in straight
runs with steps between them.  A curve that was cut into pixels passes the middle
of each run; only long runs are straight in earnest, and two long runs at a right
angle are a corner.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from .model import PlanarMap

SLACK = 0.35
"""How far from the curve a staircase may be, beyond the tolerance, px."""

PLAIN = 0.03
"""Coverage closer than this to 0 or 1 counts as none or all."""

ROUNDED = 8.0
"""Colours closer than this count as the same, of 255 (all channels together): those of gradients are rounded."""

LONG, STRAIGHT, SQUARE = 6, 3.0, 4
"""Runs longer than LONG are straight but for STRAIGHT px at either end; two of SQUARE px meet in a corner."""

DOT = 4
"""Largest region that is drawn as its pixels where these are pure, px²: it has no curve to be found."""


class Staircases(NamedTuple):
    """Outlines without anti-aliasing.

    Attributes
    ----------
    hard : ndarray of shape (A,) and dtype bool
        Arcs that are not anti-aliased.
    dot : ndarray of shape (A,) and dtype bool
        Those of them that follow the sides of pixels.
    arc : ndarray of shape (M,)
    points : ndarray of shape (M, 2)
        What the arcs' points are to be.
    """

    hard: np.ndarray
    dot: np.ndarray
    arc: np.ndarray
    points: np.ndarray


def find_staircases(planar: PlanarMap, arc: np.ndarray, edge: np.ndarray, shares: List[np.ndarray],
                    contrast: np.ndarray, ends: np.ndarray) -> Staircases:
    """Find the arcs that are not anti-aliased, and their points.

    Parameters
    ----------
    planar : PlanarMap
    arc : ndarray of shape (N,)
        Arc of each crossing.
    edge : ndarray of shape (N, 2, 2)
        Origin and end of the crossed mesh edge.
    shares : list of two ndarray of shape (N,)
        How much of the left colour there is in the pixels at these.
    contrast : ndarray of shape (N,)
        Difference of the two colours, levels.
    ends : ndarray of shape (J, 2)
        Positions of the junctions; those of dots are moved.

    Returns
    -------
    Staircases
    """
    step = edge[:, 1] - edge[:, 0]
    flat = np.maximum(PLAIN, ROUNDED / contrast)
    plain = (np.abs(shares[0]) < flat) & (np.abs(shares[1] - 1) < flat)
    axis = np.flatnonzero((np.abs(step).sum(axis=1) == 1) & (planar.left[arc] != 0))
    upright = step[axis, 0] != 0
    hard = hard_arcs(planar, arc[axis], upright, plain[axis])
    dot = dot_arcs(planar, arc, plain)
    exact, runs = axis[dot[arc[axis]]], axis[(hard & ~dot)[arc[axis]]]
    # The left side is where the edge ends: the walk goes at a right angle to it.
    dot_arc, corners = along_pixels(planar.rings, arc[exact], step[exact, ::-1] * [-1, 1], edge[exact].mean(axis=1))
    run_arc, points = through_runs(planar.rings, arc[runs], step[runs, ::-1] * [-1, 1], edge[runs].mean(axis=1))
    # An open arc gives its junctions their place.
    first = np.flatnonzero(np.diff(dot_arc, prepend=-1).astype(bool) & ~planar.rings[dot_arc])
    last = np.searchsorted(dot_arc, dot_arc[first], side="right") - 1
    ends[planar.tail[dot_arc[first]]], ends[planar.head[dot_arc[last]]] = corners[first], corners[last]
    inside = np.ones(len(dot_arc), bool)
    inside[first] = (corners[first] != ends[planar.tail[dot_arc[first]]]).any(axis=1)
    inside[last] &= (corners[last] != ends[planar.head[dot_arc[last]]]).any(axis=1)
    return Staircases(hard | dot, dot, np.concatenate([run_arc, dot_arc[inside]]),
                   np.concatenate([points, corners[inside]]))


def hard_arcs(planar: PlanarMap, arc: np.ndarray, upright: np.ndarray, pure: np.ndarray) -> np.ndarray:
    """Which arcs are staircases: nearly all of their steps show no mixed pixel.

    Parameters
    ----------
    planar : PlanarMap
    arc : ndarray of shape (N,)
        Arc of each crossing of a horizontal or vertical mesh edge, in walking order.
    upright : ndarray of shape (N,) and dtype bool
        Whether the outline runs upright there.
    pure : ndarray of shape (N,) and dtype bool
        Whether both pixels have the plain colour of their face.

    Returns
    -------
    ndarray of shape (A,) and dtype bool
    """
    step = (arc[1:] == arc[:-1]) & (upright[1:] != upright[:-1])
    steps = np.bincount(arc[1:][step], minlength=len(planar.tail))
    clean = np.bincount(arc[1:][step & pure[1:] & pure[:-1]], minlength=len(planar.tail))
    return (steps > 0) & (clean >= 0.8 * steps)


def dot_arcs(planar: PlanarMap, arc: np.ndarray, pure: np.ndarray) -> np.ndarray:
    """Which arcs (A,) bound a region of a few pixels and pass pure pixels only.

    Parameters
    ----------
    planar : PlanarMap
    arc : ndarray of shape (N,)
        Arc of each crossing.
    pure : ndarray of shape (N,) and dtype bool
        Whether both ends of the mesh edge have the plain colour of their face.
    """
    area = planar.face_areas
    small = np.minimum(area[planar.left], area[planar.right]) <= DOT
    return np.asarray(small & (planar.left != 0) & (np.bincount(arc, ~pure, len(small)) == 0))


def along_pixels(ring: np.ndarray, arc: np.ndarray, walk: np.ndarray,
                 middle: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Corners of the outlines that follow the sides of pixels; parameters and results as of `through_runs`.

    Open arcs begin and end with the corners of pixels at which their junctions lie.
    """
    ends = np.stack([middle - walk / 2, middle + walk / 2], axis=1)
    head, tail = _run_ends(arc, walk, middle)
    points = np.stack([ends[head, 0], ends[tail, 1]], axis=1).reshape(-1, 2)
    arc = np.repeat(arc[head], 2)
    before = np.arange(len(arc)) - 1
    first = np.searchsorted(arc, arc) == np.arange(len(arc))
    before[first] = np.searchsorted(arc, arc[first], side="right") - 1
    fresh = (points != points[before]).any(axis=1) | (first & ~ring[arc])
    return arc[fresh], points[fresh]


def _run_ends(arc: np.ndarray, walk: np.ndarray, middle: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """The first and the last crossing of each straight run along the sides of pixels."""
    fresh = np.ones(len(arc), bool)
    fresh[1:] = (arc[1:] != arc[:-1]) | (walk[1:] != walk[:-1]).any(axis=1)
    # After a step to the side the walk can go on as before, on another level.
    fresh[1:] |= np.abs(middle[1:] - middle[:-1] - walk[:-1]).sum(axis=1) > 0.1
    heads = np.flatnonzero(fresh)
    return heads, np.append(heads[1:], len(arc))[:len(heads)] - 1


def through_runs(ring: np.ndarray, arc: np.ndarray, walk: np.ndarray,
                 middle: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Points of the curves that staircases stand for, about a pixel apart.

    Parameters
    ----------
    ring : ndarray of shape (A,) and dtype bool
        Which arcs are rings.
    arc : ndarray of shape (N,)
        As for `hard_arcs`, of staircases only.
    walk : ndarray of shape (N, 2)
        Direction of the outline between the two pixels, a unit vector along an axis.
    middle : ndarray of shape (N, 2)
        Middle of the side between the two pixels.

    Returns
    -------
    arc : ndarray of shape (M,)
    points : ndarray of shape (M, 2)
    """
    if not len(arc):
        return arc, middle
    heads, tails = _run_ends(arc, walk, middle)
    first, last, along, run_arc = middle[heads], middle[tails], walk[heads], arc[heads]
    length = np.einsum("rd,rd->r", last - first, along) + 1
    inset = np.where(length > LONG, STRAIGHT - 0.5, (length - 1) / 2)[:, None]
    square = _square_corners(run_arc, along, length)
    following = np.append(np.arange(1, len(heads)), 0)
    corner = np.where(along[:, :1] == 0, np.stack([first[:, 0], first[following, 1]], axis=1),
                      np.stack([first[following, 0], first[:, 1]], axis=1))
    points = np.stack([first + along * inset, last - along * inset, corner], axis=1)
    present = np.stack([np.ones(len(heads), bool), length > LONG, square], axis=1)
    return _fill_in(np.repeat(run_arc, 3).reshape(-1, 3)[present], points[present], ring)


def _fill_in(arc: np.ndarray, points: np.ndarray, ring: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """The same lines with a point every pixel, so that long runs have the say due to their length."""
    n = len(arc)
    head = np.searchsorted(arc, arc)
    last = np.append(arc[1:] != arc[:-1], True)[:n]
    following = np.where(last, np.where(ring[arc], head, np.arange(n)), np.arange(1, n + 1))
    way = points[following] - points
    count = np.maximum(np.ceil(np.hypot(*way.T)), 1).astype(np.int64)
    owner = np.repeat(np.arange(n), count)
    step = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    return arc[owner], points[owner] + way[owner] * (step / count[owner])[:, None]


def _square_corners(arc: np.ndarray, along: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Which runs meet the one that follows in a corner: both are long, or one is the end of a bar."""
    n = len(arc)
    turns = np.zeros(n, bool)
    turns[:-1] = (arc[1:] == arc[:-1]) & (np.einsum("rd,rd->r", along[1:], along[:-1]) == 0)
    long_ = length >= SQUARE
    end = np.zeros(n, bool)
    end[1:-1] = turns[:-2] & turns[1:-1] & long_[:-2] & long_[2:] & (along[:-2] == -along[2:]).all(axis=1)
    square = turns.copy()
    square[:-1] &= (long_[:-1] & long_[1:]) | end[:-1] | end[1:]
    return square
