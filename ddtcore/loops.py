# SPDX-License-Identifier: GPL-2.0-or-later
"""Loops round the faces of a planar map: outer ones and holes.

An arc is walked in its own direction along the face on its right, and against it along
the one on its left.  Half-arc ``2 * a`` is arc a in its own direction, ``2 * a + 1``
against it; a loop is a cycle of half-arcs with the same face on the right.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .components import components
from .model import PlanarMap, Polylines


class FaceLoops(NamedTuple):
    """The closed walks round all faces.

    Attributes
    ----------
    starts : ndarray of shape (L + 1,) and dtype int64
        Where each loop begins in `halves`.
    halves : ndarray of shape (M,) and dtype int64
        Half-arcs, loop after loop, in walking order.
    face : ndarray of shape (L,) and dtype int32
        The face on the right.
    area : ndarray of shape (L,) and dtype float64
        px², positive if the loop runs clockwise.
    box : ndarray of shape (L,) and dtype float64
        Area of the bounding rectangle, px².
    outer : ndarray of shape (L,) and dtype bool
        Whether the loop is the outer one of its face; all others are holes.
    web : ndarray of shape (L,) and dtype int32
        Number of the loop's web.  Arcs that junctions join make a web; a hole is what one
        web cuts from the face round it.
    """

    starts: np.ndarray
    halves: np.ndarray
    face: np.ndarray
    area: np.ndarray
    box: np.ndarray
    outer: np.ndarray
    web: np.ndarray


def half_sides(planar: PlanarMap) -> Tuple[np.ndarray, np.ndarray]:
    """Faces on the right and on the left of every half-arc, each of shape (2 * A,)."""
    right = np.stack([planar.right, planar.left], axis=1).ravel()
    return right, np.stack([planar.left, planar.right], axis=1).ravel()


def both_ways(values: np.ndarray) -> np.ndarray:
    """All items in their order, then all in reverse order."""
    return np.concatenate([values, values[::-1]])


def half_ranges(starts: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Where the items of each half-arc lie in `both_ways` of the arcs' items: first and count."""
    first = np.stack([starts[:-1], 2 * starts[-1] - starts[1:]], axis=1).ravel()
    return first, np.repeat(np.diff(starts), 2)


