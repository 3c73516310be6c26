# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art from a JPEG: hue goes back to where it bled from."""

from __future__ import annotations

import io

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere, palette_of

from ddtcore import trace
from ddtcore.bleeding import TILE, without_bleeding
from ddtcore.canvas import prepare, unpack
from ddtcore.growing import Surface
from ddtcore.noise import noisy_colours
from ddtcore.options import TraceOptions
from ddtcore.palette import find_plateaus
from ddtcore.regions import label_pixels

Image = pytest.importorskip("PIL.Image")

LARGE = [(colour, lambda x, y, covers=covers: covers(x / 2, y / 2)) for colour, covers in CARTOON]
WHITE, BLACK, RED, TAN = (255, 255, 255, 255), (0, 0, 0, 255), (207, 52, 26, 255), (176, 114, 46, 255)
BLUE, YELLOW = (0, 51, 217, 255), (255, 217, 0, 255)
NOISE = 20.0


def jpeg(image, quality, subsampling=2):
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "JPEG", quality=quality, subsampling=subsampling)
    return np.array(Image.open(file).convert("RGBA"))


def stripes(paint, ground, width, height=160):
    """Slanting stripes, which meet no grid."""
    return draw(height, 160, [(ground, everywhere), (paint, lambda x, y: (y + x / 7) % (2.6 * width) < width)])


def cleared(image, colours):
    keys = np.array(sorted(colours), np.uint8).view(np.uint32)[:, 0]
    canvas = without_bleeding(prepare(image), keys, NOISE)
    return unpack(canvas.bare(canvas.keys))


def error(image, clean):
    return np.sqrt(np.square(image.astype(float) - clean).mean())


@pytest.mark.parametrize("quality", [85, 75, 50])
@pytest.mark.parametrize("colours", [(RED, BLACK), (BLUE, YELLOW), (RED, WHITE), (TAN, RED)])
def test_thin_stripes_get_their_hue_back(quality, colours):
    clean = stripes(*colours, 2.5)
    spoilt = jpeg(clean, quality)
    assert error(cleared(spoilt, {*colours, WHITE}), clean) < 0.75 * error(spoilt, clean)


@pytest.mark.parametrize("quality", [85, 75, 50])
def test_outlines_between_two_areas_take_no_colour_of_others(quality):
    """They mix three colours, one of which no pixel has in full; mixes with one that is met elsewhere come near."""
    sky, brown = (194, 255, 255, 255), (213, 151, 88, 255)
    clean = draw(160, 256, [(WHITE, everywhere), (sky, lambda x, y: y + x / 3 < 90),
                            (BLACK, lambda x, y: abs(y + x / 3 - 90) < 0.4), (BLACK, disc(135, 20, 12)),
                            (brown, disc(135, 60, 12))])
    keys = np.array([WHITE, sky, BLACK, brown], np.uint8).view(np.uint32)[:, 0]
    canvas = without_bleeding(prepare(jpeg(clean, quality)), keys, 14.0)
    found = unpack(canvas.bare(canvas.keys))[:, :84].astype(int)
    # Nothing there is red rather than blue.
    assert (found[..., 0] - found[..., 2]).max() < 32


@pytest.mark.parametrize("subsampling", [0, 1, 2])
@pytest.mark.parametrize("quality", [75, 50])
def test_pictures_are_nearer_to_what_they_were_however_hue_was_kept(subsampling, quality):
    clean = draw(192, 192, LARGE)
    spoilt = jpeg(clean, quality, subsampling)
    assert error(cleared(spoilt, palette_of(label_pixels(clean, TraceOptions()))), clean) < 0.8 * error(spoilt, clean)


@pytest.mark.parametrize("quality", [75, 50])
def test_hue_goes_back_to_ramps_too(quality):
    """The same stripes, redder from left to right: their colours are those of a surface."""
    def shade(at):
        return np.asarray(RED[:3]) + (at[:, :1] / 160 - 0.5) * (80, 40, 20)

    y, x = np.mgrid[:160, :160] + 0.5
    share = stripes(RED, BLACK, 6)[..., :1] / RED[0]
    clean = np.full((160, 160, 4), 255, np.uint8)
    clean[..., :3] = np.rint(share * shade(np.stack([x.ravel(), y.ravel()], axis=1)).reshape(160, 160, 3))
    spoilt, slopes = jpeg(clean, quality), np.where(share[..., 0] == 1, 0, -1)
    canvas = prepare(spoilt)
    clear = without_bleeding(canvas, np.array([BLACK], np.uint8).view(np.uint32)[:, 0], NOISE, slopes, [Surface(shade)])
    assert error(unpack(canvas.bare(clear.keys)), clean) < 0.6 * error(spoilt, clean)


