# SPDX-License-Identifier: GPL-2.0-or-later
r"""A mesh whose edges can be flipped: half-edges, planes, and what a flip does to them.

Two triangles t = (p, q, r) and u = (q, p, s) share the edge p-q: half-edge h in t, its
twin g in u.  A flip replaces it by the edge r-s.  Half-edges run clockwise::

                p                                p
             /  |  \                          /     \
        b  /    |    \  m                b  /    t    \  h
         /      |      \                  /      n      \
        r   t  h|g  u   s      -->       r - - - - - - - s
         \      |      /                  \      m      /
        n  \    |    /  c                g  \    u    /  c
             \  |  /                          \     /
                q                                q

So b and c stay as they are, h and g become the sides that m and n were, and these become
the new edge: two origins and three pairs of twins change.

Every triangle keeps twice the area 1, because all vertices are pixel centres and all pixel
centres are vertices (Pick's theorem).  Hence the quadrilateral p s q r is strictly convex
exactly where it is a parallelogram, r + s = p + q: with vertices numbered row by row, an
equality of whole numbers.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from .cost import EdgeCost

Corners = Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]
"""Vertices p, q, r, s round edges, int64 (n,) each."""

_NEXT, _BACK = np.array([1, 1, -2]), np.array([2, -1, -1])


@dataclass
class Ribbon:
    """The part of a mesh where edges are being flipped.

    One more triangle, number T, stands for all that lies beside the ribbon.  It is flat, so
    that edges at the rim cost nothing, and its corners lie in the frame, so that these edges
    are not flipped.

    Attributes
    ----------
    columns : int
        Columns of the framed grid of vertices.
    origins, twins : ndarray of shape (3 * T + 3,) and dtype int64
        Half-edges as in `Mesh`, but the twin of one at the rim is ``3 * T``.
    cost : EdgeCost
    planes : ndarray of shape (K, T + 1) and dtype float64
        Plane of each triangle, see `EdgeCost`.
    labels : ndarray of shape (V,) and dtype int32
        Label of each vertex of the framed grid, negative in the frame.
    thin : ndarray of shape (V,) and dtype bool
        Vertices on strokes that must not be cut.
    everywhere : bool
        False: an edge may be flipped only if the four vertices round it differ in label.
    flips : int
        Edges flipped so far.
    work : int
        Edge costs computed so far.
    finished : bool
        False if the work budget was too small.
    """

    columns: int
    origins: np.ndarray
    twins: np.ndarray
    cost: EdgeCost
    planes: np.ndarray
    labels: np.ndarray
    thin: np.ndarray
    everywhere: bool
    flips: int = 0
    work: int = 0
    finished: bool = True

    @property
    def outside(self) -> int:
        """Number of the triangle that stands for what lies beside the ribbon."""
        return int(self.planes.shape[1]) - 1

    def planes_of(self, half_edges: np.ndarray) -> np.ndarray:
        """Planes of the triangles that half-edges (n,) belong to, (K, n)."""
        return self.planes.take(half_edges // 3, axis=1)


def following(half_edges: np.ndarray) -> np.ndarray:
    """The next half-edges of the same triangles."""
    after: np.ndarray = half_edges + _NEXT[half_edges % 3]
    return after


def preceding(half_edges: np.ndarray) -> np.ndarray:
    """The half-edges of the same triangles that come before."""
    before: np.ndarray = half_edges + _BACK[half_edges % 3]
    return before


def sides(ribbon: Ribbon, edges: np.ndarray) -> Tuple[np.ndarray, ...]:
    """Half-edges b, m, c, n round each edge h, (n,) each."""
    twins = ribbon.twins[edges]
    return preceding(edges), following(twins), preceding(twins), following(edges)


def corners(ribbon: Ribbon, edges: np.ndarray) -> Corners:
    """Vertices p, q, r, s round each edge."""
    twins = ribbon.twins[edges]
    p, q, r, s = (ribbon.origins[h] for h in (edges, twins, preceding(edges), preceding(twins)))
    return p, q, r, s


def flippable(ribbon: Ribbon, around: Corners) -> Tuple[np.ndarray, Corners]:
    """Which edges p-q may become r-s: their indices (k,), and their corners."""
    p, q, r, s = around
    able = np.flatnonzero(r + s == p + q)
    labels = np.stack([ribbon.labels[vertices[able]] for vertices in around])
    least = labels.min(axis=0)
    may = least >= 0
    if not ribbon.everywhere:
        may &= labels.max(axis=0) > least
    may &= (labels[0] != labels[1]) | ~(ribbon.thin[p[able]] | ribbon.thin[q[able]])
    able = able[may]
    return able, (p[able], q[able], r[able], s[able])


def flipped_planes(ribbon: Ribbon, t: np.ndarray, u: np.ndarray, around: Corners
                   ) -> Tuple[np.ndarray, np.ndarray]:
    """Planes of (r, p, s) and (s, q, r) from those of (p, q, r) and (q, p, s), (K, n) each.

    From t to u the gradient changes by a multiple, the jump, of that of the function which is
    0 at p and q and 1 at s.  The first new plane is that of t, lifted by the jump at s alone;
    the sum of the two gradients does not change.  All these are whole numbers, so they are exact.
    """
    p, q, r, _ = (np.divmod(vertices, ribbon.columns) for vertices in around)
    a, b = q[0] - p[0], p[1] - q[1]
    cost = ribbon.cost
    gradient, other = cost.gradients(t), cost.gradients(u)
    step = other - gradient
    jump = (step[:cost.channels] * a + step[cost.channels:] * b) / (a * a + b * b)
    lifted = np.concatenate([jump * (r[0] - p[0]), jump * (p[1] - r[1])])
    lifted += gradient
    return cost.planes(lifted), cost.planes(gradient + other - lifted)


def flip_edges(ribbon: Ribbon, h: np.ndarray) -> None:
    """Flip edges, no two of which may share a triangle.

    Parameters
    ----------
    ribbon : Ribbon
        Changed in place.
    h : ndarray of shape (n,) and dtype int64
        One half-edge each.
    """
    origins, twins = ribbon.origins, ribbon.twins
    g = twins[h]
    around = corners(ribbon, h)
    _, m, _, n = sides(ribbon, h)
    ribbon.planes[:, h // 3], ribbon.planes[:, g // 3] = flipped_planes(
        ribbon, ribbon.planes_of(h), ribbon.planes_of(g), around)
    origins[n], origins[m] = around[3], around[2]
    for edge, twin in ((h, twins[m]), (g, twins[n]), (m, n)):
        twins[edge], twins[twin] = twin, edge
    ribbon.flips += len(h)


def edges_of(ribbon: Ribbon, triangles: np.ndarray) -> np.ndarray:
    """One half-edge for each inner edge of the triangles, in rising order."""
    half_edges = (3 * triangles[:, np.newaxis] + np.arange(3)).ravel()
    return one_each(ribbon, half_edges[ribbon.twins[half_edges] < 3 * ribbon.outside])


def one_each(ribbon: Ribbon, half_edges: np.ndarray) -> np.ndarray:
    """Half-edges without twins and repetitions, in rising order."""
    return distinct(len(ribbon.twins), np.minimum(half_edges, ribbon.twins[half_edges]))


def with_neighbours(ribbon: Ribbon, triangles: np.ndarray) -> np.ndarray:
    """Triangles and those beside them, in rising order."""
    beside = ribbon.twins.reshape(-1, 3)[triangles].ravel() // 3
    return distinct(ribbon.outside, np.concatenate([triangles, beside[beside < ribbon.outside]]))


def distinct(size: int, numbers: np.ndarray) -> np.ndarray:
    """Numbers from 0 to size - 1 without repetitions, in rising order."""
    marked = np.zeros(size, bool)
    marked[numbers] = True
    return np.flatnonzero(marked)
