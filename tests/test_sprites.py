# SPDX-License-Identifier: GPL-2.0-or-later
"""Pixel art, from the squares of an enlarged sprite to crisp and smooth drawings."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from otherart import enlarged, sprite
from painted import render

from ddtcore import TraceOptions, trace
from ddtcore.canvas import premultiply, prepare
from ddtcore.sprites import block_size, figures_at_crossings, label_sprite, reduced

COLOURS = np.array([(0, 0, 0, 0), (200, 30, 40, 255), (40, 60, 180, 255), (250, 220, 60, 255),
                    (255, 255, 255, 255)], np.uint8)


@st.composite
def sprites(draw, most=9):
    shape = draw(st.tuples(st.integers(2, most), st.integers(2, most)))
    random = np.random.RandomState(draw(st.integers(0, 2 ** 32 - 1)))
    return COLOURS[random.randint(0, draw(st.integers(2, len(COLOURS))), shape)]


@given(sprites(), st.integers(1, 12))
def test_squares_are_found_and_undone(image, times):
    image = enlarged(image, times)
    size = block_size(image)
    assert size == 1 or size % times == 0
    assert np.array_equal(enlarged(reduced(image, size), size), image)


@pytest.mark.parametrize("times", [2, 5, 16])
def test_one_pixel_off_the_squares_is_no_enlarged_sprite(times):
    image = enlarged(sprite(), times)
    assert block_size(image) == times
    image[times + 1, times + 1] = (9, 9, 9, 255)
    assert block_size(image) == 1
    assert block_size(enlarged(sprite(), times)[:-1]) == 1


def test_each_colour_is_a_label():
    image = sprite(((1, 2, 3, 0), (60, 220, 80, 255)))
    labels = label_sprite(prepare(image))
    assert np.array_equal(labels.palette[labels.index], np.where(image[..., 3:] > 0, image, 0))


def test_figures_stay_connected_at_crossings_and_the_ground_does_not():
    line = np.eye(8, dtype=int)
    for ground, index in ((0, line), (1, 1 - line)):
        assert np.array_equal(figures_at_crossings(index, ground), line == 1)
        assert np.array_equal(figures_at_crossings(np.fliplr(index), ground), np.fliplr(line) == 1)
    assert np.array_equal(figures_at_crossings(line, 1), (np.eye(8, k=1) + np.eye(8, k=-1)) == 1)
    assert not figures_at_crossings(np.zeros((1, 9), int), 0).any()


def test_of_two_figures_the_one_that_is_rarer_there_stays_connected():
    line = np.eye(8, dtype=int)
    assert np.array_equal(figures_at_crossings(line + 3, 0), line == 1)
    assert np.array_equal(figures_at_crossings(4 - line, 0), line == 1)


@pytest.mark.parametrize("stacking", ["stacked", "cutout"])
@pytest.mark.parametrize("times", [1, 3, 16])
@given(image=sprites())
@settings(max_examples=25, deadline=None)
def test_crisp_drawings_are_the_picture_at_any_whole_scale(image, times, stacking):
    options = TraceOptions.preset("pixel-art", stacking=stacking)
    drawing = trace(enlarged(image, times), options)
    for zoom in (1, 3):
        back = premultiply(render(drawing, zoom).astype(float))
        seen = premultiply(enlarged(image, times * zoom).astype(float))
        off = np.abs(back - seen).max(axis=2)
        if stacking == "cutout":
            assert off.max() == 0
        # Hidden edges of shapes may touch the very corner of a pixel at crossings.
        assert (off > 0).mean() < 0.01 and (off > 20).sum() <= 6


def test_crisp_drawings_lie_on_the_edges_of_pixels():
    drawing = trace(enlarged(sprite(), 16), TraceOptions.preset("pixel-art", stacking="cutout"))
    control = np.concatenate([loop.control for shape in drawing.shapes for loop in shape.loops])
    assert np.array_equal(control % 16, np.zeros_like(control))
    step = control[:, 3] - control[:, 0]
    assert ((step == 0).sum(axis=1) == 1).all(), "every line is upright or level, and none is a point"


def test_one_region_for_each_run_of_colour():
    diagonal = COLOURS[np.eye(9, dtype=int)]
    for image in (diagonal, enlarged(diagonal, 7)):
        assert len(trace(image, TraceOptions.preset("pixel-art")).shapes) == 1
    assert len(trace(sprite(), TraceOptions.preset("pixel-art")).shapes) == 1


def test_drawings_of_sprites_are_tiny():
    assert len(gzip.compress(trace(enlarged(sprite(), 16)).to_svg().encode())) < 300


@pytest.mark.parametrize("times", [1, 8])
def test_smooth_drawings_keep_the_shape_and_lose_the_corners(times):
    image = enlarged(sprite(), times)
    drawing = trace(image, TraceOptions.preset("pixel-art", curves="quadratic"))
    assert {int(degree) for shape in drawing.shapes for loop in shape.loops for degree in loop.degree} <= {1, 2}
    back = render(drawing, 8 // times)[..., 3] > 127
    truth = enlarged(sprite(), 8)[..., 3] > 0
    assert 0.005 < np.mean(back != truth) < 0.12
