# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradients are found again in pictures painted with them."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from ddtcore.gradient import BYTES, ELLIPSE_BYTES, PRICE, STOP_BYTES, Wanted, colours_at, fit_gradients, price
from ddtcore.model import Gradient
from ddtcore.samples import Samples

BLUE, WHITE, RED, BROWN = (20, 40, 160), (255, 255, 255), (220, 30, 10), (90, 50, 10)
TWO = ((0.0, BLUE, 1.0), (1.0, WHITE, 1.0))
THREE = ((0.0, RED, 1.0), (0.4, WHITE, 1.0), (1.0, BROWN, 1.0))
FADE = ((0.0, RED, 0.9), (1.0, RED, 0.1))


def linear(degrees, length=110.0, stops=TWO):
    """A gradient through the middle of the region."""
    half = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))]) * length / 2
    return Gradient("linear", tuple(60 - half), tuple(60 + half), stops)


GRADIENTS = [
    *(linear(degrees) for degrees in (0, 17, 45, 90, 133, 180, 271)),
    linear(30, stops=THREE), linear(200, stops=FADE), linear(60, length=40),
    Gradient("radial", (60, 60), (110, 60), TWO), Gradient("radial", (40, 45), (120, 45), THREE),
    Gradient("radial", (160, 10), (20, 60), TWO), Gradient("radial", (55, 60), (55, 115), FADE),
    Gradient("radial", (60, 55), (110, 65), TWO, across=(54, 85)),
]


def fit_gradient(samples, reach):
    return fit_gradients([Wanted(samples, reach)])[0]


def region():
    """Pixel centres of a disc with a hole."""
    row, col = np.mgrid[0:120, 0:120]
    points = np.stack([col.ravel(), row.ravel()], axis=1) + 0.5
    distance = np.hypot(*(points - 60).T)
    return points[(distance < 50) & (np.hypot(*(points - (75, 70)).T) > 12)]


def painted(gradient, points):
    """Samples of a picture with 8 bits per channel."""
    colour = np.rint(colours_at(gradient, points))
    channels = 3 if (colour[:, 3] == 255).all() else 4
    return Samples(points, colour[:, :channels], np.ones(len(points)))


@pytest.mark.parametrize("gradient", GRADIENTS)
def test_what_was_painted_is_found(gradient):
    points = region()
    found = fit_gradient(painted(gradient, points), points)
    assert found.kind == gradient.kind and (found.across is None) == (gradient.across is None)
    assert len(found.stops) == len(gradient.stops)
    off = colours_at(found, points) - colours_at(gradient, points)
    assert np.sqrt((off ** 2).mean()) < 0.7 and np.abs(off).max() < 4
    if gradient.kind == "radial":
        assert math.dist(found.start, gradient.start) < 5


@pytest.mark.parametrize("gradient", GRADIENTS[:9])
def test_gradients_go_on_beyond_the_samples(gradient):
    points = region()
    inner = points[np.hypot(*(points - 60).T) < 44]
    off = colours_at(fit_gradient(painted(gradient, inner), points), points) - colours_at(gradient, points)
    assert np.abs(off).max() < 4


def test_regions_do_not_matter_to_each_other():
    points = region()
    noise = np.random.RandomState(3).randint(-2, 3, (len(points), 3))
    regions = [Wanted(some, points, kinds) for some in
               (painted(gradient, points)._replace(colour=colours_at(gradient, points)[:, :3] + noise)
                for gradient in GRADIENTS) for kinds in (3, 1)]
    regions[4:4] = [Wanted(regions[0].samples._replace(colour=0 * noise), points)]
    found = fit_gradients(regions)
    assert found[4] is None and found == [fit_gradients([one])[0] for one in regions]
    assert {gradient.kind for gradient in found[6::2]} == {"linear"}


def test_stops_rise_from_the_first_to_one():
    for gradient in GRADIENTS:
        offsets = [stop[0] for stop in fit_gradient(painted(gradient, region()), region()).stops]
        assert offsets == sorted(offsets) and offsets[0] >= 0 and offsets[-1] == 1
        assert 2 <= len(offsets) <= 4


