# SPDX-License-Identifier: GPL-2.0-or-later
"""Blurred edges are measured, and made sharp again."""

from __future__ import annotations

import numpy as np
import pytest
from pictures import BLACK, disc, picture, rectangle, star

from ddtcore.unblur import LEAST, blur_width, unblur

ImageFilter = pytest.importorskip("PIL.ImageFilter")
Image = pytest.importorskip("PIL.Image")

DRAWN = {
    "turned": picture(120, 100, [rectangle((40, 45), 44, 50, 17), star((90, 60), 22, 22, 3)]),
    "round": picture(120, 100, [disc((40, 45), 27.3), disc((92, 62), 18.8)]),
    "upright": picture(120, 100, [rectangle((40.3, 45.6), 44, 50), rectangle((92.7, 62.1), 21, 33)]),
    "soft": picture(120, 100, [disc((40, 45), 27.3), disc((92, 62), 18.8)], ((0, 0, 0, 0), BLACK, BLACK)),
}


def blurred(image, width):
    bands = Image.fromarray(image).convert("RGBa").filter(ImageFilter.GaussianBlur(width))
    return np.array(bands.convert("RGBA"))


@pytest.mark.parametrize("name", DRAWN)
def test_sharp_pictures_are_left_alone(name):
    drawn = DRAWN[name]
    assert blur_width(drawn.image, drawn.labels) < 0.35
    assert unblur(drawn.image, drawn.labels) is drawn.image
    crisp = np.rint(drawn.labels.palette).astype(np.uint8)[drawn.labels.index]
    assert blur_width(crisp, drawn.labels) == 0


@pytest.mark.parametrize("width", [0.7, 1.0])
@pytest.mark.parametrize("name", DRAWN)
def test_blur_is_measured_and_most_of_it_undone(name, width):
    drawn = DRAWN[name]
    spoiled = blurred(drawn.image, width)
    assert abs(blur_width(spoiled, drawn.labels) - width) < 0.15
    sharp = unblur(spoiled, drawn.labels)
    left, before = (np.abs(image.astype(int) - drawn.image).mean() for image in (sharp, spoiled))
    assert left < 0.6 * before
    assert blur_width(sharp, drawn.labels) < max(LEAST, 0.7 * width)


def test_nothing_is_known_without_edges():
    flat = picture(30, 20, [rectangle((10, 10), 3, 3)])
    assert blur_width(blurred(flat.image, 1), flat.labels) == 0
    tiny = picture(3, 3, [rectangle((1, 1), 1, 3)])
    assert unblur(tiny.image, tiny.labels) is tiny.image


def test_noise_does_not_look_like_blur():
    drawn = DRAWN["turned"]
    noisy = drawn.image.astype(int) + np.rint(np.random.RandomState(1).randn(*drawn.image.shape) * 3).astype(int)
    noisy[..., 3] = 255
    assert blur_width(noisy.clip(0, 255).astype(np.uint8), drawn.labels) < 0.35
