# SPDX-License-Identifier: GPL-2.0-or-later
"""A flattened picture has flat colours and the same coverage as before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planar import palette_labels

from ddtcore.canvas import premultiply
from ddtcore.flatten import flatten
from ddtcore.model import Gradient
from ddtcore.paint import local_colours

SIZE = 24
SOFT = Gradient("linear", (0, 0), (0, SIZE), ((0.0, (0, 0, 120), 1.0), (1.0, (250, 160, 120), 1.0)))
SOFT_TOO = Gradient("linear", (0, 0), (0, SIZE), ((0.0, (255, 255, 255), 0.9), (1.0, (0, 90, 0), 0.3)))


def bytes_of(colour):
    """RGBA bytes of premultiplied colours."""
    alpha = np.maximum(colour[..., 3:], 1e-9)
    return np.rint(np.concatenate([colour[..., :3] * 255 / alpha, colour[..., 3:]], axis=-1)).astype(np.uint8)


def picture(gradients, palette, share):
    """Label 0 on the left and 1 on the right, and in column 12 `share` of label 0."""
    index = np.repeat(np.arange(SIZE)[None] >= (12 if share < 0.5 else 13), SIZE, axis=0).astype(np.int32)
    labels = replace(palette_labels(index, palette), gradients=gradients)
    row, col = (grid.ravel() for grid in np.mgrid[0:SIZE, 0:SIZE])
    points = np.stack([col, row], axis=1) + 0.5
    left, right = (local_colours(labels, np.full(len(points), k), points) for k in (0, 1))
    cover = np.where(col < 12, 1.0, np.where(col == 12, share, 0.0))[:, None]
    return bytes_of(cover * left + (1 - cover) * right).reshape(SIZE, SIZE, 4), labels


@pytest.mark.parametrize("share", [0.1, 0.35, 0.6, 0.95])
@pytest.mark.parametrize("gradients, palette", [
    ((SOFT, None), [(125, 80, 120, 255), (0, 220, 0, 255)]),
    ((None, SOFT), [(0, 220, 0, 255), (125, 80, 120, 255)]),
    ((SOFT, None), [(125, 80, 120, 255), (0, 0, 0, 0)]),
    ((SOFT, SOFT_TOO), [(125, 80, 120, 255), (170, 200, 170, 153)]),
])
def test_mixed_pixels_become_the_same_mix_of_the_means(gradients, palette, share):
    image, labels = picture(gradients, palette, share)
    mean = premultiply(labels.palette)
    flat = premultiply(flatten(image, labels).astype(float))
    assert np.abs(flat[:, :12] - mean[0]).max() < 3 and np.abs(flat[:, 13:] - mean[1]).max() < 3
    span = mean[0] - mean[1]
    found = (flat[:, 12] - mean[1]).dot(span) / span.dot(span)
    assert np.abs(found - share).max() < 0.05


def test_flat_pictures_stay_as_they_are():
    image, labels = picture((None, None), [(125, 80, 120, 255), (0, 220, 0, 255)], 0.5)
    assert flatten(image, labels) is image
    assert flatten(image, replace(labels, gradients=None)) is image


def test_flat_labels_keep_their_pixels_away_from_gradients():
    image, labels = picture((SOFT, None), [(125, 80, 120, 255), (0, 220, 0, 255)], 0.5)
    image[5:9, 18:21] = (9, 8, 7, 255)
    before = image.copy()
    np.testing.assert_array_equal(flatten(image, labels)[:, 16:], before[:, 16:])
    np.testing.assert_array_equal(image, before)


def test_what_is_no_mix_still_shows():
    image, labels = picture((SOFT, None), [(125, 80, 120, 255), (0, 220, 0, 255)], 0.5)
    image[10, 11] = (255, 0, 255, 255)
    changed = flatten(image, labels)[10, 11].astype(int)
    assert np.abs(changed - (125, 80, 120, 255)).max() > 60
