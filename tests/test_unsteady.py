# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures with soft ramps that were saved as JPEG or scanned: a ramp stays one, and clean ones are left alone."""

from __future__ import annotations

import io

import numpy as np
import pytest
from artwork import disc, draw, everywhere, stroke
from PIL import Image

from ddtcore import trace
from ddtcore.canvas import prepare, unpack
from ddtcore.noise import UNSTEADY, ripple_level, zigzags
from ddtcore.options import TraceOptions
from ddtcore.palette import find_plateaus
from ddtcore.regions import label_pixels
from ddtcore.unsteady import SLOPING, find_soft, without_hue_twins

PAPER, INK, SKIN = (255, 255, 255, 255), (0, 0, 0, 255), (200, 120, 40, 255)


def balloon(height=240, width=300, by=40):
    """A disc with a thick outline, a ramp in it, and strokes on and beside it."""
    image = draw(height, width, [(PAPER, everywhere), (INK, disc(150, 120, 90)), (SKIN, disc(150, 120, 78)),
                                 (INK, disc(120, 100, 14)), (INK, stroke(150, 170, 0.2, 5, 40))])
    rgb = image[..., :3].astype(float)
    across = np.linspace(-by, by, width)[None, :, None] * (1, 0.8, 0.6)
    share = np.clip(rgb / SKIN[:3], 0, 1).min(axis=-1, keepdims=True) * (rgb[..., 2:] < 128)
    image[..., :3] = np.rint((rgb + share * across).clip(0, 255))
    return image


def saved(image, quality):
    buffer = io.BytesIO()
    Image.fromarray(image[..., :3]).save(buffer, "JPEG", quality=quality)
    return np.array(Image.open(buffer).convert("RGBA"))


def scanned(image, grain, seed=1):
    out = image.copy()
    out[..., :3] = np.rint((image[..., :3] + np.random.RandomState(seed).normal(0, grain, image[..., :3].shape))
                           .clip(0, 255))
    return out


def dithered(image, colours):
    rgb = Image.fromarray(image[..., :3])
    return np.array(rgb.quantize(palette=rgb.quantize(colours), dither=1).convert("RGBA"))


SPOILED = {"q90": lambda image: saved(image, 90), "q75": lambda image: saved(image, 75),
           "q50": lambda image: saved(image, 50), "scan": lambda image: scanned(image, 3),
           "gif": lambda image: dithered(image, 12)}


def soft_of(image):
    canvas = prepare(image)
    core = find_plateaus(canvas, np.zeros(canvas.shape, bool)).core
    return find_soft(canvas, ripple_level(canvas, core))


@pytest.mark.parametrize("kind", SPOILED)
def test_zigzags_tell_spoiled_pictures_from_clean_ones(kind):
    assert zigzags(prepare(balloon()), 4) < UNSTEADY / 2
    assert zigzags(prepare(SPOILED[kind](balloon())), 4) > UNSTEADY


def test_faint_strokes_with_a_light_and_a_dark_side_are_no_ripples():
    sides = ((210, 130, 50, 255), 0.5), ((185, 105, 25, 255), -0.5)
    image = draw(240, 300, [(SKIN, everywhere), *[(colour, stroke(150, y + side, 0.03, 1, 120))
                                                  for y in (60, 70, 82, 100, 160, 172) for colour, side in sides]])
    assert zigzags(prepare(image), 3) > 10 * UNSTEADY
    assert zigzags(prepare(image), 4) < UNSTEADY / 2


def test_clean_pictures_have_nothing_to_be_calmed():
    assert soft_of(balloon()) is None


@pytest.mark.parametrize("kind", SPOILED)
def test_a_ramp_stays_one(kind):
    soft = soft_of(SPOILED[kind](balloon()))
    assert len(soft.surfaces) == 1
    y, x = np.mgrid[:240, :300]
    clear = disc(150, 120, 74)(x, y) & ~disc(120, 100, 18)(x, y) & ~stroke(150, 170, 0.2, 13, 44)(x, y)
    assert (soft.slopes[clear] == 0).mean() > 0.975
    row, col = np.nonzero(clear)
    off = soft.surfaces[0].colours(np.stack([col, row], axis=1) + 0.5) - balloon()[row, col, :3]
    assert np.abs(off).mean() < 3


@pytest.mark.parametrize("kind", SPOILED)
def test_flat_art_has_no_ramps(kind):
    assert soft_of(SPOILED[kind](balloon(by=0))) is None


@pytest.mark.parametrize("kind", SPOILED)
def test_a_spoiled_picture_has_hardly_more_shapes(kind):
    spoiled, clean = (trace(image).shapes for image in (SPOILED[kind](balloon()), balloon()))
    assert len(spoiled) <= 1.5 * len(clean)
    assert sum(shape.gradient is not None for shape in spoiled) >= 1


