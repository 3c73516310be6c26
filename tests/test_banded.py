# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures whose colours were reduced without dithering: bands of a ramp are a ramp again, stripes stay stripes."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import disc, draw, everywhere, stroke
from PIL import Image

from ddtcore import trace
from ddtcore.banded import STEP, find_banded
from ddtcore.canvas import prepare
from ddtcore.options import TraceOptions
from ddtcore.palette import find_plateaus

PAPER, INK, BLUE = (255, 255, 255, 255), (0, 0, 0, 255), (60, 120, 220, 255)


def sky(height=200, width=260):
    """A ramp with a disc and a stroke on it."""
    image = draw(height, width, [(BLUE, everywhere), (INK, disc(80, 110, 40)), (PAPER, disc(80, 110, 34)),
                                 (INK, stroke(190, 100, 0.3, 5, 60))])
    blue = (image[..., 2].astype(int) - image[..., 0])[..., None] / 160
    ramp = blue * (np.arange(height)[:, None, None] * (0.6, 0.4, 0.1))
    image[..., :3] = np.rint((image[..., :3] + ramp).clip(0, 255))
    return image


def stripes(count, step):
    """Stripes in a disc with an outline, as an artist draws them."""
    layers = [(PAPER, everywhere), (INK, disc(100, 100, 90))]
    for k in range(count):
        layers.append(((200 - step * k, 120, 60 + step * k, 255), band(20 + k * 160 / count)))
    return draw(200, 200, [*layers, (INK, stroke(100, 100, 0.5, 5, 40))])


def band(top):
    return lambda x, y: ((x - 100) ** 2 + (y - 100) ** 2 < 84 ** 2) & (y + 0.3 * x > top)


def reduced(image, colours):
    return np.array(Image.fromarray(image[..., :3]).quantize(colours).convert("RGBA"))


def hard(image):
    """A picture of bands without anti-aliasing: each pixel is black, white, or the blue of its row."""
    out = np.repeat(image[:, -1:] // 8 * 8 + 4, image.shape[1], axis=1)
    out[image[..., :3].max(axis=-1) < 120] = INK
    out[image[..., 0] > 225] = PAPER
    out[..., 3] = 255
    return out


def found(image):
    canvas = prepare(image)
    return find_banded(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)).core)


@pytest.mark.parametrize("colours", [24, 32, 64])
def test_bands_of_a_ramp_are_one_ramp(colours):
    soft = found(reduced(sky(), colours))
    assert len(soft.surfaces) == 1
    ramp = soft.slopes == 0
    blue = (sky()[..., :3] == sky()[:, -1:, :3]).all(axis=-1)
    assert np.mean(ramp[blue]) > 0.9 and np.mean(blue[ramp]) > 0.95
    row, col = np.nonzero(ramp)
    off = np.abs(soft.surfaces[0].colours(np.stack([col, row], axis=1) + 0.5) - sky()[row, col, :3]).max(axis=1)
    assert np.median(off) < STEP / 6


@pytest.mark.parametrize("image", [sky(), stripes(4, 14), stripes(8, 14), reduced(stripes(4, 14), 32), hard(sky()),
                                   np.full((1, 1, 4), 255, np.uint8), np.full((3, 200, 4), 255, np.uint8)])
def test_what_has_no_such_bands_is_left_alone(image):
    assert found(image) is None


@pytest.mark.parametrize("colours", [32, 64])
def test_a_banded_ramp_is_traced_as_a_gradient(colours):
    clean, drawing = trace(sky()), trace(reduced(sky(), colours))
    assert sum(shape.gradient is not None for shape in drawing.shapes) == 1
    assert len(drawing.shapes) <= 1.5 * len(clean.shapes)


def test_gradients_that_are_not_wanted_become_flat_all_the_same():
    drawing = trace(reduced(sky(), 32), TraceOptions(gradients="flat"))
    assert all(shape.gradient is None for shape in drawing.shapes)
    assert len(drawing.shapes) <= 1.5 * len(trace(sky()).shapes)
