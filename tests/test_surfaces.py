# SPDX-License-Identifier: GPL-2.0-or-later
"""Ramps are parted where one gradient ends and another surface begins."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, draw

from ddtcore.canvas import prepare
from ddtcore.growing import Surface
from ddtcore.ramps import find_ramps
from ddtcore.surfaces import AREA, extend, separate

SIZE = 96
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5
DISC = np.hypot(X - 48, Y - 48) < 42
GLOSS = np.hypot((X - 48) / 30, (Y - 34) / 20) < 1


def picture(level):
    """An opaque picture of premultiplied colours (SIZE, SIZE, 3)."""
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = np.rint(np.clip(level, 0, 255))
    return image


def over(base, top, alpha):
    """A colour over others, in parts."""
    return base + alpha[..., None] * (np.asarray(top, float) - base)


def fading_gloss(base):
    """White over `base` inside an ellipse, that fades out at its lower end."""
    return over(base, (255, 255, 255), GLOSS * np.clip((54 - Y) / 40, 0, 1) * 0.8)


def parted(image):
    canvas = prepare(image)
    ramps, count = find_ramps(canvas)
    return (ramps, count, *separate(canvas, ramps.copy(), count, np.zeros(ramps.shape, bool)))


def flat(rgb):
    return np.broadcast_to(np.asarray(rgb, float), (SIZE, SIZE, 3))


def slope(a, b, along=X):
    """A gradient from left to right, or from top to bottom."""
    return over(flat(a), b, along / SIZE)


@pytest.mark.parametrize("base", [flat((0, 102, 204)), slope((0, 60, 160), (40, 160, 250), Y)])
def test_a_highlight_that_fades_out_is_parted_from_what_it_lies_on(base):
    ramps, count, out, surfaces = parted(picture(np.where(DISC[..., None], fading_gloss(base), 255)))
    assert count == 1
    inside, outside = GLOSS & (Y < 46) & (ramps == 0), DISC & ~GLOSS & (Y > 60) & (ramps == 0)
    bright = np.bincount(out[inside] + 1).argmax() - 1
    assert bright >= 0 and (out[inside] == bright).mean() > 0.9
    assert not (out[outside] == bright).any()
    # A plateau is left to those who look for plateaus.
    assert (out[outside] == -1).all() == bool((base == base[0, 0]).all())
    assert len(surfaces) == (1 if (base == base[0, 0]).all() else 2)


def test_two_areas_whose_border_fades_out_are_parted():
    level = over(slope((200, 200, 205), (250, 250, 250)), (200, 120, 130), (Y > 50) * np.clip((70 - X) / 60, 0, 1))
    ramps, count, out, surfaces = parted(picture(level))
    assert count == 1 and len(surfaces) >= 2
    upper, lower = out[:46, :40][ramps[:46, :40] >= 0], out[55:, :40][ramps[55:, :40] >= 0]
    assert not np.intersect1d(upper[upper >= 0], lower[lower >= 0]).size


def test_ramps_are_extended_as_far_as_each_pixel_may_vary():
    noise = np.random.RandomState(0).uniform(-8, 8, (SIZE, SIZE, 3))
    canvas = prepare(picture(slope((60, 80, 90), (180, 200, 210)) + noise))
    surfaces = [Surface(lambda at: over(np.zeros((len(at), 3)) + (60, 80, 90), (180, 200, 210), at[:, 0] / SIZE))]
    ramps = np.where(X < 40, 0, -1).astype(np.int32)
    extend(canvas, ramps, surfaces, np.ones(ramps.shape, bool), np.where(X < 60, 10.0, 3.0))
    assert (ramps[X < 60] == 0).all()
    assert (ramps[X > 62] == 0).mean() < 0.1


def test_surfaces_have_the_colours_of_their_pixels():
    image = picture(np.where(DISC[..., None], fading_gloss(slope((0, 60, 160), (40, 160, 250), Y)), 255))
    _, _, out, surfaces = parted(image)
    for number, surface in enumerate(surfaces):
        row, col = np.nonzero(out == number)
        assert row.size >= AREA
        off = surface.colours(np.stack([col, row], axis=1) + 0.5) - image[row, col, :3]
        assert np.sqrt((off ** 2).mean()) < 2


@pytest.mark.parametrize("level", [
    slope((10, 20, 30), (200, 90, 120)),
    over(flat((255, 255, 255)), (200, 0, 0), np.hypot(X - 30, Y - 60) / 90),
    over(flat((0, 0, 0)), (255, 200, 0), np.clip((X - 30) / 40, 0, 1)),
])
def test_what_one_gradient_explains_stays_whole(level):
    ramps, count, out, surfaces = parted(picture(level))
    assert count == len(surfaces) == 1 and surfaces[0].gradient is not None
    np.testing.assert_array_equal(out, ramps)


def test_ramps_are_extended_to_free_pixels_of_their_colours():
    image = picture(slope((10, 20, 30), (200, 90, 120)))
    image[64:70, 10:20] = 255
    ramps = np.where(Y < 60, 0, -1).astype(np.int32)
    free = (Y < 80) & (X < 40)
    out, _ = separate(prepare(image), ramps.copy(), 1, free)
    spot = (image[..., :3] == 255).all(axis=2)
    assert (out[(ramps == 0) | free & ~spot] == 0).all()
    assert (out[spot | (ramps < 0) & ~free] == -1).all()


def test_flat_art_has_no_surfaces():
    _, count, out, surfaces = parted(draw(96, 96, CARTOON))
    assert count == 0 and surfaces == [] and (out == -1).all()


def test_no_gradient_at_all_still_ends():
    """A surface that no gradients explain: whatever is found, each pixel has at most one ramp."""
    level = np.stack([128 + 90 * np.sin(X / 9) * np.cos(Y / 11), 128 + 60 * np.sin((X + Y) / 14),
                      128 + 60 * np.cos(X / 13 - Y / 17)], axis=-1)
    ramps, _, out, surfaces = parted(picture(level))
    assert out.max() == len(surfaces) - 1
    assert np.unique(out[out >= 0]).size == len(surfaces)
    assert (out[ramps < 0] == -1).all()


TWO_SURFACES = picture(np.where(DISC[..., None], fading_gloss(slope((0, 60, 160), (40, 160, 250), Y)), 255))


@pytest.mark.parametrize("budget", ("_FITS", "_COMPARED"))
def test_ramps_for_which_nothing_is_left_of_the_budget_stay_whole(budget, monkeypatch):
    assert len(parted(TWO_SURFACES)[3]) == 2
    monkeypatch.setattr("ddtcore.surfaces." + budget, 0)
    ramps, _, out, surfaces = parted(TWO_SURFACES)
    assert len(surfaces) == 1
    np.testing.assert_array_equal(out, ramps)


def test_the_largest_ramps_come_first(monkeypatch):
    """Of two that need parting, the smaller one is left in one piece."""
    double = np.concatenate([TWO_SURFACES[20:], TWO_SURFACES])
    assert len(parted(double)[3]) == 4
    monkeypatch.setattr("ddtcore.surfaces._FITS", 1)
    ramps, count, out, _ = parted(double)
    assert count == 2 and [np.unique(out[ramps == number]).size > 1 for number in (0, 1)] == [False, True]


def test_pixels_come_to_the_same_surfaces_in_strips(monkeypatch):
    whole = parted(TWO_SURFACES)[2]
    monkeypatch.setattr("ddtcore.surfaces._STRIP", 1)
    np.testing.assert_array_equal(parted(TWO_SURFACES)[2], whole)
