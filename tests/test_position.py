# SPDX-License-Identifier: GPL-2.0-or-later
"""Positions of outlines against known geometry, to hundredths of a pixel."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
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
)

from ddtcore import position
from ddtcore.options import TraceOptions
from ddtcore.position import premultiplied

BARYCENTRES = TraceOptions(positions="barycentres")
ANGLES = np.arange(0, 180, 7.5)
CENTRE = np.array([24.3, 23.8])


def clear_of_border(points, size=48, margin=5):
    return points[((points > margin) & (points < size - margin)).all(axis=1)]


def line_errors(degrees, centre=CENTRE, colours=(WHITE, BLACK)):
    """Signed distances from a true line of the points along it, positive on the side of the paper."""
    line = half_plane(centre, degrees)
    drawn = placed(picture(48, 48, [line], colours))
    return away(clear_of_border(drawn.arc(drawn.inner()[0])), line)


@pytest.mark.parametrize("colours", [(WHITE, BLACK), (BLACK, WHITE), (RED, BLUE)])
def test_lines_lie_where_they_are(colours):
    errors = [line_errors(degrees, colours=colours) for degrees in ANGLES]
    assert min(map(len, errors)) > 25
    assert max(np.sqrt((e ** 2).mean()) for e in errors) < 0.012
    assert np.sqrt((np.concatenate(errors) ** 2).mean()) < 0.01
    # A shift to one side, however small, is worse than noise.
    assert abs(np.concatenate(errors).mean()) < 0.001
    assert max(np.abs(e).max() for e in errors) < 0.05


@pytest.mark.parametrize("degrees", [0, 90])
@pytest.mark.parametrize("offset", [0.0, 0.1, 0.25, 0.5, 0.75, 0.9])
def test_upright_and_level_lines_are_exact(degrees, offset):
    errors = line_errors(degrees, np.array([24.0, 24.0]) + offset)
    assert np.abs(errors).max() < 1 / 255


@pytest.mark.parametrize("radius", [5, 9, 20])
@pytest.mark.parametrize("centre", [(24, 24), (24.3, 23.8), (23.5, 24.5)])
def test_circles_lie_where_they_are(radius, centre):
    drawn = placed(picture(48, 48, [disc(centre, radius)]))
    arc, = drawn.inner()
    points = drawn.arc(arc)
    error = np.hypot(*(points - centre).T) - radius
    # Sums across a curve end 1 / 24 of its curvature too far inside; up to twice that with their slope.
    assert np.sqrt((error ** 2).mean()) < 0.005 + 0.06 / radius
    assert -2.5 / (24 * radius) < error.mean() < 0.001
    angle = np.arctan2(*(points - centre).T)
    moved = np.linalg.lstsq(np.stack([np.sin(angle), np.cos(angle)], axis=1), error, rcond=None)[0]
    assert np.abs(moved).max() < 0.01


def test_a_picture_upside_down_or_sideways_has_the_same_points_so():
    drawn = picture(48, 48, [disc((22.3, 25.1), 13.4)])
    arc, = placed(drawn).inner()
    points = placed(drawn).arc(arc)
    for turn, back in ((np.fliplr, lambda p: p * [-1, 1] + [48, 0]),
                       (np.flipud, lambda p: p * [1, -1] + [0, 48]),
                       (lambda a: np.swapaxes(a, 0, 1), lambda p: p[:, ::-1])):
        labels = drawn.labels
        other = Picture(np.ascontiguousarray(turn(drawn.image)),
                        type(labels)(turn(labels.index), labels.palette, turn(labels.thin)))
        found = back(placed(other).arc(arc))
        nearest = apart(found, points).min(axis=1)
        # A few columns of the octants' ends are summed in one picture and not in the other.
        assert (nearest < 0.003).mean() > 0.9
        assert nearest.max() < 1


def test_barycentres_lie_in_their_triangles():
    drawn = placed(picture(40, 40, [disc((18.2, 21.4), 9), rectangle((33, 8), 20, 11)]), BARYCENTRES)
    planar, mesh = drawn.planar, drawn.mesh
    for arc in drawn.inner():
        walk = planar.crossings[planar.starts[arc]:planar.starts[arc + 1]] // 3
        if not planar.rings[arc]:
            walk = np.concatenate([planar.junctions[planar.tail[arc]], walk], axis=None)
        corners = mesh.points(mesh.triangles[walk])
        framed = ((corners < 0) | (corners > 40)).any(axis=(1, 2))
        assert np.allclose(drawn.arc(arc)[~framed], corners.mean(axis=1)[~framed])
        assert (drawn.arc(arc)[framed] * (40 - drawn.arc(arc)[framed]) == 0).any(axis=1).all()


def assert_polylines_fit_map(drawn, width, height):
    planar, lines = drawn.planar, drawn.lines
    assert lines.starts[0] == 0 and lines.starts[-1] == len(lines.points) == len(lines.weight)
    assert len(lines.starts) == len(planar.tail) + 1
    assert np.isfinite(lines.points).all()
    assert (lines.points >= 0).all() and (lines.points <= [width, height]).all()
    assert (lines.weight > 0).all() and (lines.weight <= 1).all()
    for arc in np.flatnonzero(planar.rings):
        points = drawn.arc(arc)
        assert len(points) > 2 and not np.array_equal(points[0], points[-1])
    # The arcs that meet in a junction begin or end with the very same point.
    place = {}
    for arc in np.flatnonzero(~planar.rings):
        for junction, point in zip((planar.tail[arc], planar.head[arc]), drawn.arc(arc)[[0, -1]]):
            assert place.setdefault(junction, tuple(point)) == tuple(point)
    assert len(place) == len(planar.junctions)


def assert_border_is_exact(drawn, width, height):
    """The arcs beside the outside run clockwise round the picture's rectangle, once."""
    outer = np.flatnonzero(drawn.planar.left == 0)
    area, length, corners = 0.0, 0.0, []
    for arc in outer:
        points = drawn.arc(arc)
        assert (points * ([width, height] - points) == 0).any(axis=1).all()
        ahead = np.roll(points, -1, axis=0) if drawn.planar.rings[arc] else points[1:]
        begin = points[:len(ahead)]
        area += (begin[:, 0] * ahead[:, 1] - begin[:, 1] * ahead[:, 0]).sum() / 2
        length += np.hypot(*(ahead - begin).T).sum()
        corners += [tuple(p) for p in points if p[0] in (0, width) and p[1] in (0, height)]
    assert area == pytest.approx(width * height) and length == pytest.approx(2 * (width + height))
    assert {(0, 0), (width, 0), (width, height), (0, height)} <= set(corners)


