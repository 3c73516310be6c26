# SPDX-License-Identifier: GPL-2.0-or-later
"""Spots too small for a full pixel: their colour is found, and nothing else is taken for one."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere, half_plane, stroke
from test_ringing import resized

from ddtcore import palette, spots
from ddtcore.canvas import planes, prepare, unpack
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels
from ddtcore.ridges import find_ridges
from ddtcore.ringing import without_ringing
from ddtcore.strokeinks import new_colours

WHITE, BLACK, RED, SKIN = (255, 255, 255, 255), (0, 0, 0, 255), (184, 0, 0, 255), (255, 192, 128, 255)
KNOWN = np.array([WHITE, SKIN, BLACK], np.uint8).view(np.uint32)[:, 0]


def face(mouth):
    """A face with a red mouth below a black line, 120 x 120."""
    return [(WHITE, everywhere), (BLACK, disc(60, 60, 48)), (SKIN, disc(60, 60, 45.2)), (RED, mouth),
            (BLACK, stroke(60.4, 64.4, 0.1, 2.2, 9)), (BLACK, disc(44, 44, 4.4)), (BLACK, disc(76, 44, 4.4))]


def lip(x, y):
    return disc(60, 50.4, 19)(x, y) & (y > 65)


def look(canvas, doubt):
    """What `find_spots` is asked for a picture in the colours `KNOWN`, and that strokes tell."""
    plateaus = palette.find_plateaus(canvas, np.zeros(canvas.shape, bool))
    labels = palette.known_labels(canvas, plateaus, KNOWN, 2.0)
    cells = canvas.cells(~plateaus.core)
    ridges = find_ridges(canvas, cells, 2.0 + doubt)
    more = new_colours(canvas, cells, ridges, planes(KNOWN, True), labels, 2.0 + doubt)
    return canvas, cells, ridges, planes(np.append(KNOWN, more), True), labels, doubt


@pytest.mark.parametrize(("mouth", "factor"), [(lip, 0.5), (disc(60.8, 66.6, 3.6), 0.7)])
def test_lips_are_red(mouth, factor):
    image = resized(draw(120, 120, face(mouth)), factor)
    result = label_pixels(image, TraceOptions())
    assert len(result.palette) == 4
    red = np.abs(result.palette[:, :3] - RED[:3]).max(axis=1).argmin()
    assert np.abs(result.palette[red] - RED).max() < 12
    points = np.argwhere(result.index == red) / factor
    assert len(points) >= 4 and (np.abs(points - [67, 60]) < [6, 12]).all()


def test_the_fullest_pixel_tells_the_colour():
    canvas, _ = without_ringing(prepare(resized(draw(120, 120, face(lip)), 0.5)))
    found = spots.find_spots(*look(canvas, 2.0))
    assert found.size == 1
    assert np.abs(unpack(canvas.keys[found])[0].astype(int) - RED).max() < 12


def test_ramps_have_more_colours_than_are_known():
    """Where pixels are neither labelled nor asked, nothing is told of what lies beside them."""
    canvas, _ = without_ringing(prepare(resized(draw(120, 120, face(lip)), 0.5)))
    asked = look(canvas, 2.0)
    asked[4][canvas.numbers(*np.mgrid[36:40, 22:38]).ravel()] = -1
    assert not spots.find_spots(*asked).size


@pytest.mark.parametrize("layers", [CARTOON[:1], face(lip)[:3], face(lip)[:3] + face(lip)[4:]])
def test_where_all_is_explained_there_are_no_spots(layers):
    assert not spots.find_spots(*look(prepare(draw(120, 120, layers)), 0.0)).size


@pytest.mark.parametrize("angle", [0, 0.3, 0.8, 1.3])
def test_a_crossing_of_edges_is_no_spot(angle):
    image = draw(60, 60, [(SKIN, everywhere), (WHITE, half_plane(30, 30, angle)),
                          (BLACK, half_plane(30, 30, angle + 1)),
                          (WHITE, stroke(30, 30, angle + 2, 1.2, 40)), (BLACK, disc(10, 10, 6))])
    assert not spots.find_spots(*look(prepare(image), 0.0)).size
