# SPDX-License-Identifier: GPL-2.0-or-later
"""Ringing: found in resized flat art alone, and taken off up to the edges."""

from __future__ import annotations

import io
from functools import lru_cache

import numpy as np
import pytest
from artwork import CARTOON, box, disc, draw, everywhere, palette_of, stroke

from ddtcore.canvas import prepare, unpack
from ddtcore.noise import ROUNDING
from ddtcore.options import TraceOptions
from ddtcore.palette import find_plateaus
from ddtcore.regions import label_pixels
from ddtcore.ringing import BEYOND, OVERSHOOTING, is_resized, is_ringing, margins, overshoots, without_ringing
from ddtcore.unsteady import ramps_under

Image = pytest.importorskip("PIL.Image")

LARGE = [(colour, lambda x, y, covers=covers: covers(x / 3, y / 3)) for colour, covers in CARTOON]
WHITE, BLACK = (255, 255, 255, 255), (0, 0, 0, 255)
DARK, SKIN, TAN = (33, 33, 33, 255), (255, 192, 128, 255), (200, 150, 110, 255)
PALE = (232, 213, 197, 255)


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


def test_faint_edges_are_edges():
    """A shade that differs by 15 levels rings by one; ripples are no ramps."""
    shade = (222, 197, 153, 255)
    drawing = [((237, 212, 168, 255), everywhere), (BLACK, disc(60, 60, 40)), (shade, disc(150, 150, 36)),
               (shade, disc(150, 50, 30)), (WHITE, disc(60, 60, 36))]
    image = resized(draw(200, 200, drawing), 0.7)
    assert rings(image)
    assert palette_of(label_pixels(image, TraceOptions())) == {colour for colour, _ in drawing}


@pytest.mark.parametrize("factor", [0.5, 0.7])
def test_faint_strokes_go_on(factor):
    """A line of half a pixel between two pale areas shows a third of its black at most."""
    pale = (194, 255, 255, 255)
    angle = 0.3
    drawing = [(pale, everywhere), (WHITE, lambda x, y: y > 100 + (x - 100) * np.tan(angle)),
               (BLACK, stroke(100, 100, angle, 0.55 / factor, 90)), (BLACK, disc(40, 160, 20))]
    image = resized(draw(200, 200, drawing), factor)
    labels = label_pixels(image, TraceOptions())
    assert palette_of(labels) == {pale, WHITE, BLACK}
    size = len(image)
    x = np.arange(round(0.2 * size), round(0.8 * size))
    y = size / 2 + (x + 0.5 - size / 2) * np.tan(angle)
    black = (labels.palette[labels.index, :3] == 0).all(axis=-1)
    near = np.stack([black[np.floor(y + step).astype(int), x] for step in (-1, 0, 1)]).any(axis=0)
    assert near.mean() > 0.97


def test_a_mix_of_others_stays_beside_its_areas():
    """Two rows of a black stroke that are nearly the dark grey of an area far away are black all the same."""
    drawing = [(WHITE, everywhere), (DARK, disc(40, 40, 30)), (BLACK, disc(150, 40, 30)),
               (BLACK, box(20, 120.4, 180, 123.6)), (BLACK, box(20, 150.4, 180, 153.6))]
    labels = label_pixels(resized(draw(200, 200, drawing), 0.5), TraceOptions())
    grey = np.argwhere(labels.palette[labels.index, 0] == DARK[0])
    assert len(grey) and grey[:, 0].max() < 40


@pytest.mark.parametrize("factor", [0.6, 0.7, 0.8])
def test_a_narrow_mix_that_rings_from_both_sides_is_one_area(factor):
    """A shine on a disc, six pixels wide, is nowhere even in the reduced picture."""
    shine = [(TAN, disc(100, 100, 80)), (PALE, lambda x, y: outline(x, y, 60, 6.5) & (x + y < 160))]
    image = resized(draw(200, 200, [(WHITE, everywhere), (BLACK, disc(100, 100, 84)), *shine]), factor)
    labels = label_pixels(image, TraceOptions())
    near = np.abs(labels.palette[:, :3] - PALE[:3]).max(axis=1) <= 8
    y, x = (np.mgrid[:image.shape[0], :image.shape[1]] + 0.5) / factor
    inside, away = outline(x, y, 60, 3) & (x + y < 150), outline(x, y, 60, 12) | (x + y > 180)
    assert near.any() and near[labels.index[inside]].mean() > 0.9 and not near[labels.index[~away]].any()


def test_transparent_art():
    image = resized(draw(240, 240, LARGE), 0.5)
    image[image[..., 0] > 250] = 0
    assert settled(image).shape == image.shape


@lru_cache(maxsize=None)
def shaded(height=300, width=360):
    """A disc with an outline and a slope of colour in it, and a bar with a slope that is a few pixels wide."""
    image = draw(height, width, [(WHITE, everywhere), (BLACK, disc(150, 150, 120)), (TAN, disc(150, 150, 112)),
                                 (BLACK, disc(120, 120, 20)), (BLACK, box(300, 40, 330, 260)),
                                 (TAN, box(304, 44, 326, 256))])
    share = np.clip(image[..., :3] / np.array(TAN[:3], float), 0, 1).min(axis=-1, keepdims=True)
    share = share * (image[..., 2:3] < 160)
    down = np.linspace(-60, 40, height)[:, None, None] * (1, 0.8, 0.7)
    image[..., :3] = np.rint((image[..., :3] + share * down).clip(0, 255))
    return image


def overshooting(image):
    canvas = prepare(image)
    return overshoots(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)).core)


