# SPDX-License-Identifier: GPL-2.0-or-later
"""Corners: found where polygons have them, to a fraction of a pixel, and nowhere on round shapes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from meshes import exact_labels
from pictures import (
    BLACK,
    WHITE,
    Picture,
    any_picture,
    apart,
    disc,
    half_plane,
    picture,
    placed,
    rectangle,
    star,
    turned,
)

from ddtcore.arclength import Arclength
from ddtcore.corner import find_corners

CENTRE = (24.3, 23.8)


def corners_of(polygon, angle=30.0, colours=(WHITE, BLACK)):
    drawn = placed(picture(48, 48, [polygon], colours))
    along = Arclength(drawn.lines, drawn.planar.rings)
    return find_corners(drawn.planar, drawn.lines, along, angle)


def assert_corners_at(polygon, within=0.2, **settings):
    found = corners_of(polygon, **settings).point
    distance = apart(found, polygon)
    assert len(found) == len(polygon)
    assert distance.min(axis=0).max() < within
    assert sorted(distance.argmin(axis=1).tolist()) == list(range(len(polygon)))


@pytest.mark.parametrize("degrees", range(0, 45, 5))
def test_the_four_corners_of_squares(degrees):
    assert_corners_at(rectangle(CENTRE, 20, 20, degrees))


@pytest.mark.parametrize("degrees", range(0, 120, 13))
def test_the_three_corners_of_triangles(degrees):
    assert_corners_at(star(CENTRE, 19, 9.5, 3, degrees)[::2])


@pytest.mark.parametrize("degrees", range(0, 72, 9))
def test_the_tips_and_nooks_of_stars(degrees):
    # In a nook the two sides' points overlap; the polish settles where exactly it is.
    assert_corners_at(star(CENTRE, 21, 12, 5, degrees), within=0.7)


@pytest.mark.parametrize("degrees", range(0, 45, 7))
def test_blunt_corners_count_as_the_setting_says(degrees):
    octagon = star(CENTRE, 19, 19, 4, degrees)
    assert_corners_at(octagon, within=0.25, angle=30)
    assert len(corners_of(octagon, angle=60).arc) == 0


def test_light_and_dark_may_change_places():
    polygon = rectangle(CENTRE, 20, 20, 25)
    assert_corners_at(polygon, colours=(BLACK, WHITE))


@pytest.mark.parametrize("radius", [8, 12, 20])
@pytest.mark.parametrize("centre", [(24, 24), (24.3, 23.8), (23.5, 24.5), (24.15, 23.95)])
def test_circles_have_no_corners(radius, centre):
    assert len(corners_of(disc(centre, radius)).arc) == 0


def test_ellipses_have_no_corners():
    angle = np.arange(720) * np.pi / 360
    ellipse = np.stack([20 * np.cos(angle), 11 * np.sin(angle)], axis=1)
    for degrees in (0, 20, 45):
        assert len(corners_of(turned(ellipse, degrees, CENTRE)).arc) == 0


def test_straight_lines_have_no_corners():
    for degrees in range(0, 180, 15):
        assert len(corners_of(half_plane(CENTRE, degrees)).arc) == 0


@given(any_picture())
def test_corners_of_any_picture_are_in_order_and_on_their_arcs(image):
    drawn = placed(Picture(image, exact_labels(image)))
    along = Arclength(drawn.lines, drawn.planar.rings)
    found = find_corners(drawn.planar, drawn.lines, along, 30.0)
    assert np.isfinite(found.point).all()
    assert (drawn.planar.left[found.arc] != 0).all()
    assert (np.diff(found.arc) >= 0).all()
    assert (np.diff(found.length)[np.diff(found.arc) == 0] >= 0).all()


def walked(points, length, ring):
    """The point at a distance along a polyline, step by step."""
    ends = np.concatenate([points, points[:1]]) if ring else points
    sizes = np.hypot(*np.diff(ends, axis=0).T)
    if not len(sizes):
        return points[0]
    length = length % sizes.sum() if ring else min(max(length, 0), sizes.sum())
    for begin, end, size in zip(ends, ends[1:], sizes):
        if length <= size:
            return begin + (end - begin) * length / size
        length -= size
    return ends[-1]


def test_arclength_walks_rings_round_and_open_arcs_to_their_ends():
    drawn = placed(picture(48, 48, [disc((14, 15), 8), half_plane((0, 33.3), 12)]))
    along = Arclength(drawn.lines, drawn.planar.rings)
    assert drawn.planar.rings.any() and not drawn.planar.rings.all()
    for arc, ring in enumerate(drawn.planar.rings):
        points = drawn.arc(arc)
        ends = np.concatenate([points, points[:1]]) if ring else points
        assert along.total[arc] == pytest.approx(np.hypot(*np.diff(ends, axis=0).T).sum())
        for length in np.linspace(-3, along.total[arc] + 3, 40):
            assert np.allclose(along.at(np.array([arc]), np.array([length])), walked(points, length, ring))
        part = along.at_point[drawn.lines.starts[arc]:drawn.lines.starts[arc + 1]]
        assert np.allclose(along.at(np.full(len(points), arc), part), points)
