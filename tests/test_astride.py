# SPDX-License-Identifier: GPL-2.0-or-later
"""Shades across the border of two ramps are parted there, and nothing else is."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.astride import part_astride
from ddtcore.canvas import prepare
from ddtcore.growing import Surface
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

SIZE = 90
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5
ACROSS = 0.8 * X - 0.6 * Y - 10
"""Distance from the border of two ramps."""


def below(points, jump):
    """Colours of two ramps, (2, n, 3)."""
    x, y = points.T
    first = np.stack([250 - 0.5 * y, 140 + 0.4 * x, 20 + 0 * x], axis=1)
    return np.stack([first, first + (0, jump, 10)])


def picture(width, ink, share, jump=45.0):
    """A stripe of an ink along the border of two ramps, wider on the second one, and its coverage."""
    points = np.stack([X.ravel(), Y.ravel()], axis=1)
    first, second = below(points, jump).reshape(2, SIZE, SIZE, 3)
    beyond = np.clip(ACROSS + 0.5, 0, 1)[..., None]
    cover = np.clip(width / 2 + 0.5 - abs(ACROSS - width / 6), 0, 1)
    base = first + beyond * (second - first)
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = np.rint(base + share * cover[..., None] * (np.array(ink, float) - base))
    return image, cover


def parted(image, cover, jump=45.0):
    """The number of the part of each pixel of the stripe, and those pixels."""
    canvas = prepare(image)
    cells = canvas.cells(cover > 0.3)
    row, col = canvas.places(cells)
    surfaces = [Surface(lambda at, k=k: below(at, jump)[k]) for k in (0, 1)]
    # The middle of the stripe is not where the border lies: this is but a first guess.
    ramp = (ACROSS[row, col] > 1.5).astype(np.intp)
    return part_astride(canvas, cells, np.zeros(cells.size, np.intp), ramp, surfaces), row, col


@pytest.mark.parametrize("ink, share", [((0, 0, 0), 0.15), ((255, 255, 255), 0.3), ((90, 0, 60), 0.4)])
def test_a_translucent_stripe_is_parted_at_the_border(ink, share):
    part, row, col = parted(*picture(9.0, ink, share))
    side = ACROSS[row, col]
    assert part.max() == 1
    clear = abs(side) > 1
    right = (part == (side > 0))[clear].mean()
    assert max(right, 1 - right) > 0.97


@pytest.mark.parametrize("ink, share, jump", [((90, 0, 60), 1.0, 45.0), ((0, 0, 0), 0.15, 1.0)])
def test_what_is_opaque_or_lies_on_equal_ramps_stays_whole(ink, share, jump):
    assert parted(*picture(9.0, ink, share, jump), jump)[0].max() == 0


def test_what_covers_no_pixel_in_full_stays_whole():
    assert parted(*picture(1.5, (0, 0, 0), 0.3))[0].max() == 0


def test_numbers_of_areas_do_not_matter_and_none_are_joined():
    image, cover = picture(9.0, (0, 0, 0), 0.15)
    canvas = prepare(image)
    cells = canvas.cells(cover > 0.3)
    row, col = canvas.places(cells)
    surfaces = [Surface(lambda at, k=k: below(at, 45.0)[k]) for k in (0, 1)]
    area = (row > 45).astype(np.intp) * 3
    part = part_astride(canvas, cells, area, (ACROSS[row, col] > 1.5).astype(np.intp), surfaces)
    assert len(np.unique(part)) == 4
    assert all(len(np.unique(area[part == k])) == 1 for k in range(4))


def test_the_border_goes_on_below_a_shade():
    image, cover = picture(9.0, (0, 0, 0), 0.15)
    index = label_pixels(image, TraceOptions()).index
    inside = cover == 1
    one, other = (np.unique(index[inside & side]) for side in (ACROSS < -1, ACROSS > 1))
    assert not np.intersect1d(one, other).size