def kept_on(place: np.ndarray, count: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Places along arcs of `count` items, in place: what lies beyond an end is at it, or goes on round a ring."""
    out = np.flatnonzero((place < 0) | (place >= count))
    size = count[out]
    place[out] = np.where(ring[out], place[out] % size, np.clip(place[out], 0, size - 1))
    return place


def ranges(first: np.ndarray, count: np.ndarray) -> np.ndarray:
    """The integers of many ranges, one after the other."""
    before = np.cumsum(count) - count
    return np.repeat(first - before, count) + np.arange(int(count.sum()))


def begins(size: np.ndarray) -> np.ndarray:
    """Where items of the given sizes begin when stored one after the other, and the end of all."""
    return np.concatenate([[0], np.cumsum(size, dtype=np.int64)])


def face_loops(planar: PlanarMap, lines: Polylines) -> FaceLoops:
    """Walk round every face.

    Parameters
    ----------
    planar : PlanarMap
        Where the three arcs of a junction meet, three different faces do.
    lines : Polylines

    Returns
    -------
    FaceLoops
    """
    face = half_sides(planar)[0]
    following = _following(planar, face)
    web = components(len(planar.left), np.arange(len(face)) // 2, following // 2)
    starts, halves = _walk(following)
    first = halves[starts[:-1]]
    face, web = face[first], web[first // 2]
    area, box = _measure(lines, planar.rings, starts, halves)
    return FaceLoops(starts, halves, face, area, box, _outer(face, web), web)


def _following(planar: PlanarMap, face: np.ndarray) -> np.ndarray:
    """The half-arc that goes on round the same face, for every half-arc."""
    begin = np.stack([planar.tail, planar.head], axis=1).ravel()
    end = np.stack([planar.head, planar.tail], axis=1).ravel()
    following = np.arange(len(face))
    open_ = np.flatnonzero(begin >= 0)
    # A face has one corner at a junction: its loop arrives there once and leaves once.
    arriving = open_[np.lexsort((face[open_], end[open_]))]
    following[arriving] = open_[np.lexsort((face[open_], begin[open_]))]
    return following


def _walk(following: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Cycles of a permutation: starts (L + 1,) and the items, cycle after cycle."""
    ahead = following.tolist()
    seen = [False] * len(ahead)
    starts, items = [0], []
    for item in range(len(ahead)):
        if seen[item]:
            continue
        while not seen[item]:
            seen[item] = True
            items.append(item)
            item = ahead[item]
        starts.append(len(items))
    return np.array(starts, np.int64), np.array(items, np.int64)


def _measure(lines: Polylines, rings: np.ndarray, starts: np.ndarray,
             halves: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Signed area and area of the bounding rectangle of every loop."""
    # Rings of a pixel or two can have lost all their points.
    some = np.diff(lines.starts) > 0
    first, last = lines.starts[:-1][some], lines.starts[1:][some] - 1
    x, y = lines.points.T
    ahead = np.arange(1, len(x) + 1)
    ahead[last] = np.where(rings[some], first, last)
    arc = np.zeros(len(rings))
    arc[some] = np.add.reduceat((x * y[ahead] - x[ahead] * y) / 2, first)
    area = np.add.reduceat(np.stack([arc, -arc], axis=1).ravel()[halves], starts[:-1])
    low, high = np.full((len(rings), 2), np.inf), np.full((len(rings), 2), -np.inf)
    low[some] = np.minimum.reduceat(lines.points, first)
    high[some] = np.maximum.reduceat(lines.points, first)
    low = np.minimum.reduceat(low[halves // 2], starts[:-1])
    high = np.maximum.reduceat(high[halves // 2], starts[:-1])
    return area, np.prod(np.maximum(high - low, 0), axis=1)


def _outer(face: np.ndarray, web: np.ndarray) -> np.ndarray:
    """Which loops are outer ones, from the frame inwards.

    The loop by which a face is met first is its outer one; all webs in its other loops
    are met next.  This asks for no coordinates, which may be off for the smallest faces.
    """
    outer = np.zeros(len(face), bool)
    met = np.zeros(int(face.max()) + 1, bool)
    met[0] = True
    entered = np.zeros(int(web.max()) + 1, bool)
    while True:  # once per level of nesting
        entered[web[met[face]]] = True
        fresh = entered[web] & ~met[face]
        if not fresh.any():
            return outer
        outer |= fresh
        met[face[fresh]] = True


def select(loops: FaceLoops, chosen: np.ndarray) -> FaceLoops:
    """Only the loops for which `chosen` (L,) is true."""
    size = np.diff(loops.starts)
    return FaceLoops(begins(size[chosen]), loops.halves[np.repeat(chosen, size)],
                     *(values[chosen] for values in loops[2:]))


def rotate(loops: FaceLoops, hidden: np.ndarray) -> FaceLoops:
    """Let each loop begin where hidden half-arcs follow visible ones, if it has both.

    Parameters
    ----------
    loops : FaceLoops
    hidden : ndarray of shape (2 * A,) and dtype bool
        By half-arc.

    Returns
    -------
    FaceLoops
    """
    first, size = loops.starts[:-1], np.diff(loops.starts)
    index = np.arange(len(loops.halves))
    before = index - 1
    before[first] = loops.starts[1:] - 1
    covered = hidden[loops.halves]
    begin = np.minimum.reduceat(np.where(covered & ~covered[before], index, len(index)), first)
    begin = np.where(begin < len(index), begin, first)
    place = index - np.repeat(2 * first - begin, size)
    return loops._replace(halves=loops.halves[np.repeat(first, size) + place % np.repeat(size, size)])