@pytest.mark.parametrize("quality", [85, 75, 50])
def test_colours_of_strokes_are_looked_for_farther_away(quality):
    """There is no black pixel in thin black strokes, but some where they are thick."""
    def thin(x, y):
        return (np.abs(y - 60 - x / 9) < 0.4) | (np.abs(y - 110 + x / 12) < 0.4)

    clean = draw(160, 160, [(BLUE, everywhere), (BLACK, thin), (BLACK, lambda x, y: (x < 8) & (y < 8))])
    spoilt, inner = jpeg(clean, quality), np.s_[40:, 64:]
    clear = cleared(spoilt, {BLUE, YELLOW, BLACK})
    assert error(clear[inner], clean[inner]) < 0.85 * error(spoilt[inner], clean[inner])


def test_many_colours_keep_their_own():
    """More than sixteen, a few of them in each part of the picture."""
    paints = [(40 + 50 * (k % 5), 30 + 60 * (k // 5), 60 + 90 * (k % 2), 255) for k in range(20)]
    clean = draw(160, 200, [(WHITE, everywhere)] + [
        (paint, disc(20 + 40 * (k % 5), 20 + 40 * (k // 5), 14)) for k, paint in enumerate(paints)])
    spoilt = jpeg(clean, 75)
    assert error(cleared(spoilt, {*paints, WHITE}), clean) < 0.6 * error(spoilt, clean)


@pytest.mark.parametrize("top", [0, 1])
@pytest.mark.parametrize("left", [0, 1])
def test_the_grid_may_lie_anywhere(top, left):
    clean = stripes(RED, BLACK, 2.5)
    spoilt = jpeg(clean, 75)[top:, left:]
    assert error(cleared(spoilt, {RED, BLACK}), clean[top:, left:]) < 0.6 * error(spoilt, clean[top:, left:])


def test_clean_mixes_stay():
    clean = stripes(RED, BLACK, 20)
    off = np.abs(cleared(clean, {RED, BLACK, WHITE}).astype(int) - clean)
    # But for those that might as well be one of the two.
    assert off.max() <= NOISE / 2 + 1


def test_other_colours_stay():
    clean = draw(128, 128, [(WHITE, everywhere), (RED, disc(40, 64, 30)), (BLUE, disc(90, 64, 20))])
    inner = np.s_[60:68, 86:94]
    np.testing.assert_array_equal(cleared(clean, {WHITE, RED})[inner], clean[inner])


@pytest.mark.parametrize("shape", [(1, 1), (3, 70), (TILE, TILE), (TILE + 1, 2 * TILE - 1)])
def test_any_size(shape):
    image = np.full((*shape, 4), 255, np.uint8)
    np.testing.assert_array_equal(cleared(image, {WHITE, BLACK}), image)
    image[::2] = BLACK
    assert cleared(image, {WHITE, BLACK}).shape == image.shape


def test_only_noisy_pictures_are_changed():
    clean = draw(192, 192, LARGE)
    assert label_pixels(clean, TraceOptions()).clear is None
    spoilt = jpeg(clean, 75)
    clear = label_pixels(spoilt, TraceOptions()).clear
    assert error(clear, clean) < 0.8 * error(spoilt, clean)


def test_stripes_are_traced_as_such():
    clean = np.pad(stripes(RED, BLACK, 4), [(40, 40), (40, 40), (0, 0)], mode="constant", constant_values=255)
    drawn = trace(jpeg(clean, 75)).shapes
    assert len(drawn) <= 1.3 * len(trace(clean).shapes)
    assert all(min(np.abs(np.subtract(shape.rgb, colour[:3])).max() for colour in (WHITE, RED, BLACK)) <= 12
               for shape in drawn)


def test_colours_are_where_most_pixels_are():
    """The most frequent value need not be in their middle."""
    random = np.random.RandomState(3)
    image = np.full((120, 120, 4), 255, np.uint8)
    image[20:100, 20:100, :3] = np.clip(np.rint(random.normal((205, 50, 25), 7, (80, 80, 3))), 0, 255)
    image[20:100, 20:100][random.rand(80, 80) < 0.05] = 192, 44, 30, 255
    canvas = prepare(image)
    found = unpack(noisy_colours(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)), NOISE, NOISE))
    near = np.abs(found[:, :3].astype(int) - (205, 50, 25)).max(axis=1)
    assert near.min() <= 3 and len(found) == 2
