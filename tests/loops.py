# SPDX-License-Identifier: GPL-2.0-or-later
"""Loops of Bézier segments to test with."""

from __future__ import annotations

import numpy as np

from ddtcore.model import CUBIC, LINE, QUADRATIC, Loop


def polygon(corners):
    """A loop of lines."""
    corners = np.asarray(corners, dtype=float)
    ends = np.roll(corners, -1, axis=0)
    return Loop(np.stack([corners, corners, ends, ends], axis=1), np.full(len(corners), LINE, np.uint8))


def rectangle(x, y, width, height):
    return polygon([(x, y), (x + width, y), (x + width, y + height), (x, y + height)])


def spline(controls):
    """The closed uniform quadratic B-spline of some control points (the paper's curves)."""
    controls = np.asarray(controls, dtype=float)
    joints = (controls + np.roll(controls, -1, axis=0)) / 2
    control = np.stack([np.roll(joints, 1, axis=0), controls, controls, joints], axis=1)
    return Loop(control, np.full(len(controls), QUADRATIC, np.uint8))


def random_loop(rng, count, size=100.0, kinds=(LINE, QUADRATIC, CUBIC)):
    """A loop of random segments of all kinds."""
    points = rng.uniform(0, size, (count, 3, 2))
    ends = np.roll(points[:, 0], -1, axis=0)
    control = np.concatenate([points, ends[:, None]], axis=1)
    degree = rng.choice(np.array(kinds, np.uint8), count)
    quadratic = degree == QUADRATIC
    control[quadratic, 2] = control[quadratic, 1]
    return Loop(control, degree)
