# SPDX-License-Identifier: GPL-2.0-or-later
"""Ridges: crests of thin strokes stand out, edges do not."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import box, disc, draw, everywhere, half_plane, stroke

from ddtcore import palette
from ddtcore.canvas import prepare
from ddtcore.ridges import LEAST, find_ridges

WHITE, BLACK, RED = (255, 255, 255, 255), (0, 0, 0, 255), (200, 30, 40, 255)
ANGLES = [0, 0.2, 0.7, np.pi / 4, 1.2, np.pi / 2, 2.2]


def ridges_of(image):
    """Canvas, colours, known labels and ridges of a picture."""
    canvas = prepare(image)
    plateaus = palette.find_plateaus(canvas, np.zeros(canvas.shape, bool))
    keys = palette.choose_colours(canvas, plateaus, False)
    labels = palette.known_labels(canvas, plateaus, keys, 2.0)
    return canvas, keys, labels, find_ridges(canvas, canvas.cells(~plateaus.core), 2.0)


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
    assert (ridges.height > LEAST).all()
    some = ridges.some(np.array([3, 5]))
    np.testing.assert_array_equal(some.height, ridges.height[[3, 5]])
