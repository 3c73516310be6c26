# SPDX-License-Identifier: GPL-2.0-or-later
"""Colours that only thin strokes have are found, exactly and once."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import box, disc, draw, everywhere, half_plane, stroke
from test_ridges import ANGLES, BLACK, WHITE, ridges_of

from ddtcore.canvas import planes, prepare, unpack
from ddtcore.ridges import find_ridges
from ddtcore.strokeinks import new_colours


def test_new_colour_is_exact_where_it_is_ever_fully_covered():
    image = draw(90, 90, [((255, 192, 128, 255), everywhere), (BLACK, disc(30, 30, 12)),
                          ((184, 0, 0, 255), stroke(60, 50, 0.7, 1.5, 20))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    known = planes(keys, True)
    found = new_colours(canvas, cells, ridges, known, labels, 2.0)
    assert unpack(np.append(keys, found)).tolist().count([184, 0, 0, 255]) == 1


def test_black_that_is_nowhere_full_is_black():
    image = draw(60, 60, [((169, 169, 169, 255), everywhere), (WHITE, half_plane(30.3, 30.1, np.pi / 4)),
                          (BLACK, stroke(30.3, 30.1, np.pi / 4, 1.38, 24))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    assert image[..., 0].min() > 0
    found = new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0)
    assert unpack(found).tolist() == [list(BLACK)]


def test_a_new_colour_is_found_once():
    """In a grain no two pixels of a stroke are equal."""
    ink = 150, 20, 90, 255
    image = draw(90, 90, [(WHITE, everywhere)] + [(ink, stroke(45, y, 0.1, 1.5, 40)) for y in (20, 45, 70)])
    image[..., :3] = np.clip(image[..., :3] + np.random.RandomState(1).randint(-4, 5, (90, 90, 3)), 0, 255)
    canvas = prepare(image)
    cells = canvas.cells(np.ones(canvas.shape, bool))
    labels = np.full(canvas.keys.size, -1, np.int32)
    ridges = find_ridges(canvas, cells, 7.0)
    found = unpack(new_colours(canvas, cells, ridges, np.full((3, 1), 255, np.float32), labels, 7.0))
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
    ridges = find_ridges(canvas, cells, 4.0)
    known = np.array([[200, 220, 250], [255, 255, 255]], np.float32).T
    pale, deep = (unpack(new_colours(canvas, cells, ridges, known, labels, 4.0, blurred)).tolist()
                  for blurred in (False, True))
    assert pale and min(pale[0][:3]) > 0
    assert (list(BLACK) in deep) == black


def test_no_new_colours_where_the_palette_explains_all():
    image = draw(90, 90, [(WHITE, everywhere), (BLACK, disc(30, 30, 12))]
                 + [(BLACK, stroke(60, 50, angle, 1.0, 20)) for angle in ANGLES])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    assert not new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0).size


def test_a_new_colour_is_no_mix_of_one_that_was_found():
    """A black stroke between blue and white in two rows, each a mix of its own."""
    blue = (0, 51, 217, 255)
    image = draw(90, 90, [(WHITE, everywhere), (blue, box(0, 0, 90, 30.6)), (BLACK, box(0, 29.75, 90, 31.15)),
                          (BLACK, stroke(45, 60, 0.7, 1.3, 25)), (BLACK, stroke(30, 15, 2.5, 1.3, 10))])
    canvas, keys, labels, ridges = ridges_of(image)
    cells = canvas.cells(canvas.bare(labels) < 0)
    found = new_colours(canvas, cells, ridges, planes(keys, True), labels, 2.0)
    assert unpack(found).tolist() == [list(BLACK)]
