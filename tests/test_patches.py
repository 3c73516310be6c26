# SPDX-License-Identifier: GPL-2.0-or-later
"""Narrow areas in pictures with noise have their colour, and edges, strokes and ramps give none."""

from __future__ import annotations

import io
from functools import lru_cache

import numpy as np
import pytest
from artwork import box, disc, draw, everywhere, stroke
from PIL import Image, ImageFilter

from ddtcore.canvas import planes, prepare, unpack
from ddtcore.options import TraceOptions
from ddtcore.patches import NOISE, OFF, find_patches
from ddtcore.regions import label_pixels

PAPER, INK, BALL = (255, 255, 255, 255), (0, 0, 0, 255), (0, 160, 40, 255)
SHINE, SHADE = (140, 214, 159, 255), (0, 96, 24, 255)
FLAT = [(PAPER, everywhere), (INK, disc(150, 120, 92)), (BALL, disc(150, 120, 89))]


def crescent(x, y, radius, width, side):
    """What a disc leaves of another one, at its left or right."""
    whole, rest = disc(x, y, radius), disc(x + side * width, y, radius)
    return lambda across, down: whole(across, down) & ~rest(across, down) & (np.abs(down - y) < radius / 2)


@lru_cache(maxsize=None)
def drawn(*layers):
    """A disc with an outline, and layers on it."""
    return draw(240, 300, [*FLAT, *layers])


def ball():
    """The same with a translucent shine and a translucent shade, both flat."""
    return drawn((SHINE, LEFT), (SHADE, RIGHT))


LEFT, RIGHT = crescent(150, 120, 76, 7, 1), crescent(150, 120, 84, 7, -1)
LINES = [(INK, stroke(150, 120, angle, width, 60)) for angle, width in ((0.2, 1.5), (0.9, 2.2), (2, 3.1))]
GAP = PAPER, box(40, 20.5, 42.5, 200.3)


def saved(image, quality):
    buffer = io.BytesIO()
    Image.fromarray(image[..., :3]).save(buffer, "JPEG", quality=quality)
    return np.array(Image.open(buffer).convert("RGBA"))


def scanned(image, seed=1):
    blurred = np.array(Image.fromarray(image[..., :3]).filter(ImageFilter.GaussianBlur(0.7)), float)
    blurred += np.random.RandomState(seed).normal(0, 3, blurred.shape)
    return np.dstack([np.rint(blurred).clip(0, 255).astype(np.uint8), image[..., 3]])


def reduced(image, factor=0.7):
    height, width = (round(size * factor) for size in image.shape[:2])
    return np.array(Image.fromarray(image).resize((width, height), Image.LANCZOS))


SPOILED = {"q75": (lambda image: saved(image, 75), 20), "q50": (lambda image: saved(image, 50), 24),
           "scan": (scanned, 20), "reduced": (reduced, 16)}


def packed(*colours):
    return np.array(colours, np.uint8).view(np.uint32)[:, 0]


def found(image, noise, *known):
    canvas = prepare(image)
    return canvas, find_patches(canvas, packed(*known), noise, np.ones(canvas.shape, bool))


@pytest.mark.parametrize("kind", SPOILED)
def test_mixes_that_fill_narrow_areas_are_found(kind):
    spoil, noise = SPOILED[kind]
    canvas, patches = found(spoil(ball()), noise, PAPER, BALL, INK)
    colours = unpack(patches.keys)[:, :3].astype(int)
    assert len(colours) == 2
    for true in (SHINE, SHADE):
        assert np.abs(colours - true[:3]).max(axis=1).min() <= noise / 2
    off = canvas.colours(patches.cells) - planes(patches.keys, True)[:, patches.number]
    assert np.mean(np.abs(off).max(axis=0) <= noise) > 0.7


@pytest.mark.parametrize("kind", SPOILED)
def test_edges_strokes_and_known_colours_are_no_areas(kind):
    spoil, noise = SPOILED[kind]
    assert not found(spoil(drawn(*LINES, GAP)), noise, PAPER, BALL, INK)[1].keys.size


@pytest.mark.parametrize("kind", SPOILED)
def test_ramps_are_no_areas(kind):
    spoil, noise = SPOILED[kind]
    image = drawn().copy()
    image[100:112, 100:190, :3] = np.linspace(40, 230, 90)[None, :, None]
    assert not found(spoil(image), noise, PAPER, BALL, INK)[1].keys.size


def test_a_hue_that_was_moved_is_no_colour():
    image = drawn().copy()
    image[110:116, 120:160] = (20, 146, 60, 255)
    assert not found(image, 20, PAPER, BALL, INK)[1].keys.size
    image[110:116, 120:160] = (40, 200, 80, 255)
    assert found(image, 20, PAPER, BALL, INK)[1].keys.size == 1


def test_what_is_nearly_black_is_black():
    image = drawn().copy()
    image[110:116, 120:180] = (12, 14, 10, 255)
    assert (found(image, NOISE, PAPER, BALL)[1].keys == packed(INK)).all()


def test_nothing_known_nothing_found():
    canvas = prepare(ball())
    patches = find_patches(canvas, np.zeros(0, np.uint32), NOISE, np.ones(canvas.shape, bool))
    assert patches.keys.size == patches.cells.size == patches.number.size == 0


@pytest.mark.parametrize("kind", SPOILED)
def test_labels_of_spoiled_pictures_have_them(kind):
    colours = label_pixels(SPOILED[kind][0](ball()), TraceOptions()).palette[:, :3]
    for true in (SHINE, SHADE):
        assert np.abs(colours - true[:3]).max(axis=1).min() <= OFF / 2
