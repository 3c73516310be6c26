# SPDX-License-Identifier: GPL-2.0-or-later
"""Bézier segments as arrays: the mathematics, no policy.

Segments are arrays (S, 4, 2) of control points; a value of the parameter t
belongs to the segment whose number stands beside it.
"""

from __future__ import annotations

import numpy as np


def basis(t: np.ndarray) -> np.ndarray:
    """The cubic Bernstein polynomials at `t`, (4, N)."""
    s = 1 - t
    return np.stack([s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t])


def evaluate(control: np.ndarray, segment: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points (N, 2) of cubic segments."""
    # Coordinates in rows: several times as quick as rows of coordinates.
    parts = np.ascontiguousarray(control.transpose(1, 2, 0))
    points = sum(weight * part.take(segment, axis=1) for weight, part in zip(basis(t), parts))
    return np.asarray(points).T


def from_line(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Lines (S, 4, 2) as cubics with evenly spaced control points."""
    control: np.ndarray = start[:, None] + (end - start)[:, None] * (np.arange(4) / 3.0)[:, None]
    # Rounding must not open what meets.
    control[:, 3] = end
    return control
