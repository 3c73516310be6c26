# SPDX-License-Identifier: GPL-2.0-or-later
"""How much the flat colours of a picture vary: by rounding only, or by JPEG and resizing.

Clean flat art changes at its edges only, by large steps.  JPEG and resampling filters
leave small, uneven ripples at some distance from edges too.
"""

from __future__ import annotations

import numpy as np

from .canvas import Canvas
from .sides import window

ROUNDING = 2.0
"""How far a renderer's rounding may move a flat colour, levels."""

STRONGEST = 24.0
"""Largest noise that is reckoned with, levels."""

_LOW = 32
_HIGH = 48
_UNEVEN = 2
_SAMPLE = 1 << 14


def noise_level(canvas: Canvas, core: np.ndarray, slopes: np.ndarray) -> float:
    """How far pixels of flat areas may be from their colour, levels; `ROUNDING` for a clean picture.

    Parameters
    ----------
    core : ndarray of shape (H, W) and dtype bool
        Pixels of plateaus.
    slopes : ndarray of shape (H, W) and dtype int32
        Number of the soft ramp of each pixel, -1 where there is none.
    """
    sloped = slopes >= 0
    cells = canvas.cells(~core & ~sloped)
    # A picture with large even ramps has none of this noise.
    if not cells.size or np.count_nonzero(sloped) > 0.1 * sloped.size:
        return ROUNDING
    cells = cells[::max(1, cells.size // _SAMPLE)]
    around = canvas.colours(cells + np.append(window(canvas.stride, 1, 1), 0)[:, None])
    span = (around.max(axis=1) - around.min(axis=1)).max(axis=0)
    bends = [canvas.colours(cells - step) + canvas.colours(cells + step) - 2 * around[:, -1]
             for step in (1, canvas.stride)]
    uneven = np.abs(bends).max(axis=(0, 1)) > _UNEVEN
    if np.mean(uneven & (span <= _LOW)) < 0.05:
        return ROUNDING
    return float(min(STRONGEST, 0.6 * np.percentile(span[uneven & (span <= _HIGH)], 90)))
