# SPDX-License-Identifier: GPL-2.0-or-later
"""Translucent borders and glosses are one stroke each, all the way round."""

from __future__ import annotations

import numpy as np
import pytest
from painted import render
from test_gradient_pictures import over, psnr, rendered

from ddtcore import glazes, palette
from ddtcore.canvas import prepare
from ddtcore.growing import gradient_surface
from ddtcore.model import Gradient
from ddtcore.pipeline import trace
from ddtcore.regions import label_flat_art

DOWN = Gradient("linear", (80, 20), (80, 140), ((0.0, (227, 196, 250), 1.0), (1.0, (140, 60, 215), 1.0)))
PAGE = '<rect width="160" height="160" fill="#fff"/>'


def button(width, opacity, radius, ink):
    """A button with a border and a gloss inside of that."""
    ring = '<rect x="{0}" y="{0}" width="{1}" height="{1}" rx="{2}" fill="none" stroke="{3}" {4}/>'.format
    inner = 21 + width
    return (PAGE + f'<rect x="20" y="20" width="120" height="120" rx="{radius}" fill="url(#a)"/>'
            + ring(21, 118, radius - 1, ink, f'stroke-opacity="{opacity}" stroke-width="{width}"')
            + ring(inner, 160 - 2 * inner, radius - 1 - width, "#fff", f'stroke-opacity=".4" stroke-width="{width}"'))


@pytest.mark.parametrize("width, opacity, radius, ink, least", [
    (2, 0.6, 24, "#301060", 41), (2, 0.6, 30, "#301060", 39), (4, 0.5, 30, "#301060", 38), (2, 0.7, 30, "#5a2ca0", 40)])
def test_a_button_with_border_and_gloss(width, opacity, radius, ink, least):
    """Before strokes were followed round their bends, these had 32-34 dB."""
    body = button(width, opacity, radius, ink)
    off = over(render(trace(rendered(DOWN, body)), 4).astype(float), 255) - over(rendered(DOWN, body, 4), 255)
    assert psnr(off) > least


def test_all_round_there_are_two_strokes_and_no_colours_of_bends():
    labels = label_flat_art(prepare(rendered(DOWN, button(2, 0.6, 24, "#301060"))))
    assert len(labels.palette) == 4 and labels.ramp.sum() == 3
    assert all(gradient is not None for gradient in labels.gradients[1:])


def test_each_pixel_of_a_bend_comes_to_its_stroke():
    image = rendered(DOWN, button(2, 0.6, 24, "#301060"))
    canvas = prepare(image)
    ramps = np.full(canvas.shape, -1, np.int16)
    ramps[44:116, 24:136] = ramps[24:136, 50:110] = 0
    ramps[50:110, 20:22] = ramps[50:110, 138:140] = 1
    below = gradient_surface(DOWN, 3)
    plateaus = palette.find_plateaus(canvas, ramps >= 0)
    ramps, surfaces, found = glazes.follow(canvas, ramps, [below, below], plateaus)
    assert found and len(surfaces) == 2
    row, col = np.nonzero(ramps == 1)
    assert row.min() == 20 and row.max() == 139
    off = surfaces[1].colours(np.stack([col, row], axis=1) + 0.5) - image[row, col, :3]
    assert np.abs(off).max() < glazes.OFF + 1
    bend = (np.abs(row - 80) > 36) & (np.abs(col - 80) > 36)
    assert np.count_nonzero(bend) >= 40


@pytest.mark.parametrize("stripe", ["#fff", "#301060"])
def test_what_is_opaque_is_no_mix_that_goes_on(stripe):
    """Nothing below shows through, so nothing tells where it goes on."""
    body = PAGE + ('<rect x="20" y="20" width="120" height="120" fill="url(#a)"/>'
                   f'<rect x="60" y="30" width="12" height="100" fill="{stripe}"/>')
    canvas = prepare(rendered(DOWN, body))
    ramps = np.full(canvas.shape, -1, np.int16)
    ramps[20:140, 20:60] = ramps[20:140, 72:140] = 0
    ramps[30:130, 60:72] = 1
    before = ramps.copy()
    surface = gradient_surface(DOWN, 3)
    ramps, surfaces, found = glazes.follow(canvas, ramps, [surface, surface],
                                           palette.find_plateaus(canvas, ramps >= 0))
    assert not found and len(surfaces) == 2 and (ramps == before).all()
