# SPDX-License-Identifier: GPL-2.0-or-later
"""All pictures of two colours up to 3 x 3 pixels, and some of three: nothing is lost, nothing is too large."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from invariants import assert_sound
from painted import render

from ddtcore import TraceOptions, trace

COLOURS = np.array([(255, 255, 255, 255), (0, 0, 0, 255), (220, 30, 40, 255)], np.uint8)
ZOOM = 20
SHAPES = [(height, width) for height in (1, 2, 3) for width in (1, 2, 3)]
EXACT = {"stacked": TraceOptions(), "cutout": TraceOptions(stacking="cutout")}
LIKE_PIXELS = {"automatic": None, "pixels": TraceOptions.preset("pixel-art")}
PAPER = {"paper": TraceOptions.preset("paper"), "cutout": TraceOptions.preset("paper", stacking="cutout")}


def patterns(height, width, colours=2):
    """Every picture of a size as labels (H, W)."""
    for number in range(colours ** (height * width)):
        yield number // colours ** np.arange(height * width).reshape(height, width) % colours


def some_of_three(count=120):
    random = np.random.RandomState(3)
    return [random.randint(0, 3, SHAPES[random.randint(len(SHAPES))]) for _ in range(count)]


def shown(index, options):
    """Area of each colour and of all together in the drawing, px²; the edges are not smoothed."""
    drawing = trace(COLOURS[index], options)
    assert_sound(drawing)
    points = render(drawing, ZOOM, antialias=False)
    return [(points == colour).all(axis=2).sum() / ZOOM ** 2 for colour in COLOURS], (points[..., 3] == 255).mean()


def wrong(pictures, options, within):
    """Those pictures whose areas are not those of their pixels."""
    for index in pictures:
        areas, covered = shown(index, options)
        pixels = np.bincount(index.ravel(), minlength=len(COLOURS))
        if covered < 1 or np.abs(areas - pixels).max() > within:
            yield index.tolist(), areas


@pytest.mark.parametrize("options", [pytest.param(options, id=name) for name, options in EXACT.items()])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_areas_of_two_colours_are_those_of_the_pixels(shape, options):
    assert not list(wrong(patterns(*shape), options, within=0.05))


@pytest.mark.parametrize("options", [pytest.param(options, id=name) for name, options in EXACT.items()])
def test_areas_of_three_colours_are_those_of_the_pixels(options):
    assert not list(wrong(some_of_three(), options, within=0.05))


@pytest.mark.parametrize("options", [pytest.param(options, id=name) for name, options in LIKE_PIXELS.items()])
def test_so_are_they_when_the_preset_is_chosen_by_the_picture(options):
    assert not list(wrong([*islice(patterns(3, 3), 0, None, 7), *some_of_three(30)], options, within=0.05))


@pytest.mark.parametrize("options", [pytest.param(options, id=name) for name, options in PAPER.items()])
def test_curves_through_barycentres_round_the_corners_but_lose_nothing(options):
    """Half of the corners' points are left out as well: up to a quarter of these pictures changes its colour."""
    for index in [*islice(patterns(3, 3), 0, None, 5), *patterns(2, 3), *some_of_three(30)]:
        areas, covered = shown(index, options)
        assert covered == 1, index
        assert all(area > 0.05 for area, pixels in zip(areas, np.bincount(index.ravel())) if pixels), index
        assert np.abs(areas - np.bincount(index.ravel(), minlength=3)).max() < 0.25 * index.size + 0.2, index