@given(any_picture())
@pytest.mark.parametrize("options", [TraceOptions(), BARYCENTRES], ids=lambda o: o.positions)
def test_any_picture_gets_sound_polylines(options, image):
    height, width = image.shape[:2]
    drawn = placed(Picture(image, exact_labels(image)), options)
    assert_polylines_fit_map(drawn, width, height)
    assert_border_is_exact(drawn, width, height)


@pytest.mark.parametrize("radius", [5, 9, 15, 20])
def test_rings_do_not_repeat_their_first_point(radius):
    assert_polylines_fit_map(placed(picture(48, 48, [disc(CENTRE, radius)])), 48, 48)


@pytest.mark.parametrize("degrees", [10, 55, 100, 145])
def test_outlines_end_on_the_border_of_the_picture(degrees):
    line = half_plane(CENTRE, degrees)
    drawn = placed(picture(48, 48, [line]))
    arc, = drawn.inner()
    ends = drawn.arc(arc)[[0, -1]]
    assert ((ends == 0) | (ends == 48)).any(axis=1).all()
    assert np.abs(away(ends, line)).max() < 0.75


def test_a_third_colour_nearby_makes_positions_doubtful():
    """Between two outlines less than a pixel apart no column has a flat side."""
    bar = rectangle(CENTRE, 60, 0.8, 10)
    drawn = placed(picture(48, 48, [bar]))
    weight = np.concatenate([drawn.lines.weight[drawn.lines.starts[a]:drawn.lines.starts[a + 1]]
                             for a in drawn.inner()])
    assert (weight < 1).mean() > 0.5


def test_premultiplied_colours():
    colours = premultiplied(np.array([[200, 100, 0, 255], [200, 100, 0, 51], [9, 9, 9, 0]], np.uint8))
    assert colours.dtype == np.float32
    assert np.allclose(colours, [[200, 100, 0, 255], [40, 20, 0, 51], [0, 0, 0, 0]])


@pytest.mark.parametrize("gap", [1, 3])
def test_doubtful_crossings_go_only_between_sure_ones_of_their_arc(gap):
    rng = np.random.RandomState(gap)
    arc, sure = np.sort(rng.randint(0, 12, 300)), rng.rand(300) < 0.4
    kept = position._needed(arc, sure, np.full(300, gap))
    for number in range(12):
        own = np.flatnonzero(arc == number)
        places = own[sure[own]]
        dropped = {k for a, b in zip(places, places[1:]) if b - a <= gap + 1 for k in range(a + 1, b)}
        assert set(own[~kept[own]].tolist()) == dropped
