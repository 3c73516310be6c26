# SPDX-License-Identifier: GPL-2.0-or-later
"""Stops are found where they were put, and no more of them than needed."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.stops import choose_stops, profile

PLACE = np.linspace(0, 1, 4001)
KNOWN = [
    ((0, 1), ((10, 200, 7), (250, 20, 7))),
    ((0.2, 0.7), ((10, 200, 7), (250, 20, 99))),
    ((0, 0.35, 1), ((0, 0, 0), (200, 100, 50), (255, 255, 255))),
    ((0, 0.5, 1), ((200, 0, 0), (0, 0, 200), (200, 0, 0))),
    ((0.1, 0.3, 0.6, 0.9), ((0, 0, 0), (250, 0, 0), (250, 250, 0), (30, 30, 90))),
]


def along(offsets, colours, place=PLACE):
    """Colours (n, C) between stops."""
    return np.stack([np.interp(place, offsets, channel) for channel in np.array(colours, float).T], axis=1)


@pytest.mark.parametrize("seed", range(6))
def test_colours_of_stops_are_those_of_least_squares(seed):
    random = np.random.RandomState(seed)
    place = np.sort(random.rand(4000))
    colour = np.stack([127 + 90 * np.sin(9 * place + k) for k in range(3)], axis=1) + random.randn(4000, 3)
    bins = profile(place, colour, 1 + random.rand(4000))
    (knots, values), = choose_stops([bins], 10.0)
    shares = np.stack([np.interp(bins.place, knots, row) for row in np.eye(len(knots))], axis=1)
    root = np.sqrt(bins.weight[:, :1])
    best = np.linalg.lstsq(root * shares, root * bins.colour, rcond=None)[0]
    np.testing.assert_allclose(values, np.clip(best, 0, 255), atol=0.5)


@pytest.mark.parametrize("offsets, colours", KNOWN)
def test_known_stops_are_found_in_rounded_colours(offsets, colours):
    bins = profile(PLACE, np.rint(along(offsets, colours)), np.ones(len(PLACE)))
    (knots, values), = choose_stops([bins], price=200.0)
    assert len(knots) == len(offsets)
    np.testing.assert_allclose(knots, offsets, atol=0.01)
    # Within the first and the last bin the colours are the bin's mean.
    inner = (PLACE > 0.01) & (PLACE < 0.99)
    np.testing.assert_allclose(along(knots, values)[inner], along(offsets, colours)[inner], atol=1.5)


def test_a_stop_that_saves_less_than_its_price_is_left_out():
    bins = profile(PLACE, along(*KNOWN[2]), np.ones(len(PLACE)))
    assert len(choose_stops([bins], price=1e9)[0][0]) == 2


def test_a_profile_averages_what_falls_into_a_bin():
    bins = profile(np.array([0.5, 0.5, 1.0]), np.array([[10.0, 0, 0], [40.0, 0, 0], [7.0, 7, 7]]),
                   np.array([2.0, 1.0, 5.0]))
    np.testing.assert_allclose(bins.place, [0.5, 1])
    np.testing.assert_allclose(bins.colour, [[20, 0, 0], [7, 7, 7]])
    np.testing.assert_allclose(bins.weight, [[3, 3, 3], [5, 5, 5]])


def test_translucent_colours_are_not_premultiplied_and_count_by_their_alpha():
    bins = profile(np.array([0.0, 1.0]), np.array([[50.0, 25, 0, 127.5], [0, 0, 0, 0]]), np.ones(2))
    np.testing.assert_allclose(bins.colour[0], [100, 50, 0, 127.5])
    np.testing.assert_allclose(bins.weight[0], [0.25, 0.25, 0.25, 1])
    assert bins.weight[1, 0] < 1e-5


def test_gradients_do_not_matter_to_each_other():
    """The stops of many gradients at a time, of few bins or many, are those that each has alone."""
    bins = [profile(place, np.rint(along(offsets, colours, place)), np.ones(len(place))) for offsets, colours in KNOWN
            for place in (PLACE, np.linspace(0, 1, 9), np.linspace(0, 1, 50) ** 2)]
    for (knots, values), one in zip(choose_stops(bins, 50.0), bins):
        (expected, colours), = choose_stops([one], 50.0)
        np.testing.assert_allclose(knots, expected, atol=1e-6)
        np.testing.assert_allclose(values, colours, atol=1e-4)
