# SPDX-License-Identifier: GPL-2.0-or-later
"""Thin strokes: where they are found, and which colour they get."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import box, disc, draw, everywhere, half_plane, stroke

from ddtcore import palette, strokes
from ddtcore.canvas import planes, prepare, unpack

WHITE, BLACK, RED = (255, 255, 255, 255), (0, 0, 0, 255), (200, 30, 40, 255)
ANGLES = [0, 0.2, 0.7, np.pi / 4, 1.2, np.pi / 2, 2.2]


def ridges_of(image):
    """Canvas, colours, known labels and ridges of a picture."""
    canvas = prepare(image)
    plateaus = palette.find_plateaus(canvas, np.zeros(canvas.shape, bool))
    keys = palette.choose_colours(canvas, plateaus, False)
    labels = palette.known_labels(canvas, plateaus, keys, 2.0)
    return canvas, keys, labels, strokes.find_ridges(canvas, canvas.cells(~plateaus.core), 2.0)


@pytest.mark.parametrize("angle", ANGLES)
def test_one_edge_has_no_ridges(angle):
    """Across an edge between two colours nothing stands out, at whatever angle."""
    image = draw(40, 40, [(RED, everywhere), ((30, 60, 200, 255), half_plane(20.3, 20.1, angle))])
    assert ridges_of(image)[3].cells.size == 0


@pytest.mark.parametrize("angle", [0.02, 0.04, 0.3])
@pytest.mark.parametrize("height", [-0.2, 0.4, 1.1])
def test_an_edge_that_leaves_the_picture_has_no_ridges(angle, height):
    image = draw(50, 60, [(WHITE, everywhere), (BLACK, half_plane(30, height, angle))])
    assert ridges_of(image)[3].cells.size == 0


def test_round_edges_hardly_stand_out():
    image = draw(80, 80, [(WHITE, everywhere), (BLACK, disc(40.2, 39.7, 30))])
    ridges = ridges_of(image)[3]
    assert ridges.cells.size < 12 and (ridges.height < 60).all()


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("width", [0.7, 1.0, 1.4])
def test_every_step_along_a_stroke_has_a_ridge(angle, width):
    image = draw(60, 60, [(WHITE, everywhere), (BLACK, half_plane(30.3, 30.1, angle)),
                          (RED, stroke(30.3, 30.1, angle, width, 40))])
    canvas, _, _, ridges = ridges_of(image)
    row, col = canvas.places(ridges.cells)
    steps = col if abs(np.cos(angle)) > abs(np.sin(angle)) else row
    assert set(range(5, 55)) <= set(steps.tolist())
    across = (row + 0.5 - 30.1) * np.cos(angle) - (col + 0.5 - 30.3) * np.sin(angle)
    assert np.abs(across).max() < 1.5


def test_a_stroke_beside_a_gap_that_stands_out_more():
    """Ridges to opposite sides do not suppress each other."""
    red, brown = (207, 52, 26, 255), (176, 114, 46, 255)
    canvas, _, _, ridges = ridges_of(draw(40, 40, [
        (BLACK, everywhere), (brown, box(0, 20.1, 40, 21.25)),
        (red, box(0, 22.48, 40, 26)), (red, box(0, 10, 40, 18.27))]))
    rows = canvas.places(ridges.cells)[0]
    assert np.count_nonzero(rows == 20) == 40 and np.count_nonzero(rows == 21) >= 38


def test_ridges_stand_out_by_their_excess():
    image = draw(60, 60, [(WHITE, everywhere), (BLACK, stroke(30.3, 30.1, 0.5, 1.0, 20))])
    canvas, _, _, ridges = ridges_of(image)
    np.testing.assert_allclose(ridges.colour, canvas.colours(ridges.cells))
    assert (ridges.height > strokes.LEAST).all()
    some = ridges.some(np.array([3, 5]))
    np.testing.assert_array_equal(some.height, ridges.height[[3, 5]])


@pytest.mark.parametrize("sides", [(WHITE, WHITE), (WHITE, BLACK), ((255, 208, 32, 255), (32, 80, 208, 255))])
def test_the_stroke_gets_its_colour_not_one_nearby(sides):
    """Brown, the mix of the red stroke with what lies beside it, stands ready in the palette and near."""
    one, other = sides
    for angle in ANGLES:
        image = draw(60, 60, [(one, everywhere), (other, half_plane(30.3, 30.1, angle)),
                              (RED, stroke(30.3, 30.1, angle, 1.0, 20)), (RED, disc(6, 6, 4)),
                              ((228, 142, 148, 255), disc(54, 6, 4)), ((100, 15, 20, 255), disc(54, 54, 4))])
        canvas, keys, labels, ridges = ridges_of(image)
        label, share = strokes.stroke_labels(canvas, ridges, planes(keys, True), labels, 2.0)
        row, col = canvas.places(ridges.cells)
        along = (col - 30) * np.cos(angle) + (row - 30) * np.sin(angle)
        own = (np.hypot(row - 30, col - 30) < 16) & (np.abs(along) < 16)
        assert (unpack(keys)[label[own]] == RED).all()
        assert ((share[own] > 0.2) & (share[own] <= 1)).all()


def test_new_colour_is_exact_where_it_is_ever_fully_covered():
    image = draw(90, 90, [((255, 192, 128, 255), everywhere), (BLACK, disc(30, 30, 12)),
                          ((184, 0, 0, 255), stroke(60, 50, 0.7, 1.5, 20))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    known = planes(keys, True)
    found = strokes.new_colours(canvas, cells, ridges, known, labels, 2.0)
    assert unpack(np.append(keys, found)).tolist().count([184, 0, 0, 255]) == 1


def test_black_that_is_nowhere_full_is_black():
    image = draw(60, 60, [((169, 169, 169, 255), everywhere), (WHITE, half_plane(30.3, 30.1, np.pi / 4)),
                          (BLACK, stroke(30.3, 30.1, np.pi / 4, 1.38, 24))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    assert image[..., 0].min() > 0
    found = strokes.new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0)
    assert unpack(found).tolist() == [list(BLACK)]


def test_a_new_colour_is_found_once():
    """In a grain no two pixels of a stroke are equal."""
    ink = 150, 20, 90, 255
    image = draw(90, 90, [(WHITE, everywhere)] + [(ink, stroke(45, y, 0.1, 1.5, 40)) for y in (20, 45, 70)])
    image[..., :3] = np.clip(image[..., :3] + np.random.RandomState(1).randint(-4, 5, (90, 90, 3)), 0, 255)
    canvas = prepare(image)
    cells = canvas.cells(np.ones(canvas.shape, bool))
    labels = np.full(canvas.keys.size, -1, np.int32)
    ridges = strokes.find_ridges(canvas, cells, 7.0)
    found = unpack(strokes.new_colours(canvas, cells, ridges, np.full((3, 1), 255, np.float32), labels, 7.0))
    assert len(found) == 1 and np.abs(found[0].astype(int) - ink).max() < 20


@pytest.mark.parametrize("ink, black", [((0, 0, 0), True), ((150, 20, 90), False), ((110, 110, 110), False)])
def test_strokes_that_blur_made_pale_are_black_where_mixes_with_black_explain_them(ink, black):
    """What is less than half as dark stays grey."""
    image = draw(90, 90, [((200, 220, 250, 255), everywhere), (WHITE, half_plane(45, 45, 0.1))]
                 + [((*ink, 255), stroke(45, y, 0.1, 1.2, 40)) for y in (20, 45, 70)])
    plane = np.pad(image[..., :3].astype(float), [(1, 1), (1, 1), (0, 0)], mode="edge")
    plane = plane[1:-1] * 0.5 + (plane[2:] + plane[:-2]) * 0.25
    image[..., :3] = np.rint(plane[:, 1:-1])
    canvas = prepare(image)
    cells = canvas.cells(np.ones(canvas.shape, bool))
    labels = np.full(canvas.keys.size, -1, np.int32)
    ridges = strokes.find_ridges(canvas, cells, 4.0)
    known = np.array([[200, 220, 250], [255, 255, 255]], np.float32).T
    pale, deep = (unpack(strokes.new_colours(canvas, cells, ridges, known, labels, 4.0, blurred)).tolist()
                  for blurred in (False, True))
    assert pale and min(pale[0][:3]) > 0
    assert (list(BLACK) in deep) == black


def test_no_new_colours_where_the_palette_explains_all():
    image = draw(90, 90, [(WHITE, everywhere), (BLACK, disc(30, 30, 12))]
                 + [(BLACK, stroke(60, 50, angle, 1.0, 20)) for angle in ANGLES])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    assert not strokes.new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0).size


def test_a_new_colour_is_no_mix_of_one_that_was_found():
    """A black stroke between blue and white in two rows, each a mix of its own."""
    blue = (0, 51, 217, 255)
    image = draw(90, 90, [(WHITE, everywhere), (blue, box(0, 0, 90, 30.6)), (BLACK, box(0, 29.75, 90, 31.15)),
                          (BLACK, stroke(45, 60, 0.7, 1.3, 25)), (BLACK, stroke(30, 15, 2.5, 1.3, 10))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    found = strokes.new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0)
    assert unpack(found).tolist() == [list(BLACK)]


@pytest.mark.parametrize("angle", ANGLES)
def test_a_tip_is_followed_until_it_is_faint(angle):
    """A wedge that narrows by 0.02 px per px has a coverage of 0.1 some 5 px before its tip."""
    def wedge(x, y):
        along = (x - 40.3) * np.cos(angle) + (y - 40.2) * np.sin(angle)
        across = (y - 40.2) * np.cos(angle) - (x - 40.3) * np.sin(angle)
        return (np.abs(across) < (along + 34) * 0.01) & (along < 34)

    image = draw(80, 80, [(WHITE, everywhere), (BLACK, wedge), (BLACK, disc(8, 70, 4)), (BLACK, disc(70, 8, 4))])
    canvas, keys, labels, ridges = ridges_of(image)
    label, share = strokes.stroke_labels(canvas, ridges, planes(keys, True), labels, 2.0)
    row, col = canvas.places(ridges.cells[label >= 0])
    along = (col + 0.5 - 40.3) * np.cos(angle) + (row + 0.5 - 40.2) * np.sin(angle)
    across = (row + 0.5 - 40.2) * np.cos(angle) - (col + 0.5 - 40.3) * np.sin(angle)
    assert along[np.abs(across) < 2].min() < -23
    assert share[label >= 0].min() < strokes.FAINT


def test_faint_pixels_alone_are_no_stroke():
    image = draw(60, 60, [(WHITE, everywhere), (BLACK, stroke(30, 30, 0.5, 0.13, 20)), (BLACK, disc(8, 50, 5))])
    canvas, keys, labels, ridges = ridges_of(image)
    label, share = strokes.stroke_labels(canvas, ridges, planes(keys, True), labels, 2.0)
    faint = share < strokes.FAINT
    assert faint.sum() > 10 and (label[faint] < 0).mean() > 0.9


def test_lone_corners():
    stride = 7
    labels = np.zeros((7, stride), int)
    labels[3:5, 2:4] = 1  # an area with one stroke pixel at a corner, and a stroke of two at another
    labels[5, 1] = labels[2, 4] = labels[1, 5] = 1
    thin = np.zeros(labels.shape, bool)
    thin[5, 1] = thin[2, 4] = thin[1, 5] = True
    cells = np.flatnonzero(thin)
    lone = strokes.lone_corners(labels.ravel(), thin.ravel(), cells, stride)
    np.testing.assert_array_equal(lone, cells == 5 * stride + 1)


def test_no_ridges_and_no_colours_give_no_labels():
    image = np.full((9, 9, 4), 200, np.uint8)
    canvas, keys, labels, ridges = ridges_of(image)
    label, share = strokes.stroke_labels(canvas, ridges, planes(keys, canvas.opaque), labels, 2.0)
    assert label.shape == share.shape == (0,)
