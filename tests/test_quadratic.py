# SPDX-License-Identifier: GPL-2.0-or-later
"""The curves of the paper: outline points are control points, the points half-way lie on the curve."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meshes import exact_labels
from pictures import Picture, any_picture, placed

from ddtcore.model import LINE, QUADRATIC, PlanarMap, Polylines
from ddtcore.options import TraceOptions
from ddtcore.quadratic import fit_quadratics, polygons

PAPER = TraceOptions.preset("paper")


def outlines(image):
    return placed(Picture(image, exact_labels(image)), PAPER)


def segments(curves, arc):
    part = slice(curves.starts[arc], curves.starts[arc + 1])
    return curves.control[part], curves.degree[part]


def without_collinear(points, ring):
    """Points of an arc that bend, by exact arithmetic in sixths."""
    whole = [tuple(round(6 * v) for v in point) for point in points]
    kept = []
    for k, (x, y) in enumerate(whole):
        if not ring and k in (0, len(whole) - 1):
            kept.append(k)
            continue
        (x0, y0), (x1, y1) = whole[k - 1], whole[(k + 1) % len(whole)]
        if (x - x0) * (y1 - y) != (y - y0) * (x1 - x):
            kept.append(k)
    return points[kept]


@given(any_picture(), st.integers(0, 3))
def test_segments_join_and_close(image, suppression):
    drawn = outlines(image)
    for curves in (fit_quadratics(drawn.planar, drawn.lines, suppression),
                   polygons(drawn.planar, drawn.lines)):
        assert curves.starts[0] == 0 and curves.starts[-1] == len(curves.control) == len(curves.degree)
        for arc, ring in enumerate(drawn.planar.rings):
            control, degree = segments(curves, arc)
            assert len(control) and set(degree.tolist()) <= {LINE, QUADRATIC}
            assert np.array_equal(control[1:, 0], control[:-1, 3])
            points = drawn.arc(arc)
            if ring:
                assert np.array_equal(control[0, 0], control[-1, 3])
            else:
                assert np.array_equal(control[[0, -1], [0, 3]], points[[0, -1]])


@given(any_picture())
def test_all_points_that_bend_are_control_points_in_their_order(image):
    drawn = outlines(image)
    curves = fit_quadratics(drawn.planar, drawn.lines, 0)
    for arc in drawn.inner():
        ring = bool(drawn.planar.rings[arc])
        points = without_collinear(drawn.arc(arc), ring)
        control, degree = segments(curves, arc)
        if degree[0] == LINE:
            assert len(points) == 2 and np.array_equal(control[0, [0, 3]], points)
            continue
        assert np.array_equal(control[:, 1], points if ring else points[1:-1])
        assert np.array_equal(control[:, 1], control[:, 2]) and (degree == QUADRATIC).all()


@given(any_picture(), st.integers(0, 3))
def test_joints_lie_half_way_between_control_points(image, suppression):
    """Then the reflection of one control point in the joint is the next: T alone says it all."""
    drawn = outlines(image)
    curves = fit_quadratics(drawn.planar, drawn.lines, suppression)
    for arc in drawn.inner():
        control, degree = segments(curves, arc)
        if degree[0] == QUADRATIC:
            assert np.array_equal(control[:-1, 3], (control[:-1, 1] + control[1:, 1]) / 2)
            assert np.allclose(2 * control[:-1, 3] - control[:-1, 1], control[1:, 1], rtol=0, atol=1e-9)
            if drawn.planar.rings[arc]:
                assert np.array_equal(control[-1, 3], (control[-1, 1] + control[0, 1]) / 2)


@given(any_picture(), st.integers(1, 4))
def test_suppression_keeps_one_in_so_many_but_never_less_than_an_area(image, suppression):
    drawn = outlines(image)
    curves = fit_quadratics(drawn.planar, drawn.lines, suppression)
    for arc in drawn.inner():
        ring = bool(drawn.planar.rings[arc])
        kept = without_collinear(drawn.arc(arc), ring)
        control, degree = segments(curves, arc)
        used = control[:, 1] if degree[0] == QUADRATIC else control[:0, 1]
        among = [np.flatnonzero((kept == point).all(axis=1)) for point in used]
        assert all(len(found) for found in among)
        if ring:
            fewest = -(-len(kept) // (suppression + 1))
            assert len(used) == (fewest if fewest >= 3 else len(kept))
        else:
            assert len(used) in (max(len(kept) - 2, 0) // (suppression + 1),
                                 -(-max(len(kept) - 2, 0) // (suppression + 1)))


def one_arc(points, ring):
    """A map of nothing but one arc between two regions."""
    end, none = np.array([-1 if ring else 0], np.int32), np.zeros(0, np.int32)
    planar = PlanarMap(np.zeros(2, int), none, end, end, np.array([1]), np.array([2]), none,
                       np.zeros(3, np.int32), np.ones(3, int), np.zeros((1, 1), np.int32))
    points = np.array(points, float) / 3
    return planar, Polylines(np.array([0, len(points)]), points, np.ones(len(points)), np.zeros(1))


@pytest.mark.parametrize("ring", [True, False])
def test_points_amid_straight_lines_are_left_out(ring):
    thirds = [(0, 0), (2, 0), (4, 0), (5, 0), (7, 1), (9, 2), (13, 4), (13, 7), (13, 8), (10, 8), (1, 8),
              (0, 8)]
    curves = fit_quadratics(*one_arc(thirds, ring), 0)
    bends = np.array([(0, 0), (5, 0), (13, 4), (13, 8), (0, 8)]) / 3
    assert np.array_equal(curves.control[:, 1], bends if ring else bends[1:-1])


def test_an_arc_of_two_points_is_a_line():
    curves = fit_quadratics(*one_arc([(3, 4), (9, 5)], False), 0)
    assert curves.degree.tolist() == [LINE]
    assert np.array_equal(curves.control[0, [0, 3]], np.array([(3, 4), (9, 5)]) / 3)


def test_the_border_of_the_picture_stays_straight():
    image = np.full((5, 7, 4), 255, np.uint8)
    image[2:, 3:] = [0, 0, 0, 255]
    drawn = outlines(image)
    curves = fit_quadratics(drawn.planar, drawn.lines, 1)
    for arc in np.flatnonzero(drawn.planar.left == 0):
        control, degree = segments(curves, arc)
        assert (degree == LINE).all()
        step = control[:, 3] - control[:, 0]
        assert ((step == 0).sum(axis=1) == 1).all()


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1)])
def test_small_pictures_are_rectangles(shape):
    drawn = outlines(np.full((*shape, 4), 255, np.uint8))
    curves = fit_quadratics(drawn.planar, drawn.lines, 1)
    assert curves.control[:, 0].tolist() == [[0, 0], [shape[1], 0], [shape[1], shape[0]], [0, shape[0]]]


def test_polygons_are_the_points_themselves():
    image = np.zeros((6, 6, 4), np.uint8)
    image[2:4, 2:5] = 255
    drawn = outlines(image)
    curves = polygons(drawn.planar, drawn.lines)
    for arc in range(len(drawn.planar.tail)):
        control, degree = segments(curves, arc)
        points = drawn.arc(arc)
        assert (degree == LINE).all()
        assert np.array_equal(control[:, 0], points if drawn.planar.rings[arc] else points[:-1])
