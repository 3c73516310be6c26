# SPDX-License-Identifier: GPL-2.0-or-later
"""The order of painting: large to small, and no hole filled that must stay open."""

from __future__ import annotations

import numpy as np
import pytest
from planar import planar_map

from ddtcore.loops import face_loops
from ddtcore.order import area_order, covers_all, filled_holes
from ddtcore.paint import NOTHING, Paint

NESTED = np.zeros((11, 11), int)
for depth in range(1, 5):
    NESTED[depth:11 - depth, depth:11 - depth] = depth


def ordered(index, opacity=None, by_box=False):
    """Loops, order and the label of each face, with an opacity per label."""
    planar, lines, _ = planar_map(index)
    loops = face_loops(planar, lines)
    opacity = opacity or {}
    labels = planar.face_labels[1:].tolist()
    paints = [NOTHING] + [Paint((0, 0, 0), opacity.get(label, 1.0)) for label in labels]
    return loops, area_order(loops, paints, by_box), planar.face_labels


@pytest.mark.parametrize("by_box", [False, True])
@pytest.mark.parametrize("seed", range(10))
def test_keys_do_not_increase_and_holders_come_before_what_they_hold(seed, by_box):
    loops, order, _ = ordered(np.random.RandomState(seed).randint(0, 3, (8, 9)), by_box=by_box)
    assert (np.diff(order.key) <= 0).all()
    outer_face = dict(zip(loops.web[~loops.outer], loops.face[~loops.outer]))
    for web, face in zip(loops.web[loops.outer], loops.face[loops.outer]):
        assert order.rank[outer_face[web]] < order.rank[face]


def test_the_key_counts_what_lies_in_holes():
    index = np.zeros((12, 12), int)
    index[1:11, 1:11] = 1
    for row, col in np.ndindex(2, 2):
        index[2 + 5 * row:5 + 5 * row, 2 + 4 * col:5 + 4 * col] = 2
    _, order, labels = ordered(index)
    assert labels[order.faces].tolist() == [0, 1, 2, 2, 2, 2]


def test_equal_boxes_are_sorted_by_area():
    index = np.zeros((12, 12), int)
    corner = np.add.outer(np.arange(10), np.arange(10))
    index[1:11, 1:11] = np.where(corner < 12, 1, 2)
    _, order, labels = ordered(index, by_box=True)
    assert labels[order.faces].tolist() == [0, 1, 2]
    assert order.key[1] == pytest.approx(100)


def test_translucent_faces_come_first_and_cover_nothing():
    _, order, labels = ordered(NESTED, {2: 0.5, 3: 0.5})
    assert labels[order.faces].tolist() == [2, 3, 0, 1, 4]
    assert (order.cover[labels == 2] == -1).all() and (order.rank[labels == 2] == 0).all()
    assert not covers_all(order)


def test_transparent_faces_are_not_painted():
    _, order, labels = ordered(NESTED, {0: 0.0, 2: 0.0})
    assert labels[order.faces].tolist() == [1, 3, 4]
    assert (order.rank[labels == 2] == -1).all()


def test_everything_opaque_lies_on_the_first():
    assert covers_all(ordered(NESTED)[1])
    assert not covers_all(ordered(NESTED, {4: 0.0})[1])


def test_all_holes_are_filled_where_all_is_opaque():
    loops, order, _ = ordered(NESTED)
    painted = order.rank[loops.face] >= 0
    assert filled_holes(loops, order)[painted].tolist() == (~loops.outer)[painted].tolist()


def test_something_transparent_keeps_all_holes_round_it_open():
    loops, order, labels = ordered(NESTED, {3: 0.0})
    filled = filled_holes(loops, order)
    still_open = set(labels[loops.face[~loops.outer & ~filled & (loops.face > 0)]].tolist())
    # The face inside the transparent one has no hole; the transparent one is not painted.
    assert {0, 1, 2} <= still_open and 4 not in still_open


def test_a_hole_is_kept_if_an_earlier_face_lies_inside():
    loops, order, _ = ordered(NESTED)
    swapped = order._replace(rank=order.rank[::-1].copy(), cover=order.cover[::-1].copy())
    painted = swapped.rank[loops.face] >= 0
    assert not filled_holes(loops, swapped)[painted & (loops.face > 0)].any()
