# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes on ramps are found, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import RIM, prepare, unpack
from ddtcore.growing import Surface
from ddtcore.options import TraceOptions
from ddtcore.overlays import AREA, add_drawn, flat_colours
from ddtcore.palette import find_plateaus, known_labels
from ddtcore.ramps import find_ramps
from ddtcore.regions import label_pixels
from ddtcore.surfaces import separate

SIZE = 80
Y, X = np.mgrid[:SIZE, :SIZE] + 0.5
ALONG = 0.8 * X + 0.6 * Y
ACROSS = 0.6 * X - 0.8 * Y + 8


def stroke(width):
    """Coverage of a slanting stroke."""
    return np.clip(width / 2 + 0.5 - abs(ACROSS), 0, min(width, 1)) * (ALONG > 20) * (ALONG < 80)


def picture(cover, top, slope=1.2):
    """A ramp with something of one colour on it."""
    base = np.stack([250 - slope * Y, 140 + 0.5 * Y, 20 + 0 * X], axis=-1)
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[..., :3] = np.rint(base + cover[..., None] * (np.asarray(top, float) - base))
    return image


def drawn(image):
    """Ramps with the drawn things, and how many there are of each."""
    canvas = prepare(image)
    ramps, surfaces = separate(canvas, *find_ramps(canvas), np.zeros(canvas.shape, bool))
    plateaus = find_plateaus(canvas, ramps >= 0)
    keys = plateaus.keys[(plateaus.counts >= 64) & (plateaus.full > 0)]
    labels = known_labels(canvas, plateaus, keys, 2.0)
    return ramps, len(surfaces), add_drawn(canvas, ramps, surfaces, keys, labels)[0] - len(surfaces)


@pytest.mark.parametrize(("width", "alpha"), [(1.2, 0.25), (2.0, 0.25), (3.0, 0.25), (2.0, 1.0), (3.0, 1.0)])
@pytest.mark.parametrize("top", [(255, 255, 255), (60, 30, 0)])
def test_a_stroke_is_one_thing(width, alpha, top):
    ramps, count, more = drawn(picture(alpha * stroke(width), top))
    assert count == 1 and more == 1
    full, away = stroke(width) > 0.9 * min(width, 1), abs(ACROSS) > width / 2 + 1.5
    assert (ramps[full] == count).mean() > 0.95
    assert not (ramps[away] == count).any()


@pytest.mark.parametrize("width", [1.2, 1.6])
@pytest.mark.parametrize("top", [(255, 255, 255), (60, 30, 0)])
def test_a_stroke_that_covers_few_pixels_in_full_has_its_ink(width, top):
    image = picture(stroke(width), top)
    assert drawn(image)[2] == 0
    labels = label_pixels(image, TraceOptions())
    ink = int(np.abs(labels.palette[:, :3] - top).max(axis=1).argmin())
    assert np.abs(labels.palette[ink, :3] - top).max() <= 2
    assert (labels.index[stroke(width) > 0.9] == ink).mean() > 0.95
    assert not (labels.index[abs(ACROSS) > width / 2 + 1.5] == ink).any()


