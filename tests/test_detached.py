# SPDX-License-Identifier: GPL-2.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import prepare
from ddtcore.detached import AREA, join_detached
from ddtcore.gradient import colours_at
from ddtcore.growing import Surface
from ddtcore.model import Gradient
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

HEIGHT, WIDTH = 30, 60
GRADIENT = Gradient("linear", (0.0, 0.0), (60.0, 0.0), ((0.0, (240, 120, 0), 1.0), (1.0, (250, 210, 60), 1.0)))


def picture():
    """A ramp from edge to edge."""
    row, col = np.mgrid[:HEIGHT, :WIDTH] + 0.5
    points = np.stack([col.ravel(), row.ravel()], axis=1)
    return np.rint(colours_at(GRADIENT, points)).astype(np.uint8).reshape(HEIGHT, WIDTH, 4)


def joined(image, free, ramps):
    """The ramps after what is free and belongs to them is joined."""
    def colours(points):
        return colours_at(GRADIENT, points)[:, :3]

    return join_detached(prepare(image), ramps, [Surface(colours, GRADIENT)], free)[0]


def cut(image):
    """The ramp above row 10 only, and everything below row 12 free; a gap lies between them."""
    ramps = np.full((HEIGHT, WIDTH), -1, np.int32)
    ramps[:10] = 0
    free = np.zeros((HEIGHT, WIDTH), bool)
    free[13:] = True
    return joined(image, free, ramps)


def test_what_has_the_colours_of_a_ramp_beyond_a_gap_belongs_to_it():
    assert (cut(picture())[13:] == 0).all()


def test_only_free_pixels_join():
    assert (cut(picture())[10:13] == -1).all()


@pytest.mark.parametrize("shift", [5, 20, 90])
def test_other_colours_do_not_join(shift):
    image = picture()
    image[13:, :, 2] += shift
    assert (cut(image)[13:] == -1).all()


@pytest.mark.parametrize("height, width, joins", [(1, 40, False), (2, AREA // 2 - 1, False), (2, AREA // 2, True)])
def test_pieces_have_some_area(height, width, joins):
    image = picture()
    image[13:, :, 2] += 90
    image[20:20 + height, 5:5 + width] = picture()[20:20 + height, 5:5 + width]
    out = cut(image)
    assert (out[20:20 + height, 5:5 + width] == (0 if joins else -1)).all()
    assert np.count_nonzero(out[13:] == 0) == (height * width if joins else 0)


def test_of_two_ramps_the_nearer_one_gets_a_piece():
    image = picture()
    image[:10, :30, 2] += 90
    ramps = np.full((HEIGHT, WIDTH), -1, np.int32)
    ramps[:10, :30], ramps[:10, 30:] = 0, 1
    free = np.zeros((HEIGHT, WIDTH), bool)
    free[13:] = True

    def near(points):
        return colours_at(GRADIENT, points)[:, :3] + np.where(points[:, 1:] < 10, [0, 0, 90], 1)

    def nearer(points):
        return colours_at(GRADIENT, points)[:, :3]

    ramps, _ = join_detached(prepare(image), ramps, [Surface(near, GRADIENT), Surface(nearer, GRADIENT)], free)
    assert (ramps[13:] == 1).all()


@pytest.mark.parametrize("shift, count", [(0, 1), (2, 1), (5, 2)])
def test_one_surface_serves_all_ramps_that_it_explains(shift, count):
    image = picture()
    image[20:, :20, 2] += shift
    ramps = np.full((HEIGHT, WIDTH), -1, np.int32)
    ramps[20:, :20], ramps[:15] = 0, 1
    surfaces = [Surface(lambda points: colours_at(GRADIENT, points)[:, :3] + [0, 0, shift], GRADIENT),
                Surface(lambda points: colours_at(GRADIENT, points)[:, :3], GRADIENT)]
    out, left = join_detached(prepare(image), ramps, surfaces, np.zeros((HEIGHT, WIDTH), bool))
    assert len(left) == count and left[-1] is surfaces[1]
    assert ((out >= 0) == (ramps >= 0)).all() and len(np.unique(out)) == count + 1


def test_a_strip_inside_a_frame_is_of_the_ramp():
    image = picture()
    image[8:20, 4:56] = image[8:20, 4:56] * np.array([0.85, 0.85, 0.85, 1.0])
    image[12:16, 8:52] = picture()[12:16, 8:52]
    labels = label_pixels(image, TraceOptions())
    assert (labels.index[12:16, 8:52] == labels.index[2, 30]).all()
    assert (labels.index[9, 8:52] != labels.index[2, 30]).all()
