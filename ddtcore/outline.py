# SPDX-License-Identifier: GPL-2.0-or-later
"""Border triangles become closed outlines: the walk of the paper, section V.

"Follow the wind rose and the colour value" is made definite on the dual graph of
the mesh.  Call a mesh edge *mixed* if its ends carry different labels.  A border
triangle with two labels has exactly two mixed edges: a walk that keeps one label
on its left and the other on its right enters by one and leaves by the other, so
it is a permutation and cannot get lost.  A triangle with three labels has three
mixed edges and is a junction, where walks begin and end::

        a ------ a                 a ------ a
         \\   2  / \\                 \\   3  /
          \\  . /   \\                 \\  . /
      ->--------.   \\             ->--------.      the walk crosses mixed edges;
            \\ /  1   \\                 \\ / \\       triangle 1 has labels a b b,
             b ------ b                 c   ...     triangle 3 has labels a a c ...

The frame round the picture carries a label of its own, so no end stays open.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .components import components
from .model import OUTSIDE, Labels, Mesh, PlanarMap


def link_outlines(mesh: Mesh, labels: Labels) -> PlanarMap:
    """Join border triangles into arcs between junctions, and find the faces.

    Parameters
    ----------
    mesh : Mesh
        Every quad whose vertices differ in label must be meshed.
    labels : Labels

    Returns
    -------
    PlanarMap
        Each boundary once, with the smaller label on its left.
    """
    framed = frame_labels(labels.index)
    vertex = framed.ravel()
    origin = mesh.triangles.ravel()
    end = np.roll(mesh.triangles, -1, axis=1).ravel()
    # The label pair stays the same along a walk, so one direction of each is enough.
    crossings = np.flatnonzero(vertex[end] < vertex[origin])
    following, first_junction, last_junction = _follow(mesh, vertex, origin, end, crossings)
    order, starts, ring = _chains(following)
    crossings = crossings[order].astype(np.int32)
    faces, face_labels = _faces(mesh, framed)
    heads, tails = last_junction[order[starts[1:] - 1]], first_junction[order[starts[:-1]]]
    junctions, numbers = np.unique(np.concatenate([tails[~ring], heads[~ring]]), return_inverse=True)
    tail = np.full(len(ring), -1, np.int32)
    head = tail.copy()
    tail[~ring], head[~ring] = np.split(numbers.ravel(), 2)
    begin = crossings[starts[:-1]]
    return PlanarMap(
        starts=starts, crossings=crossings, tail=tail, head=head,
        left=faces.ravel()[end[begin]], right=faces.ravel()[origin[begin]],
        junctions=junctions.astype(np.int32), face_labels=face_labels,
        pixel_faces=np.ascontiguousarray(faces[1:-1, 1:-1]))


def frame_labels(index: np.ndarray) -> np.ndarray:
    """Labels of the framed vertex grid, int32 (H + 2, W + 2), `OUTSIDE` in the ring."""
    return np.pad(index.astype(np.int32, copy=False), 1, constant_values=OUTSIDE)


def _follow(mesh: Mesh, vertex: np.ndarray, origin: np.ndarray, end: np.ndarray,
            crossings: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Index of the next crossing (-1 at a junction); junction triangles before and after."""
    mixed = (vertex[origin] != vertex[end]).reshape(-1, 3)
    junction = mixed.all(axis=1)
    triangle, side = np.divmod(crossings, 3)
    # In a triangle with two labels one side is not mixed; the walk leaves by the third.
    leave = 3 * triangle + 3 - side - np.argmin(mixed[triangle], axis=1)
    leave[junction[triangle]] = 0
    number = np.full(len(origin), -1, np.int64)
    number[crossings] = np.arange(len(crossings))
    following = np.where(junction[triangle], -1, number[mesh.twins[leave]])
    before = mesh.twins[crossings] // 3
    return (following, np.where(junction[before], before, -1), np.where(junction[triangle], triangle, -1))


