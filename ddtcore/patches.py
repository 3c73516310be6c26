# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours of narrow areas under noise: a shine on a ball, a shade along its rim.

Too little of such an area is flat for its colour to stand out among ripples, and most often it
is a mix of others, as translucent paint is, so that an edge might explain it.  But on an edge
colours change within a pixel or two by more than what they are off the colours at its sides.
"""

from __future__ import annotations

from typing import List, Tuple

import numpy as np

from .canvas import Canvas, pack, planes
from .components import cell_components
from .sides import window

OFF = 8.0
"""How far a new colour is from all that are known at least, levels of a channel, or else the noise."""

LEVEL = 0.5
"""Colours round a pixel of an area differ by less than this share of what it is off the known ones."""

PIECE, AREA = 6, 12
"""Fewest such pixels of one piece, and of one colour."""

EVEN = 0.75
"""Share of a piece's pixels that are nearer to their median colour than half the noise."""

PURE = 12.0
"""A new colour so near to black or white is one of these, levels."""

MANY = 128
"""Most pieces that are looked at, the largest ones."""


def patch_colours(canvas: Canvas, keys: np.ndarray, noise: float, asked: np.ndarray) -> np.ndarray:
    """Packed colours of narrow areas, unlike those known.

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
    order = cells[np.argsort(piece, kind="stable")]
    ends = np.cumsum(size)
    found: List[np.ndarray] = []
    counts: List[int] = []
    for k in np.argsort(-size, kind="stable")[:MANY].tolist():
        if size[k] < PIECE:
            break
        colours = canvas.colours(order[ends[k] - size[k]:ends[k]])
        colour = np.median(colours, axis=1)
        if np.mean(np.abs(colours - colour[:, None]).max(axis=0) <= margin / 2) < EVEN:
            continue
        off = [np.abs(colour - known).max() for known in found]
        if off and min(off) <= margin:
            counts[int(np.argmin(off))] += int(size[k])
        else:
            found.append(colour)
            counts.append(int(size[k]))
    kept = [_pure(colour) for colour, count in zip(found, counts) if count >= AREA]
    return pack(np.stack(kept, axis=1)) if kept else np.zeros(0, np.uint32)


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


def _pure(colour: np.ndarray) -> np.ndarray:
    """A premultiplied colour (C,), or black or white if it is nearly that."""
    for end in (0, 255):
        if np.abs(colour[:3] - end).max() <= PURE and colour[3:].min(initial=255) == 255:
            return np.append(np.full(3, end), colour[3:])
    return colour
