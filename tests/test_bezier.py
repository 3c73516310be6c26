# SPDX-License-Identifier: GPL-2.0-or-later
"""Bézier mathematics against de Casteljau's construction and plain differences."""

from __future__ import annotations

import numpy as np

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


def test_a_line_is_walked_at_an_even_pace():
    start, end = CONTROL[:, 0], CONTROL[:, 3]
    lines = bezier.from_line(start, end)
    assert np.array_equal(lines[:, [0, 3]], CONTROL[:, [0, 3]])
    expected = start[SEGMENT] + T[:, None] * (end - start)[SEGMENT]
    assert np.allclose(bezier.evaluate(lines, SEGMENT, T), expected)