def _chains(following: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order linked items chain by chain, by pointer doubling.

    Parameters
    ----------
    following : ndarray of shape (N,) and dtype int64
        The next item, -1 at the end of a chain; no two items share one.

    Returns
    -------
    order : ndarray of shape (N,)
        The items, chain after chain, in walking order.
    starts : ndarray of shape (A + 1,) and dtype int64
    ring : ndarray of shape (A,) and dtype bool
    """
    n = len(following)
    items = np.arange(n)
    preceding = np.full(n, -1, np.int64)
    open_ = following >= 0
    preceding[following[open_]] = items[open_]
    ring_start = _ring_starts(preceding)
    preceding[ring_start] = -1
    first = preceding < 0
    jump = np.where(first, items, preceding)
    rank = (~first).astype(np.int64)
    while True:
        further = jump[jump]
        if np.array_equal(further, jump):
            break
        rank += rank[jump]
        jump = further
    heads = np.flatnonzero(first)
    length = np.bincount(jump, minlength=n)[heads] if n else np.zeros(0, np.int64)
    starts = np.concatenate([[0], np.cumsum(length)]).astype(np.int64)
    offset = np.zeros(n, np.int64)
    offset[heads] = starts[:-1]
    order = np.empty(n, np.int64)
    order[offset[jump] + rank] = items
    is_ring = np.zeros(n, bool)
    is_ring[ring_start] = True
    return order, starts, is_ring[heads]


def _ring_starts(preceding: np.ndarray) -> np.ndarray:
    """The smallest item of every ring."""
    items = np.arange(len(preceding))
    jump = np.where(preceding < 0, items, preceding)
    least = np.minimum(items, jump)
    for _ in range(len(items).bit_length()):
        least = np.minimum(least, least[jump])
        jump = jump[jump]
    # By now every walk back has reached the beginning of its chain, unless it is a ring.
    return np.flatnonzero((least == items) & (preceding[jump] >= 0))


def _faces(mesh: Mesh, framed: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Number the regions that mesh edges connect: faces (H + 2, W + 2) and their labels."""
    rows, cols = mesh.shape
    right, below, extra = _mesh_links(mesh, framed)
    breaks = np.ones((rows, cols), bool)
    breaks[:, 1:] = ~right
    run = np.cumsum(breaks.ravel(), dtype=np.int32).reshape(rows, cols) - 1
    # A vertical link repeats the one to its left where both runs simply go on.
    fresh = below.copy()
    fresh[:, 1:] &= breaks[:-1, 1:] | breaks[1:, 1:] | ~below[:, :-1]
    flat = run.ravel()
    a = np.concatenate([run[:-1][fresh], flat[extra[0]]])
    b = np.concatenate([run[1:][fresh], flat[extra[1]]])
    part = components(int(flat[-1]) + 1, a, b)
    face_labels = np.empty(int(part.max()) + 1, np.int32)
    heads = np.flatnonzero(breaks.ravel())
    face_labels[part] = framed.ravel()[heads]
    return part.astype(np.int32)[run], face_labels


def _mesh_links(mesh: Mesh, framed: np.ndarray) -> Tuple[np.ndarray, np.ndarray, Tuple[np.ndarray, np.ndarray]]:
    """Which neighbours of equal label mesh edges join: right, below, and all others as pairs."""
    rows, cols = mesh.shape
    right = framed[:, 1:] == framed[:, :-1]
    below = framed[1:] == framed[:-1]
    # An edge between two meshed quads can have been flipped away.
    inner_right = np.zeros_like(right)
    inner_right[1:-1] = mesh.quads[:-1] & mesh.quads[1:]
    inner_below = np.zeros_like(below)
    inner_below[:, 1:-1] = mesh.quads[:, :-1] & mesh.quads[:, 1:]
    origin = mesh.triangles.ravel()
    end = np.roll(mesh.triangles, -1, axis=1).ravel()
    step = np.abs(end - origin)
    low = np.minimum(origin, end)
    present = np.zeros(rows * cols, bool)
    present[low[step == 1]] = True
    right &= ~inner_right | present.reshape(rows, cols)[:, :-1]
    present[:] = False
    present[low[step == cols]] = True
    below &= ~inner_below | present.reshape(rows, cols)[:-1]
    vertex = framed.ravel()
    other = (step != 1) & (step != cols) & (end > origin) & (vertex[origin] == vertex[end])
    return right, below, (origin[other], end[other])
