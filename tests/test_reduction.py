# SPDX-License-Identifier: GPL-2.0-or-later
"""Smaller pictures are block means, and their drawings grow back to the right place."""

from __future__ import annotations

import numpy as np
import pytest
from alignment import shift
from painted import render
from pictures import BLACK, RED, WHITE, disc, picture, star

from ddtcore import trace
from ddtcore.model import Drawing, Gradient, Loop, Shape, Triangles
from ddtcore.reduction import enlarge, reduce


def noise(height, width, opaque):
    image = np.random.RandomState(height).randint(0, 256, (height, width, 4)).astype(np.uint8)
    if opaque:
        image[..., 3] = 255
    return image


def block_mean(image, row, col, factor):
    """Mean of one block by the definition, in whole numbers as far as they go."""
    block = image[row * factor:(row + 1) * factor, col * factor:(col + 1) * factor].reshape(-1, 4).astype(float)
    alpha = block[:, 3:]
    if not alpha.any():
        return np.zeros(4)
    return np.append((block * alpha).sum(axis=0)[:3] / alpha.sum(), alpha.mean())


@pytest.mark.parametrize("factor", (2, 3, 7))
@pytest.mark.parametrize("opaque", (True, False))
def test_pixels_are_means_of_blocks(factor, opaque):
    image = noise(150 * factor, 5 * factor, opaque)
    image[:factor, :factor, 3] = 0
    small = reduce(image, factor)
    assert small.shape == (150, 5, 4) and small.dtype == np.uint8
    expected = [[block_mean(image, row, col, factor) for col in range(5)] for row in range(150)]
    visible = small[..., 3] > 0
    assert np.abs(small - expected)[visible].max() <= 0.5 + 1e-9
    assert np.abs(small - expected)[..., 3].max() <= 0.5 + 1e-9


def test_flat_pictures_stay_as_they_are():
    for colour in ((7, 99, 201, 255), (7, 99, 201, 3), (0, 0, 0, 0)):
        image = np.full((5, 8, 4), colour, np.uint8)
        assert (reduce(image, 3) == colour).all()


def test_factor_one_does_nothing():
    image = noise(4, 5, True)
    assert reduce(image, 1) is image


def test_blocks_that_are_not_full_repeat_the_outermost_pixels():
    image = noise(5, 7, True)
    padded = np.pad(image, ((0, 1), (0, 2), (0, 0)), mode="edge")
    assert (reduce(image, 3) == reduce(padded, 3)).all() and reduce(image, 3).shape == (2, 3, 4)


def test_colours_under_transparent_pixels_have_no_say():
    image = noise(6, 6, False)
    image[::2, :, 3] = 0
    other = image.copy()
    other[::2, :, :3] = 255 - other[::2, :, :3]
    assert (reduce(image, 2) == reduce(other, 2)).all()


def test_everything_in_a_drawing_grows():
    control = np.array([[[0, 0], [1, 0], [2, 0], [3, 1]], [[3, 1], [2, 2], [1, 2], [0, 0]]], float)
    radial = Gradient("radial", (1, 1), (2, 1), ((0.0, (1, 2, 3), 1.0), (1.0, (4, 5, 6), 0.5)), (1, 3))
    shapes = (Shape("a", (1, 2, 3), 1.0, (Loop(control, np.full(2, 3)),), 2.5, radial),
              Shape("b", (1, 2, 3), 0.5, (), 1.0))
    grown = enlarge(Drawing(3, 2, shapes, notes=("so",)), (10, 10), 28, 20)
    assert (grown.width, grown.height, grown.notes) == (28, 20, ("so",))
    loop = grown.shapes[0].loops[0]
    assert loop.control.tolist() == [[[0, 0], [10, 0], [18, 0], [28, 10]], [[28, 10], [18, 20], [10, 20], [0, 0]]]
    assert (loop.control[:, 3] == np.roll(loop.control[:, 0], -1, axis=0)).all()
    assert [shape.area for shape in grown.shapes] == [250, 100] and grown.shapes[1].gradient is None
    gradient = grown.shapes[0].gradient
    assert (gradient.start, gradient.end, gradient.across) == ((10, 10), (20, 10), (10, 30))


def test_handles_beyond_the_picture_stay():
    """A curve that lies within the picture keeps its form wherever its control points are."""
    control = np.array([[[5, 1], [10, 1], [10, 9], [5, 9]], [[5, 9], [5, 6], [5, 3], [5, 1]]], float)
    shape = Shape("a", (1, 2, 3), 1.0, (Loop(control, np.full(2, 3)),), 30.0)
    assert (enlarge(Drawing(9, 10, (shape,)), (2, 2), 18, 20).shapes[0].loops[0].control == 2 * control).all()


def test_meshes_grow():
    points = np.array([[[0, 0], [2, 0], [0, 2]]], float)
    mesh = Triangles(points, np.zeros((1, 3), np.uint8), np.ones(1), np.zeros(1, bool), True)
    assert enlarge(Drawing(2, 2, triangles=mesh), (4, 4), 8, 7).triangles.points.tolist() == [[[0, 0], [8, 0], [0, 7]]]


def test_the_drawing_of_a_reduced_picture_lies_on_the_picture():
    parts = [disc((60.3, 52.2), 40), star((141.2, 60.4), 44, 20, 5, 12)]
    image = picture(199, 121, parts, (WHITE, BLACK, RED)).image
    drawing = enlarge(trace(reduce(image, 2)), (2, 2), 199, 121)
    back = render(drawing, 1, page="white")[..., :3].astype(float)
    assert back.shape == (121, 199, 3)
    assert np.abs(shift(image[..., :3].astype(float), back)).max() < 0.05
