# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradients become bands, or one colour, as asked."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.bands import MOST, level
from ddtcore.canvas import premultiply
from ddtcore.gradient import colours_at
from ddtcore.model import Gradient, Labels
from ddtcore.options import TraceOptions
from ddtcore.paint import find_gradients
from ddtcore.pipeline import trace

SIZE = 64
LINEAR = Gradient("linear", (4, 0), (60, 0), ((0.0, (10, 40, 160), 1.0), (1.0, (250, 160, 40), 1.0)))
FADING = Gradient("radial", (32, 32), (70, 32), ((0.0, (200, 20, 0), 1.0), (1.0, (200, 20, 0), 0.2)))
FAINT = Gradient("linear", (4, 0), (60, 0), ((0.0, (100, 100, 100), 1.0), (1.0, (110, 100, 100), 1.0)))
OPTIONS = {kind: TraceOptions(gradients=kind) for kind in ("gradients", "bands", "flat")}


def painted(gradient):
    """A gradient (label 0) in a frame of green (label 1)."""
    row, col = (grid.ravel() for grid in np.mgrid[:SIZE, :SIZE])
    colour = colours_at(gradient, np.stack([col, row], axis=1) + 0.5).reshape(SIZE, SIZE, 4)
    alpha = np.maximum(colour[..., 3:], 1)
    image = np.rint(np.concatenate([colour[..., :3] * 255 / alpha, colour[..., 3:]], axis=2)).astype(np.uint8)
    index = np.ones((SIZE, SIZE), np.int32)
    index[4:-4, 4:-4] = 0
    image[index == 1] = (0, 120, 30, 255)
    mean = image[index == 0].mean(axis=0)
    labels = Labels(index, np.array([mean, (0, 120, 30, 255)]), np.zeros(index.shape, bool),
                    np.array([True, False]), (gradient, None))
    return image, labels


def test_gradients_stay_unless_something_else_is_asked_for():
    image, labels = painted(LINEAR)
    same, unchanged = level(image, labels, OPTIONS["gradients"])
    assert same is image and unchanged is labels


@pytest.mark.parametrize("gradient", [LINEAR, FADING])
def test_bands_are_flat_few_and_near_the_gradient(gradient):
    image, labels = painted(gradient)
    out, banded = level(image, labels, OPTIONS["bands"])
    assert not banded.ramp.any() and not any(banded.gradients)
    inside = labels.index == 0
    bands = np.unique(banded.index[inside])
    assert 4 < bands.size <= MOST
    near = premultiply(banded.palette)[banded.index[inside]] - premultiply(image[inside].astype(float))
    step = np.ptp(premultiply(image[inside].astype(float)), axis=0).max() / bands.size
    assert np.abs(near).max() < step + 2
    # Away from all edges a band has one colour.
    flat = premultiply(out.astype(float)) - premultiply(banded.palette)[banded.index]
    assert (np.abs(flat[inside]).max(axis=1) < 1.1).mean() > 0.6
    np.testing.assert_array_equal(out[~inside], image[~inside])


def test_edges_of_bands_are_mixed_by_how_much_each_covers():
    gradient = Gradient("linear", (3.3, 0), (60.1, 0), LINEAR.stops)
    image, labels = painted(gradient)
    out, banded = level(image, labels, OPTIONS["bands"])
    colours = banded.palette[banded.index[32]]
    edges = np.flatnonzero(np.diff(banded.index[32, 6:-6])) + 6
    for k in edges:
        share = [(out[32, j, 0] - colours[k + 1, 0]) / (colours[k, 0] - colours[k + 1, 0]) for j in (k, k + 1)]
        passed = k + sum(share)
        place = (passed - 3.3) / 56.8 * MOST
        assert abs(place - round(place)) < 0.05


def test_faint_gradients_have_few_bands():
    image, labels = painted(FAINT)
    _, banded = level(image, labels, OPTIONS["bands"])
    assert np.unique(banded.index[labels.index == 0]).size == 1


def test_flat_is_one_mean_colour():
    image, labels = painted(LINEAR)
    out, flat = level(image, labels, OPTIONS["flat"])
    assert not flat.ramp.any() and not any(flat.gradients)
    np.testing.assert_array_equal(flat.index, labels.index)
    np.testing.assert_allclose(flat.palette, labels.palette)
    assert np.abs(out[8:-8, 8:-8].astype(float) - labels.palette[0]).max() < 1


@pytest.mark.parametrize("kind, shapes, gradients", [("gradients", 2, 1), ("bands", MOST + 1, 0), ("flat", 2, 0)])
def test_traces_have_what_was_asked_for(kind, shapes, gradients):
    image, _ = painted(LINEAR)
    drawing = trace(image, OPTIONS[kind])
    assert len(drawing.shapes) == shapes
    assert sum(shape.gradient is not None for shape in drawing.shapes) == gradients


def test_pictures_without_gradients_are_left_alone():
    image = np.full((9, 9, 4), 255, np.uint8)
    labels = find_gradients(image, Labels(np.zeros((9, 9), np.int32), np.full((1, 4), 255.0),
                                          np.zeros((9, 9), bool)))
    for options in OPTIONS.values():
        assert level(image, labels, options)[0] is image
