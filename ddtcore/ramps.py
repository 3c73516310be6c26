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
from .components import block_areas, components, linked_areas, next_among
from .gradient import BYTES, PRICE
from .model import Labels
from .parts import in_parts
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
"""A plateau of so many pixels is no piece of a ramp, px²."""

SOFT = 14.0
"""How far the colour of a piece may be from the ramp near it, levels."""

SLOPES = 40
"""Most gradients of a photograph."""

_SAMPLED = 1 << 17
"""Pixels of a photograph that are looked at to choose them, about."""

SLOPING = 0.02
"""Smallest share of a ramp's pixels that differ from a neighbour."""


def find_ramps(canvas: Canvas, bend: float = BEND) -> Tuple[np.ndarray, int]:
    """Find the connected soft ramps of a picture.

    Parameters
    ----------
    canvas : Canvas
    bend : float
        Largest change of the step from pixel to pixel, levels.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.  Without any, it takes no
        memory and must not be written to.
    count : int
        How many there are.
    """
    key = canvas.bare(canvas.keys)
    block, uneven, sloped, level = in_parts(
        lambda rows: _even_blocks(canvas, key, rows, bend), len(key) - 1, size=key.shape[1])
    ramps, count = no_ramps(canvas.shape), 0
    if sloped.size >= AREA:
        areas = block_areas(block)
        chosen = _many_levels(areas.at(sloped), areas.size, level)
        count = chosen.size
        if count:
            ramps = ramps.copy()
            areas.put(ramps.ravel(), _numbered(chosen, areas.size.size, 0))
    cells, number = _narrow(canvas, ramps, count, uneven, bend)
    if not cells.size:
        return ramps, count
    ramps = ramps if count else ramps.copy()
    ramps[canvas.places(cells)] = number
    return ramps, int(number.max()) + 1


def no_ramps(shape: Tuple[int, int]) -> np.ndarray:
    """-1 for each pixel, all of them in the same place."""
    return np.broadcast_to(np.int16(-1), shape)


def _even_blocks(canvas: Canvas, key: np.ndarray, rows: slice, bend: float) -> Tuple[np.ndarray, ...]:
    """Which 2 x 2 blocks in some rows have even steps on all sides, and which are not of one colour.

    And of those that are both, the first pixels, numbered row by row, and their packed colours.
    """
    some = key[rows.start:rows.stop + 1]
    flat_right, flat_down = some[:, 1:] == some[:, :-1], some[1:] == some[:-1]
    right = _even_steps(canvas, flat_right, 1, rows.start, bend)
    down = _even_steps(canvas, flat_down, canvas.stride, rows.start, bend)
    block = right[1:] & right[:-1]
    block &= down[:, 1:]
    block &= down[:, :-1]
    flat = flat_right[1:] & flat_right[:-1]
    flat &= flat_down[:, 1:]
    uneven = ~flat
    row, col = np.nonzero(block & uneven)
    return block, uneven, (rows.start + row) * key.shape[1] + col, some[row, col]


def _numbered(chosen: np.ndarray, size: int, first: int) -> np.ndarray:
    """Numbers from `first` on for the chosen ones of some areas, -1 for the others."""
    number = np.full(size, -1, np.int16)
    number[chosen] = np.arange(first, first + chosen.size)
    return number


