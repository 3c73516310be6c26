# SPDX-License-Identifier: GPL-2.0-or-later
"""Shapes in runs of one colour paint the picture that they painted before."""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
import resvg_py
from alignment import over_white
from hypothesis import given
from hypothesis import strategies as st

import ddtcore
from ddtcore.grouping import by_colour, paint_of
from ddtcore.model import LINE, Gradient, Loop, Shape

IMAGES = Path(__file__).parent / "images"
WIDTH, HEIGHT = 40, 30
COLOURS = ((200, 0, 0), (0, 120, 0), (0, 0, 250))
RECTANGLES = st.tuples(st.integers(0, WIDTH - 1), st.integers(0, HEIGHT - 1), st.integers(1, 12),
                       st.integers(1, 12), st.sampled_from(COLOURS))


def rectangle(left, top, width, height, rgb, opacity=1.0, gradient=None):
    corners = np.array([[left, top], [left + width, top], [left + width, top + height], [left, top + height]])
    ends = np.roll(corners, -1, axis=0)
    control = np.stack([corners, corners, ends, ends], axis=1).astype(float)
    loop = Loop(control, np.full(4, LINE, np.uint8))
    return Shape("shape", rgb, opacity, (loop,), float(width * height), gradient)


def painted(shapes):
    """The pixels of rectangles painted one over the other."""
    picture = np.zeros((HEIGHT + 12, WIDTH + 12, 3), np.uint8)
    for shape in shapes:
        (left, top), (right, bottom) = shape.loops[0].control[[0, 2], 0].astype(int)
        picture[top:bottom, left:right] = shape.rgb
    return picture[:HEIGHT, :WIDTH]


def runs(shapes):
    return [len(list(run)) for _, run in groupby(shapes, key=paint_of)]


@given(st.lists(RECTANGLES, max_size=30))
def test_the_picture_stays_and_no_shape_is_lost(boxes):
    shapes = [rectangle(*box) for box in boxes]
    grouped = by_colour(shapes, WIDTH, HEIGHT)
    assert sorted(map(id, grouped)) == sorted(map(id, shapes))
    assert np.array_equal(painted(grouped), painted(shapes))
    assert len(runs(grouped)) <= len(runs(shapes))


@given(st.permutations([(x, y) for x in range(0, 40, 10) for y in range(0, 30, 10)]))
def test_shapes_that_do_not_meet_need_one_run_for_each_colour(places):
    shapes = [rectangle(x, y, 8, 8, COLOURS[number % 3]) for number, (x, y) in enumerate(places)]
    assert runs(by_colour(shapes, WIDTH, HEIGHT)) == [4, 4, 4]


def test_order_within_a_run_stays():
    shapes = [rectangle(3 * x, 0, 2, 2, COLOURS[x % 2]) for x in range(10)]
    assert list(by_colour(shapes, WIDTH, HEIGHT)) == shapes[::2] + shapes[1::2]


def test_what_lies_over_another_colour_stays_there():
    shapes = [rectangle(0, 0, 20, 20, COLOURS[0]), rectangle(5, 5, 9, 9, COLOURS[1]),
              rectangle(7, 7, 2, 2, COLOURS[0]), rectangle(30, 0, 5, 5, COLOURS[0])]
    assert runs(by_colour(shapes, WIDTH, HEIGHT)) == [1, 1, 2]


def test_opacity_and_gradients_are_colours_of_their_own():
    ramp = Gradient("linear", (0, 0), (9, 0), ((0, (0, 0, 0), 1), (1, (9, 9, 9), 1)))
    shapes = [rectangle(0, 0, 2, 2, COLOURS[0]), rectangle(5, 0, 2, 2, COLOURS[0], opacity=0.5),
              rectangle(9, 0, 2, 2, COLOURS[0], gradient=ramp), rectangle(15, 0, 2, 2, COLOURS[0])]
    assert runs(by_colour(shapes, WIDTH, HEIGHT)) == [2, 1, 1]


@pytest.mark.parametrize("size", [(1, 1), (256, 3), (257, 300), (5000, 10)])
def test_pictures_of_any_size(size):
    shapes = [rectangle(0, 0, *size, COLOURS[0]), rectangle(-2, -2, 1, 1, COLOURS[1]),
              rectangle(size[0], size[1], 1, 1, COLOURS[0])]
    assert len(by_colour(shapes, *size)) == 3


@pytest.mark.parametrize("stacking", ["stacked", "cutout"])
@pytest.mark.parametrize("name", ["stegosaurus", "doctor"])
def test_a_trace_looks_the_same(name, stacking):
    picture = ddtcore.load_image(str(IMAGES / f"{name}.png"))
    plain, grouped = (ddtcore.trace(picture, ddtcore.TraceOptions(stacking=stacking, group=group))
                      for group in ("none", "color"))
    assert len(runs(grouped.shapes)) < len(runs(plain.shapes))
    before, after = (over_white(bytes(resvg_py.svg_to_bytes(svg_string=drawing.to_svg())))
                     for drawing in (plain, grouped))
    assert np.abs(before - after).max() <= 2
