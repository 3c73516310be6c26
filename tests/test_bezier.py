# SPDX-License-Identifier: GPL-2.0-or-later
"""Bézier mathematics against de Casteljau's construction and plain differences."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore import bezier

RANDOM = np.random.RandomState(1)
CONTROL = RANDOM.uniform(-50, 50, (20, 4, 2))
SEGMENT = RANDOM.randint(0, 20, 200)
T = RANDOM.uniform(0, 1, 200)


def de_casteljau(control, t):
    points = control
    while len(points) > 1:
        points = (1 - t) * points[:-1] + t * points[1:]
    return points[0]


def test_points_are_those_of_de_casteljau():
    expected = [de_casteljau(CONTROL[s], t) for s, t in zip(SEGMENT, T)]
    assert np.allclose(bezier.evaluate(CONTROL, SEGMENT, T), expected)


def test_ends_are_exact():
    every = np.arange(20)
    assert np.array_equal(bezier.evaluate(CONTROL, every, np.zeros(20)), CONTROL[:, 0])
    assert np.array_equal(bezier.evaluate(CONTROL, every, np.ones(20)), CONTROL[:, 3])


@pytest.mark.parametrize("function, slope", [(bezier.evaluate, bezier.derivative),
                                             (bezier.derivative, bezier.second_derivative)])
def test_derivatives_are_limits_of_differences(function, slope):
    h = 1e-5
    difference = (function(CONTROL, SEGMENT, T + h) - function(CONTROL, SEGMENT, T - h)) / (2 * h)
    assert np.allclose(slope(CONTROL, SEGMENT, T), difference, atol=1e-4)


def test_a_line_is_walked_at_an_even_pace():
    start, end = CONTROL[:, 0], CONTROL[:, 3]
    lines = bezier.from_line(start, end)
    assert np.array_equal(lines[:, [0, 3]], CONTROL[:, [0, 3]])
    expected = start[SEGMENT] + T[:, None] * (end - start)[SEGMENT]
    assert np.allclose(bezier.evaluate(lines, SEGMENT, T), expected)


def test_reprojection_finds_the_nearest_point():
    control = np.array([[[0, 0], [10, 15], [30, 15], [40, 0]]], float)
    segment = np.zeros(50, int)
    truth = np.linspace(0.05, 0.95, 50)
    along = bezier.derivative(control, segment, truth)
    across = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
    side = np.where(np.arange(50) % 2, 0.5, -0.5)[:, None]
    points = bezier.evaluate(control, segment, truth) + across * side
    t = np.clip(truth + 0.05 * np.cos(np.arange(50)), 0, 1)
    for _ in range(4):
        t = bezier.reproject(control, segment, t, points)
    assert np.allclose(t, truth, atol=1e-6)


def test_reprojection_stays_on_the_segment():
    points = RANDOM.uniform(-100, 100, (200, 2))
    t = bezier.reproject(CONTROL, SEGMENT, T, points)
    assert t.min() >= 0 and t.max() <= 1
    still = bezier.reproject(np.zeros((1, 4, 2)), np.zeros(3, int), np.array([0, 0.5, 1]), np.zeros((3, 2)))
    assert still.tolist() == [0, 0.5, 1]