def _narrow(canvas: Canvas, ramps: np.ndarray, count: int, uneven: np.ndarray,
            bend: float) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels of ramps apart from the first `count`, even within 3 x 3 only, and the numbers of these further ones."""
    def busy(rows: slice) -> Tuple[np.ndarray]:
        some = uneven[rows.start:rows.stop + 1]
        both = some[1:] & some[:-1]
        both = both[:, 1:] & both[:, :-1]
        if count:
            both &= ramps[rows.start + 1:rows.stop + 1, 1:-1] < 0
        row, col = np.divmod(np.flatnonzero(both).astype(np.int32), np.int32(max(both.shape[1], 1)))
        return (canvas.numbers(row + np.int32(rows.start + 1), col + np.int32(1)),)

    cells, = in_parts(busy, max(len(uneven) - 1, 0), size=canvas.stride)
    even, = in_parts(lambda part: (_is_plane(canvas, cells[part], bend),), cells.size)
    middle = cells[even]
    if 9 * middle.size < AREA:
        return middle[:0], middle[:0]
    # What is even round pixels that are two apart is connected.
    edges = []
    for step in np.sort(window(canvas.stride, 1, 2))[12:]:
        place = next_among(middle, step)
        near = np.flatnonzero(place >= 0)
        edges.append((near, place[near]))
    area = components(middle.size, *(np.concatenate(ends) for ends in zip(*edges)))
    levels = _many_levels(area, 9 * np.bincount(area), canvas.keys[middle])
    # Few are left whose surroundings need to be looked at.
    area = _numbered(levels, int(area.max()) + 1, 0)[area]
    around = np.append(window(canvas.stride, 1, 1), 0)[:, None]
    pairs = np.unique(area[area >= 0].astype(np.int64) << 32 | (middle[area >= 0] + around))
    area, cells = (pairs >> 32).astype(np.int32), pairs.astype(np.uint32).astype(np.int32)
    row, col = (np.clip(place, 0, size - 1) for place, size in zip(canvas.places(cells + around), canvas.shape))
    held = (ramps[row, col] >= 0).any(axis=0)
    fitting = (np.bincount(area, minlength=levels.size) >= AREA) & (np.bincount(area, held, levels.size) == 0)
    number = _numbered(np.flatnonzero(fitting), levels.size, count)[area]
    return cells[number >= 0], number[number >= 0]


def _is_plane(canvas: Canvas, cells: np.ndarray, bend: float) -> np.ndarray:
    """Round which pixels the colour changes by small and even steps within 3 x 3."""
    here = canvas.colours(cells)
    plane = np.ones(cells.size, bool)
    for step in (1, canvas.stride, canvas.stride + 1, canvas.stride - 1):
        before, after = canvas.colours(cells - step), canvas.colours(cells + step)
        plane &= is_straight(before, here, after, bend)
        plane &= np.abs(after - here).max(axis=0) <= STEP
    return plane


def _even_steps(canvas: Canvas, equal: np.ndarray, step: int, top: int, bend: float) -> np.ndarray:
    """Where pixels of the rows from `top` on equal the next, or the step is small and like those before and after."""
    cells = canvas.cells(~equal, top)
    # On edges most steps are large.
    even = np.abs(canvas.colours(cells + step) - canvas.colours(cells)).max(axis=0) <= STEP
    some = cells[even]
    before, here, there, after = (canvas.colours(some + k * step) for k in (-1, 0, 1, 2))
    even[even] = is_even(before, here, there, after, bend)
    out = equal.copy()
    out[~equal] = even
    return out


def is_even(before: np.ndarray, here: np.ndarray, there: np.ndarray, after: np.ndarray,
            bend: float) -> np.ndarray:
    """Whether four pixels in a row (C, N) change by small and even steps."""
    even: np.ndarray = np.abs(there - here).max(axis=0) <= STEP
    even &= is_straight(before, here, there, bend)
    even &= is_straight(here, there, after, bend)
    return even


def is_straight(before: np.ndarray, here: np.ndarray, after: np.ndarray, bend: float = BEND) -> np.ndarray:
    """Whether the colour changes alike on both sides of pixels (C, N), but for what rounding makes of it."""
    off = np.abs(before + after - 2 * here)
    if len(off) == 4:
        # Where there is alpha, colours have been rounded twice.
        off[:3] /= 2
    straight: np.ndarray = off.max(axis=0) <= bend
    return straight


def _many_levels(area: np.ndarray, size: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Numbers of the areas that have the size, the slopes and the levels of a ramp.

    `area` and `level` say the area, -1 for none, and the packed colour of each pixel on a slope.
    """
    area, level = area[area >= 0], level[area >= 0]
    slopes = np.bincount(area, minlength=size.size)
    pairs = np.unique(area.astype(np.uint64) << np.uint64(32) | level)
    levels = np.bincount((pairs >> np.uint64(32)).astype(np.intp), minlength=size.size)
    chosen = np.flatnonzero((size >= AREA) & (levels >= LEVELS) & (slopes >= SLOPING * size))
    return np.sort(chosen[np.argsort(-size[chosen], kind="stable")[:MANY]])


