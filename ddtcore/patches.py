# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours of narrow areas under noise: a shine on a ball, a shade along its rim.

Too little of such an area is flat for its colour to stand out among ripples, and most often it
is a mix of others, as translucent paint is, so that an edge might explain it.  But on an edge
colours change within a pixel or two by more than what they are off the colours at its sides.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .canvas import LUMA, RIM, Canvas, pack, planes
from .components import cell_components, next_among
from .palette import MIXED, is_mixed
from .sides import window

OFF, NOISE = 24.0, 8.0
"""How far a new colour is from all that are known at least, levels of a channel, and the least noise reckoned with."""

LEVEL = 0.5
"""Colours round a pixel of an area differ by less than this share of what it is off the known ones."""

PIECE, MOST, AREA = 6, 512, 12
"""Fewest and most such pixels of one piece, and fewest of one colour."""

EVEN = 0.75
"""Share of a piece's pixels that are nearer to their median colour than half the noise."""

STEEP, SLOPING = 4.0, 0.7
"""An area is a ramp whose pixels are so far from their mean, levels, if a slope explains this share of that."""

HUE, BRIGHT, BESIDE = 2.0, 0.4, 0.03
"""Hue that a JPEG moved is no colour of its own beside one that is so far off at most, and in brightness, as multiples
of the noise, and that such a share of the pixels round an area have."""

MANY = 128
"""Most pieces that are looked at, the largest ones."""


class Patches(NamedTuple):
    """Narrow areas.

    Attributes
    ----------
    keys : ndarray of shape (K,) and dtype uint32
        Their colours, packed.
    cells : ndarray of shape (N,)
        Pixels well inside them.
    number : ndarray of shape (N,)
        The colour of each of these.
    """

    keys: np.ndarray
    cells: np.ndarray
    number: np.ndarray


def find_patches(canvas: Canvas, keys: np.ndarray, noise: float, asked: np.ndarray) -> Patches:
    """Find narrow areas in colours unlike those known.

    Parameters
    ----------
    canvas : Canvas
    keys : ndarray of shape (K,) and dtype uint32
        The colours known, packed, the most frequent ones first.
    noise : float
        How far pixels may be from their colour, levels.
    asked : ndarray of shape (H, W) and dtype bool
        Where such areas may be.
    """
    if not keys.size:
        asked = np.zeros_like(asked)
    noise = max(noise, NOISE)
    cells = _level(canvas, *_unlike(canvas, canvas.cells(asked), keys, max(OFF, noise)))
    piece = cell_components(cells, np.zeros(cells.size, np.int8), canvas.stride)
    size = np.bincount(piece, minlength=1)
    order, ends = cells[np.argsort(piece, kind="stable")], np.cumsum(size)
    into, found = np.full(size.size, -1), np.zeros((3 if canvas.opaque else 4, 0))
    narrow = np.flatnonzero((size >= PIECE) & (size <= MOST))
    for k in narrow[np.argsort(-size[narrow], kind="stable")[:MANY]].tolist():
        own = order[ends[k] - size[k]:ends[k]]
        colour = np.median(canvas.colours(own), axis=1)[:, None]
        if not _is_flat(canvas, own, colour, noise) or _is_moved(canvas, own, colour, keys, noise):
            continue
        if _is_wide(own, canvas.stride) or is_mixed(colour, planes(keys, canvas.opaque), max(MIXED, noise))[0]:
            off = np.abs(found - colour).max(axis=0)
            into[k] = off.argmin() if off.size and off.min() <= max(OFF, noise) else off.size
            found = found if into[k] < off.size else np.append(found, _pure(colour), axis=1)
    number = into[piece]
    kept = np.bincount(number[number >= 0], minlength=found.shape[1]) >= AREA
    number = np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)[number]
    return Patches(pack(found[:, kept]), cells[number >= 0], number[number >= 0])


def _unlike(canvas: Canvas, cells: np.ndarray, keys: np.ndarray, margin: float) -> Tuple[np.ndarray, np.ndarray]:
    """The pixels that are farther than a margin from all known colours, and how far they are, levels."""
    off = np.full(cells.size, np.inf, np.float32)
    for colour in planes(keys, canvas.opaque).T:
        np.minimum(off, np.abs(canvas.colours(cells) - colour[:, None]).max(axis=0), out=off)
        left = off > margin
        cells, off = cells[left], off[left]
    return cells, off


def _level(canvas: Canvas, cells: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Those of some pixels round which colours change by little beside how far `off` the known ones they are."""
    high = low = canvas.colours(cells)
    for step in window(canvas.stride, 1, 1):
        beside = canvas.colours(cells + step)
        high, low = np.maximum(high, beside), np.minimum(low, beside)
    return np.asarray(cells[(high - low).max(axis=0) <= LEVEL * off])


def _is_wide(cells: np.ndarray, stride: int) -> bool:
    """Whether there are 2 x 2 pixels in a square among some: strokes with colours of their own have none."""
    return bool(np.all([next_among(cells, step) >= 0 for step in (1, stride, stride + 1)], axis=0).any())


def _is_flat(canvas: Canvas, cells: np.ndarray, colour: np.ndarray, noise: float) -> bool:
    """Whether pixels have one colour (C, 1), but for noise, and do not change along a slope."""
    values = canvas.colours(cells).T.astype(np.float64)
    if np.mean(np.abs(values - colour.T).max(axis=1) <= noise / 2) < EVEN:
        return False
    row, col = canvas.places(cells)
    design = np.stack([np.ones(cells.size), row, col], axis=1)
    left = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    off = np.square(values - values.mean(axis=0)).sum()
    return bool(off < cells.size * STEEP ** 2 or np.square(left).sum() > (1 - SLOPING) * off)


def _is_moved(canvas: Canvas, cells: np.ndarray, colour: np.ndarray, keys: np.ndarray, noise: float) -> bool:
    """Whether a colour (C, 1) differs in hue only from a known one that many pixels beside some of it have."""
    off = planes(keys, canvas.opaque) - colour
    twins = np.flatnonzero((np.abs(off).max(axis=0) <= HUE * noise) & (np.abs(LUMA @ off[:3]) <= BRIGHT * noise))
    around = canvas.colours(cells + window(canvas.stride, 1, RIM)[:, None]).reshape(len(off), -1)
    like = np.zeros(around.shape[1], bool)
    for known in planes(keys[twins], canvas.opaque).T:
        like |= np.abs(around - known[:, None]).max(axis=0) <= noise
    return bool(like.mean() >= BESIDE)


def _pure(colour: np.ndarray) -> np.ndarray:
    """A premultiplied colour (C, 1), or black or white if it is nearly that."""
    for end in (0, 255):
        if np.abs(colour[:3] - end).max() <= OFF and colour[3:].min(initial=255) == 255:
            return np.append(np.full((3, 1), end), colour[3:], axis=0)
    return colour
