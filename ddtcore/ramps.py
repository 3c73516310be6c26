# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps: areas where the colour changes in small, even steps.

The paper excludes "adjacent colours having smooth luminance variations" from the
border, so what is connected by small steps is one region.  A ramp differs from an
anti-aliased edge by being smooth in both directions, over 2 x 2 blocks; and from a
pair of similar flat colours by its many levels.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import Canvas
from .components import label_components, link_components
from .sides import window

STEP = 16.0
"""Largest step of a channel from pixel to pixel on a ramp, levels."""

BEND = 2.0
"""Largest change of the step from pixel to pixel: what the rounding of an even ramp can make of 0, levels."""

LEVELS = 6
"""Fewest different colours on the slopes of a ramp."""

AREA = 24
"""Smallest ramp, px²."""

MANY = 256
"""Most ramps of a picture, the largest ones."""

PIECE = 200
"""Largest plateau that may be a piece of a ramp, px²."""

SOFT = 14.0
"""How far the colour of a piece may be from the ramp near it, levels."""

SLOPING = 0.02
"""Smallest share of a ramp's pixels that differ from a neighbour."""

_CHUNK = 1 << 18


def find_ramps(canvas: Canvas) -> Tuple[np.ndarray, int]:
    """Find the connected soft ramps of a picture.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int32
        Number of the ramp of each pixel, -1 where there is none.
    count : int
        How many there are.
    """
    key = canvas.bare(canvas.keys)
    flat_right, flat_down = key[:, 1:] == key[:, :-1], key[1:] == key[:-1]
    right = _even_steps(canvas, flat_right, 1)
    down = _even_steps(canvas, flat_down, canvas.stride)
    block = right[1:] & right[:-1]
    block &= down[:, 1:]
    block &= down[:, :-1]
    sloped = block & ~(flat_right[1:] & flat_right[:-1] & flat_down[:, 1:])
    if np.count_nonzero(sloped) < AREA:
        return np.full(canvas.shape, -1, np.int32), 0
    right[...], down[...] = False, False
    right[1:] |= block
    right[:-1] |= block
    down[:, 1:] |= block
    down[:, :-1] |= block
    covered = np.zeros(canvas.shape, bool)
    covered[:, 1:] |= right
    covered[:, :-1] |= right
    area = link_components(right, down)
    chosen = _many_levels(area, sloped, key)
    number = np.full(int(area.max()) + 1, -1, np.int32)
    number[chosen] = np.arange(chosen.size)
    return np.where(covered, number[area], np.int32(-1)), chosen.size


def _even_steps(canvas: Canvas, equal: np.ndarray, step: int) -> np.ndarray:
    """Where a pixel equals the next one, or the step to it is small and like those before and after it."""
    cells = canvas.cells(~equal)
    even = np.empty(cells.size, bool)
    for start in range(0, cells.size, _CHUNK):
        part = slice(start, start + _CHUNK)
        even[part] = is_even(*(canvas.colours(cells[part] + k * step) for k in (-1, 0, 1, 2)))
    out = equal.ravel().copy()
    out[~out] = even
    return out.reshape(equal.shape)


def is_even(before: np.ndarray, here: np.ndarray, there: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Whether four pixels in a row (C, N) change by small and even steps."""
    even = np.abs(there - here).max(axis=0) <= STEP
    even &= np.abs(before + there - 2 * here).max(axis=0) <= BEND
    even &= np.abs(here + after - 2 * there).max(axis=0) <= BEND
    return even


def _many_levels(area: np.ndarray, sloped: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Numbers of the areas that have the size, the slopes and the levels of a ramp."""
    size = np.bincount(area.ravel())
    here = area[:-1, :-1][sloped]
    slopes = np.bincount(here, minlength=size.size)
    pairs = np.unique(here.astype(np.uint64) << np.uint64(32) | key[:-1, :-1][sloped])
    levels = np.bincount((pairs >> np.uint64(32)).astype(np.intp), minlength=size.size)
    chosen = np.flatnonzero((size >= AREA) & (levels >= LEVELS) & (slopes >= SLOPING * size))
    return np.sort(chosen[np.argsort(-size[chosen], kind="stable")[:MANY]])


def absorb_pieces(canvas: Canvas, labels: np.ndarray, slopes: np.ndarray) -> None:
    """Make the small plateaus unknown that hardly differ from a ramp near them, in place.

    Parameters
    ----------
    labels : ndarray of shape (P,) and dtype int32
        Known labels with the rim, negative where unknown.
    slopes : ndarray of shape (H, W) and dtype int32
        Number of the ramp of each pixel, -1 where there is none.
    """
    plateau = label_components(np.where(slopes >= 0, -2, canvas.bare(labels)))
    size = np.bincount(plateau.ravel())
    small = (size[plateau] < PIECE) & (canvas.bare(labels) >= 0) & (slopes < 0)
    cells = canvas.cells(small)
    here = canvas.colours(cells)
    sloped = canvas.rimmed(slopes >= 0, False)
    like = np.zeros(cells.size, bool)
    for step in window(canvas.stride, 1, 3):
        like |= sloped[cells + step] & (np.abs(canvas.colours(cells + step) - here).max(axis=0) < SOFT)
    plateau = plateau[small]
    share = np.bincount(plateau, like, size.size) / size
    labels[cells[share[plateau] >= 0.5]] = -1