def test_a_flat_region_has_no_gradient():
    points = region()
    grey = np.full((len(points), 3), 77.0)
    assert fit_gradient(Samples(points, grey, np.ones(len(points))), points) is None


def test_noise_is_no_gradient():
    points = region()
    noise = 128 + 3.0 * np.random.RandomState(6).randn(len(points), 3)
    assert fit_gradient(Samples(points, np.rint(noise), np.ones(len(points))), points) is None


def test_a_gradient_must_pay_for_its_bytes():
    """A slope of four levels is worth a gradient in a large region, but not in a small one."""
    faint = linear(0, stops=((0.0, (100, 100, 100), 1.0), (1.0, (108, 108, 108), 1.0)))
    points = region()
    small = points[np.abs(points - 60).max(axis=1) < 10]
    assert fit_gradient(painted(faint, points), points) is not None
    assert fit_gradient(painted(faint, small), small) is None


def test_a_single_point_or_none_apart_has_no_gradient():
    points = np.full((5, 2), 3.5)
    assert fit_gradient(Samples(points, np.arange(15.0).reshape(5, 3), np.ones(5)), points) is None


def test_pixels_of_something_else_do_not_matter():
    points = region()
    samples = painted(linear(17), points)
    samples.colour[::40] = (0, 255, 0)
    off = colours_at(fit_gradient(samples, points), points) - colours_at(linear(17), points)
    assert np.abs(off).max() < 4


@pytest.mark.parametrize("seed", range(30))
def test_odd_regions_have_sound_gradients_or_none(seed):
    """Few points, on a line, of any colours: whatever is found can be written and painted."""
    random = np.random.RandomState(seed)
    points = random.randint(0, 9, (random.randint(1, 40), 2)) * (1, seed % 2) + 0.5
    colour = random.randint(0, 256, (len(points), 3 + seed % 2)).astype(float)
    colour[:, :3] *= colour[:, 3:] / 255 if seed % 2 else 1
    found = fit_gradient(Samples(points, colour, np.ones(len(points))), points)
    if found is not None:
        assert found.start != found.end
        assert np.isfinite(colours_at(found, points)).all() and 2 <= len(found.stops) <= 4
        offsets = [stop[0] for stop in found.stops]
        assert offsets == sorted(set(offsets))


def test_a_thin_bar_has_its_gradient_along_it():
    row, col = np.mgrid[0:3, 0:90]
    points = np.stack([col.ravel(), row.ravel()], axis=1) + 0.5
    bar = Gradient("linear", (0, 0), (90, 0), TWO)
    off = colours_at(fit_gradient(painted(bar, points), points), points) - colours_at(bar, points)
    assert np.abs(off).max() < 3


def test_colours_follow_the_rules_of_svg():
    at = np.array([[0, 9], [5, -3], [10, 0], [-20, 0], [30, 0]], float)
    across = Gradient("linear", (0, 0), (10, 0), ((0.0, (200, 100, 0), 1.0), (1.0, (0, 0, 0), 0.0)))
    # Halfway the colour is (100, 50, 0) and half transparent, whatever the colour of nothing.
    np.testing.assert_allclose(colours_at(across, at),
                               [[200, 100, 0, 255], [50, 25, 0, 127.5], [0] * 4, [200, 100, 0, 255], [0] * 4])
    ring = Gradient("radial", (0, 0), (0, 10), ((0.5, (0, 0, 0), 1.0), (1.0, (100, 100, 100), 1.0)))
    np.testing.assert_allclose(colours_at(ring, np.array([[1.0, 0], [0, 7.5], [-6, 8], [40, 0]]))[:, 0],
                               [0, 50, 100, 100])
    oval = replace(ring, across=(20, 0))
    np.testing.assert_allclose(colours_at(oval, np.array([[15.0, 0], [0, 7.5], [10, 5]]))[:, 0],
                               [50, 50, 100 * (2 * math.sqrt(0.5) - 1)])


def test_prices_grow_with_stops_and_ellipses():
    assert price(linear(0)) == PRICE * BYTES
    assert price(linear(0, stops=THREE)) == PRICE * (BYTES + STOP_BYTES)
    assert price(GRADIENTS[-1]) == PRICE * (BYTES + ELLIPSE_BYTES)
