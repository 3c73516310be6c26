# SPDX-License-Identifier: GPL-2.0-or-later
"""Areas of noisy pictures are painted in the colours of their own pixels, where these tell them."""

from __future__ import annotations

import numpy as np
import pytest
from painted import render
from test_patches import saved

from ddtcore import trace
from ddtcore.canvas import prepare
from ddtcore.exact import FAR, NEAR, exact_colours
from ddtcore.model import Labels

PAPER, ONE, OTHER = (255, 255, 255, 255), (229, 11, 0, 255), (240, 0, 0, 255)


def blocks(height=120, width=200, edge=40):
    """Two blocks in nearly the same red on white."""
    image = np.full((height, width, 4), 255, np.uint8)
    image[20:20 + edge, 20:80], image[20:20 + edge, 110:180] = ONE, OTHER
    return image


def labelled(image, *colours, ramp=None):
    """Labels of a picture with the first of some colours for white, and one for all else."""
    index = (image[..., 2] < 128).astype(np.int32)
    return Labels(index, np.array(colours, float), np.zeros(index.shape, bool), ramp)


def noisy(image, level=6, seed=3):
    grain = np.random.RandomState(seed).randint(-level, level + 1, image.shape[:2] + (3,))
    image = image.copy()
    image[..., :3] = (image[..., :3] + grain).clip(0, 255)
    return image


def test_areas_of_one_label_get_a_colour_each():
    image = noisy(blocks())
    labels = exact_colours(prepare(image), labelled(blocks(), PAPER, OTHER), 12.0)
    own = labels.exact[labels.index]
    assert np.abs(own - blocks()).max() <= 3
    assert (labels.palette[labels.index][20:60, 20:80] == OTHER).all()


def test_what_is_near_enough_stays():
    labels = labelled(blocks(), PAPER, OTHER)
    image = blocks()
    image[image[..., 2] < 128] = np.array(OTHER) - (FAR[1] - 1, 0, 0, 0)
    assert exact_colours(prepare(image), labels, 12.0) is labels


def test_narrow_areas_have_to_be_farther_off():
    image = blocks(edge=6)
    for off, asked in ((NEAR[1] - 2, False), (NEAR[1] + 2, True)):
        image[20:26, 20:80] = image[20:26, 110:180] = np.array(OTHER) - (off, 0, 0, 0)
        labels = exact_colours(prepare(image), labelled(image, PAPER, OTHER), 12.0)
        assert (labels.exact is not None) == asked


def test_uneven_areas_and_ramps_tell_nothing():
    image = blocks()
    image[20:60, 20:80, 0] = np.linspace(120, 255, 60)
    image[20:60, 110:180] = image[20:60, 20:21]
    labels = labelled(blocks(), PAPER, (200, 0, 0, 255))
    assert (exact_colours(prepare(image), labels, 12.0).index[20:60, 20:80] == 1).all()
    ramp = labelled(blocks(), PAPER, OTHER, ramp=np.array([False, True]))
    assert exact_colours(prepare(blocks()), ramp, 12.0) is ramp


@pytest.mark.parametrize("quality", [75, 50])
def test_a_jpeg_is_traced_in_its_own_colours(quality):
    drawn = render(trace(saved(blocks(240, 300, 120), quality)))
    for true, col in ((ONE, 50), (OTHER, 145)):
        assert np.abs(drawn[60, col, :3].astype(int) - true[:3]).max() <= 3
