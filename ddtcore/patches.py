# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours of narrow areas under noise: a shine on a ball, a shade along its rim.

Too little of such an area is flat for its colour to stand out among ripples, and most often it
is a mix of others, as translucent paint is, so that an edge might explain it.  But on an edge
colours change within a pixel or two by more than what they are off the colours at its sides.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .canvas import Canvas, pack, planes
from .components import cell_components
from .sides import window

OFF = 8.0
"""How far a new colour is from all that are known at least, levels of a channel, or else the noise."""

LEVEL = 0.5
"""Colours round a pixel of an area differ by less than this share of what it is off the known ones."""

PIECE, MOST, AREA = 6, 512, 12
"""Fewest and most such pixels of one piece, and fewest of one colour."""

EVEN = 0.75
"""Share of a piece's pixels that are nearer to their median colour than half the noise."""

STEEP, SLOPING = 4.0, 0.7
"""An area whose pixels are so far from their mean, root mean square, levels, is a ramp if a slope explains such a share."""

PURE = 12.0
"""A new colour so near to black or white is one of these, levels."""

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
    margin = max(OFF, noise)
    cells = _level(canvas, *_unlike(canvas, canvas.cells(asked), keys, margin))
    piece = cell_components(cells, np.zeros(cells.size, np.int8), canvas.stride)
    size = np.bincount(piece, minlength=1)
    order, ends = cells[np.argsort(piece, kind="stable")], np.cumsum(size)
    into, found = np.full(size.size, -1), np.zeros((3 if canvas.opaque else 4, 0))
    narrow = np.flatnonzero((size >= PIECE) & (size <= MOST))
    for k in narrow[np.argsort(-size[narrow], kind="stable")[:MANY]].tolist():
        own = order[ends[k] - size[k]:ends[k]]
        colours = canvas.colours(own)
        colour = np.median(colours, axis=1)[:, None]
        if np.mean(np.abs(colours - colour).max(axis=0) <= margin / 2) >= EVEN and not _slopes(canvas, own):
            off = np.abs(found - colour).max(axis=0)
            into[k] = off.argmin() if off.size and off.min() <= margin else off.size
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


def _slopes(canvas: Canvas, cells: np.ndarray) -> bool:
    """Whether the colours of pixels change along a slope."""
    row, col = canvas.places(cells)
    design = np.stack([np.ones(cells.size), row, col], axis=1)
    values = canvas.colours(cells).T.astype(np.float64)
    left = values - design @ np.linalg.lstsq(design, values, rcond=None)[0]
    off = np.square(values - values.mean(axis=0)).sum()
    return bool(off > cells.size * STEEP ** 2 and np.square(left).sum() < (1 - SLOPING) * off)


def _pure(colour: np.ndarray) -> np.ndarray:
    """A premultiplied colour (C, 1), or black or white if it is nearly that."""
    for end in (0, 255):
        if np.abs(colour[:3] - end).max() <= PURE and colour[3:].min(initial=255) == 255:
            return np.append(np.full((3, 1), end), colour[3:], axis=0)
    return colour
