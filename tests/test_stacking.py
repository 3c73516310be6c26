# SPDX-License-Identifier: GPL-2.0-or-later
"""Shapes on top of each other show the label map: no seams, nothing hidden, nothing in the way."""

from __future__ import annotations

import functools
from dataclasses import replace

import hypothesis.extra.numpy as arrays
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from painted import colours_at, render, winding
from planar import palette_labels, planar_map

from ddtcore.model import Curves, Labels
from ddtcore.options import TraceOptions
from ddtcore.stacking import stack

ZOOMS = (1.0, 2.7, 4.0)


@functools.lru_cache(maxsize=None)
def known_map(shape, content):
    return planar_map(np.frombuffer(content, np.int64).reshape(shape))


def stacked(index, palette=None, **settings):
    """The labels and the drawing of a label array whose arcs are lines through mid-points."""
    index = np.asarray(index, np.int64)
    labels = palette_labels(index, palette)
    planar, lines, curves = known_map(index.shape, index.tobytes())
    image = np.zeros((*index.shape, 4), np.uint8)
    return labels, stack(image, labels, planar, lines, curves, TraceOptions(**settings))


def centres(shape, per_pixel=1):
    """Points amid pixels, or amid the cells of a finer grid, but not on the lines that arcs follow."""
    row, col = np.mgrid[:shape[0] * per_pixel, :shape[1] * per_pixel]
    return (np.stack([col, row], axis=-1).reshape(-1, 2) + 0.5) / per_pixel + [0.0013, 0.0007]


def true_colours(labels: Labels):
    """Premultiplied colours at the pixel centres."""
    colours = labels.palette[labels.index.ravel()].copy()
    colours[:, :3] *= colours[:, 3:] / 255
    return colours


def drawn(index, *conditions):
    """A copy of a label array with label k + 1 where condition k holds, later ones on top."""
    index = np.array(index)
    for label, condition in enumerate(conditions, 1):
        index[condition] = label
    return index


Y, X = np.mgrid[:40, :50] + 0.5
PAGE = np.zeros((40, 50), int)


def disc(x, y, radius):
    return np.hypot(X - x, Y - y) < radius


EYE = drawn(PAGE, disc(24, 20, 16), disc(24, 20, 12), disc(24, 20, 6))
EYE[EYE == 3] = 1
SITES = ((14, 12), (30, 9), (24, 22), (36, 24), (15, 29), (29, 33))
VORONOI = np.where(disc(24, 20, 18), 1 + np.argmin([np.hypot(X - x, Y - y) for x, y in SITES], axis=0), 0)

