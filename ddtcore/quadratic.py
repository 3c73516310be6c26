# SPDX-License-Identifier: GPL-2.0-or-later
"""The curves of the paper, section V: outline points as control points.

Points on one straight line are left out, then all but every (k + 1)-th by the
suppression factor k.  What remains are the control points of a uniform quadratic
B-spline; the points half-way between them lie on the curve, so that in SVG one
`Q` is followed by `T` alone.
"""

from __future__ import annotations

from typing import Callable, Tuple

import numpy as np

from .bezier import from_line
from .model import LINE, QUADRATIC, Curves, PlanarMap, Polylines

_Piece = Tuple[np.ndarray, np.ndarray]


def fit_quadratics(planar: PlanarMap, lines: Polylines, suppression: int) -> Curves:
    """Quadratic segments of every arc.

    Parameters
    ----------
    planar, lines
    suppression : int
        Control points left out between two that are kept.

    Returns
    -------
    Curves
        An arc of two points, and those along the picture's border, give lines.
    """
    def curve(points: np.ndarray, ring: bool, frame: bool) -> _Piece:
        return _polygon(points, ring) if frame else _spline(_thin_out(points, ring, suppression), ring)

    return _each_arc(planar, lines, curve)


def polygons(planar: PlanarMap, lines: Polylines) -> Curves:
    """The outlines as they are: straight lines from point to point."""
    return _each_arc(planar, lines, lambda points, ring, frame: _polygon(points, ring))


def _each_arc(planar: PlanarMap, lines: Polylines, curve: Callable[[np.ndarray, bool, bool], _Piece]) -> Curves:
    parts = [curve(lines.points[lines.starts[arc]:lines.starts[arc + 1]], ring, planar.left[arc] == 0)
             for arc, ring in enumerate(planar.rings.tolist())]
    count = [len(control) for control, _ in parts]
    starts = np.concatenate([[0], np.cumsum(count)]).astype(np.int64)
    if not parts:
        return Curves(starts, np.zeros((0, 4, 2)), np.zeros(0, np.uint8))
    control, degree = (np.concatenate(part) for part in zip(*parts))
    return Curves(starts, control, degree)


def _thin_out(points: np.ndarray, ring: bool, suppression: int) -> np.ndarray:
    """Drop points amid straight lines, then by the suppression factor; never an open arc's ends."""
    # Barycentres are thirds of whole numbers: six times them are whole, and the test is exact.
    whole = np.rint(points * 6).astype(np.int64)
    before, after = whole - np.roll(whole, 1, axis=0), np.roll(whole, -1, axis=0) - whole
    bend = before[:, 0] * after[:, 1] != before[:, 1] * after[:, 0]
    if not ring:
        bend[[0, -1]] = True
    kept = points[bend]
    if ring:
        # Of a ring smaller than those thirds nothing might be left.
        return next((some for some in (kept[::suppression + 1], kept) if len(some) >= 3), points)
    inner = kept[1:-1][suppression // 2::suppression + 1]
    return np.concatenate([kept[:1], inner, kept[-1:]])


def _spline(points: np.ndarray, ring: bool) -> _Piece:
    """A quadratic B-spline; open ones begin and end at their first and last point."""
    if ring:
        middle = (points + np.roll(points, -1, axis=0)) / 2
        start, inner, end = np.roll(middle, 1, axis=0), points, middle
    elif len(points) == 2:
        return _polygon(points, False)
    else:
        middle = (points[1:-2] + points[2:-1]) / 2
        start = np.concatenate([points[:1], middle])
        inner = points[1:-1]
        end = np.concatenate([middle, points[-1:]])
    control = np.stack([start, inner, inner, end], axis=1)
    return control, np.full(len(control), QUADRATIC, np.uint8)


def _polygon(points: np.ndarray, ring: bool) -> _Piece:
    following = np.roll(points, -1, axis=0)
    count = len(points) if ring else len(points) - 1
    return from_line(points[:count], following[:count]), np.full(count, LINE, np.uint8)
