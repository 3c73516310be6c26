# SPDX-License-Identifier: GPL-2.0-or-later
"""The raster of drawn curves agrees with the label map that the curves came from."""

from __future__ import annotations

import numpy as np
import pytest
from planar import planar_map

from ddtcore.model import CUBIC, LINE, QUADRATIC, Curves, PlanarMap
from ddtcore.rankmap import REACH, RankMap, as_cubics, sample_arcs


def rank_map(index):
    """A map in which the rank of each face is its number; the outside hides nothing."""
    planar, _, curves = planar_map(index)
    cover = np.arange(len(planar.face_labels), dtype=np.int32)
    cover[0] = -1
    return planar, RankMap(*sample_arcs(curves, 1.5), planar, cover)


def centres(shape):
    return np.stack(np.mgrid[:shape[0], :shape[1]][::-1], axis=-1).reshape(-1, 2) + 0.5


@pytest.mark.parametrize("seed", range(6))
def test_what_is_seen_at_pixel_centres_is_their_face(seed):
    planar, ranks = rank_map(np.random.RandomState(seed).randint(0, 4, (9, 11)))
    at = centres(planar.pixel_faces.shape) - 0.1
    assert (ranks.lowest(at, 0) == planar.pixel_faces.ravel()).all()


@pytest.mark.parametrize("level", [1, 2])
def test_coarse_levels_look_at_least_as_far_as_they_say(level):
    planar, ranks = rank_map(np.random.RandomState(7).randint(0, 4, (12, 14)))
    at = centres(planar.pixel_faces.shape)
    seen = ranks.lowest(at, level)
    for angle in np.linspace(0, 2 * np.pi, 16, endpoint=False):
        away = at + REACH[level] * np.array([np.cos(angle), np.sin(angle)])
        inside = (away > 0).all(axis=1) & (away < planar.pixel_faces.shape[::-1]).all(axis=1)
        assert (seen <= ranks.lowest(away, 0))[inside].all()


def test_nothing_is_seen_outside():
    _, ranks = rank_map(np.zeros((3, 4), int))
    outside = np.array([[-0.1, 1], [4.1, 1], [2, -5], [2, 3.1], [900, 900]])
    for level in range(3):
        assert (ranks.lowest(outside, level) == -1).all()


def test_where_arcs_cross_the_earlier_face_is_seen():
    # Walls between faces 3 | 2 and 2 | 1 have changed places: 1 must not turn into 2 on the right.
    planar = PlanarMap(
        starts=np.zeros(5, int), crossings=np.zeros(0, int), tail=np.arange(4), head=np.arange(4),
        left=np.array([3, 2, 1, 0]), right=np.array([0, 3, 2, 1]), junctions=np.zeros(4, int),
        face_labels=np.arange(4), face_areas=np.full(4, 10), pixel_faces=np.zeros((4, 10), np.int32))
    x = np.array([0.0, 6.0, 4.0, 10.0])
    points = np.stack([np.repeat(x, 2), np.tile([0.0, 4.0], 4)], axis=1)
    ranks = RankMap(np.arange(0, 9, 2), points, planar, np.array([-1, 1, 2, 3]))
    seen = ranks.lowest(np.array([[2, 2], [5, 2], [8, 2]]), 0)
    assert seen.tolist() == [2, 1, 1]


def test_samples_lie_close_together_on_the_curves_and_keep_their_joints():
    control = np.array([[[0, 0], [0, 0], [9, 0], [9, 0]], [[9, 0], [14, 0], [14, 0], [14, 5]],
                        [[0, 9], [3, 9], [6, 9], [9, 9]]], float)
    curves = Curves(np.array([0, 2, 3]), control, np.array([LINE, QUADRATIC, CUBIC]))
    starts, points = sample_arcs(curves, 1.5)
    first, second = points[:starts[1]], points[starts[1]:]
    assert np.hypot(*np.diff(first, axis=0).T).max() <= 1.6
    assert (first[0] == [0, 0]).all() and (first[-1] == [14, 5]).all()
    assert (first == [9, 0]).all(axis=1).sum() == 1
    assert second == pytest.approx(np.stack([np.linspace(0, 9, 7), np.full(7, 9)], axis=1))


def test_quadratics_and_lines_become_the_same_cubics():
    control = np.array([[[0, 0], [7, 7], [7, 7], [6, 0]], [[0, 0], [3, 3], [3, 3], [6, 0]]], float)
    line, quadratic = as_cubics(Curves(np.array([0, 2]), control, np.array([LINE, QUADRATIC])))
    assert line.tolist() == [[0, 0], [2, 0], [4, 0], [6, 0]]
    assert quadratic.tolist() == [[0, 0], [2, 2], [4, 2], [6, 0]]


def test_arcs_that_all_but_touch_far_from_the_origin_are_no_error():
    """Where the sum of row and column has no digits left to tell them apart."""
    none = np.zeros(0, np.int32)
    planar = PlanarMap(
        starts=np.arange(0, 9, 2), crossings=none, tail=none, head=none, left=np.array([1, 3, 2, 0]),
        right=np.array([0, 2, 1, 3]), junctions=none, face_labels=np.arange(4),
        face_areas=np.full(4, 10), pixel_faces=np.zeros((700, 2400), np.int32))
    # Cells are half pixels, sampled in their middles.
    x = np.array([0.0, 664.25 + 1.2e-13, 664.25, 2400.0])
    assert x[1] > x[2] and 1299 * 9600 + 2 * x[1] == 1299 * 9600 + 2 * x[2]
    points = np.stack([np.repeat(x, 2), np.tile([0.0, 700.0], 4)], axis=1)
    ranks = RankMap(np.arange(0, 9, 2), points, planar, np.array([-1, 1, 2, 3]))
    seen = ranks.lowest(np.array([[600, 650], [700, 650]]), 0)
    assert seen[0] == 1 and seen[1] in (2, 3)
