# SPDX-License-Identifier: GPL-2.0-or-later
"""Ringing: found in resized flat art alone, and taken off up to the edges."""

from __future__ import annotations

import io

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere, palette_of

from ddtcore.canvas import prepare, unpack
from ddtcore.noise import ROUNDING
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels
from ddtcore.ringing import BEYOND, is_ringing, without_ringing

Image = pytest.importorskip("PIL.Image")

LARGE = [(colour, lambda x, y, covers=covers: covers(x / 3, y / 3)) for colour, covers in CARTOON]
WHITE, BLACK = (255, 255, 255, 255), (0, 0, 0, 255)
DARK, SKIN = (33, 33, 33, 255), (255, 192, 128, 255)


def outline(x, y, radius, width):
    return np.abs(np.hypot(x - 100, y - 100) - radius) < width / 2


DRAWING = [(WHITE, everywhere), (SKIN, disc(100, 100, 60)), (DARK, disc(40, 40, 25)),
           (BLACK, lambda x, y: outline(x, y, 60, 3.4)), (BLACK, lambda x, y: outline(x, y, 30, 3.4))]


def resized(image, factor, kernel=None):
    size = tuple(round(side * factor) for side in image.shape[1::-1])
    kernel = Image.LANCZOS if kernel is None else kernel
    return np.array(Image.fromarray(image).convert("RGB").resize(size, kernel).convert("RGBA"))


def jpeg(image, quality):
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "JPEG", quality=quality)
    return np.array(Image.open(file).convert("RGBA"))


def rings(image):
    return is_ringing(prepare(image))


def is_flat(image):
    colours = np.array([colour for colour, _ in LARGE], np.uint8)
    return (image[..., None, :] == colours).all(axis=-1).any(axis=-1)


def settled(image):
    canvas, _ = without_ringing(prepare(image))
    return unpack(canvas.bare(canvas.keys))


@pytest.mark.parametrize(("factor", "kernel"), [(0.5, "LANCZOS"), (0.7, "LANCZOS"), (1.5, "BICUBIC")])
def test_resized_art_rings_and_jpeg_does_not(factor, kernel):
    image = draw(240, 240, LARGE)
    small = resized(image, factor, getattr(Image, kernel))
    assert rings(small)
    assert not rings(jpeg(image, 90))
    assert not rings(jpeg(small, 75))
    assert not rings(np.full((20, 30, 4), 255, np.uint8))


@pytest.mark.parametrize("kernel", ["LANCZOS", "BICUBIC"])
def test_colours_reach_up_to_the_edges(kernel):
    image = resized(draw(240, 240, LARGE), 0.5, getattr(Image, kernel))
    flat, even = is_flat(image), settled(image)
    assert (even[flat] == image[flat]).all()
    # What is left is mixes.
    assert np.count_nonzero(~is_flat(even)) < 0.7 * np.count_nonzero(~flat)
    assert np.abs(even.astype(int) - image).max() <= BEYOND * 255 + ROUNDING


def test_clean_art_stays():
    image = draw(240, 240, LARGE)
    changed = (settled(image) != image).any(axis=-1)
    assert changed.mean() < 0.02 and not (changed & is_flat(image)).any()


def test_thin_black_outlines_stay_black_beside_a_dark_grey():
    image = resized(draw(200, 200, DRAWING), 0.5)
    labels = label_pixels(image, TraceOptions())
    assert palette_of(labels) == {WHITE, SKIN, DARK, BLACK}
    y, x = np.mgrid[:100, :100] + 0.5
    ring = np.abs(np.hypot(x - 50, y - 50) - 30) < 0.4
    assert (labels.palette[labels.index[ring], :3] == 0).all(axis=-1).mean() > 0.98


def test_a_dark_grey_does_not_ring_as_far_as_black():
    drawing = [(WHITE, everywhere), (DARK, disc(60, 60, 50)),
               (DARK, lambda x, y: outline(x, y, 80, 4))]
    labels = label_pixels(resized(draw(200, 200, drawing), 0.5), TraceOptions())
    assert palette_of(labels) == {WHITE, DARK}


def test_transparent_art():
    image = resized(draw(240, 240, LARGE), 0.5)
    image[image[..., 0] > 250] = 0
    assert settled(image).shape == image.shape
