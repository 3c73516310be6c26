# SPDX-License-Identifier: GPL-2.0-or-later
"""Distances from segments and triangles of colours, against sampled mixes."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.mixes import excess, length, segment_distance, third_share


def colours(seed, *shape):
    return np.random.RandomState(seed).randint(0, 256, shape).astype(np.float32)


@pytest.mark.parametrize("channels", [3, 4])
def test_segment_distance_is_the_least_over_all_mixes(channels):
    points, a, b = colours(1, 3, channels, 200)
    distance, share = segment_distance(points, a, b)
    mixes = a[..., None] + np.linspace(0, 1, 1001) * (b - a)[..., None]
    least = length(points[..., None] - mixes).min(axis=-1)
    assert (distance <= least + 1e-3).all() and (distance > least - 0.5).all()
    np.testing.assert_allclose(length(points - a - share * (b - a)), distance, atol=1e-3)
    np.testing.assert_allclose(excess(points, a, b), points - a - share * (b - a), atol=1e-3)


def test_segment_of_one_colour():
    point, a = np.array([[10.0]]), np.array([[4.0]])
    distance, _ = segment_distance(point, a, a)
    assert distance[0] == 6


@pytest.mark.parametrize("channels", [3, 4])
def test_third_share_is_the_nearest_mix_with_the_third(channels):
    points, a, b = colours(2, 3, channels, 60)
    thirds = colours(3, channels, 5)
    distance, share = third_share(points, a, b, thirds)
    x, y = np.meshgrid(np.linspace(0, 1, 81), np.linspace(0, 1, 81))
    x, y = x[x + y <= 1], y[x + y <= 1]
    for k in range(5):
        third = thirds[:, k, None]
        mixes = a[..., None] + x * (b - a)[..., None] + y * (third - a)[..., None]
        off = length(points[..., None] - mixes)
        inside = off.min(axis=-1)
        # The side from a to b has none of the third colour and is left out.
        sides = off[:, (x == 0) | (x + y == 1)].min(axis=-1)
        assert (distance[:, k] >= inside - 4).all() and (distance[:, k] <= sides + 4).all()
    assert ((share >= 0) & (share <= 1)).all()


@pytest.mark.parametrize("coverage", [0.1, 0.4, 0.9])
def test_share_of_a_known_mix_is_found(coverage):
    a, b, third = (np.array(c, np.float32)[:, None] for c in ((255, 208, 32), (32, 80, 208), (10, 0, 0)))
    point = (1 - coverage) * (0.3 * a + 0.7 * b) + coverage * third
    distance, share = third_share(point, a, b, third)
    assert distance[0, 0] < 0.5
    np.testing.assert_allclose(share[0, 0], coverage, atol=0.01)


def test_colours_on_one_line_are_mixed_along_it():
    a, b, third, point = (np.full((3, 1), level, np.float32) for level in (255, 255, 0, 100))
    distance, share = third_share(point, a, b, third)
    assert distance[0, 0] < 0.1
    np.testing.assert_allclose(share[0, 0], 155 / 255, atol=1e-3)
