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

from typing import NamedTuple, Tuple

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
    corner = framed.ravel()[mesh.triangles]
    ahead = np.roll(corner, -1, axis=1)
    mixed = ahead != corner
    # The label pair stays the same along a walk, so one direction of each is enough.
    crossings = np.flatnonzero(ahead < corner)
    following, first_junction, last_junction = _follow(mesh, mixed, crossings)
    order, starts, ring = _chains(following)
    crossings = crossings[order].astype(np.int32)
    faces = _faces(mesh, framed)
    heads, tails = last_junction[order[starts[1:] - 1]], first_junction[order[starts[:-1]]]
    junctions, numbers = np.unique(np.concatenate([tails[~ring], heads[~ring]]), return_inverse=True)
    tail = np.full(len(ring), -1, np.int32)
    head = tail.copy()
    tail[~ring], head[~ring] = np.split(numbers.ravel(), 2)
    triangle, side = np.divmod(crossings[starts[:-1]], 3)
    return PlanarMap(
        starts=starts, crossings=crossings, tail=tail, head=head,
        left=faces.of(mesh.triangles[triangle, (side + 1) % 3]), right=faces.of(mesh.triangles[triangle, side]),
        junctions=junctions.astype(np.int32), face_labels=faces.labels,
        face_areas=np.bincount(faces.numbers, faces.sizes).astype(np.int64), pixel_faces=faces.pixels())


def frame_labels(index: np.ndarray) -> np.ndarray:
    """Labels of the framed vertex grid (H + 2, W + 2), `OUTSIDE` in the ring."""
    return np.pad(index, 1, mode="constant", constant_values=OUTSIDE)


def _follow(mesh: Mesh, mixed: np.ndarray, crossings: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Index of the next crossing (-1 at a junction); junction triangles before and after.

    Parameters
    ----------
    mesh : Mesh
    mixed : ndarray of shape (T, 3) and dtype bool
        Whether the ends of a half-edge differ in label.
    crossings : ndarray of shape (N,)
        Half-edges.
    """
    junction = np.asarray(mixed.all(axis=1))
    triangle, side = np.divmod(crossings, 3)
    # In a triangle with two labels one side is not mixed; the walk leaves by the third.
    leave = 3 * triangle + 3 - side - np.argmin(mixed[triangle], axis=1)
    leave[junction[triangle]] = 0
    number = np.full(mixed.size, -1, np.int32)
    number[crossings] = np.arange(len(crossings), dtype=np.int32)
    following = np.where(junction[triangle], -1, number[mesh.twins[leave]])
    before = mesh.twins[crossings] // 3
    return (following, np.where(junction[before], before, -1), np.where(junction[triangle], triangle, -1))


def _chains(following: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Order linked items chain by chain, by pointer doubling.

    Parameters
    ----------
    following : ndarray of shape (N,) and dtype int32
        The next item, -1 at the end of a chain; no two items share one.

    Returns
    -------
    order : ndarray of shape (N,)
        The items, chain after chain, in walking order.
    starts : ndarray of shape (A + 1,) and dtype int64
    ring : ndarray of shape (A,) and dtype bool
    """
    n = len(following)
    items = np.arange(n, dtype=np.int32)
    preceding = np.full(n, -1, np.int32)
    open_ = following >= 0
    preceding[following[open_]] = items[open_]
    ring_start = _ring_starts(preceding)
    preceding[ring_start] = -1
    first = preceding < 0
    jump = np.where(first, items, preceding)
    rank = (~first).astype(np.int32)
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
    items = np.arange(len(preceding), dtype=np.int32)
    jump = np.where(preceding < 0, items, preceding)
    least = np.minimum(items, jump)
    for _ in range(len(items).bit_length()):
        least = np.minimum(least, least[jump])
        jump = jump[jump]
    # By now every walk back has reached the beginning of its chain, unless it is a ring.
    return np.flatnonzero((least == items) & (preceding[jump] >= 0))


class _Faces(NamedTuple):
    """Runs of linked vertices in the rows of the framed grid, and the faces they are parts of."""

    labels: np.ndarray   # (F,) label of each face
    heads: np.ndarray    # (R,) vertex at which each run begins
    sizes: np.ndarray    # (R,) how many of its vertices are pixels
    numbers: np.ndarray  # (R,) its face
    shape: Tuple[int, int]

    def of(self, vertices: np.ndarray) -> np.ndarray:
        """Faces of vertices, int32."""
        return self.numbers[np.searchsorted(self.heads, vertices, side="right") - 1]

    def pixels(self) -> np.ndarray:
        """Faces of all pixels, int32 (H, W)."""
        return np.repeat(self.numbers, self.sizes).reshape(self.shape)


def _faces(mesh: Mesh, framed: np.ndarray) -> _Faces:
    """Number the regions that mesh edges connect.

    Whether a run is linked to one of the next row need only be asked where one of them begins,
    and beside links that are missing.
    """
    cols = framed.shape[1]
    vertex = framed.ravel()
    no_right, no_below = _missing_links(mesh)
    cut = np.ones(framed.shape, bool)
    np.not_equal(framed[:, 1:], framed[:, :-1], out=cut[:, 1:])
    cut.ravel()[no_right + 1] = True
    heads = np.flatnonzero(cut)
    asked = cut[:-1] | cut[1:]
    asked.ravel()[no_below + 1] = True
    upper = np.flatnonzero(asked)
    missing = np.zeros(len(vertex), bool)
    missing[no_below] = True
    upper = upper[(vertex[upper] == vertex[upper + cols]) & ~missing[upper]]
    oblique = _oblique_links(mesh, vertex)
    a, b = (np.searchsorted(heads, np.concatenate(side), side="right") - 1
            for side in ((upper, oblique[0]), (upper + cols, oblique[1])))
    numbers = components(len(heads), a, b)
    labels = np.empty(int(numbers.max()) + 1, np.int32)
    labels[numbers] = vertex[heads]
    sizes = np.where(vertex[heads] == OUTSIDE, 0, np.diff(np.append(heads, len(vertex))))
    return _Faces(labels, heads, sizes, numbers, (framed.shape[0] - 2, cols - 2))


def _missing_links(mesh: Mesh) -> Tuple[np.ndarray, np.ndarray]:
    """Vertices whose edge to the right one, or to the one below, has been flipped away."""
    rows, cols = mesh.shape
    origin, end = _edges(mesh)
    step, low = np.abs(end - origin), np.minimum(origin, end)
    row, col = np.divmod(np.flatnonzero(mesh.quads), cols - 1)
    missing = []
    for length, down, across in ((1, 1, 0), (cols, 0, 1)):
        present = np.zeros(rows * cols, bool)
        present[low[step == length]] = True
        # Sides between two quads that are meshed begin at the second one's first corner.
        at = (row + down) * cols + col + across
        meshed = (row + down < rows - 1) & (col + across < cols - 1)
        meshed[meshed] = mesh.quads[row[meshed] + down, col[meshed] + across]
        missing.append(at[meshed & ~present[at]])
    return missing[0], missing[1]


def _oblique_links(mesh: Mesh, vertex: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Ends of the mesh edges that are neither level nor upright, where their labels are equal."""
    origin, end = _edges(mesh)
    step = end - origin
    oblique = np.flatnonzero((step > 1) & (step != mesh.shape[1]))
    origin, end = origin[oblique], end[oblique]
    same = vertex[origin] == vertex[end]
    return origin[same], end[same]


def _edges(mesh: Mesh) -> Tuple[np.ndarray, np.ndarray]:
    """Vertices that half-edges run from and to."""
    return mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