def absorb_pieces(canvas: Canvas, labels: np.ndarray, slopes: np.ndarray, most: int, soft: float = SOFT) -> None:
    """Make the small plateaus unknown that hardly differ from a ramp near them, in place.

    Parameters
    ----------
    labels : ndarray of shape (P,) and dtype int16
        Known labels with the rim, negative where unknown.
    slopes : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.
    most : int
        Plateaus of so many pixels stay.
    soft : float
        How far the colour of a piece may be from the ramp near it, levels.
    """
    small, number, size = _small_plateaus(canvas.bare(labels), slopes, most)
    cells = canvas.cells(small)
    here = canvas.colours(cells)
    sloped = canvas.rimmed(slopes >= 0, False)
    like = np.zeros(cells.size, bool)
    for step in window(canvas.stride, 1, 3):
        like |= sloped[cells + step] & (np.abs(canvas.colours(cells + step) - here).max(axis=0) < soft)
    share = np.bincount(number, like, size.size) / size
    labels[cells[share[number] >= 0.5]] = -1


def _small_plateaus(labels: np.ndarray, slopes: np.ndarray, most: int) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which pixels belong to small plateaus, the plateau of each of them in reading order, and their sizes."""
    small = labels >= 0
    small &= slopes < 0
    right, down = labels[:, 1:] == labels[:, :-1], labels[1:] == labels[:-1]
    for links, one, other in ((right, small[:, 1:], small[:, :-1]), (down, small[1:], small[:-1])):
        links &= one
        links &= other
    areas = linked_areas(right, down)
    areas.put(small.ravel(), np.where(areas.size < most, -1, 0))
    number = areas.at(np.flatnonzero(small))
    lone = np.flatnonzero(number < 0)
    number[lone] = np.arange(areas.size.size, areas.size.size + lone.size)
    return small, number, np.append(areas.size, np.ones(lone.size, np.int64))


def mark_slopes(canvas: Canvas, labels: Labels) -> Labels:
    """Take the areas of a photograph for ramps whose colours a slope explains best, if that pays.

    Parameters
    ----------
    canvas : Canvas
    labels : Labels
        One label for each area.
    """
    # It is large areas that matter: some of their pixels tell enough.
    step = max(int(np.sqrt(labels.index.size / _SAMPLED)), 1)
    some, count = labels.index[::step, ::step], len(labels.palette)
    row, col = (place.ravel() * float(step) for place in np.indices(some.shape, np.int32))
    index = some.ravel()
    size = np.maximum(np.bincount(index, minlength=count), 1)
    x, y = (place - (np.bincount(index, place, count) / size)[index] for place in (col, row))
    xx, xy, yy = (np.bincount(index, product, count) for product in (x * x, x * y, y * y))
    det = np.maximum(xx * yy - xy * xy, 1e-6 * (xx + yy + 1) ** 2)
    gain = np.zeros(count)
    for plane in planes(canvas.bare(canvas.keys)[::step, ::step], canvas.opaque):
        along, down = (np.bincount(index, place * plane.ravel(), count) for place in (x, y))
        gain += (yy * along * along - 2 * xy * along * down + xx * down * down) / det
    best = np.argsort(-gain, kind="stable")[:SLOPES]
    ramp = np.zeros(count, bool)
    ramp[best] = step**2 * gain[best] > 2 * PRICE * BYTES
    return replace(labels, ramp=ramp)
