# SPDX-License-Identifier: GPL-2.0-or-later
"""Thin strokes: which colour they get, and how far."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import disc, draw, everywhere, half_plane, stroke
from test_ridges import ANGLES, BLACK, RED, WHITE, ridges_of

from ddtcore import strokes
from ddtcore.canvas import planes, unpack


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
