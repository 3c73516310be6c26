# SPDX-License-Identifier: GPL-2.0-or-later
"""Drawings under uneven light and a grain: paper is one soft area, and what is flat stays flat."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import disc, draw, everywhere, stroke

from ddtcore import trace
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

PAPER, INK = (243, 243, 243, 255), (28, 28, 28, 255)


def grainy(image, grain, light=None, seed=1):
    """A picture with a grain, darker and brighter by the planes `light` (H, W)."""
    values = image[..., :3] + np.random.RandomState(seed).normal(0, grain, (*image.shape[:2], 1))
    if light is not None:
        values += light[..., None]
    out = image.copy()
    out[..., :3] = np.rint(values.clip(0, 255))
    return out


def sheet(height=240, width=300):
    return draw(height, width, [(PAPER, everywhere), (INK, disc(70, 80, 34)), (INK, stroke(150, 130, -0.5, 9, 130))])


def slope(height=240, width=300, by=12):
    across, down = np.linspace(-by, by, width), np.linspace(-by / 2, by / 2, height)
    return across + down[:, None]


def labels_of(image):
    return label_pixels(image, TraceOptions())


@pytest.mark.parametrize("grain", [3, 5, 8])
def test_paper_under_uneven_light_is_one_soft_area(grain):
    drawing = trace(grainy(sheet(), grain, slope()))
    assert len(drawing.shapes) <= 5
    paper = drawing.shapes[0].gradient
    ends = sorted(np.mean(rgb) for _, rgb, _ in (paper.stops[0], paper.stops[-1]))
    assert ends[0] < 238 and ends[1] > 246


@pytest.mark.parametrize("grain", [3, 5, 8])
def test_under_even_light_all_is_flat(grain):
    labels = labels_of(grainy(sheet(), grain))
    assert len(labels.palette) == 2 and not labels.ramp.any()


@pytest.mark.parametrize("step", [14, 20])
def test_a_border_between_two_like_colours_stays(step):
    image = sheet()
    image[:, 160:, :3] = image[:, 160:, :3] * ((243 - step) / 243)
    labels = labels_of(grainy(image, 4))
    assert not labels.ramp.any()
    border = labels.index[:40, 158:162] != labels.index[:40, 10:11]
    assert (border == [False, False, True, True]).mean() > 0.95


@pytest.mark.parametrize("width", [3, 6, 12])
def test_stripes_of_two_like_colours_are_no_slope(width):
    image = sheet()
    dark = (np.arange(300) // width % 2 == 1) & (image[..., 0] > 200)
    image[dark, :3] -= 20
    assert not labels_of(grainy(image, 3)).ramp.any()
