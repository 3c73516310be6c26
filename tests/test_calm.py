# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art under a grain."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, draw, everywhere

from ddtcore.calm import LEFT, calm, without_grain
from ddtcore.canvas import prepare, unpack

FAINT = [((237, 212, 168, 255), everywhere), ((222, 197, 153, 255), lambda x, y: x > 40.3),
         ((60, 40, 30, 255), lambda x, y: y > 70.2)]


def grained(image, sigma, seed=0):
    noisy = image.astype(float)
    noisy[..., :3] += np.random.RandomState(seed).randn(*image.shape[:2], 3) * sigma
    return np.rint(noisy).clip(0, 255).astype(np.uint8)


def bare(canvas):
    return unpack(canvas.bare(canvas.keys)).astype(int)


def test_what_has_no_grain_stays_as_it_is():
    image = draw(40, 50, [((10, 200, 30, 255), everywhere)])
    np.testing.assert_array_equal(bare(calm(prepare(image), 14)), image)


@pytest.mark.parametrize("sigma", [1.5, 3])
def test_flat_areas_get_their_colour_and_edges_stay(sigma):
    clean = draw(96, 96, FAINT).astype(int)
    spoiled = grained(clean, sigma)
    canvas, grain = without_grain(prepare(spoiled))
    assert 2.5 * sigma < grain < 6 * sigma
    off = np.abs(bare(canvas) - clean)[..., :3].max(axis=-1)
    assert np.mean(off <= sigma) > 0.85 and np.mean(off <= grain / LEFT) > 0.95
    across = bare(canvas)[30:60, 34:48, 0].mean(axis=0)
    assert abs(across[:3].mean() - 237) < 1 and abs(across[-3:].mean() - 222) < 1, "a faint edge is gone"


def test_turning_the_picture_turns_the_result():
    image = grained(draw(96, 96, CARTOON), 3)
    for turn in (np.rot90, np.flipud, np.fliplr):
        turned = bare(calm(prepare(np.ascontiguousarray(turn(image))), 14))
        np.testing.assert_array_equal(turned, turn(bare(calm(prepare(image), 14))))


def test_clean_pictures_have_no_grain():
    assert without_grain(prepare(draw(96, 96, CARTOON))) is None
