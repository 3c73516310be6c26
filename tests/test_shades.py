# SPDX-License-Identifier: GPL-2.0-or-later
"""Things drawn beside each other on a ramp are told apart, and one thing stays one."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import prepare
from ddtcore.shades import part

SIZE = 60
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5
SHADE, LIP, LIGHT = np.array([-14, -12, 0]), np.array([-27, -46, 46]), np.array([-8, 0, 34])


def band(low, high, slope=0.3):
    """Coverage of a slanting band."""
    place = Y - slope * X
    return np.clip(place - low + 0.5, 0, 1) * np.clip(high + 0.5 - place, 0, 1)


def parted(change, base=(200, 150, 100)):
    """Numbers (H, W) of the things that change a picture by (H, W, 3), -1 for none."""
    change = np.rint(change)
    size = np.abs(change).max(axis=2)
    row, col = np.nonzero(size > 5)
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = base + change
    canvas = prepare(image)
    out = np.full((SIZE, SIZE), -1)
    out[row, col] = part(canvas, canvas.numbers(row, col), change[row, col].T.astype(np.float32),
                         np.zeros(row.size, np.int64))
    return out


@pytest.mark.parametrize("slope", [0, 0.05, 0.3, 1])
@pytest.mark.parametrize("width", [2.0, 3.0, 6.0])
@pytest.mark.parametrize("one, other", [(SHADE, LIP), (LIP, SHADE), (LIP, LIGHT)])
def test_two_things_side_by_side_are_two(slope, width, one, other):
    width *= np.hypot(1, slope)
    above, below = band(5, 5 + width, slope), band(5 + width, 5 + 2 * width, slope)
    found = parted(above[..., None] * one + below[..., None] * other)
    inside = (X > 4) & (X < SIZE - 4) & (Y < SIZE - 4)
    first, second = (np.unique(found[inside & (cover > 0.95)]) for cover in (above, below))
    assert first.size == second.size == 1 and first != second


@pytest.mark.parametrize("slope", [0, 0.05, 0.3, 1])
@pytest.mark.parametrize("width", [0.8, 1.4, 2.0, 3.0, 6.0])
@pytest.mark.parametrize("change", [SHADE, LIP, LIGHT])
def test_one_thing_is_one_whatever_it_covers(slope, width, change):
    found = parted(band(5, 5 + width, slope)[..., None] * change)
    assert set(np.unique(found)) <= {-1, 0}


def test_a_thing_that_grows_stronger_is_one():
    found = parted((band(5, 9) * X / SIZE)[..., None] * LIP)
    assert set(np.unique(found)) <= {-1, 0}


@pytest.mark.parametrize("slope", [0, 0.05, 0.3])
@pytest.mark.parametrize("width", [4.0, 6.0])
def test_what_is_opaque_is_one_on_two_ramps(slope, width):
    middle = 5 + width / 2
    beyond = (Y - slope * X >= middle)[..., None]
    base = np.where(beyond, (250, 210, 90), (250, 140, 0))
    found = parted(band(5, 5 + width, slope)[..., None] * ((230, 85, 50) - base), base)
    assert set(np.unique(found)) <= {-1, 0}


def test_areas_are_parted_each_on_its_own():
    canvas = prepare(np.full((SIZE, SIZE, 4), 255, np.uint8))
    row, col = np.nonzero((Y < 20) | (Y > 40))
    number = part(canvas, canvas.numbers(row, col), np.tile(SHADE[:, None], row.size).astype(np.float32),
                  (row > 30).astype(np.int64))
    assert np.array_equal(number, (row > 30).astype(np.int64))
