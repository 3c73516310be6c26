# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps: areas where the colour changes in small, even steps.

The paper excludes "adjacent colours having smooth luminance variations" from the
border, so what is connected by small steps is one region.  A ramp differs from an
anti-aliased edge by being smooth in both directions, over 2 x 2 blocks; and from a
pair of similar flat colours by its many levels.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Tuple

import numpy as np

from .canvas import Canvas, planes
from .components import label_components, linked_areas
from .gradient import BYTES, PRICE
from .model import Labels
from .sides import window

STEP = 16.0
"""Largest step of a channel from pixel to pixel on a ramp, levels."""

BEND = 2.0
"""Largest change of the step from pixel to pixel: what the rounding of an even ramp can make of 0, levels."""

LEVELS = 4
"""Fewest different colours on the slopes of a ramp."""

AREA = 12
"""Smallest ramp, px²."""

MANY = 256
"""Most ramps of a picture, the largest ones."""

PIECE = 200
"""Largest plateau that may be a piece of a ramp, px²."""

SOFT = 14.0
"""How far the colour of a piece may be from the ramp near it, levels."""

SLOPES = 40
"""Most gradients of a photograph."""

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
    ramps = np.full(canvas.shape, -1, np.int32)
    count = 0
    if np.count_nonzero(sloped) >= AREA:
        right[...], down[...] = False, False
        right[1:] |= block
        right[:-1] |= block
        down[:, 1:] |= block
        down[:, :-1] |= block
        count = _number(ramps, 0, right, down, np.pad(sloped, ((0, 1), (0, 1)), mode="constant"), key)
    return ramps, _add_narrow(canvas, ramps, count, ~(flat_right[1:] & flat_right[:-1] & flat_down[:, 1:]))


def _number(ramps: np.ndarray, count: int, right: np.ndarray, down: np.ndarray, sloped: np.ndarray,
            key: np.ndarray) -> int:
    """Number the areas of linked pixels that are ramps, in place; returns how many ramps there are then."""
    area, size = linked_areas(right, down)
    chosen = _many_levels(area, size, sloped, key)
    number = np.full(size.size, -1, np.int32)
    number[chosen] = np.arange(count, count + chosen.size)
    _put(ramps, area, number)
    return count + chosen.size


def _put(ramps: np.ndarray, area: np.ndarray, number: np.ndarray) -> None:
    """Give pixels the number of their area, in place, where both there is an area and it has a number."""
    inside = np.flatnonzero(area >= 0)
    number = number[area.ravel()[inside]]
    ramps.ravel()[inside[number >= 0]] = number[number >= 0]


def _add_narrow(canvas: Canvas, ramps: np.ndarray, count: int, uneven: np.ndarray) -> int:
    """Number further ramps, apart from the others, that are even within 3 x 3 only, in place."""
    busy = np.zeros(canvas.shape, bool)
    busy[1:-1, 1:-1] = uneven[1:, 1:] & uneven[:-1, :-1] & uneven[1:, :-1] & uneven[:-1, 1:]
    cells = canvas.cells(busy & (ramps < 0))
    even = np.empty(cells.size, bool)
    for start in range(0, cells.size, _CHUNK):
        part = slice(start, start + _CHUNK)
        even[part] = _is_plane(canvas, cells[part])
    if 9 * np.count_nonzero(even) < AREA:
        return count
    sloped = np.zeros(canvas.shape, bool)
    sloped[canvas.places(cells[even])] = True
    right, down = sloped[:, 1:] | sloped[:, :-1], sloped[1:] | sloped[:-1]
    for links in (right, down.T):
        middle = links.copy()
        links[1:] |= middle[:-1]
        links[:-1] |= middle[1:]
    key = canvas.bare(canvas.keys)
    more = np.full(canvas.shape, -1, np.int32)
    total = _number(more, 0, right, down, sloped, key)
    apart = np.ones(total, bool)
    if count:
        near = more[_widened(ramps >= 0)]
        apart[near[near >= 0]] = False
    _put(ramps, more, np.where(apart, count + np.cumsum(apart) - 1, -1))
    return count + int(np.count_nonzero(apart))


def _is_plane(canvas: Canvas, cells: np.ndarray) -> np.ndarray:
    """Round which pixels the colour changes by small and even steps within 3 x 3."""
    here = canvas.colours(cells)
    plane = np.ones(cells.size, bool)
    for step in (1, canvas.stride, canvas.stride + 1, canvas.stride - 1):
        before, after = canvas.colours(cells - step), canvas.colours(cells + step)
        plane &= is_straight(before, here, after)
        plane &= np.abs(after - here).max(axis=0) <= STEP
    return plane


def _widened(mask: np.ndarray) -> np.ndarray:
    """The pixels of a mask and their eight neighbours."""
    rows = mask.copy()
    rows[1:] |= mask[:-1]
    rows[:-1] |= mask[1:]
    out = rows.copy()
    out[:, 1:] |= rows[:, :-1]
    out[:, :-1] |= rows[:, 1:]
    return out


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
    even &= is_straight(before, here, there)
    even &= is_straight(here, there, after)
    return even


def is_straight(before: np.ndarray, here: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Whether the colour changes alike on both sides of pixels (C, N), but for what rounding makes of it."""
    off = np.abs(before + after - 2 * here)
    if len(off) == 4:
        # Where there is alpha, colours have been rounded twice.
        off[:3] /= 2
    return off.max(axis=0) <= BEND


def _many_levels(area: np.ndarray, size: np.ndarray, sloped: np.ndarray, key: np.ndarray) -> np.ndarray:
    """Numbers of the areas that have the size, the slopes and the levels of a ramp."""
    cells = np.flatnonzero(sloped)
    cells = cells[area.ravel()[cells] >= 0]
    here, level = area.ravel()[cells], key[np.divmod(cells, key.shape[1])]
    slopes = np.bincount(here, minlength=size.size)
    pairs = np.unique(here.astype(np.uint64) << np.uint64(32) | level)
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


def mark_slopes(canvas: Canvas, labels: Labels) -> Labels:
    """Take the areas of a photograph for ramps whose colours a slope explains best, if that pays.

    Parameters
    ----------
    canvas : Canvas
    labels : Labels
        One label for each area.
    """
    index, count = labels.index.ravel(), len(labels.palette)
    row, col = np.divmod(np.arange(index.size, dtype=np.int32), labels.index.shape[1])
    size = np.maximum(np.bincount(index, minlength=count), 1)
    x, y = (place - (np.bincount(index, place, count) / size)[index] for place in (col, row))
    xx, xy, yy = (np.bincount(index, product, count) for product in (x * x, x * y, y * y))
    det = np.maximum(xx * yy - xy * xy, 1e-6 * (xx + yy + 1) ** 2)
    gain = np.zeros(count)
    for plane in planes(canvas.bare(canvas.keys), canvas.opaque):
        along, down = (np.bincount(index, place * plane.ravel(), count) for place in (x, y))
        gain += (yy * along * along - 2 * xy * along * down + xx * down * down) / det
    best = np.argsort(-gain, kind="stable")[:SLOPES]
    ramp = np.zeros(count, bool)
    ramp[best] = gain[best] > 2 * PRICE * BYTES
    return replace(labels, ramp=ramp)
