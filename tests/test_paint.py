# SPDX-License-Identifier: GPL-2.0-or-later
"""Each face gets the colours that its pixels have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planar import palette_labels, planar_map

from ddtcore.canvas import premultiply
from ddtcore.gradient import colours_at
from ddtcore.model import OUTSIDE, Gradient
from ddtcore.options import TraceOptions
from ddtcore.paint import NOTHING, Paint, face_paints, find_gradients, local_colours

SIZE = 30
OPAQUE = Gradient("linear", (2, 0), (28, 0), ((0.0, (10, 60, 200), 1.0), (1.0, (240, 120, 0), 1.0)))
FADING = Gradient("linear", (0, 2), (0, 28), ((0.0, (200, 0, 0), 0.9), (1.0, (200, 0, 0), 0.2)))
GREEN = (0, 180, 40, 255)


def painted(gradient, flat=GREEN):
    """A ramp (label 0) in two halves, a flat bar (label 1) between, and a white speck of label 0."""
    index = np.zeros((SIZE, SIZE), np.int32)
    index[:, 13:17] = 1
    row, col = np.mgrid[0:SIZE, 0:SIZE]
    colour = colours_at(gradient, np.stack([col.ravel(), row.ravel()], axis=1) + 0.5).reshape(SIZE, SIZE, 4)
    alpha = np.maximum(colour[..., 3:], 1)
    image = np.rint(np.concatenate([colour[..., :3] * 255 / alpha, colour[..., 3:]], axis=2)).astype(np.uint8)
    image[index == 1] = flat
    index[14:16, 14:16], image[14:16, 14:16] = 0, (255, 255, 255, 255)
    palette = [image[index == 0].mean(axis=0), flat]
    labels = palette_labels(index, palette)
    return image, replace(labels, ramp=np.array([True, False]))


def paints_of(image, labels):
    planar, _, _ = planar_map(labels.index)
    return face_paints(image, labels, planar, TraceOptions()), planar


def test_flat_faces_have_the_colours_of_the_palette():
    index = np.zeros((4, 6), np.int32)
    index[:, 3:] = 1
    index[0, 0] = 2
    labels = palette_labels(index, [(10.4, 20.6, 30, 255), (0, 0, 0, 0), (9, 9, 9, 51)])
    paints, planar = paints_of(np.zeros((4, 6, 4), np.uint8), labels)
    known = {OUTSIDE: NOTHING, 0: Paint((10, 21, 30), 1.0), 1: NOTHING, 2: Paint((9, 9, 9), 0.2)}
    assert paints == [known[label] for label in planar.face_labels.tolist()]


@pytest.mark.parametrize("gradient", [OPAQUE, FADING])
def test_faces_of_a_ramp_share_the_gradient_they_were_painted_with(gradient):
    image, labels = painted(gradient)
    paints, planar = paints_of(image, labels)
    left, right = (paints[planar.pixel_faces[15, col]] for col in (2, 27))
    assert left.gradient is right.gradient is not None
    row, col = np.nonzero(labels.index == 0)
    points = np.stack([col, row], axis=1)[np.abs(col - 14.5) > 3] + 0.5
    assert np.abs(colours_at(left.gradient, points) - colours_at(gradient, points)).max() < 3
    assert paints[planar.pixel_faces[0, 14]] == Paint(GREEN[:3], 1.0)


def test_a_stray_face_of_a_ramp_keeps_its_own_colour():
    image, labels = painted(OPAQUE)
    paints, planar = paints_of(image, labels)
    assert paints[planar.pixel_faces[14, 14]] == Paint((255, 255, 255), 1.0)


def test_the_colour_of_a_gradient_stays_where_pixels_are_covered_in_part():
    image, labels = painted(OPAQUE)
    even = replace(OPAQUE, stops=((0.0, (200, 90, 60), 1.0), (1.0, (200, 90, 60), 1.0)))
    labels = replace(labels, gradients=(even, None))
    image[:, :13, :3] = np.where(np.arange(13)[:, None] % 3 > 0, (200, 90, 60), (220, 160, 140))
    paints, planar = paints_of(image, labels)
    assert paints[planar.pixel_faces[15, 2]] == Paint((200, 90, 60), 1.0)


def test_the_colour_of_a_gradient_is_its_mean_over_the_face():
    image, labels = painted(OPAQUE)
    paints, planar = paints_of(image, labels)
    for col in (2, 27):
        face = planar.pixel_faces[15, col]
        mean = image[planar.pixel_faces == face].mean(axis=0)
        assert np.abs(mean[:3] - paints[face].rgb).max() < 2


def test_only_gradients_without_translucent_stops_are_opaque():
    for gradient, opaque in ((OPAQUE, True), (FADING, False)):
        paints, planar = paints_of(*painted(gradient))
        assert (paints[planar.pixel_faces[15, 2]].opacity == 1) is opaque
    stops = ((0.0, (200, 0, 0), 1.0), (0.99, (0, 99, 0), 1.0), (1.0, (0, 99, 0), 0.996))
    nearly = replace(FADING, stops=stops)
    image, labels = painted(OPAQUE)
    paints, planar = paints_of(image, replace(labels, gradients=(nearly, None)))
    assert all(paint.opacity < 1 for paint in paints if paint.gradient)


def test_a_ramp_that_is_flat_has_no_gradient():
    image, labels = painted(OPAQUE, flat=(7, 7, 7, 255))
    image[labels.index == 0] = (50, 60, 70, 255)
    paints, planar = paints_of(image, labels)
    assert find_gradients(image, labels).gradients == (None, None)
    assert paints[planar.pixel_faces[15, 2]] == Paint((50, 60, 70), 1.0)


def test_labels_without_ramps_have_no_gradients():
    labels = palette_labels(np.arange(12).reshape(3, 4) // 6)
    assert find_gradients(np.zeros((3, 4, 4), np.uint8), labels).gradients == (None, None)


def test_local_colours_are_those_of_the_gradient_or_of_the_palette():
    _, labels = painted(OPAQUE)
    labels = replace(labels, gradients=(OPAQUE, None))
    points = np.array([[3.0, 5], [20, 5], [20, 5], [20, 5]])
    number = np.array([0, 0, 1, OUTSIDE])
    known = np.concatenate([colours_at(OPAQUE, points[:2]), [GREEN], np.zeros((1, 4))])
    np.testing.assert_allclose(local_colours(labels, number, points), known)
    np.testing.assert_allclose(local_colours(replace(labels, gradients=None), number[:1], points[:1]),
                               premultiply(labels.palette[:1]))


def stroke(width, flare=0.0):
    """A slanting stroke (label 1) on white (label 0), and its colour, which changes in its left half."""
    row, col = np.mgrid[:40, :80] + 0.5
    wide = width + flare * col / 80
    cover = np.clip(wide / 2 + 0.5 - abs(row - 12 - 0.2 * col), 0, 1)[..., None]
    left = np.maximum(50 - col, 0)
    colour = np.stack([200 + 0.5 * left, 110 - left, 40 + 0 * col], axis=-1)
    image = np.full((40, 80, 4), 255, np.uint8)
    image[..., :3] = np.rint(255 + cover * (colour - 255))
    labels = palette_labels((cover[..., 0] >= 0.5).astype(np.int32), [(255, 255, 255, 255), (210, 100, 40, 255)])
    return image, replace(labels, ramp=np.array([False, True])), colour


@pytest.mark.parametrize("width, flare", [(2.2, 0), (3, 0), (4, 0), (1.8, 3), (1.8, 6), (5, 0)])
def test_the_edge_of_a_narrow_region_tells_nothing_of_its_colour(width, flare):
    image, labels, colour = stroke(width, flare)
    labels = find_gradients(image, labels)
    row, col = np.nonzero(labels.index == 1)
    found = local_colours(labels, np.ones(row.size, int), np.stack([col, row], axis=1) + 0.5)
    assert np.abs(found[:, :3] - colour[row, col]).max() < 6
