# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures whose colours were reduced with dithering: dots become the colour they stand for, and nothing else does."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere, stroke
from PIL import Image

from ddtcore import trace
from ddtcore.canvas import prepare, unpack
from ddtcore.dither import LEFT, STRONGEST, undithered
from ddtcore.palette import find_plateaus

PAPER, INK = (255, 255, 255, 255), (0, 0, 0, 255)
PALETTE = [(255, 255, 255), (225, 225, 225), (0, 0, 0), (60, 140, 200), (230, 200, 40)]
LOST = [(145, 170, 120), (110, 155, 160), (190, 185, 80), (90, 105, 70)]
"""Mixes of two or three colours of the palette."""


def page(lost=LOST[0]):
    """A disc of a colour that gets lost, with an outline, and thin strokes beside it."""
    return draw(160, 240, [(PAPER, everywhere), (INK, disc(80, 80, 60)), ((*lost, 255), disc(80, 80, 54)),
                           (INK, stroke(190, 80, 0.7, 3, 70)), (INK, stroke(210, 80, -0.7, 1.6, 70))])


def sky(height=200, width=260):
    """A ramp with a disc and a stroke on it."""
    image = draw(height, width, [((60, 120, 220, 255), everywhere), (INK, disc(80, 110, 40)),
                                 (PAPER, disc(80, 110, 34)), (INK, stroke(190, 100, 0.3, 5, 60))])
    rgb = image[..., :3].astype(float)
    blue = (image[..., 2].astype(int) - image[..., 0])[..., None] / 160
    image[..., :3] = np.rint((rgb + blue * (np.arange(height)[:, None, None] * (0.6, 0.4, 0.1))).clip(0, 255))
    return image


def reduced(image, colours):
    """A picture in some colours, with the dots of Floyd and Steinberg."""
    rgb = Image.fromarray(image[..., :3])
    if isinstance(colours, int):
        palette = rgb.quantize(colours)
    else:
        palette = Image.new("P", (1, 1))
        palette.putpalette(np.resize(colours, (256, 3)).astype(np.uint8).tobytes())
    return np.array(rgb.quantize(palette=palette, dither=1).convert("RGBA"))


def found(image):
    canvas = prepare(image)
    out = undithered(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)).core)
    return None if out is None else (unpack(canvas.bare(out[0].keys)).astype(int), canvas.bare(out[1]))


@pytest.mark.parametrize("lost", LOST)
def test_dots_become_the_colour_they_stand_for(lost):
    clean, spoiled = page(lost).astype(int), reduced(page(lost), PALETTE)
    image, dots = found(spoiled)
    inside = disc(80, 80, 48)(*np.meshgrid(np.arange(240) + 0.5, np.arange(160) + 0.5))
    off = np.abs(image - clean)[inside, :3].max(axis=-1)
    assert np.median(off) <= LEFT and np.percentile(off, 90) <= STRONGEST
    assert np.median(dots[inside]) >= 40
    # No single pixel was near that colour.
    assert np.abs(spoiled.astype(int) - clean)[inside, :3].max(axis=-1).min() >= 40


def test_edges_and_strokes_beside_dots_stay():
    spoiled = reduced(page(), PALETTE)
    image, dots = found(spoiled)
    np.testing.assert_array_equal(image[:, 160:], spoiled[:, 160:])
    assert not dots[:, 165:].any()
    ink = (spoiled[..., :3] == 0).all(axis=-1) & ~disc(80, 80, 55)(
        *np.meshgrid(np.arange(240) + 0.5, np.arange(160) + 0.5))
    assert np.mean(image[ink, :3].max(axis=-1) < 40) > 0.95


@pytest.mark.parametrize("colours", [16, 32, 64])
def test_ramps_are_smooth_again(colours):
    clean = sky().astype(int)
    spoiled = reduced(sky(), colours)
    image, _ = found(spoiled)
    before, after = (np.abs(some - clean)[..., :3].mean() for some in (spoiled, image))
    assert after < 0.8 * before


@pytest.mark.parametrize("image", [page(), sky(), draw(120, 120, CARTOON), reduced(draw(120, 120, CARTOON), 32),
                                   reduced(page(), [PALETTE[0], *PALETTE[2:]])])
def test_what_has_no_dots_is_left_alone(image):
    assert found(image) is None


def test_transparent_pixels_are_no_part_of_a_mixture():
    image = reduced(page(), PALETTE)
    image[:, :80] = 0
    after, _ = found(image)
    assert set(np.unique(after[..., 3])) == {0, 255}
    np.testing.assert_array_equal(after[..., 3], image[..., 3])


@pytest.mark.parametrize("seed", range(4))
def test_any_pattern_keeps_its_range_and_its_mean(seed):
    random = np.random.RandomState(seed)
    image = np.full((random.randint(1, 40), random.randint(1, 40), 4), 255, np.uint8)
    image[..., :3] = random.choice(256, (random.randint(1, 9), 3))[random.randint(0, 1, image.shape[:2])]
    image[random.rand(*image.shape[:2]) < 0.3, :3] = random.choice(256, 3)
    out = found(image)
    if out is not None:
        low, high = image.reshape(-1, 4).min(axis=0), image.reshape(-1, 4).max(axis=0)
        assert (out[0] >= low).all() and (out[0] <= high).all()


@pytest.mark.parametrize("lost", LOST)
def test_a_lost_colour_is_one_shape_again(lost):
    drawing = trace(reduced(page(lost), PALETTE))
    assert len(drawing.shapes) == len(trace(page(lost)).shapes)
    assert sum(np.abs(np.subtract(shape.rgb, lost)).max() <= LEFT for shape in drawing.shapes) == 1


@pytest.mark.parametrize("colours", [16, 32, 64])
def test_a_ramp_is_one_gradient_again(colours):
    clean, drawing = trace(sky()), trace(reduced(sky(), colours))
    assert sum(shape.gradient is not None for shape in drawing.shapes) >= 1
    assert len(drawing.shapes) <= 1.5 * len(clean.shapes) + 1
