# SPDX-License-Identifier: GPL-2.0-or-later
"""Fitted curves: within the tolerance of every point, few, joined exactly, and true to known shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from meshes import exact_labels
from pictures import (
    BLACK,
    BLUE,
    RED,
    WHITE,
    Picture,
    any_picture,
    apart,
    away,
    disc,
    half_plane,
    picture,
    placed,
    rectangle,
    star,
    turned,
)

from ddtcore import bezier
from ddtcore.arclength import Arclength
from ddtcore.corner import find_corners
from ddtcore.fit import fit_arcs
from ddtcore.model import CUBIC, LINE, Gradient
from ddtcore.options import TraceOptions
from ddtcore.runs import cut_at_knots
from ddtcore.segments import fit_runs

CENTRE = (24.3, 23.8)


def fitted(drawn: Picture, **changes):
    options = TraceOptions(**changes)
    outlines = placed(drawn, options)
    return outlines, fit_arcs(drawn.image, drawn.labels, outlines.planar, outlines.lines, options)


def part(curves, arc):
    which = slice(curves.starts[arc], curves.starts[arc + 1])
    return curves.control[which], curves.degree[which]


def along(control, count=100):
    """Points on segments, one after the other."""
    t = np.tile(np.linspace(0, 1, count), len(control))
    return bezier.evaluate(control, np.repeat(np.arange(len(control)), count), t)


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


def shape(polygon, **changes):
    """Control points and degrees of the one outline of a shape."""
    outlines, curves = fitted(picture(48, 48, [polygon]), **changes)
    arc, = outlines.inner()
    return part(curves, arc)


def run_distances(runs, segments):
    """Distance of each segment from the farthest of the points it replaces, by dense sampling."""
    far = []
    for k in range(len(segments.run)):
        points = runs.points[segments.first[k]:segments.last[k]]
        curve = along(segments.fit.control[k:k + 1], 1000)
        far.append(apart(points, curve).min(axis=1).max() if len(points) else 0)
    return np.array(far)


ART = picture(60, 48, [star((16.3, 15.2), 13, 7.5, 5, 8), disc((41.6, 17.1), 11.4),
                       turned([(-20, -4), (20, -6), (22, 5), (-18, 3)], -9, (30, 37))])


@pytest.mark.parametrize("tolerance", [0.05, 0.2, 1.0])
def test_no_point_is_farther_from_its_segment_than_the_tolerance(tolerance):
    outlines = placed(ART)
    length = Arclength(outlines.lines, outlines.planar.rings)
    corners = find_corners(outlines.planar, outlines.lines, length, 30.0)
    runs = cut_at_knots(outlines.planar, outlines.lines, length, corners, (60.0, 48.0))
    segments = fit_runs(runs, np.full(len(runs.arc), tolerance))
    distance = run_distances(runs, segments)
    assert distance.max() <= tolerance
    # Each point of each run belongs to one segment; cuts between segments are nodes at points.
    for run in range(len(runs.arc)):
        mine = np.flatnonzero(segments.run == run)
        assert segments.first[mine[0]] == runs.first[run] and segments.last[mine[-1]] == runs.last[run]
        assert (segments.first[mine[1:]] - segments.last[mine[:-1]] == 1).all()
        control = segments.fit.control[mine]
        assert np.allclose(control[1:, 0], control[:-1, 3], rtol=0, atol=1e-9)


def test_a_larger_tolerance_needs_fewer_segments():
    counts = [len(fitted(ART, tolerance=tolerance)[1].degree) for tolerance in (0.05, 0.2, 1.0)]
    assert counts[0] > counts[1] >= counts[2]


@given(any_picture())
@settings(max_examples=30)
@pytest.mark.parametrize("changes", [{}, {"curves": "quadratic", "suppression": 1}, {"result": "outlines"}],
                         ids=["cubic", "quadratic", "outlines"])
def test_segments_of_any_picture_join_exactly(changes, image):
    drawn = Picture(image, exact_labels(image))
    outlines, curves = fitted(drawn, **changes)
    size = np.array([image.shape[1], image.shape[0]])
    assert len(curves.starts) == len(outlines.planar.tail) + 1
    assert np.isfinite(curves.control).all()
    junctions = {}
    for arc, ring in enumerate(outlines.planar.rings):
        control, degree = part(curves, arc)
        assert len(control)
        assert np.array_equal(control[1:, 0], control[:-1, 3])
        begin, end = control[0, 0], control[-1, 3]
        if ring:
            assert np.array_equal(begin, end)
        else:
            for junction, point in ((outlines.planar.tail[arc], begin), (outlines.planar.head[arc], end)):
                assert junctions.setdefault(junction, tuple(point)) == tuple(point)
        if outlines.planar.left[arc] == 0:
            # The border of the picture is its rectangle, to the last digit.
            assert (degree == LINE).all()
            assert ((control[:, [0, 3]] == 0) | (control[:, [0, 3]] == size)).any(axis=2).all()
    assert len(junctions) == len(outlines.planar.junctions)


def test_a_circle_needs_few_segments_and_looks_like_one():
    outlines, curves = fitted(picture(100, 100, [disc((50.3, 49.8), 40)]))
    control, degree = part(curves, outlines.inner()[0])
    assert len(control) <= 8 and (degree == CUBIC).all()
    error = np.hypot(*(along(control) - [50.3, 49.8]).T) - 40
    assert np.abs(error).max() < 0.2
    assert rms(error) < 0.05
    arriving = np.roll(control[:, 3] - control[:, 2], 1, axis=0)
    leaving = control[:, 1] - control[:, 0]
    cross = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    assert np.degrees(np.abs(cross) / np.hypot(*arriving.T) / np.hypot(*leaving.T)).max() < 0.5


@pytest.mark.parametrize("radius", [6, 10, 15, 20])
@pytest.mark.parametrize("centre", [(24, 24), (24.3, 23.8)])
def test_small_circles_too(radius, centre):
    control, _ = shape(disc(centre, radius))
    error = np.hypot(*(along(control) - centre).T) - radius
    assert len(control) <= 8
    assert np.abs(error).max() < 0.2
    assert abs(error.mean()) < 0.02


@pytest.mark.parametrize("radius", [19.2, 22, 25])
@pytest.mark.parametrize("centre", [(30.3, 31.2), (31.2, 29.7), (29.5, 30.5)])
def test_a_circle_is_parted_evenly(radius, centre):
    """However it lies on the grid: parts of different length would differ in how well they fit."""
    outlines, curves = fitted(picture(60, 62, [disc(centre, radius)]))
    control = part(curves, outlines.inner()[0])[0]
    start, end = (np.arctan2(*(control[:, k] - centre).T) for k in (0, 3))
    turn = np.degrees(np.abs(np.angle(np.exp(1j * (end - start)))))
    assert turn.max() < 1.4 * turn.min()
    assert rms(apart(along(control), np.array([centre])).ravel() - radius) < 0.006


@pytest.mark.parametrize("degrees", range(5, 45, 5))
def test_squares_are_four_lines(degrees):
    polygon = rectangle(CENTRE, 20, 20, degrees)
    control, degree = shape(polygon)
    assert len(control) == 4 and (degree == LINE).all()
    assert np.abs(away(along(control), polygon)).max() < 0.02
    assert apart(control[:, 0], polygon).min(axis=0).max() < 0.05


@pytest.mark.parametrize("offset", [0.0, 0.2, 0.5, 0.8])
def test_upright_rectangles_stay_upright(offset):
    polygon = rectangle((24 + offset, 24 + offset), 21, 15)
    control, _ = shape(polygon)
    assert np.abs(away(along(control), polygon)).max() < 0.2
    assert rms(away(along(control), polygon)) < 0.03


@pytest.mark.parametrize("degrees", range(0, 120, 13))
def test_triangles_keep_their_tips(degrees):
    polygon = star(CENTRE, 19, 9.5, 3, degrees)[::2]
    control, _ = shape(polygon)
    points = along(control)
    assert rms(away(points, polygon)) < 0.1
    assert apart(points, polygon).min(axis=0).max() < 0.5


@pytest.mark.parametrize("degrees", [0, 7.5, 30, 45, 82.5, 90, 135])
def test_a_straight_edge_is_one_line(degrees):
    line = half_plane(CENTRE, degrees)
    control, degree = shape(line)
    assert degree.tolist() == [LINE]
    middle = along(control)[20:80]
    assert np.abs(away(middle, line)).max() < 0.02


def test_boundaries_are_fitted_once_for_both_sides():
    """A disc of two halves: three arcs, and all of them begin and end in the same two points."""
    upper = np.concatenate([disc((24.3, 23.8), 14)[360:], disc((24.3, 23.8), 14)[:1]])
    lower = disc((24.3, 23.8), 14)[:361]
    outlines, curves = fitted(picture(48, 48, [upper, lower], (WHITE, RED, BLUE)))
    assert len(outlines.inner()) == 3 and len(outlines.planar.junctions) == 2
    ends = np.concatenate([part(curves, arc)[0][[0, -1], [0, 3]] for arc in outlines.inner()])
    assert len(np.unique(ends, axis=0)) == 2
    truth = np.array([(10.3, 23.8), (38.3, 23.8)])
    assert apart(ends, truth).min(axis=1).max() < 0.1


def test_curves_of_inverted_colours_are_the_same():
    polygon = star(CENTRE, 21, 12, 5, 8)
    one, other = (fitted(picture(48, 48, [polygon], colours)) for colours in ((WHITE, BLACK), (BLACK, WHITE)))
    first, second = (along(part(curves, outlines.inner()[0])[0]) for outlines, curves in (one, other))
    assert apart(first, second).min(axis=1).max() < 0.25


def test_outlines_as_they_are():
    outlines, curves = fitted(ART, result="outlines")
    assert (curves.degree == LINE).all()
    for arc in range(len(outlines.planar.tail)):
        assert set(map(tuple, part(curves, arc)[0][:, 0])) <= set(map(tuple, outlines.arc(arc)))


@pytest.mark.parametrize("mean", [5, 250])
def test_edges_on_ramps_are_fitted_by_how_they_differ_where_they_lie(mean):
    angle = np.arange(720) * np.pi / 360
    radius = 15 + 0.7 * np.sin(6 * angle)
    waves = np.asarray(CENTRE) + radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    drawn = picture(48, 48, [waves], (BLACK, WHITE))
    outlines = placed(drawn, TraceOptions())

    def segments(level):
        """How many there are round a ramp that has this level at its border, and some mean."""
        stops = ((0.0, (level,) * 3, 1.0), (1.0, (level,) * 3, 1.0))
        labels = replace(drawn.labels, palette=np.array([BLACK, (mean, mean, mean, 255)], float),
                         gradients=(None, Gradient("linear", (0.0, 0.0), (1.0, 0.0), stops)))
        return len(fit_arcs(drawn.image, labels, outlines.planar, outlines.lines, TraceOptions()).degree)

    assert segments(4) < segments(250) - 4
