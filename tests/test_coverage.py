# SPDX-License-Identifier: GPL-2.0-or-later
"""Coverage of pixels: rectangles and half-planes exactly, all else against supersampling."""

from __future__ import annotations

import numpy as np
import pytest
from pictures import coverage, disc, rectangle, star, turned

from ddtcore.bezier import evaluate, from_line
from ddtcore.coverage import colours_along, cut_into_pixels, touched_pixels

SIZE = 24


def rendered(control, line, step=1.0, shape=(SIZE, SIZE)):
    """Touched pixels and their colours; what lies on the right of the segments has the colour `step`."""
    pieces = cut_into_pixels(control, line, shape)
    pixels, number = touched_pixels(pieces, shape[0] * shape[1])
    steps = np.broadcast_to(-np.atleast_1d(np.asarray(step, float)), (len(pieces.segment), np.size(step)))
    return pixels, colours_along(pieces, pixels, number, steps, shape[1])


def sides(points):
    """The sides of a polygon as control points of lines."""
    points = np.asarray(points, float)
    return from_line(points, np.roll(points, -1, axis=0))


def drawn(points, **settings):
    return rendered(sides(points), np.ones(len(points), bool), **settings)


def supersampled(points, times=32):
    """Share of the samples of each pixel inside a polygon, by the crossing rule."""
    at = (np.arange(SIZE * times) + 0.5) / times
    inside = np.zeros((len(at), len(at)), bool)
    for (x0, y0), (x1, y1) in zip(points, np.roll(points, -1, axis=0)):
        crossed = np.flatnonzero((y0 > at) != (y1 > at))
        inside[crossed] ^= at > (x0 + (at[crossed] - y0) * (x1 - x0) / (y1 - y0 or 1))[:, None]
    return inside.reshape(SIZE, times, SIZE, times).mean(axis=(1, 3))


def assert_agrees(pixels, colours, truth, slack=1e-9):
    assert np.abs(colours[:, 0] - truth.ravel()[pixels]).max() < slack
    rest = np.ones(truth.size, bool)
    rest[pixels] = False
    # What no outline touches is all inside or all outside.
    assert (np.abs(truth.ravel()[rest] - np.rint(truth.ravel()[rest])) < slack).all()


SHAPES = {
    "triangle": star((12.3, 11.6), 9, 9, 3, 10)[::2],
    "star": star((12.1, 12.4), 10, 4, 5, 7),
    "thin bar": rectangle((12.2, 11.7), 18, 0.6, 33),
    "speck within a pixel": rectangle((12.45, 11.55), 0.5, 0.4, 20),
    "comb": turned([(-9, -8), (9, -8), (9, 8), (5, 8), (5, -5), (0, -5), (0, 8), (-9, 8)], 4, (12.1, 11.8)),
    "disc": disc((12.2, 11.9), 8.3),
}


@pytest.mark.parametrize("name", SHAPES)
def test_polygons_agree_with_supersampling_and_an_independent_integral(name):
    pixels, colours = drawn(SHAPES[name])
    assert_agrees(pixels, colours, coverage(SHAPES[name], SIZE, SIZE))
    assert np.abs(colours[:, 0] - supersampled(SHAPES[name]).ravel()[pixels]).max() < 1 / 128


@pytest.mark.parametrize("x, y, width, height", [(3, 4, 7, 5), (3.25, 4.5, 7, 5.125), (2.9, 2.9, 0.2, 12),
                                                 (5.1, 6.2, 0.5, 0.3)])
def test_rectangles_are_exact(x, y, width, height):
    across = np.clip(np.arange(1, SIZE + 1) - x, 0, 1) - np.clip(np.arange(1, SIZE + 1) - x - width, 0, 1)
    down = np.clip(np.arange(1, SIZE + 1) - y, 0, 1) - np.clip(np.arange(1, SIZE + 1) - y - height, 0, 1)
    points = rectangle((x + width / 2, y + height / 2), width, height)
    assert_agrees(*drawn(points), np.outer(down, across))


@pytest.mark.parametrize("slope", [0, 0.3, 1, 2.5])
def test_the_column_sums_of_half_planes_are_exact(slope):
    """A column is covered up to where the line crosses its middle."""
    points = np.array([(0, 3.2), (SIZE, 3.2 + slope * SIZE), (SIZE, 200), (0, 200)])
    pixels, colours = drawn(points)
    row, col = np.divmod(pixels, SIZE)
    for middle in range(1, 7):
        rows, share = row[col == middle], colours[col == middle, 0]
        assert rows[-1] < SIZE - 1
        assert rows[-1] + 1 - share.sum() == pytest.approx(3.2 + slope * (middle + 0.5))


