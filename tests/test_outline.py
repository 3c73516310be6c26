# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines: each mixed edge crossed once, each face enclosed by its own loops and no others."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meshes import grey

from ddtcore.model import OUTSIDE, Labels, Mesh, PlanarMap
from ddtcore.options import TraceOptions
from ddtcore.outline import link_outlines
from ddtcore.triangulation import triangulate

FLIPS = ("boundaries", "everywhere")


def flat(rows) -> Labels:
    """Labels from rows of digits."""
    index = np.array([list(map(int, row)) for row in rows], np.int32)
    return Labels(index, np.zeros((index.max() + 1, 4)), np.zeros(index.shape, bool))


def mapped(labels: Labels, image=None, flips: str = "boundaries"):
    """Mesh and map of labels; the flips follow `image`, whose colours need not agree with the labels."""
    image = grey(labels.index * 40) if image is None else image
    mesh = triangulate(image, labels, TraceOptions(flips=flips))
    return mesh, link_outlines(mesh, labels)


@st.composite
def labelled(draw):
    """Small label maps of up to four labels, and noise for the flips to follow."""
    shape = draw(st.tuples(st.integers(1, 8), st.integers(1, 8)))
    random = np.random.RandomState(draw(st.integers(0, 2 ** 32 - 1)))
    index = random.randint(0, draw(st.integers(2, 4)), shape).astype(np.int32)
    # With a margin outlines are rings; without one most of them end at the picture's border.
    index = np.pad(index, draw(st.integers(0, 1)), mode="constant")
    labels = Labels(index, np.zeros((4, 4)), np.zeros(index.shape, bool))
    return labels, grey(random.randint(0, 256, index.shape)), draw(st.sampled_from(FLIPS))


def ends(mesh: Mesh, half) -> np.ndarray:
    """Origin and end of half-edges, (N, 2)."""
    triangle, side = np.divmod(np.asarray(half), 3)
    return np.stack([mesh.triangles[triangle, side], mesh.triangles[triangle, (side + 1) % 3]], axis=1)


def framed(pixels: np.ndarray, around: int) -> np.ndarray:
    """Values of the pixels for all vertices of the mesh, those in the frame among them."""
    return np.pad(pixels, 1, mode="constant", constant_values=around).ravel()


def crossing_points(mesh: Mesh, planar: PlanarMap, arc: int) -> np.ndarray:
    """An arc through the mid-points of its mesh edges, from junction to junction."""
    walk = planar.crossings[planar.starts[arc]:planar.starts[arc + 1]]
    crossed = mesh.points(ends(mesh, walk)).mean(axis=1)
    if planar.rings[arc]:
        return crossed
    junctions = planar.junctions[[planar.tail[arc], planar.head[arc]]]
    tail, head = mesh.points(mesh.triangles[junctions]).mean(axis=1)
    return np.concatenate([[tail], crossed, [head]])


