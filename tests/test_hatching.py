# SPDX-License-Identifier: GPL-2.0-or-later
"""Drawings hatched nearly everywhere, saved as JPEG, and what is none."""

from __future__ import annotations

import io

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere
from otherart import photograph

from ddtcore.canvas import prepare, unpack
from ddtcore.components import label_components
from ddtcore.hatching import MANY, find_inks
from ddtcore.options import TraceOptions
from ddtcore.posterise import is_noisy
from ddtcore.regions import label_pixels

Image = pytest.importorskip("PIL.Image")

WHITE, RED, BLUE, YELLOW, GREEN = ((255, 255, 255, 255), (200, 30, 40, 255), (40, 90, 180, 255), (250, 210, 60, 255),
                                   (10, 125, 60, 255))


def stripes(pitch, wide, slope):
    return lambda x, y: (y + x / slope) % pitch < wide


HATCHED = {
    "red on white": [(WHITE, everywhere), (RED, stripes(7, 3.3, 7))],
    "yellow on blue": [(BLUE, everywhere), (YELLOW, stripes(10, 4.3, 5))],
    "grey": [(WHITE, everywhere), ((20, 20, 20, 255), stripes(6, 2.4, -3))],
    "four": [(WHITE, everywhere), *((ink, lambda x, y, k=k: stripes(12, 6, 6)(x, y) & (x // 50 == k))
                                    for k, ink in enumerate([RED, BLUE, GREEN, YELLOW]))],
    "shaded": [((200, 225, 245, 255), everywhere), ((30, 70, 40, 255), stripes(7, 3, 2)),
               ((240, 200, 160, 255), disc(100, 100, 80)),
               ((60, 30, 20, 255), lambda x, y: disc(100, 100, 80)(x, y) & stripes(6, 2.5, 4)(x, y))],
}


def jpeg(image, quality, subsampling=-1):
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "JPEG", quality=quality, subsampling=subsampling)
    return np.array(Image.open(file).convert("RGBA"))


def regions(image):
    labels = label_pixels(image, TraceOptions())
    return int(label_components(labels.index, 8).max()) + 1, labels


@pytest.mark.parametrize("quality", [95, 75, 50])
@pytest.mark.parametrize("name", HATCHED)
def test_inks_are_those_that_were_drawn(name, quality):
    inks = unpack(find_inks(prepare(jpeg(draw(200, 200, HATCHED[name]), quality)))).astype(int)
    true = np.unique([ink for ink, _ in HATCHED[name]], axis=0).astype(int)
    off = np.abs(inks[:, None] - true).max(axis=-1)
    assert len(inks) == len(true)
    assert off.min(axis=0).max() <= 32 and np.median(off.min(axis=0)) <= (20 if quality < 75 else 8)


def test_hue_that_did_not_bleed_tells_them_as_well():
    canvas = prepare(jpeg(draw(200, 200, HATCHED["red on white"]), 75, 0))
    inks = np.sort(unpack(find_inks(canvas)).astype(int), axis=0)
    assert len(inks) == 2 and np.abs(inks - [RED, WHITE]).max() <= 8


@pytest.mark.parametrize("quality", [75, 50])
@pytest.mark.parametrize("name", HATCHED)
def test_strokes_stay_whole(name, quality):
    """Few areas more than in the drawing, and they are where they were."""
    clean = draw(200, 200, HATCHED[name])
    count, flat = regions(clean)
    spoilt = jpeg(clean, quality)
    assert is_noisy(prepare(spoilt))
    found, labels = regions(spoilt)
    assert found <= 1.25 * count
    off = np.abs(labels.palette[labels.index] - flat.palette[flat.index]).max(axis=-1)
    assert np.mean(off > 32) < 0.08


@pytest.mark.parametrize("quality", [90, 75, 50])
@pytest.mark.parametrize("channels", [1, 3])
def test_photographs_are_no_drawings(channels, quality):
    for seed in range(3):
        assert not find_inks(prepare(jpeg(photograph(channels=channels, seed=seed), quality))).size


def test_drawings_that_are_flat_or_grainy_are_known_otherwise():
    cartoon = draw(60, 60, CARTOON)
    assert not find_inks(prepare(jpeg(np.kron(cartoon, np.ones((4, 4, 1), np.uint8)), 75))).size
    grain = np.random.RandomState(1).randn(200, 200, 1) * 6
    image = draw(200, 200, [((230, 225, 215, 255), everywhere), ((60, 90, 40, 255), stripes(24, 10, 6))])
    image[..., :3] = np.rint(image[..., :3] + grain).clip(0, 255)
    assert not find_inks(prepare(image)).size


@pytest.mark.parametrize("name", ["red on white", "grey"])
def test_pixels_without_mixes_are_what_they_say(name):
    hard = [(ink, lambda x, y, covers=covers: covers(np.floor(x), np.floor(y))) for ink, covers in HATCHED[name]]
    assert not find_inks(prepare(draw(200, 200, hard))).size


def test_what_shines_through_is_no_jpeg():
    image = draw(64, 64, HATCHED["grey"])
    image[..., 3] = 128
    assert not find_inks(prepare(image)).size


def test_small_pictures_and_many_inks_end_well():
    assert not find_inks(prepare(np.full((1, 3, 4), 255, np.uint8))).size
    random = np.random.RandomState(3)
    image = np.repeat(np.repeat(random.randint(0, 256, (64, 64, 4)), 8, 0), 8, 1).astype(np.uint8)
    image[..., 3] = 255
    assert find_inks(prepare(image)).size <= MANY
