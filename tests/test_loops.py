# SPDX-License-Identifier: GPL-2.0-or-later
"""Loops of planar maps: closed walks that share out the picture, outer ones and holes."""

from __future__ import annotations

import numpy as np
import pytest
from planar import planar_map

from ddtcore.loops import FaceLoops, both_ways, face_loops, half_ranges, half_sides, ranges, rotate, select

RING_IN_RING = np.zeros((9, 9), int)
for inset in range(1, 5):
    RING_IN_RING[inset:9 - inset, inset:9 - inset] = inset % 2

MAPS = {
    "one pixel": [[0]], "row": [[0, 1, 0, 0, 2]], "checkerboard": np.indices((4, 5)).sum(axis=0) % 2,
    "ring in ring": RING_IN_RING, "four corners": [[0, 0, 1, 1], [0, 0, 1, 1], [2, 2, 3, 3], [2, 2, 3, 3]],
    "web in a hole": np.pad([[1, 1, 2, 2], [1, 1, 2, 2], [3, 3, 3, 3]], 2),
    "touching holes": [[0, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 0]],
    **{f"random {seed}": np.random.RandomState(seed).randint(0, 4, (7, 8)) for seed in range(8)},
}


@pytest.fixture(params=MAPS)
def world(request):
    planar, lines, _ = planar_map(MAPS[request.param])
    return planar, lines, face_loops(planar, lines)


def test_every_half_arc_lies_on_one_loop_of_its_face(world):
    planar, _, loops = world
    assert sorted(loops.halves) == list(range(2 * len(planar.left)))
    face = np.repeat(loops.face, np.diff(loops.starts))
    assert (half_sides(planar)[0][loops.halves] == face).all()


def test_loops_are_closed_walks(world):
    planar, _, loops = world
    begin = np.stack([planar.tail, planar.head], axis=1).ravel()
    end = np.stack([planar.head, planar.tail], axis=1).ravel()
    for first, last in zip(loops.starts[:-1], loops.starts[1:]):
        halves = loops.halves[first:last]
        assert (end[halves] == np.roll(begin[halves], -1)).all()
        assert len(halves) == 1 or (begin[halves] >= 0).all()


def test_areas_share_out_the_picture(world):
    planar, _, loops = world
    height, width = planar.pixel_faces.shape
    area = np.zeros(len(planar.face_labels))
    np.add.at(area, loops.face, loops.area)
    assert area[0] == pytest.approx(-height * width)
    assert (area[1:] > 0).all()
    assert area[1:].sum() == pytest.approx(height * width)


def test_each_face_has_one_outer_loop_and_it_runs_clockwise(world):
    planar, _, loops = world
    assert (np.bincount(loops.face[loops.outer], minlength=len(planar.face_labels))[1:] == 1).all()
    assert (loops.outer == (loops.area > 0)).all()


def test_a_web_leaves_one_hole(world):
    _, _, loops = world
    assert (np.bincount(loops.web[~loops.outer]) == 1).all()


def test_boxes_bound_the_outer_loops():
    planar, lines, _ = planar_map(np.pad(np.ones((3, 5), int), 2))
    loops = face_loops(planar, lines)
    assert sorted(loops.box[loops.outer]) == pytest.approx([15, 7 * 9])


def test_arcs_without_points_enclose_nothing():
    planar, lines, _ = planar_map([[0, 0, 0], [0, 1, 0], [0, 0, 0]])
    ring = int(np.flatnonzero(np.diff(lines.starts) == np.diff(lines.starts).min())[0])
    a, b = lines.starts[ring:ring + 2]
    starts = lines.starts - np.where(np.arange(len(lines.starts)) > ring, b - a, 0)
    loops = face_loops(planar, type(lines)(starts, np.delete(lines.points, range(a, b), axis=0),
                                           np.delete(lines.weight, range(a, b)), lines.slack))
    assert sorted(loops.area[loops.outer]) == pytest.approx([0, 9])
    assert sorted(loops.box[loops.outer]) == pytest.approx([0, 9])


def test_half_arcs_find_their_items_forwards_and_backwards():
    starts, items = np.array([0, 2, 2, 5]), np.arange(10, 15)
    first, count = half_ranges(starts)
    walks = [both_ways(items)[a:a + n].tolist() for a, n in zip(first, count)]
    assert walks == [[10, 11], [11, 10], [], [], [12, 13, 14], [14, 13, 12]]


def test_ranges_follow_one_another():
    assert ranges(np.array([5, 0, 7]), np.array([2, 0, 3])).tolist() == [5, 6, 7, 8, 9]
    assert ranges(np.zeros(0, int), np.zeros(0, int)).tolist() == []


def simple_loops(starts, halves):
    count = len(starts) - 1
    return FaceLoops(np.array(starts), np.array(halves), np.arange(count), np.ones(count), np.ones(count),
                     np.ones(count, bool), np.arange(count))


def test_rotated_loops_begin_where_hidden_half_arcs_do():
    loops = simple_loops([0, 4, 6, 9], [0, 1, 2, 3, 4, 5, 6, 7, 8])
    hidden = np.isin(np.arange(9), [0, 3, 4, 5])
    assert rotate(loops, hidden).halves.tolist() == [3, 0, 1, 2, 4, 5, 6, 7, 8]


def test_selected_loops_keep_their_half_arcs():
    chosen = select(simple_loops([0, 2, 3, 6], [5, 4, 3, 2, 1, 0]), np.array([True, False, True]))
    assert chosen.starts.tolist() == [0, 2, 5]
    assert chosen.halves.tolist() == [5, 4, 2, 1, 0]
    assert chosen.face.tolist() == [0, 2]
