# SPDX-License-Identifier: GPL-2.0-or-later
"""Differences of colours as they look."""

from __future__ import annotations

import numpy as np

from ddtcore.perception import nearest, oklab

RANDOM = np.random.RandomState(0)


def test_black_and_white_are_one_apart_and_greys_have_no_colour():
    grey = np.repeat(np.arange(256)[:, None], 3, axis=1)
    lightness, *opponents = oklab(grey).T
    assert lightness[0] == 0 and abs(lightness[-1] - 1) < 1e-6
    assert (np.diff(lightness) > 0).all() and np.abs(opponents).max() < 1e-6


def test_known_values():
    # From the article.
    expected = {(255, 0, 0): (0.628, 0.225, 0.126), (0, 255, 0): (0.866, -0.234, 0.179),
                (0, 0, 255): (0.452, -0.032, -0.312)}
    for rgb, values in expected.items():
        assert np.abs(oklab(np.array(rgb)) - values).max() < 1e-3


def test_the_nearest_colour_is_the_one_at_the_least_distance():
    points, among = RANDOM.randint(0, 256, (200, 3)), RANDOM.randint(0, 256, (9, 3))
    distance = np.linalg.norm(oklab(points)[:, None] - oklab(among), axis=2)
    assert np.array_equal(nearest(points, among), np.argmin(distance, axis=1))


def test_nearness_is_that_of_the_eye_not_that_of_the_numbers():
    # As numbers the dark blue is nearer to black; it looks blue.
    assert nearest(np.array([[0, 0, 120]]), np.array([[0, 0, 0], [0, 0, 255]])).tolist() == [1]
