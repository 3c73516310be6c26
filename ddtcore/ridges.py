# SPDX-License-Identifier: GPL-2.0-or-later
"""The crests of thin strokes: pixels that no edge explains.

Across an anti-aliased edge the colour runs straight from one side to the other, so
a pixel lies on the line between its neighbours' colours.  On a thin stroke, in a thin
gap or at the tip of a wedge it lies beside that line; how far and in which
direction tells the colour of the stroke, whatever the colours at its two sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from .canvas import Canvas
from .components import next_among
from .mixes import dot, excess, length, segment_distance, third_share
from .noise import ROUNDING
from .parts import in_parts

LEAST = 12.0
"""Smallest distance of a stroke's pixel from the mixes of its two sides, levels."""

_DIRECTIONS = [(0, 1), (1, 0), (1, 1), (1, -1)]
_STRAIGHT = 14.0


@dataclass(frozen=True)
class Ridges:
    """Pixels whose colour stands out from both sides.

    Attributes
    ----------
    cells : ndarray of shape (R,) and dtype int32
        Pixel numbers, rising.
    colour : ndarray of shape (C, R) and dtype float32
        Their colours.
    one, other : ndarray of shape (C, R) and dtype float32
        Colours at the two sides.
    off : ndarray of shape (C, R) and dtype float32
        Vector from the nearest mix of the two sides to the colour.
    """

    cells: np.ndarray
    colour: np.ndarray
    one: np.ndarray
    other: np.ndarray
    off: np.ndarray

    @property
    def height(self) -> np.ndarray:
        """How far the pixels stand out, float32 (R,)."""
        return length(self.off)

    def some(self, which: np.ndarray) -> Ridges:
        """A part of the ridge pixels."""
        return Ridges(self.cells[which], self.colour[:, which], self.one[:, which], self.other[:, which],
                      self.off[:, which])


def find_ridges(canvas: Canvas, cells: np.ndarray, noise: float) -> Ridges:
    """Find the pixels among `cells` that no monotone edge explains, the crests of strokes.

    They stand out by more than ripples of the given `noise` (levels) do.
    """
    least = LEAST + 2 * (noise - ROUNDING)
    here = canvas.colours(cells)
    height = np.zeros(cells.size, np.float32)
    one, other = here.copy(), here.copy()
    for row, col in _DIRECTIONS:
        step = np.int32(row * canvas.stride + col)
        before, after, a, b, off = _across(canvas, cells, here, step, least)
        size = length(off)
        peak = (size > least) & (size > height) & canvas.holds(cells - step) & canvas.holds(cells + step)
        # Only a neighbour that stands out to the same side belongs to the same stroke.
        peak &= (size >= size[before]) | (before < 0) | (dot(off, off.take(before, axis=1)) <= 0)
        peak &= (size > size[after]) | (after < 0) | (dot(off, off.take(after, axis=1)) <= 0)
        for known, new in ((height, size), (one, a), (other, b)):
            np.copyto(known, new, where=peak)
    kept = np.flatnonzero(height > 0)
    here, one, other = (part.take(kept, axis=1) for part in (here, one, other))
    return Ridges(cells[kept], here, one, other, excess(here, one, other))


def _across(canvas: Canvas, cells: np.ndarray, here: np.ndarray, step: np.int32,
            least: float) -> Tuple[np.ndarray, ...]:
    """Numbers of the pixels before and after each in one direction, and its `_two_sides`."""
    after = next_among(cells, int(step))
    before = np.full(cells.size, -1)
    before[after[after >= 0]] = np.flatnonzero(after >= 0)
    return (before, after, *in_parts(
        lambda part: _two_sides(canvas, cells[part], here[:, part], before[part], after[part], step, least),
        cells.size, axis=1))


def _two_sides(canvas: Canvas, cells: np.ndarray, here: np.ndarray, before: np.ndarray, after: np.ndarray,
               step: np.int32, least: float) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours at both sides of each pixel in one direction, and how it stands out: those from which it does most.

    A stroke that covers two pixels in part is seen past its other half, where the colour
    runs straight from the pixel through that half to the far side, or where the other half
    stands out in the same direction.
    """
    best = np.stack([canvas.colours(cells - step), canvas.colours(cells + step)])
    sides, out = best.copy(), excess(here, *best)
    square = dot(out, out)
    for far, sign, next_ in ((1, 2, after), (0, -2, before)):
        near, half = sides[1 - far], sides[far]
        beyond = canvas.colours(cells + sign * step)
        off = excess(here, near, beyond)
        size = dot(off, off) * np.float32(0.998)
        # Few stand out more, and enough to matter.
        more = np.flatnonzero(size > np.maximum(square, np.float32(0.99 * least * least)))
        more = more[_is_passed(here[:, more], near[:, more], half[:, more], beyond[:, more], off[:, more],
                               next_[more] >= 0)]
        best[far][:, more], best[1 - far][:, more] = beyond[:, more], near[:, more]
        square[more] = size[more]
        out[:, more] = excess(here[:, more], *best[:, :, more])
    return best[0], best[1], out


def _is_passed(here: np.ndarray, near: np.ndarray, half: np.ndarray, beyond: np.ndarray, off: np.ndarray,
               beside: np.ndarray) -> np.ndarray:
    """Whether pixels are seen past their other half: it stands out likewise, or lies on the way to the far side."""
    twin = excess(half, near, beyond)
    agree = dot(off, twin)
    size = dot(off, off) * np.float32(0.998)
    passed = beside & (agree > 0) & (agree * agree > 0.5 * size * dot(twin, twin))
    return np.asarray(passed | (segment_distance(half, here, beyond)[0] < _STRAIGHT))


def unexplained(ridges: Ridges, colours: np.ndarray, doubt: float) -> Ridges:
    """The ridge pixels that mixes with no known colour explain: the better, the surer their two sides are."""
    if not colours.shape[1]:
        return ridges
    beside, _ = third_share(ridges.colour, ridges.one, ridges.other, colours)
    trust = np.where(_is_any(ridges.one, colours) & _is_any(ridges.other, colours), 0.2, 0.4)
    return ridges.some(np.flatnonzero(beside.min(axis=1) >= np.maximum(trust * ridges.height, 30 + 2 * doubt)))


def _is_any(points: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Which points (C, N) are, but for rounding, one of the colours (C, K), bool (N,)."""
    square = dot(points, points)[:, None] - 2 * points.T @ colours + dot(colours, colours)
    return np.asarray(square.min(axis=1) < (2 * ROUNDING) ** 2)
