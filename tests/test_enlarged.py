# SPDX-License-Identifier: GPL-2.0-or-later
"""Enlarged pictures are found out and get their own pixels back, and no others."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, disc, draw, everywhere, stroke

from ddtcore.canvas import premultiply
from ddtcore.enlarged import BENT, LEAST, LOST, bent, enlarged_by, lost_by_shrinking, original, shrunk
from ddtcore.options import TraceOptions
from ddtcore.pipeline import trace

Image = pytest.importorskip("PIL.Image")
ImageFilter = pytest.importorskip("PIL.ImageFilter")

FILTERS = {"linear": Image.BILINEAR, "cubic": Image.BICUBIC, "lanczos": Image.LANCZOS}


def scaled(image, factor, kind=Image.BICUBIC):
    size = tuple(round(side * factor) for side in image.shape[1::-1])
    return np.array(Image.fromarray(image).convert("RGB").resize(size, kind).convert("RGBA"))


@pytest.fixture(scope="module")
def clean():
    return draw(192, 192, [(colour, lambda x, y, c=covers: c(x / 2, y / 2)) for colour, covers in CARTOON])


@pytest.mark.parametrize("factor", LOST, ids=str)
@pytest.mark.parametrize("kind", FILTERS)
def test_enlarged_pictures_get_their_pixels_back(clean, kind, factor):
    image = scaled(clean, float(factor), FILTERS[kind])
    assert enlarged_by(image) == (factor, kind)
    small, times = original(image)
    assert times == (factor, factor) and small.shape == clean.shape
    off = np.abs(small.astype(int) - clean).max(axis=-1)
    assert np.mean(off > 2) < 0.01 and off.max() <= 24


@pytest.mark.parametrize("kind", FILTERS)
def test_enlarged_pictures_are_traced_as_they_were(clean, kind):
    before, after = (trace(image, TraceOptions()) for image in (clean, scaled(clean, 2, FILTERS[kind])))
    assert {shape.rgb for shape in before.shapes} <= {shape.rgb for shape in after.shapes}
    assert abs(len(before.shapes) - len(after.shapes)) <= 2


@pytest.mark.parametrize("kind", FILTERS)
def test_faint_strokes_on_a_pure_hue_stay(kind):
    # Nothing was cut off but the excess of the one channel that is at its end.
    image = draw(192, 192, [((255, 160, 40, 255), everywhere), ((255, 150, 32, 255), stroke(96, 96, 0.3, 4, 80)),
                            ((30, 20, 10, 255), disc(40, 150, 24))])
    small = original(scaled(image, 2, FILTERS[kind]))[0]
    assert np.abs(small.astype(int) - image)[20:170, 70:].max() <= 6


def test_what_is_transparent_is_enlarged_too(clean):
    image = clean.copy()
    image[(clean == 255).all(axis=-1)] = 0
    # Pillow enlarges premultiplied colours.
    small, times = original(np.array(Image.fromarray(image).resize((384, 384), Image.BICUBIC)))
    off = np.abs(premultiply(small).astype(int) - premultiply(image))
    assert times == (2, 2) and np.mean(off.max(axis=-1) > 3) < 0.04


def test_pictures_enlarged_twice(clean):
    small, times = original(scaled(scaled(clean, 2), 2))
    assert times == (4, 4) and small.shape == clean.shape


@pytest.mark.parametrize("spoil", [
    lambda image: image, lambda image: scaled(image, 0.7), lambda image: scaled(image, 1.2),
    lambda image: np.repeat(np.repeat(image, 2, axis=0), 2, axis=1),
    lambda image: np.array(Image.fromarray(image).filter(ImageFilter.GaussianBlur(0.7)))],
    ids=["clean", "reduced", "by a fifth", "in squares", "blurred"])
def test_others_are_left_alone(clean, spoil):
    image = spoil(clean)
    small, times = original(image)
    assert times == (1, 1) and small is image
    assert all(lost_by_shrinking(image, 2.0, name) > LOST[2.0] for name in FILTERS)


def test_steps_change_less_in_enlarged_pictures(clean):
    assert bent(clean) > 1.1 * max(BENT.values())
    for kind in FILTERS.values():
        bends = [bent(scaled(clean, factor, kind)) for factor in LOST]
        assert max(bends) == bends[-1] and all(bend < 0.9 * BENT[factor] for bend, factor in zip(bends, LOST))


def test_sizes_that_are_no_multiples(clean):
    image = clean[:181, :187]
    large = scaled(image, 1.5)
    assert large.shape == (272, 280, 4)
    small, (across, down) = original(large)
    assert small.shape == image.shape and (across, down) == (280 / 187, 272 / 181)
    off = np.abs(small.astype(int) - image).max(axis=-1)
    assert np.mean(off > 2) < 0.01 and off.max() <= 24
    drawing = trace(large, TraceOptions())
    corners = np.concatenate([loop.control for shape in drawing.shapes for loop in shape.loops]).reshape(-1, 2)
    assert np.abs(corners.max(axis=0) - (280, 272)).max() < 1e-9


def test_odd_sizes_and_edges(clean):
    for height, width in ((7, 9), (1, 1), (2, 5)):
        assert shrunk(clean[:height, :width], 2.0, "cubic").shape == (-(-height // 2), -(-width // 2), 4)
    flat = np.full((2 * LEAST, 2 * LEAST, 4), 77, np.uint8)
    assert original(flat)[1] == (1, 1)
    assert (shrunk(flat, 2.0, "lanczos") == 77).all()


def test_their_drawing_has_the_size_of_the_picture(clean):
    image = scaled(clean, 2)[:-1, :-1]
    drawing = trace(image, TraceOptions())
    assert (drawing.width, drawing.height) == (383, 383)
    corners = np.concatenate([loop.control for shape in drawing.shapes for loop in shape.loops])
    assert corners.max() == 383
    assert len(drawing.shapes) <= len(trace(clean, TraceOptions()).shapes) + 2


def test_very_large_pictures_are_taken_as_they_are(clean, monkeypatch):
    image = scaled(clean, 2, Image.LANCZOS)
    assert original(image)[1] == (2, 2)
    monkeypatch.setattr("ddtcore.enlarged.LARGEST", image.shape[0] * image.shape[1] - 1)
    assert original(image)[0] is image
