# SPDX-License-Identifier: GPL-2.0-or-later
"""Bands of flat colours that one gradient explains become a ramp; flat areas and what stands out stay."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import prepare
from ddtcore.gradient import colours_at
from ddtcore.growing import gradient_surface
from ddtcore.model import Gradient, Labels
from ddtcore.regained import regain_ramps

ROW, COL = np.mgrid[:80, :120]
STRIP = (ROW >= 30) & (ROW < 42)
SLOPE = 90 + COL
NOISE = 10.0


def bands(level, wobble=3, width=30):
    """A strip with the grey levels given, of which labels from 1 on have a band each, whose borders wind."""
    rng = np.random.RandomState(1)
    grain = rng.randint(-2, 3, level.shape)
    image = np.full((80, 120, 4), 255, np.uint8)
    image[STRIP, :3] = (level + grain).clip(0, 255)[STRIP][:, None]
    index = np.where(STRIP, 1 + np.clip(COL + rng.randint(-wobble, wobble + 1, (80, 1)), 0, 119) // width, 0)
    return image, index


def regained(image, index, surfaces=None, ramp=None):
    canvas = prepare(image)
    count = index.max() + 1
    palette = np.array([[*[image[index == k, 0].mean()] * 3, 255] for k in range(count)])
    labels = Labels(index, palette, np.zeros(index.shape, bool), ramp)
    return regain_ramps(canvas, labels, surfaces or [None] * count, np.full(index.shape, NOISE / 3), NOISE)


def test_bands_become_one_ramp_with_the_gradient_that_explains_them():
    image, index = bands(SLOPE)
    out = regained(image, index)
    strip = np.unique(out.index[STRIP])
    assert strip.size == 1 and out.ramp[strip[0]] and not out.ramp[out.index[~STRIP]].any()
    points = np.stack([COL[STRIP], ROW[STRIP]], axis=1) + 0.5
    off = colours_at(out.gradients[strip[0]], points)[:, 0] - SLOPE[STRIP]
    assert np.abs(off).max() < 3
    assert out.palette[strip[0], 0] == pytest.approx(SLOPE[STRIP].mean(), abs=1)


@pytest.mark.parametrize("width", [20, 30, 60])
def test_flat_areas_beside_each_other_stay(width):
    image, index = bands(90 + COL // width * width, 0, width)
    out = regained(image, index)
    assert (out.index == index).all()


def test_one_colour_alone_is_no_bands():
    image, _ = bands(SLOPE)
    index = STRIP.astype(int)
    assert (regained(image, index).index == index).all()


def test_less_contrast_than_ripples_have_is_no_ramp():
    image, index = bands(120 + COL // 24)
    assert (regained(image, index).index == index).all()


def test_a_piece_joins_the_ramp_beside_it_that_explains_it_and_no_other():
    gradient = Gradient("linear", (0.0, 0.0), (120.0, 0.0), ((0.0, (90,) * 3, 1.0), (1.0, (210,) * 3, 1.0)))
    image, _ = bands(SLOPE)
    like, dark = (STRIP & (np.abs(COL - middle) < 8) & (ROW > 34) for middle in (40, 80))
    image[dark, :3] -= 30
    index = np.where(STRIP, 1, 0)
    index[like], index[dark] = 2, 3
    out = regained(image, index, [None, gradient_surface(gradient, 3), None, None],
                   np.array([False, True, False, False]))
    assert (out.index[like] == 1).all()
    assert (out.index[dark] == 3).all()
    assert (out.index[~like] == index[~like]).all()