def loops_of(mesh: Mesh, planar: PlanarMap):
    """All closed walks with one face on the right: face and signed area of each."""
    halves = {}
    for arc in range(len(planar.tail)):
        points = crossing_points(mesh, planar, arc)
        halves[2 * arc] = (planar.right[arc], planar.tail[arc], planar.head[arc], points)
        halves[2 * arc + 1] = (planar.left[arc], planar.head[arc], planar.tail[arc], points[::-1])
    found = []
    while halves:
        half = min(halves)
        face, begin, end, points = halves.pop(half)
        walk = [points]
        while end != begin:
            half = next(k for k in sorted(halves) if halves[k][0] == face and halves[k][1] == end)
            _, _, end, points = halves.pop(half)
            walk.append(points[1:])
        x, y = np.concatenate(walk).T
        found.append((face, (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() / 2))
    return found


SHARES = {(1, 3): 1 / 2, (2, 1): 1 / 8, (2, 2): 3 / 8, (3, 1): 1 / 6}
"""Area of a triangle that belongs to a face, by the triangle's faces and its vertices of this one.

The cut from mid-point to mid-point takes off a quarter of the triangle; three cuts from the
mid-points to the barycentre leave a third to each vertex.
"""


def face_areas(mesh: Mesh, planar: PlanarMap) -> np.ndarray:
    """Area of each face within the frame, quad by quad and triangle by triangle."""
    face = framed(planar.pixel_faces, 0)
    row, col = np.nonzero(~mesh.quads)
    area = np.bincount(face[row * mesh.shape[1] + col], minlength=len(planar.face_labels)).astype(float)
    for triangle in face[mesh.triangles].tolist():
        counted = Counter(triangle)
        for number, count in counted.items():
            area[number] += SHARES[len(counted), count]
    return area


def assert_valid_map(mesh: Mesh, labels: Labels, planar: PlanarMap) -> None:
    vertex = framed(labels.index, OUTSIDE)
    assert_faces_are_connected_labels(mesh, labels, planar)
    areas = np.bincount(planar.pixel_faces.ravel(), minlength=len(planar.face_labels))
    assert np.array_equal(planar.face_areas, areas)
    # Each mixed edge is crossed exactly once.
    origin, end = ends(mesh, np.arange(len(mesh.twins))).T
    mixed = np.flatnonzero((vertex[origin] != vertex[end]) & (np.arange(len(origin)) < mesh.twins))
    crossed = np.minimum(planar.crossings, mesh.twins[planar.crossings])
    assert np.array_equal(np.sort(crossed), mixed)
    # Walks go from triangle to triangle, from junction to junction or round.
    three = np.array([len(set(t)) == 3 for t in vertex[mesh.triangles].tolist()])
    assert np.array_equal(planar.junctions, np.flatnonzero(three))
    face = framed(planar.pixel_faces, 0)
    for arc in range(len(planar.tail)):
        walk = planar.crossings[planar.starts[arc]:planar.starts[arc + 1]]
        assert len(walk)
        entered, left = walk // 3, mesh.twins[walk] // 3
        assert np.array_equal(entered[:-1], left[1:]) and not three[entered[:-1]].any()
        if planar.rings[arc]:
            assert planar.head[arc] == -1 and entered[-1] == left[0] and not three[entered[-1]]
        else:
            assert left[0] == planar.junctions[planar.tail[arc]]
            assert entered[-1] == planar.junctions[planar.head[arc]]
        assert (face[ends(mesh, walk)] == [planar.right[arc], planar.left[arc]]).all()
        assert planar.face_labels[planar.left[arc]] < planar.face_labels[planar.right[arc]]
    assert_loops_enclose_faces(mesh, planar)


def assert_faces_are_connected_labels(mesh: Mesh, labels: Labels, planar: PlanarMap) -> None:
    """A plain flood fill along the mesh and across flat quads finds the same faces."""
    vertex = framed(labels.index, OUTSIDE)
    sides = set(map(tuple, ends(mesh, np.arange(len(mesh.twins))).tolist()))
    cols = mesh.shape[1]
    for row, col in np.argwhere(~mesh.quads):
        a = row * cols + col
        sides |= {(a, a + 1), (a, a + cols), (a + 1, a + cols + 1), (a + cols, a + cols + 1)}
    near = {}
    for a, b in sides:
        if vertex[a] == vertex[b]:
            near.setdefault(a, set()).add(b)
            near.setdefault(b, set()).add(a)
    face = framed(planar.pixel_faces, 0)
    assert np.array_equal(planar.face_labels[face], vertex) and planar.face_labels[0] == OUTSIDE
    seen = {}
    for seed in range(len(vertex)):
        if seed in seen:
            continue
        stack = [seed]
        seen[seed] = seed
        while stack:
            for other in near.get(stack.pop(), ()):
                if other not in seen:
                    seen[other] = seed
                    stack.append(other)
    assert len(set(seen.values())) == len(planar.face_labels)
    assert len(set(zip(face.tolist(), (seen[v] for v in range(len(vertex)))))) == len(planar.face_labels)


def assert_loops_enclose_faces(mesh: Mesh, planar: PlanarMap) -> None:
    loops = loops_of(mesh, planar)
    enclosed = np.zeros(len(planar.face_labels))
    for face, area in loops:
        assert area != 0
        enclosed[face] += area
    areas = face_areas(mesh, planar)
    # The outside is what the frame's own outline leaves of it; that outline is no loop of the map.
    areas[0] -= (mesh.shape[0] - 1) * (mesh.shape[1] - 1)
    assert np.allclose(enclosed, areas, atol=1e-9)
    outer = Counter(face for face, area in loops if area > 0)
    assert outer == dict.fromkeys(range(1, len(planar.face_labels)), 1)
    # Euler: V - E + F = 1 + C, a ring counting as one vertex and one edge.
    holes = len(loops) - sum(outer.values())
    vertices = len(planar.junctions) + int(planar.rings.sum())
    assert vertices - len(planar.tail) + len(planar.face_labels) == 1 + holes
    assert 3 * len(planar.junctions) == 2 * int((~planar.rings).sum())


@given(labelled())
def test_maps_of_random_labels_are_valid(drawn):
    labels, image, flips = drawn
    mesh, planar = mapped(labels, image, flips)
    assert_valid_map(mesh, labels, planar)


CASES = {
    # name: rows, faces (the outside among them), rings, open arcs, junctions
    "one pixel": (["0"], 2, 1, 0, 0),
    "one row": (["00000"], 2, 1, 0, 0),
    "one colour": (["000", "000", "000"], 2, 1, 0, 0),
    "dot": (["000", "010", "000"], 3, 2, 0, 0),
    "ring": (["00000", "01110", "01010", "01110", "00000"], 4, 3, 0, 0),
    "rings in a ring": (["000000000", "011111110", "010000010", "010111010", "010101010", "010111010",
                         "010000010", "011111110", "000000000"], 6, 5, 0, 0),
    "two dots": (["00000", "01020", "00000"], 4, 3, 0, 0),
    "two halves": (["0011", "0011"], 3, 0, 3, 2),
    "stripes": (["0123"], 5, 0, 9, 6),
    "dot in the corner": (["100", "000", "000"], 3, 0, 3, 2),
    "dot on the border": (["010", "000"], 3, 0, 3, 2),
    "touching areas": (["00000", "01120", "01120", "00000"], 4, 1, 3, 2),
    "three at a point": (["1122", "1122", "0000"], 4, 0, 6, 4),
    "four at a point": (["0011", "0011", "2233", "2233"], 5, 0, 9, 6),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("flips", FLIPS)
def test_known_maps(name, flips):
    rows, faces, rings, open_arcs, junctions = CASES[name]
    labels = flat(rows)
    mesh, planar = mapped(labels, flips=flips)
    assert_valid_map(mesh, labels, planar)
    assert (len(planar.face_labels), len(planar.junctions)) == (faces, junctions)
    assert (planar.rings.sum(), (~planar.rings).sum()) == (rings, open_arcs)


def test_four_colours_meet_in_two_junctions_that_an_arc_joins():
    mesh, planar = mapped(flat(["0011", "0011", "2233", "2233"]))
    row, col = np.divmod(mesh.triangles[planar.junctions], mesh.shape[1])
    inside = np.flatnonzero(((row > 0) & (row < 5) & (col > 0) & (col < 5)).all(axis=1))
    assert len(inside) == 2
    assert sorted(inside.tolist()) in np.sort(np.stack([planar.tail, planar.head], axis=1), axis=1).tolist()


def test_arcs_keep_the_smaller_label_on_their_left():
    mesh, planar = mapped(flat(["000", "010", "000"]))
    inner = int(np.flatnonzero(planar.left != 0)[0])
    x, y = crossing_points(mesh, planar, inner).T
    # The dot lies on the right, so the ring runs clockwise: a positive area.
    assert (x * np.roll(y, -1) - np.roll(x, -1) * y).sum() > 0
    assert planar.face_labels[planar.left[inner]] == 0 and planar.face_labels[planar.right[inner]] == 1


def test_a_ring_of_thousands_of_crossings_keeps_its_order():
    index = np.zeros((61, 61), np.int32)
    index[1:-1, 1::2] = 1
    index[1, 1:-1] = 1
    labels = Labels(index, np.zeros((2, 4)), np.zeros(index.shape, bool))
    mesh, planar = mapped(labels)
    assert planar.rings.all() and np.diff(planar.starts).max() > 5000
    assert_valid_map(mesh, labels, planar)