@pytest.mark.parametrize("dx, dy", [(-9, 0), (9, 0), (0, -9), (0, 9), (-8, -8), (8, 8)])
def test_shapes_that_reach_outside_are_cut_off_at_the_picture(dx, dy):
    points = star((12.1 + dx, 12.4 + dy), 10, 6, 5, 7)
    assert_agrees(*drawn(points), coverage(points, SIZE, SIZE))


def test_curves_cover_what_they_enclose():
    reach = 4 / 3 * (np.sqrt(2) - 1)
    quarter = np.array([(1, 0), (1, reach), (reach, 1), (0, 1)])
    control = np.stack([turned(8.3 * quarter, 90 * k, (12.2, 11.9)) for k in range(4)])
    # Chords may cut 0.01 px off, and such a cubic bulges out by 0.002 px.
    assert_agrees(*rendered(control, np.zeros(4, bool)), coverage(disc((12.2, 11.9), 8.3), SIZE, SIZE), 0.015)


@pytest.mark.parametrize("handles", [(0.05, 0.05), (0.9, 0.02), (1.2, 1.2), (0.0, 0.5)])
def test_curves_of_uneven_pace_are_cut_everywhere(handles):
    """Long handles make a curve fast at that end: bits of one step of the parameter are long there."""
    start, bend, end = np.array([(3.2, 4.1), (20.7, 5.3), (19.6, 20.4)])
    curve = np.array([start, start + handles[0] * (bend - start), end + handles[1] * (bend - end), end])
    control = np.concatenate([curve[None], from_line(end[None], start[None])])
    polygon = evaluate(curve[None], np.zeros(2000, int), np.linspace(0, 1, 2000))
    assert_agrees(*rendered(control, np.array([False, True])), coverage(polygon, SIZE, SIZE), 0.02)


def test_a_hole_is_what_runs_the_other_way_round():
    outer, inner = rectangle((12, 12), 18, 17), rectangle((12.3, 11.4), 9, 8, 15)
    control = np.concatenate([sides(outer), sides(inner[::-1])])
    truth = coverage(outer, SIZE, SIZE) - coverage(inner, SIZE, SIZE)
    assert_agrees(*rendered(control, np.ones(8, bool)), truth)


def test_colours_are_mixed_channel_by_channel():
    step = (200.0, -30.0, 0.0, 255.0)
    points = SHAPES["star"]
    _, colours = drawn(points, step=step)
    _, share = drawn(points)
    assert np.allclose(colours, share * step)


def test_pieces_are_parts_of_their_segments_within_their_pixels():
    control = sides(SHAPES["star"])
    pieces = cut_into_pixels(control, np.ones(len(control), bool), (SIZE, SIZE))
    start, end = control[:, 0], control[:, 3]
    moved = np.stack([np.bincount(pieces.segment, pieces.move[k]) for k in (0, 1)], axis=1)
    assert np.allclose(moved, end - start)
    middle = start[pieces.segment] + pieces.t[:, None] * (end - start)[pieces.segment]
    row, col = np.divmod(pieces.pixel, SIZE)
    for at, cell, move in ((middle[:, 0], col, pieces.move[0]), (middle[:, 1], row, pieces.move[1])):
        assert (at - np.abs(move) / 2 > cell - 1e-9).all() and (at + np.abs(move) / 2 < cell + 1 + 1e-9).all()
    assert np.allclose(pieces.inset, middle[:, 0] - col)
    assert (np.diff(pieces.segment) >= 0).all()


def test_pieces_of_any_curve_stay_within_their_columns():
    control = np.random.RandomState(5).uniform(2, SIZE - 2, (200, 4, 2))
    pieces = cut_into_pixels(control, np.zeros(200, bool), (SIZE, SIZE))
    reach = np.abs(pieces.move[0]) / 2
    assert (pieces.inset - reach > -1e-9).all() and (pieces.inset + reach < 1 + 1e-9).all()
    moved = np.stack([np.bincount(pieces.segment, pieces.move[k]) for k in (0, 1)], axis=1)
    assert np.allclose(moved, control[:, 3] - control[:, 0])


def test_a_line_through_corners_of_pixels_loses_nothing():
    pixels, colours = drawn([(2, 2), (20, 20), (2, 20)])
    truth = np.tril(np.ones((SIZE, SIZE)), -1) + np.eye(SIZE) / 2
    truth[:2] = truth[20:] = truth[:, :2] = 0
    assert_agrees(pixels, colours, truth)
