# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps under the ripples of JPEG, the dots of dithering, or the grain of a scan.

No step is even there, and each ripple looks like a ramp or a thing drawn on one.  So the
picture is calmed first, and then ramps are what one gradient explains but for the ripples,
up to the edges beside them.  What is left has few flat colours, as in other noisy pictures.
"""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from .calm import calm
from .canvas import RIM, Canvas
from .growing import FIT, Surface
from .noise import REDUCED, ROUNDING, SLOPING, noisy_colours, sloping_area
from .palette import Plateaus, find_plateaus
from .ramps import find_ramps
from .sides import window
from .spans import renumber, spans_of
from .surfaces import extend, separate

UNSTEADY = 0.006
"""Least share of zigzags in a picture with ripples: strokes and rounding make fewer."""

GRAINY = 0.42
"""Share of zigzags that only a grain makes, which is the same everywhere."""

RIPPLED, DITHERED = 1.4, 2.5
"""How much stronger than most are the ripples beside edges in a JPEG, and the dots of colours far apart in a GIF."""

SOFT = 24.0
"""Largest range of a channel within 7 x 7 pixels where zigzags are looked for, levels."""

BEND = 5.0
"""Largest change of the step from pixel to pixel on a ramp without most of its ripples, levels."""

LEFT = 2.0
"""How much less pixels vary there at least."""

AREA = 64
"""Smallest ramp, px²."""

BETWEEN = 0.05
"""Least share of a ramp's pixels in the middle half of its contrast."""

FLAT = 256
"""A flat area of so many pixels is no part of the ramp beside it, px²."""

SPECK = 24.0
"""Regions smaller than this are ripples, px²."""

_TURN = 2
_SAMPLE = 1 << 15
_ASKED = 1 << 10
_ENDS = 2, 98


class Soft(NamedTuple):
    """A calmed picture and its soft ramps.

    Attributes
    ----------
    canvas : Canvas
    slopes : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.
    surfaces : list of Surface
        One for each ramp.
    plateaus : Plateaus
        Those apart from the ramps.
    keys : ndarray of shape (K,) and dtype uint32
        The flat colours, packed.
    noise : float
        How far pixels may be from their colour, levels.
    """

    canvas: Canvas
    slopes: np.ndarray
    surfaces: List[Surface]
    plateaus: Plateaus
    keys: np.ndarray
    noise: float


def find_soft(canvas: Canvas, noise: float) -> Optional[Soft]:
    """The ramps of a picture with ripples, most of them no stronger than `noise` levels, if it has both."""
    share = zigzags(canvas) if noise > ROUNDING else 0.0
    if share < UNSTEADY:
        return None
    noise *= _strength(canvas, share)
    even = calm(canvas, noise)
    slopes, count = find_ramps(even, BEND)
    if sloping_area(even, slopes) < SLOPING * slopes.size:
        return None
    slopes = slopes.copy()
    size, steep = _steep(even, slopes, count, noise)
    if size[steep].sum() < SLOPING * slopes.size:
        return None
    flat = np.append(~steep & (size >= FLAT), False)[slopes]
    renumber(slopes, _numbers(steep))
    slopes, surfaces = separate(even, slopes, int(steep.sum()), ~flat, max(FIT, noise / LEFT))
    size, steep = _steep(even, slopes, len(surfaces), noise)
    steep &= [surface.gradient is not None for surface in surfaces]
    if size[steep].sum() < SLOPING * slopes.size:
        return None
    flat |= np.append(~steep & (size >= FLAT), False)[slopes]
    renumber(slopes, _numbers(steep))
    surfaces = [surface for surface, kept in zip(surfaces, steep.tolist()) if kept]
    extend(even, slopes, surfaces, ~flat, noise)
    plateaus = find_plateaus(even, slopes >= 0)
    keys = noisy_colours(even, plateaus, noise, noise, slopes >= 0)
    return Soft(even, slopes, surfaces, plateaus, keys, noise)


def _strength(canvas: Canvas, share: float) -> float:
    """How much stronger than most the strongest ripples of a picture with a share of zigzags are."""
    if share > GRAINY:
        return 1.0
    return DITHERED if np.unique(canvas.keys).size <= REDUCED else RIPPLED


def _steep(canvas: Canvas, slopes: np.ndarray, count: int, noise: float) -> Tuple[np.ndarray, np.ndarray]:
    """Sizes of some ramps, and which of them are large and have more contrast than noise alone."""
    size, steep = np.zeros(count, np.int64), np.zeros(count, bool)
    for number, spans in enumerate(spans_of(slopes, count)):
        size[number] = spans.size
        if spans.size >= AREA:
            row, col = np.divmod(spans.every(-(-spans.size // _ASKED)), slopes.shape[1])
            colour = canvas.colours(canvas.numbers(row, col))
            low, high = np.percentile(colour, _ENDS, axis=1)
            most = int(np.argmax(high - low))
            share = (colour[most] - low[most]) / max(high[most] - low[most], 1.0)
            # Two flat colours have next to nothing between them.
            steep[number] = high[most] - low[most] >= noise and np.mean(np.abs(share - 0.5) < 0.25) >= BETWEEN
    return size, steep


def _numbers(kept: np.ndarray) -> np.ndarray:
    """Numbers of the ramps that are kept, -1 for the others, and for pixels that belong to none."""
    return np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1).astype(np.int32)


def zigzags(canvas: Canvas) -> float:
    """Share of the pixels of soft areas, where three steps in a row go up, down and up, or the other way round."""
    cells = canvas.cells(np.ones(canvas.shape, bool))
    cells = cells[::max(1, cells.size // _SAMPLE)]
    around = canvas.colours(cells + np.append(window(canvas.stride, 1, RIM), 0)[:, None])
    span = (around.max(axis=1) - around.min(axis=1)).max(axis=0)
    cells = cells[(span > ROUNDING) & (span <= SOFT)]
    turning = np.zeros(cells.size, bool)
    for step in (1, canvas.stride):
        before, here, there, after = (canvas.colours(cells + k * step) for k in (-1, 0, 1, 2))
        for sign in (1, -1):
            steps = sign * np.stack([here - before, here - there, after - there])
            turning |= (steps >= _TURN).all(axis=0).any(axis=0)
    return float(turning.sum() / max(turning.size, 1))