@pytest.mark.parametrize("factor", [0.5, 0.7, 1.5])
def test_edges_of_shaded_art_overshoot_when_it_was_resized_only(factor):
    assert overshooting(shaded()) < OVERSHOOTING / 2
    assert overshooting(shaded()[::2, ::2]) < OVERSHOOTING / 2
    assert overshooting(resized(shaded(), factor)) > OVERSHOOTING
    assert overshooting(np.full((20, 30, 4), 255, np.uint8)) == 0


def test_ripples_of_a_jpeg_are_no_resizing():
    image = draw(240, 240, LARGE)
    file = io.BytesIO()
    Image.fromarray(image[..., :3]).save(file, "JPEG", quality=50)
    jpeg = np.asarray(Image.open(file).convert("RGBA"))
    for picture, wanted in ((image, False), (resized(image, 0.7), True), (jpeg, False)):
        canvas = prepare(picture)
        assert is_resized(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)).core) == wanted


def test_clipped_channels_do_not_tell():
    # Red and blue are at their ends on both sides.
    orange, black = (255, 127, 0, 255), (0, 0, 0, 255)
    discs = [(orange, everywhere), (black, disc(120, 120, 80)), (orange, disc(120, 120, 60))]
    image = resized(draw(240, 240, discs), 0.7)
    assert np.unique(image[..., 0]).max() == 255 and overshooting(image) > 2 * OVERSHOOTING


def test_thin_strokes_are_no_ripples():
    # Light gaps beside dark strokes on a middle tone look like edges that overshoot.
    rings = [(TAN, everywhere)]
    for radius in range(100, 20, -10):
        rings += [(WHITE, disc(110, 110, radius)), (TAN, disc(110, 110, radius - 0.12)),
                  (BLACK, disc(110, 110, radius - 1)), (TAN, disc(110, 110, radius - 4))]
    canvas = prepare(draw(220, 220, rings))
    core = find_plateaus(canvas, np.zeros(canvas.shape, bool)).core
    assert overshoots(canvas, core) > OVERSHOOTING and not is_resized(canvas, core)


def test_a_drawn_rim_is_no_overshoot():
    image = draw(240, 240, [(TAN, everywhere), ((250, 230, 190, 255), disc(120, 120, 82)), (BLACK, disc(120, 120, 80)),
                            (TAN, disc(120, 120, 60))])
    assert overshooting(image) < OVERSHOOTING / 2


def test_halos_beside_one_plateau_are_no_colour_that_lies_nearer():
    grey = (229, 229, 229, 255)
    discs = [(WHITE, everywhere), (BLACK, disc(150, 150, 120)), (grey, disc(150, 150, 112))]
    image = resized(draw(300, 300, discs), 0.5)
    labels = label_pixels(image, TraceOptions())
    row, col = np.mgrid[:150, :150] + 0.5
    inside = np.hypot(row - 75, col - 75) < 54
    white = np.flatnonzero((np.rint(labels.palette) == WHITE).all(axis=1))
    assert not np.isin(labels.index[inside], white).any()



@pytest.mark.parametrize("factor", [0.5, 0.7])
def test_ramps_reach_up_to_the_edges(factor):
    canvas = prepare(resized(shaded(), factor))
    slopes, surfaces = ramps_under(canvas, margins(canvas))
    small, _ = without_ringing(canvas, slopes, surfaces)
    y, x = (np.mgrid[:canvas.shape[0], :canvas.shape[1]] + 0.5) / factor
    beside = (np.hypot(x - 150, y - 150) > 104) & (np.hypot(x - 150, y - 150) < 112 - 1.3 / factor)
    expected = np.array(TAN[:3]) + (-60 + 100 * y[..., None] / 299) * (1, 0.8, 0.7)
    off, before = (np.abs(unpack(canvas.bare(some.keys))[..., :3] - expected).max(axis=-1)[beside]
                   for some in (small, canvas))
    assert np.mean(off <= 3) > 0.97
    assert np.mean(before <= 3) < 0.95


@pytest.mark.parametrize("factor", [0.5, 0.7])
def test_reduced_shaded_art_has_no_more_regions(factor):
    labels = label_pixels(resized(shaded(), factor), TraceOptions())
    assert palette_of(labels) >= {WHITE, BLACK}
    # The disc and the bar may have a gradient each.
    assert len(labels.palette) == 2 + np.count_nonzero(labels.ramp) <= 4


def test_faint_shades_on_ramps_stay():
    image = resized(shaded(), 0.5)
    image[40:60, 70:100, :3] = np.rint(image[40:60, 70:100, :3] * 0.95)
    index = label_pixels(image, TraceOptions()).index
    assert (index[42:58, 72:98] == index[50, 80]).all() and index[50, 80] != index[100, 60]


def test_strokes_on_ramps_ring_and_have_their_ink_and_no_rims():
    image = shaded().copy()
    lines = draw(300, 360, [(BLACK, everywhere), (WHITE, stroke(150, 200, 0.02, 2.4, 70)),
                            (WHITE, stroke(150, 90, 1.4, 2.4, 40))])[..., :1] / 255.0
    image[..., :3] = np.rint(image[..., :3] * (1 - lines) + lines * (160, 0, 0))
    labels = label_pixels(resized(image, 0.7), TraceOptions())
    assert np.count_nonzero(labels.ramp) <= 2
    ink = int(np.abs(labels.palette[:, :3] - (160, 0, 0)).max(axis=1).argmin())
    assert np.abs(labels.palette[ink, :3] - (160, 0, 0)).max() <= 16 and not labels.ramp[ink]
