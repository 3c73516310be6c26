# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps: linear, radial and none at all."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, draw

from ddtcore.canvas import prepare
from ddtcore.model import Labels
from ddtcore.ramps import AREA, SLOPES, absorb_pieces, find_ramps, mark_slopes

SIZE = 60
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5


def picture(value, inside):
    """A picture of a level at each pixel inside a mask, on white."""
    image = np.full((*np.shape(inside), 4), 255, np.uint8)
    level = np.rint(np.clip(value, 0, 255)).astype(np.uint8)
    image[..., :3] = np.where(inside, level, 255)[..., None]
    return image


@pytest.mark.parametrize("angle", [0, 0.3, 1.0, np.pi / 2, 2.5])
@pytest.mark.parametrize("slope", [0.3, 1.0, 3.0, 8.0])
def test_linear_ramps(angle, slope):
    inside = (abs(X - 30) < 20) & (abs(Y - 30) < 12)
    along = (X - 30) * np.cos(angle) + (Y - 30) * np.sin(angle)
    ramps, count = find_ramps(prepare(picture(100 + slope * along, inside & (abs(slope * along) < 99))))
    assert count == 1
    # At its rim the steps are not even, towards the white round it.
    rim = 3 * slope + 1
    assert (ramps >= 0)[(abs(X - 30) < 17) & (abs(Y - 30) < 9) & (abs(slope * along) < 99 - rim)].all()
    assert not (ramps >= 0)[~inside].any()


@pytest.mark.parametrize("slope", [1.0, 4.0])
def test_radial_ramps(slope):
    radius = np.hypot(X - 30, Y - 30)
    ramps, count = find_ramps(prepare(picture(20 + slope * radius, radius < 25)))
    assert count == 1
    # The tip of a steep cone is no even step.
    assert (ramps >= 0)[(radius > 3) & (radius < 23)].all()


def test_ramps_that_do_not_touch_are_numbered_apart():
    inside = (abs(X - 30) > 4) & (abs(Y - 30) < 12)
    ramps, count = find_ramps(prepare(picture(60 + 2 * X, inside)))
    assert count == 2
    assert len(np.unique(ramps[30, :20])) == len(np.unique(ramps[30, 40:])) == 1


def test_flat_art_has_none():
    for image in (draw(96, 96, CARTOON), np.full((SIZE, SIZE, 4), 90, np.uint8)):
        assert find_ramps(prepare(image))[1] == 0


def test_two_colours_that_hardly_differ_are_no_ramp():
    image = picture(np.where(X > Y, 12, 14), X > 0)
    assert find_ramps(prepare(image))[1] == 0


def test_noise_is_no_ramp():
    image = np.random.RandomState(1).randint(0, 256, (SIZE, SIZE, 4)).astype(np.uint8)
    assert find_ramps(prepare(image))[1] == 0


def test_tiny_ramps_are_left_out():
    inside = (abs(X - 30) < 3) & (abs(Y - 30) < 1)
    assert np.count_nonzero(inside) <= AREA
    assert find_ramps(prepare(picture(60 + 9 * (X - 27), inside)))[1] == 0


@pytest.mark.parametrize("width", [6, 7, 8])
def test_small_steep_ramps_are_found(width):
    inside = (X > 26) & (X - width < 26) & (Y > 26) & (Y < 29)
    assert find_ramps(prepare(picture(60 + 9 * (X - 27), inside)))[1] == 1


def test_ramp_of_opacity():
    image = np.zeros((SIZE, SIZE, 4), np.uint8)
    image[..., 0] = 200
    image[..., 3] = np.clip(4 * (X - 5), 0, 255)
    ramps, count = find_ramps(prepare(image))
    assert count == 1 and (ramps >= 0)[:, 10:55].all()


def test_areas_with_the_strongest_slopes_are_marked():
    """Stripes: flat, noisy, hardly sloping, sloping."""
    level = np.full((SIZE, SIZE), 90.0)
    level[15:30] += 8 * np.random.RandomState(2).randn(15, SIZE)
    level[30:45] += 0.01 * X[30:45]
    level[45:] += 2 * X[45:]
    index = (Y // 15).astype(np.int32)
    labels = Labels(index, np.full((4, 4), 255.0), np.zeros(index.shape, bool))
    marked = mark_slopes(prepare(picture(level, Y > 0)), labels)
    assert marked.ramp.tolist() == [False, False, False, True]


def test_of_large_pictures_some_pixels_tell_the_same():
    """Stripes of a picture that is larger than is looked at: flat, sloping by too little, sloping by enough."""
    row, col = np.mgrid[:1000, :800]
    index = (row // 250).astype(np.int32)
    slope = np.choose(index, [0, 0.0005, 0.02, 0.1])
    labels = Labels(index, np.full((4, 4), 255.0), np.zeros(index.shape, bool))
    marked = mark_slopes(prepare(picture(90 + slope * col, row >= 0)), labels)
    assert marked.ramp.tolist() == [False, False, True, True]


def test_few_areas_are_marked():
    index = (Y.astype(int) // 6 * 10 + X.astype(int) // 6).astype(np.int32)
    labels = Labels(index, np.full((100, 4), 255.0), np.zeros(index.shape, bool))
    marked = mark_slopes(prepare(picture(20 + 3.5 * X, Y > 0)), labels)
    assert marked.ramp.sum() <= SLOPES


@pytest.mark.parametrize("most, stays", [(100, True), (101, False)])
def test_small_plateaus_like_a_ramp_beside_them_become_unknown(most, stays):
    image = np.full((40, 40, 4), 255, np.uint8)
    image[:, :20, :3] = np.arange(40)[:, None, None] + 100
    image[8:28, 20:25, :3] = 117
    canvas = prepare(image)
    slopes = np.full((40, 40), -1, np.int32)
    slopes[:, :20] = 0
    labels = canvas.rimmed(np.where(slopes == 0, -1, 0), -1)
    square = np.zeros((40, 40), bool)
    square[8:28, 20:25] = True
    canvas.bare(labels)[square] = 1
    absorb_pieces(canvas, labels, slopes, most)
    known = canvas.bare(labels)
    assert (known[square] == (1 if stays else -1)).mean() == 1
    assert (known[:, 20:][~square[:, 20:]] == 0).all()
