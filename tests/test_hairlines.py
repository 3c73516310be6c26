# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes thinner than a pixel have the colour of their ink, and shades none."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import prepare, unpack
from ddtcore.hairlines import AREA, Inks

SIZE = 60
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5
RAMP = np.stack([250 - 1.2 * Y, 140 + 0.5 * Y + X, 60 + 0 * X], axis=-1)
BESIDE = np.array([232.0, 208, 64])
ROUND = np.hypot(X - 30.3, Y - 29.8) - 22


def covered(width, fine=8):
    """Share of each pixel that a ring covers, by counting points in it."""
    v, u = (np.mgrid[:SIZE * fine, :SIZE * fine] + 0.5) / fine
    inside = abs(np.hypot(u - 30.3, v - 29.8) - 22) < width / 2
    return inside.reshape(SIZE, fine, SIZE, fine).mean(axis=(1, 3))


def ink_of(cover, ink, beyond=BESIDE):
    """The ink found for what is drawn between a ramp and another surface; None for none."""
    inside = np.clip(0.5 - ROUND, 0, 1)[..., None]
    base = inside * RAMP + (1 - inside) * beyond
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = np.rint(base + cover[..., None] * (np.asarray(ink, float) - base))
    canvas = prepare(image)
    drawn = cover > 0.08
    sides = np.stack([RAMP[drawn], np.broadcast_to(beyond, RAMP.shape)[drawn]], axis=1).T.astype(np.float32)
    cells = canvas.cells(drawn)
    found = Inks(canvas, cells, sides, np.ones((2, cells.size), bool)).find(np.arange(cells.size))
    return None if found is None else unpack(np.array([found]))[0, :3].astype(int)


@pytest.mark.parametrize("width", [0.6, 0.8, 1.0])
@pytest.mark.parametrize("ink", [(0, 0, 0), (255, 255, 255)])
@pytest.mark.parametrize("beyond", [BESIDE, RAMP])
def test_the_ink_of_a_rim_is_found(width, ink, beyond):
    assert ink_of(covered(width), ink, beyond).tolist() == list(ink)


@pytest.mark.parametrize("ink", [(0, 0, 0), (160, 0, 0), (20, 10, 120)])
@pytest.mark.parametrize("width", [1.4, 1.6])
def test_strokes_that_cover_some_pixels_in_full_have_their_ink(width, ink):
    assert abs(ink_of(covered(width), ink, RAMP) - ink).max() <= 2


def test_pale_lines_have_an_ink_that_surely_explains_them():
    assert ink_of(covered(0.45), (0, 0, 0)).tolist() == [0, 0, 0]


@pytest.mark.parametrize("ink", [(80, 32, 16), (20, 10, 120)])
def test_other_inks_are_nearly_found(ink):
    assert abs(ink_of(covered(0.9), ink) - ink).max() < 40


@pytest.mark.parametrize("ink", [(0, 0, 0), (255, 255, 255), (80, 32, 16)])
def test_wide_and_translucent_strokes_have_no_ink(ink):
    assert ink_of(0.3 * covered(1.0), ink, RAMP) is None
    assert ink_of(0.5 * covered(2.5), ink, RAMP) is None
    assert ink_of(covered(2.5), ink) is None


def test_strokes_of_two_inks_have_none():
    two = np.where(X[..., None] < 30, np.array([255.0, 255, 255]), np.array([0.0, 0, 200]))
    assert ink_of(covered(0.8), two) is None


def test_scraps_are_mixes_with_an_ink_that_was_found():
    cover = covered(0.8)
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = np.rint(RAMP * (1 - cover[..., None]))
    canvas = prepare(image)
    cells = canvas.cells(cover > 0.08)
    row, col = canvas.places(cells)
    search = Inks(canvas, cells, RAMP[row, col].T[:, None].repeat(2, axis=1), np.ones((2, cells.size), bool))
    few, black, red = np.arange(AREA - 1), np.array([0xFF000000], np.uint32), np.array([0xFF0000FF], np.uint32)
    assert search.are_scraps(few, black)
    assert not search.are_scraps(few, red) and not search.are_scraps(few, black[:0])
    assert not search.are_scraps(np.arange(AREA), black)


def test_specks_have_no_ink():
    cover = covered(0.8) * (Y < 8)
    assert np.count_nonzero(cover > 0.08) < AREA
    assert ink_of(cover, (0, 0, 0)) is None
