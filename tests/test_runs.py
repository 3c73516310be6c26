# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs between knots: complete, in order, clear of the pixels that see more than two sides."""

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
    turned,
)

from ddtcore.arclength import Arclength
from ddtcore.corner import find_corners
from ddtcore.runs import CLEAR, cut_at_knots, end_lines


def cut(drawn: Picture):
    outlines = placed(drawn)
    height, width = drawn.image.shape[:2]
    along = Arclength(outlines.lines, outlines.planar.rings)
    corners = find_corners(outlines.planar, outlines.lines, along, 30.0)
    runs = cut_at_knots(outlines.planar, outlines.lines, along, corners, (float(width), float(height)))
    return outlines, corners, runs


def used(runs, run):
    return runs.points[runs.first[run]:runs.last[run]]


def sectors(centre, first, second, third):
    """Three regions that meet at a point, divided by rays at these angles in degrees."""
    def ray(degrees):
        return np.asarray(centre) + 200 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])

    def wedge(begin, end):
        return np.array([centre] + [ray(degrees) for degrees in np.linspace(begin, end, 9)])

    return [wedge(first, second), wedge(second, third)]


@given(any_picture())
def test_the_runs_of_any_picture_are_chains_from_knot_to_knot(image):
    outlines, _, runs = cut(Picture(image, exact_labels(image)))
    planar = outlines.planar
    assert (np.diff(runs.arc) >= 0).all()
    assert np.array_equal(np.unique(runs.arc), np.arange(len(planar.tail)))
    assert runs.knots.min() >= 0 and runs.knots.max() < len(runs.places)
    assert np.isfinite(runs.places).all()
    for arc, ring in enumerate(planar.rings):
        knots = runs.knots[runs.arc == arc]
        assert np.array_equal(knots[1:, 0], knots[:-1, 1])
        inner = knots[1:, 0]
        assert (inner >= len(planar.junctions)).all()
        if ring:
            assert knots[0, 0] == knots[-1, 1] >= len(planar.junctions)
        else:
            assert (knots[0, 0], knots[-1, 1]) == (planar.tail[arc], planar.head[arc])
    shared = np.bincount(runs.knots.ravel(), minlength=len(runs.places))
    assert (shared[:len(planar.junctions)] == 3).all() and (shared[len(planar.junctions):] == 2).all()


@given(any_picture())
def test_runs_are_made_of_points_of_their_arcs_each_used_once(image):
    outlines, _, runs = cut(Picture(image, exact_labels(image)))
    for arc in range(len(outlines.planar.tail)):
        points = list(map(tuple, outlines.arc(arc)))
        taken = [tuple(p) for run in np.flatnonzero(runs.arc == arc) for p in used(runs, run)]
        assert set(taken) <= set(points)
        assert len(taken) <= len(points)
    bounds = np.stack([runs.low, runs.first, runs.last, runs.high])
    assert (np.diff(bounds, axis=0) >= 0).all()


def test_rings_without_corners_are_one_run_of_all_points_but_their_knot():
    outlines, corners, runs = cut(picture(48, 48, [disc((24.3, 23.8), 15)]))
    arc, = outlines.inner()
    run, = np.flatnonzero(runs.arc == arc)
    assert runs.smooth[run] and len(corners.arc) == 0
    knot = tuple(runs.places[runs.knots[run, 0]])
    assert {knot, *map(tuple, used(runs, run))} == set(map(tuple, outlines.arc(arc)))
    assert runs.knots[run, 0] == runs.knots[run, 1]
    assert not runs.smooth[runs.arc != arc].any()


def test_the_corners_of_the_picture_are_knots():
    outlines, _, runs = cut(picture(30, 20, [disc((14, 9), 6)]))
    border, = np.flatnonzero(outlines.planar.left == 0)
    places = runs.places[runs.knots[runs.arc == border, 0]]
    assert places.tolist() == [[0, 0], [30, 0], [30, 20], [0, 20]]


def test_points_beside_corners_are_left_out_and_all_others_kept():
    square = rectangle((24.3, 23.8), 22, 22, 20)
    outlines, corners, runs = cut(picture(48, 48, [square]))
    arc, = outlines.inner()
    mine = np.flatnonzero(runs.arc == arc)
    assert len(mine) == len(corners.arc) == 4
    kept = np.concatenate([used(runs, run) for run in mine])
    assert apart(kept, square).min() > 0.5
    clear = outlines.arc(arc)
    clear = clear[apart(clear, square).min(axis=1) > 2 * CLEAR]
    assert set(map(tuple, clear)) <= set(map(tuple, kept))
    # One side each: the points of a run stay on one side of the square.
    for run in mine:
        points = used(runs, run)
        across = np.linalg.svd(points - points.mean(axis=0))[1][1]
        assert across / np.sqrt(len(points)) < 0.02


@pytest.mark.parametrize("rays", [(0, 120, 240), (10, 100, 225), (35, 180, 300), (80, 200, 310)])
@pytest.mark.parametrize("centre", [(24, 24), (24.3, 23.8), (23.6, 24.45)])
def test_junctions_lie_where_three_regions_meet(rays, centre):
    outlines, _, runs = cut(picture(48, 48, sectors(centre, *rays), (WHITE, RED, BLUE)))
    places = runs.places[:len(outlines.planar.junctions)]
    inside = places[((places > 1) & (places < 47)).all(axis=1)]
    assert len(inside) == 1
    assert np.hypot(*(inside[0] - centre)) < 0.1


def test_t_junctions_too():
    """A bar that ends on a straight edge."""
    bar = turned([(0, -4), (60, -4), (60, 4), (0, 4)], 10, (20.2, 24.4))
    left = half_plane((20.2, 24.4), 100)
    outlines, _, runs = cut(picture(48, 48, [left, bar], (WHITE, BLACK, RED)))
    places = runs.places[:len(outlines.planar.junctions)]
    inside = places[((places > 1) & (places < 47)).all(axis=1)]
    distance = apart(inside, bar[[0, 3]]).min(axis=0)
    assert len(inside) == 2 and distance.max() < 0.1


@given(any_picture())
def test_junctions_on_the_border_stay_where_they_are(image):
    outlines, _, runs = cut(Picture(image, exact_labels(image)))
    size = np.array([image.shape[1], image.shape[0]], float)
    raw = np.zeros((len(outlines.planar.junctions), 2))
    for arc in np.flatnonzero(~outlines.planar.rings):
        raw[outlines.planar.tail[arc]], raw[outlines.planar.head[arc]] = outlines.arc(arc)[[0, -1]]
    places = runs.places[:len(raw)]
    on_border = (raw == 0) | (raw == size)
    assert np.array_equal(places[on_border], raw[on_border])
    assert (places >= 0).all() and (places <= size).all()


def test_ends_of_runs_point_along_their_sides():
    square = rectangle((24.3, 23.8), 22, 22, 20)
    outlines, _, runs = cut(picture(48, 48, [square]))
    point, tangent, trust = end_lines(runs)
    assert np.allclose(np.hypot(*np.moveaxis(tangent, 2, 0)), 1)
    for run in np.flatnonzero(runs.arc == outlines.inner()[0]):
        assert (trust[run] == 1).all()
        assert np.abs(away(point[run], square)).max() < 0.05
        way = runs.places[runs.knots[run, 1]] - runs.places[runs.knots[run, 0]]
        way /= np.hypot(*way)
        assert tangent[run, 0] @ way > 0.999 and tangent[run, 1] @ way < -0.999