COUNTEREXAMPLES = {
    "black ring, white eye, black pupil": EYE,
    "thin net over its cells": drawn(PAGE, (X > 4) & (X < 44) & (Y > 4) & (Y < 36),
                                     (X > 4) & (X < 44) & (Y > 4) & (Y < 36) & (X % 8 > 2) & (Y % 8 > 2)),
    "crescent and disc share a box": drawn(PAGE, disc(24, 20, 15), disc(24, 20, 15) & ~disc(24, 14, 13)),
    "two halves of a square": drawn(PAGE, (X > 8) & (X < 38) & (Y > 5) & (Y < 35),
                                    (X > 8) & (X < 38) & (Y > 5) & (Y < 35) & (X + Y > 41)),
    "bar behind post": drawn(PAGE, (Y > 14) & (Y < 26) & (X > 3) & (X < 45), (X > 20) & (X < 26)),
    "ringed by two that come later": drawn(PAGE, disc(24, 20, 14), disc(24, 20, 11) & (X < 24),
                                           disc(24, 20, 11) & (X >= 24), disc(24, 20, 10)),
    "ring in ring in ring": drawn(PAGE, *(disc(24, 20, radius) for radius in (19, 16, 13, 10))),
    "strip of one pixel between earlier ones": drawn(PAGE, X > 23, (X > 23) & (X < 24)),
    "web in a hole": drawn(PAGE, disc(24, 20, 18), disc(24, 20, 12), disc(24, 20, 12) & (X > 24),
                           disc(28, 20, 5)),
    "touching at corners": drawn(PAGE, ((X // 8 + Y // 8) % 2 == 0)),
    "many neighbours": VORONOI,
}


@pytest.mark.parametrize("curves", ["cubic", "quadratic"])
@pytest.mark.parametrize("name", COUNTEREXAMPLES)
def test_counterexamples_show_every_pixel(name, curves):
    labels, drawing = stacked(COUNTEREXAMPLES[name], curves=curves)
    assert colours_at(drawing, centres(labels.index.shape)) == pytest.approx(true_colours(labels))


@pytest.mark.parametrize("nothing", range(4))
@pytest.mark.parametrize("name", ["ring in ring in ring", "web in a hole",
                                  "black ring, white eye, black pupil"])
def test_transparent_holes_stay_open(name, nothing):
    index = COUNTEREXAMPLES[name]
    palette = palette_labels(index).palette
    palette[min(nothing, index.max()), 3] = 0
    labels, drawing = stacked(index, palette)
    assert colours_at(drawing, centres(index.shape)) == pytest.approx(true_colours(labels))


@pytest.mark.parametrize("name", COUNTEREXAMPLES)
def test_areas_do_not_increase_and_every_face_has_its_own_named_shape(name):
    _, drawing = stacked(COUNTEREXAMPLES[name])
    faces = planar_map(COUNTEREXAMPLES[name])[0].face_labels
    areas = [shape.area for shape in drawing.shapes]
    assert areas == sorted(areas, reverse=True)
    assert len(drawing.shapes) == len(faces) - 1
    names = [shape.name for shape in drawing.shapes]
    assert len(set(names)) == len(names)
    for name, shape in zip(names, drawing.shapes):
        assert name.startswith("#{:02x}{:02x}{:02x} ".format(*shape.rgb))


LABEL_MAPS = st.tuples(st.integers(1, 11), st.integers(1, 11)).flatmap(
    lambda shape: arrays.arrays(np.int64, shape, elements=st.integers(0, 3)))
OPACITIES = st.lists(st.sampled_from([255, 255, 255, 0, 120]), min_size=4, max_size=4)


@settings(max_examples=150, deadline=None, derandomize=True)
@given(LABEL_MAPS, OPACITIES, st.sampled_from(["stacked", "cutout"]), st.sampled_from(["cubic", "quadratic"]))
def test_any_label_map_is_shown(index, opacities, stacking, curves):
    palette = palette_labels(np.arange(4)[None]).palette
    palette[:, 3] = opacities
    labels, drawing = stacked(index, palette, stacking=stacking, curves=curves)
    assert colours_at(drawing, centres(index.shape)) == pytest.approx(true_colours(labels))


@pytest.mark.parametrize("seed", range(12))
def test_hidden_borders_neither_cut_nor_spill(seed):
    rng = np.random.RandomState(seed)
    index = np.kron(rng.randint(0, 5, (6, 7)), np.ones((3, 3), int))
    palette = palette_labels(index).palette
    palette[rng.randint(5), 3] = rng.choice([0, 120, 255])
    at = centres(index.shape, per_pixel=5)
    one, other = (colours_at(stacked(index, palette, stacking=way)[1], at) for way in ("stacked", "cutout"))
    assert (np.abs(one - other).max(axis=1) > 0.01).mean() < 1e-3


@pytest.mark.parametrize("name", COUNTEREXAMPLES)
def test_cutout_shapes_have_the_areas_of_their_faces_and_share_out_the_picture(name):
    labels, drawing = stacked(COUNTEREXAMPLES[name], stacking="cutout")
    points = np.concatenate([loop.control[:, (0, 3)] for shape in drawing.shapes for loop in shape.loops])
    cross = points[:, 0, 0] * points[:, 1, 1] - points[:, 1, 0] * points[:, 0, 1]
    assert cross.sum() / 2 == pytest.approx(labels.index.size)
    at = centres(labels.index.shape)
    covering = [winding(shape.loops, at) != 0 for shape in drawing.shapes]
    assert (np.sum(covering, axis=0) == 1).all()


@pytest.mark.parametrize("way", ["stacked", "cutout"])
def test_loops_are_closed(way):
    _, drawing = stacked(VORONOI, stacking=way)
    for loop in (loop for shape in drawing.shapes for loop in shape.loops):
        assert len(loop.degree) == len(loop.control)
        assert np.array_equal(loop.control[:, 3], np.roll(loop.control[:, 0], -1, axis=0))


def interior(index, zoom, margin):
    """Rendered pixels farther than `margin` px from label 0, the back-most face."""
    near = index == 0
    for _ in range(margin):
        near = np.pad(near, 1, mode="edge")
        near = near[:-2] | near[1:-1] | near[2:]
        near = near[:, :-2] | near[:, 1:-1] | near[:, 2:]
    height, width = (round(size * zoom) for size in index.shape)
    row = ((np.arange(height) + 0.5) * index.shape[0] / height).astype(int)
    col = ((np.arange(width) + 0.5) * index.shape[1] / width).astype(int)
    return ~near[np.ix_(row, col)]


def leak(drawing, zoom, inside):
    """How much of the page's colour is seen through all but the back-most shape, 0 to 255."""
    front = replace(drawing, shapes=drawing.shapes[1:])
    magenta, green = (render(front, zoom, page) for page in ("#ff00ff", "#00ff00"))
    return int(np.abs(magenta - green)[inside].max())


SEAMS = ["many neighbours", "web in a hole", "ring in ring in ring", "thin net over its cells",
         "bar behind post"]


@pytest.mark.parametrize("zoom", ZOOMS)
@pytest.mark.parametrize("name", SEAMS)
def test_nothing_of_the_page_shows_through(name, zoom):
    index = COUNTEREXAMPLES[name]
    inside = interior(index, zoom, 2)
    assert inside.sum() > 100
    assert leak(stacked(index)[1], zoom, inside) <= 1
    transparent = palette_labels(index).palette
    transparent[0, 3] = 0
    floating = stacked(index, transparent)[1]
    # Without a background nothing needs to be removed to see through.
    assert leak(replace(floating, shapes=floating.shapes[:1] + floating.shapes), zoom, inside) <= 1


def test_the_seam_test_sees_seams():
    inside = interior(VORONOI, 2.7, 2)
    assert leak(stacked(VORONOI, stacking="cutout")[1], 2.7, inside) > 30


def fringe(drawing, exact, zoom):
    """How far pixels that two faces share are from any mix of their colours, 0 to 255."""
    seen = render(drawing, zoom, "#ff00ff")[..., :3]
    height, width = seen.shape[:2]
    fine = render(exact, zoom * 8, antialias=False)[..., :3].reshape(height, 8, width, 8, 3)
    parts = fine.transpose(0, 2, 1, 3, 4).reshape(-1, 64, 3)
    one = parts[:, 0]
    row = np.arange(len(parts))
    other = parts[row, np.abs(parts - one[:, None]).sum(axis=2).argmax(axis=1)]
    two = ((parts == one[:, None]).all(axis=2) | (parts == other[:, None]).all(axis=2)).all(axis=1)
    seen, one, span = seen.reshape(-1, 3)[two], one[two], (other - one)[two]
    share = np.clip(((seen - one) * span).sum(axis=1) / np.maximum((span**2).sum(axis=1), 1), 0, 1)
    return np.abs(seen - one - share[:, None] * span).max()


@pytest.mark.parametrize("zoom", ZOOMS)
@pytest.mark.parametrize("name", SEAMS[:2])
def test_no_third_colour_fringes_a_boundary(name, zoom):
    exact = stacked(COUNTEREXAMPLES[name], stacking="cutout")[1]
    # Where three faces meet, one of them may be short of the others by a part of a pixel.
    assert fringe(stacked(COUNTEREXAMPLES[name])[1], exact, zoom) <= 16


def test_the_fringe_test_sees_fringes():
    exact = stacked(VORONOI, stacking="cutout")[1]
    assert fringe(exact, exact, 1.0) > 30


def test_a_translucent_shape_continues_under_opaque_ones_but_none_under_it():
    index = drawn(PAGE, disc(24, 20, 16), disc(24, 20, 16) & (X > 24))
    palette = palette_labels(index).palette
    palette[0, 3], palette[1, 3] = 0, 100
    _, drawing = stacked(index, palette)
    assert [round(255 * shape.opacity) for shape in drawing.shapes] == [100, 255]
    assert colours_at(drawing, centres(index.shape, 3)) == pytest.approx(
        colours_at(stacked(index, palette, stacking="cutout")[1], centres(index.shape, 3)))
    glass, solid = (winding(shape.loops, centres(index.shape)) != 0 for shape in drawing.shapes)
    assert (glass & solid).any()


def test_the_back_most_opaque_shape_is_the_whole_page():
    _, drawing = stacked(EYE)
    assert [len(loop.degree) for loop in drawing.shapes[0].loops] == [4]
    assert drawing.shapes[0].loops[0].control.max() == 50
    palette = palette_labels(EYE).palette
    palette[2, 3] = 0
    assert len(stacked(EYE, palette)[1].shapes[0].loops) == 2


def test_outer_loops_come_first_and_run_clockwise():
    _, drawing = stacked(COUNTEREXAMPLES["ring in ring in ring"], stacking="cutout")
    for shape in drawing.shapes:
        begin, end = (np.concatenate([loop.control[:, k] for loop in shape.loops]) for k in (0, 3))
        turned = np.add.reduceat(begin[:, 0] * end[:, 1] - end[:, 0] * begin[:, 1],
                                 np.cumsum([0] + [len(loop.degree) for loop in shape.loops[:-1]]))
        assert turned[0] > 0 and (turned[1:] < 0).all()


def test_holes_that_are_painted_over_are_filled():
    assert [len(shape.loops) for shape in stacked(EYE)[1].shapes] == [1, 1, 1, 1]
    assert [len(shape.loops) for shape in stacked(EYE, stacking="cutout")[1].shapes] == [2, 2, 2, 1]


def test_each_boundary_is_stored_once_and_hidden_ones_take_few_lines():
    _, _, curves = planar_map(VORONOI)
    _, drawing = stacked(VORONOI)
    exact = {tuple(map(tuple, sorted(ends))) for ends in curves.control[:, (0, 3)].tolist()}
    pieces = [tuple(map(tuple, sorted(ends))) for shape in drawing.shapes for loop in shape.loops
              for ends in loop.control[:, (0, 3)].tolist()]
    shown = [ends for ends in pieces if ends in exact]
    assert len(shown) == len(set(shown))
    assert len(pieces) - len(shown) < 30


def test_faces_are_sorted_by_what_they_enclose_before_simplification():
    """A ring whose curve was cut short must still lie behind the larger disc in it."""
    index = drawn(PAGE, disc(24, 20, 15), disc(24, 20, 12))
    planar, lines, curves = planar_map(index)
    inner = planar.pixel_faces[20, 24]
    sides = np.stack([planar.left, planar.right])
    ring = int(np.flatnonzero(((sides > 0) & (sides != inner)).all(axis=0))[0])
    shrunk = curves.control.copy()
    part = slice(curves.starts[ring], curves.starts[ring + 1])
    shrunk[part] = (shrunk[part] - [24, 20]) * 0.5 + [24, 20]
    labels = palette_labels(index)
    drawing = stack(np.zeros((*index.shape, 4), np.uint8), labels, planar, lines,
                    Curves(curves.starts, shrunk, curves.degree), TraceOptions(curves="quadratic"))
    middle = colours_at(drawing, np.array([[24.01, 20.02]]))[0]
    assert middle == pytest.approx([*labels.palette[2, :3], 255])


@pytest.mark.parametrize("index", [[[0]], [[0, 1]], [[0], [1], [0]], np.zeros((3, 5), int)])
def test_tiny_pictures(index):
    labels, drawing = stacked(np.array(index))
    assert colours_at(drawing, centres(labels.index.shape)) == pytest.approx(true_colours(labels))


def test_an_empty_picture_has_no_shapes():
    _, drawing = stacked(np.zeros((3, 4), int), [[9, 9, 9, 0]])
    assert drawing.shapes == () and (drawing.width, drawing.height) == (4, 3)


def test_the_sort_key_of_the_paper_is_the_bounding_rectangle():
    index = drawn(PAGE, (np.abs(X - Y) < 4) & (X > 5) & (X < 35), (X > 28) & (X < 43) & (Y > 2) & (Y < 22))
    by_area = [shape.rgb for shape in stacked(index)[1].shapes]
    by_box = [shape.rgb for shape in stacked(index, curves="quadratic")[1].shapes]
    assert sorted(by_area) == sorted(by_box) and by_area != by_box