@pytest.mark.parametrize("kind", SPOILED)
def test_labels_are_those_of_the_clean_picture(kind):
    spoiled, clean = (label_pixels(image, TraceOptions()) for image in (SPOILED[kind](balloon()), balloon()))
    assert spoiled.ramp.sum() == 1
    assert (spoiled.ramp[spoiled.index] != clean.ramp[clean.index]).mean() < 0.01


@pytest.mark.parametrize("kind", SPOILED)
def test_a_channel_that_is_nowhere_used_stays_so(kind):
    image = balloon()
    image[..., 2] = np.where(image[..., 2] == 255, 255, 0)
    for surface in soft_of(SPOILED[kind](image)).surfaces:
        assert [rgb[2] for _, rgb, _ in surface.gradient.stops] == [0] * len(surface.gradient.stops)


def test_ripples_of_a_jpeg_are_strongest_beside_edges_and_a_grain_is_so_everywhere():
    jpeg, scan = (prepare(image) for image in (SPOILED["q75"](balloon()), SPOILED["scan"](balloon())))
    doubt = jpeg.bare(soft_of(SPOILED["q75"](balloon())).doubt)
    assert doubt[:20, :20].max() == doubt.min() < 0.5 * doubt[28:34, 148:152].min()
    assert np.ptp(scan.bare(soft_of(SPOILED["scan"](balloon())).doubt)) == 0


@pytest.mark.parametrize("kind", SPOILED)
def test_a_ramp_counts_in_a_picture_that_is_flat_elsewhere(kind):
    image = np.pad(balloon(), [(20, 120), (20, 220), (0, 0)], mode="edge")
    assert len(soft_of(SPOILED[kind](image)).surfaces) == 1


@pytest.mark.parametrize("kind", ["q90", "q75", "q50", "scan"])
def test_a_single_small_ramp_counts_if_it_is_sure(kind):
    small = draw(100, 100, [(PAPER, everywhere), (INK, disc(50, 50, 44)), (SKIN, disc(50, 50, 38))])
    ball = disc(50, 50, 35)(*np.mgrid[:100, :100][::-1])
    small[ball, :3] = np.clip(150 + 1.6 * (np.nonzero(ball)[0] - 50), 0, 255)[:, None] * (1, 0.7, 0.5)
    small, ball = (np.pad(some, [(200, 100), (100, 200), (0, 0)][:some.ndim], mode="edge") for some in (small, ball))
    assert ball.sum() < SLOPING * ball.size
    soft = soft_of(SPOILED[kind](small))
    assert (soft.slopes[ball] >= 0).mean() > 0.9
    assert (soft.slopes[:200] < 0).all() and len(soft.surfaces) <= 3


def shadow(height=240, width=300):
    """A disc whose shadow fades into the paper."""
    y, x = np.mgrid[:height, :width] + 0.5
    dark = np.clip(1.2 - np.hypot((x - 150) / 120, (y - 180) / 45), 0, 1)
    image = draw(height, width, [(PAPER, everywhere), (SKIN, disc(150, 110, 70))])
    paper = (image[..., :3] == 255).all(axis=-1)
    image[paper, :3] = np.rint(255 - 120 * dark[paper])[:, None]
    return image


@pytest.mark.parametrize("kind", ["q75", "q50", "scan"])
def test_what_fades_into_a_flat_area_is_a_ramp_and_the_flat_area_none(kind):
    image = np.concatenate([shadow(), balloon()], axis=1)
    image = np.pad(image, [(60, 60), (60, 60), (0, 0)], mode="edge")
    soft = soft_of(SPOILED[kind](image))
    assert len(soft.surfaces) in (2, 3)
    level = image[..., :3].astype(int)
    grey = (level[..., 0] > 150) & (level[..., 0] < 240) & (np.ptp(level, axis=-1) == 0)
    assert (soft.slopes[grey] >= 0).mean() > 0.8
    assert (soft.slopes[-50:] < 0).all()


@pytest.mark.parametrize("apart, blue, one", [(3, 145, True), (40, 145, False), (3, 200, False)])
def test_hues_of_equal_brightness_are_one_colour_where_they_lie_among_each_other(apart, blue, one):
    first, second = (41, 72, 118, 255), (34 - (blue > 145) * 15, 71 - (blue > 145) * 4, blue, 255)
    stripes = [((PAPER, first, second)[k], lambda x, y, k=k: abs(y - 60 - k * apart % 80) < 2) for k in (1, 2)]
    canvas = prepare(draw(200, 90, [(PAPER, everywhere), *stripes]))
    plateaus = find_plateaus(canvas, np.zeros(canvas.shape, bool))
    keys = np.array([PAPER, first, second], np.uint8).view(np.uint32)[:, 0]
    left = unpack(without_hue_twins(canvas, plateaus, keys, 15.0))
    assert len(left) == (2 if one else 3)
    assert left[0].tolist() == list(PAPER)
    assert np.abs(left[1:, :3].mean(axis=0) - np.mean([first, second], axis=0)[:3]).max() < 4