@pytest.mark.parametrize("seed", range(3))
def test_what_pixels_vary_by_is_nothing_drawn_but_a_stroke_is(seed):
    """Ripples wider than strokes, of 12 levels, and a stroke that stands out by some 35."""
    random = np.random.RandomState(seed).uniform(-12, 12, (SIZE // 8, SIZE // 8, 1))
    ripples = random.repeat(8, axis=0).repeat(8, axis=1)
    surface = Surface(lambda at: np.stack([250 - 1.2 * at[:, 1], 140 + 0.5 * at[:, 1], 20 + 0 * at[:, 0]], axis=-1))
    found = []
    for doubt in (None, np.full((SIZE + 2 * RIM) ** 2, 14.0)):
        image = picture(0.14 * stroke(3.0), (0, 0, 0))
        image[..., :3] = np.rint(np.clip(image[..., :3] + ripples, 0, 255))
        canvas, ramps = prepare(image), np.where((stroke(3.0) > 0) | (abs(ripples[..., 0]) > 8), -1, 0).astype(np.int32)
        none = np.full(canvas.keys.size, -1, np.int32)
        found.append((add_drawn(canvas, ramps, [surface], np.zeros(0, np.uint32), none, doubt)[0] - 1, ramps))
    assert found[0][0] > 3
    assert found[1][0] == 1
    assert (found[1][1][stroke(3.0) == 1] >= 1).mean() > 0.8
    assert (found[1][1][abs(ACROSS) > 5] < 1).all()


def test_light_and_dark_strokes_side_by_side_are_two_things():
    image = picture(0.3 * stroke(2.0), (255, 255, 255))
    dark = np.roll(stroke(2.0), (2, -1), axis=(0, 1))[..., None] * 0.3
    image[..., :3] = np.rint(image[..., :3] * (1 - dark))
    _, count, more = drawn(image)
    assert count == 1 and more == 2


def test_a_bare_ramp_has_nothing_drawn_on_it():
    ramps, count, more = drawn(picture(0 * X, (0, 0, 0)))
    assert (count, more) == (1, 0) and (ramps == 0).all()


def test_edges_between_surfaces_are_nothing_drawn():
    cover = np.clip(np.hypot(X - 40, Y - 40) - 24.5, 0, 1)
    for top in ((255, 255, 255), (0, 0, 90)):
        assert drawn(picture(cover, top))[2] == 0


def test_strokes_in_a_colour_of_the_picture_are_left_to_the_palette():
    cover = np.maximum(stroke(1.4), (Y > 60) & (Y < 78))
    assert drawn(picture(cover, (0, 0, 0)))[2] == 0


@pytest.mark.parametrize("top", [(0, 0, 0), (255, 255, 255)])
def test_strokes_thinner_than_a_pixel_give_inks(top):
    canvas = prepare(picture(stroke(0.8), top))
    ramps, surfaces = separate(canvas, *find_ramps(canvas), np.zeros(canvas.shape, bool))
    none = np.full(canvas.keys.size, -1, np.int32)
    count, inks = add_drawn(canvas, ramps, surfaces, np.zeros(0, np.uint32), none)
    assert count == len(surfaces) == 1 and unpack(inks)[:, :3].tolist() == [list(top)]
    assert (ramps[stroke(0.8) > 0.5] == -1).all()


def test_specks_are_nothing_drawn():
    cover = np.zeros((SIZE, SIZE))
    cover[10:12, 10:13] = cover[40, 50] = 1
    assert cover.sum() <= AREA
    assert drawn(picture(cover, (0, 60, 0)))[2] == 0


def test_flat_art_has_nothing_drawn():
    image = np.full((SIZE, SIZE, 4), 255, np.uint8)
    image[20:40, 20:60, :3] = 0
    assert drawn(image)[1:] == (0, 0)


@pytest.mark.parametrize("length, found", [(4, 0), (30, 1)])
def test_what_is_drawn_pays_for_its_path(length, found):
    cover = stroke(3.0) * (abs(ALONG - 50) < length / 2)
    assert drawn(picture(0.07 * cover, (60, 30, 0)))[2] == found


@pytest.mark.parametrize("peak, found", [(26, 1), (9, 0)])
def test_a_shade_goes_on_where_it_is_faint(peak, found):
    level = stroke(3.0) * np.clip(peak - 0.3 * (ALONG - 20), 8.5, None)
    image = picture(np.zeros((SIZE, SIZE)), (0, 0, 0))
    image[..., :3] = np.rint(image[..., :3] - level[..., None] * (0.8, 0.6, 0))
    ramps, count, more = drawn(image)
    assert more == found
    full = (stroke(3.0) == 1) & (ALONG > 22) & (ALONG < 78)
    assert (ramps[full] == count).mean() == pytest.approx(found, abs=0.05)


def test_a_few_pixels_of_a_flat_colour_do_not_make_all_flat():
    image = picture(0.08 * stroke(3.0), (60, 30, 0))
    image[2:14, 60:72, :3] = 0
    end = (stroke(3.0) == 1) & (ALONG > 76)
    image[end, :3] = np.rint(0.2 * image[end, :3])
    ramps, count, more = drawn(image)
    assert 0 < np.count_nonzero(end) < 20
    full = (stroke(3.0) == 1) & (ALONG > 22) & (ALONG < 72)
    assert more >= 1 and (ramps[full] >= count).mean() > 0.95


def translucent(slope, alpha=0.15):
    """A black translucent stroke on a ramp."""
    row, col = np.mgrid[:200, :200] + 0.5
    cover = np.clip(2.5 - abs(row - 60 - 0.4 * col), 0, 1)[..., None]
    base = np.stack([255 + 0 * col, 192 - slope * col, 0 * col], axis=-1)
    image = np.full((200, 200, 4), 255, np.uint8)
    image[..., :3] = np.rint(base * (1 - alpha * cover))
    return image, cover[..., 0]


def test_a_stroke_whose_colour_hardly_changes_has_no_flat_colour():
    for slope, flat in ((0.05, 0), (0, 1)):
        canvas = prepare(translucent(slope)[0])
        keys = flat_colours(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)))
        assert np.count_nonzero(unpack(keys)[:, 0] < 255) == flat


@pytest.mark.parametrize("slope", [0.02, 0.05, 0.2])
def test_a_translucent_stroke_has_no_gaps(slope):
    image, cover = translucent(slope)
    labels = label_pixels(image, TraceOptions())
    assert (labels.index[cover == 1] != labels.index[5, 5]).all()
