# SPDX-License-Identifier: GPL-2.0-or-later
"""Bézier segments as arrays: the mathematics, no policy.

Segments are arrays (S, 4, 2) of control points; a value of the parameter t
belongs to the segment whose number stands beside it.
"""

from __future__ import annotations

import numpy as np


def basis(t: np.ndarray) -> np.ndarray:
    """The cubic Bernstein polynomials at `t`, (N, 4)."""
    s = 1 - t
    return np.stack([s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t], axis=-1)


def evaluate(control: np.ndarray, segment: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points (N, 2) of cubic segments."""
    return np.einsum("nk,nkd->nd", basis(t), control[segment])


def derivative(control: np.ndarray, segment: np.ndarray, t: np.ndarray) -> np.ndarray:
    """First derivatives (N, 2) by the parameter."""
    s = 1 - t
    weights = np.stack([s * s, 2 * s * t, t * t], axis=-1)
    return np.einsum("nk,nkd->nd", 3 * weights, np.diff(control, axis=1)[segment])


def second_derivative(control: np.ndarray, segment: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Second derivatives (N, 2) by the parameter."""
    bend = 6 * np.diff(control, n=2, axis=1)[segment]
    return (1 - t)[:, None] * bend[:, 0] + t[:, None] * bend[:, 1]


def from_line(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Lines (S, 4, 2) as cubics with evenly spaced control points."""
    control = start[:, None] + (end - start)[:, None] * (np.arange(4) / 3.0)[:, None]
    # Rounding must not open what meets.
    control[:, 3] = end
    return control


def reproject(control: np.ndarray, segment: np.ndarray, t: np.ndarray, points: np.ndarray) -> np.ndarray:
    """One Newton step of each parameter towards the foot of the perpendicular from its point."""
    away = evaluate(control, segment, t) - points
    d1 = derivative(control, segment, t)
    d2 = second_derivative(control, segment, t)
    slope = np.einsum("nd,nd->n", away, d1)
    bend = np.einsum("nd,nd->n", d1, d1) + np.einsum("nd,nd->n", away, d2)
    step = slope / np.where(bend > 1e-9, bend, np.inf)
    return np.clip(t - np.clip(step, -0.2, 0.2), 0.0, 1.0)
