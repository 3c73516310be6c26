# SPDX-License-Identifier: GPL-2.0-or-later
"""Ramps that fell into bands, where colours were reduced without dithering, as in a GIF.

The bands follow each other in small steps and without the mixes that edges farther apart
have: so it was no artist who drew them, or they were drawn before the colours were reduced.
What one gradient explains to within a step, across many bands, is a ramp again.
"""

from __future__ import annotations

from typing import Optional, Sequence, Tuple

import numpy as np

from .canvas import Canvas, count_keys, planes
from .components import block_areas
from .growing import FIT
from .noise import REDUCED, ROUNDING
from .palette import choose_colours, find_plateaus
from .ramps import MANY, no_ramps
from .spans import Spans, renumber, spans_of
from .surfaces import separate
from .unsteady import PIECE, Soft

STEP = 24.0
"""Largest step from band to band, levels of a channel."""

CLOSE = 0.004
"""Smallest share of a picture's pixels that lie at the end of a band, in rows or in columns."""

FAR, HARD = 64.0, 0.5
"""In an anti-aliased picture, of the edges between colours farther apart than this, levels, no larger share is hard."""

BANDS, FEWER = 6, 16
"""Fewest bands of a ramp, and one for so many colours of the picture: where many are left, steps are small."""

WIDE = 0.01
"""Smallest share of a ramp's area that counts as a band."""

AREA = 256
"""Smallest ramp, px²."""

OFF = 0.75
"""How far pixels are at most from the gradient, as a share of the large ones among the steps."""

_LARGE = 90
_SAMPLE = 1 << 14


def find_banded(canvas: Canvas, flat: np.ndarray) -> Optional[Soft]:
    """The ramps of a picture without dithering that fell into bands, if it has such.

    Parameters
    ----------
    canvas : Canvas
    flat : ndarray of shape (H, W) and dtype bool
        Pixels of plateaus, and of ramps that are even as they are.
    """
    if not _is_banded(canvas, flat):
        return None
    colours = count_keys(canvas.keys)[0].size
    if colours > REDUCED:
        return None
    least = max(BANDS, colours // FEWER)
    slopes, count = _linked(canvas)
    count = _keep(slopes, [_bands(canvas, spans) >= least for spans in spans_of(slopes, count)])
    if not count:
        return None
    fit = max(FIT, OFF * _step(canvas, slopes) + 1)
    slopes, surfaces = separate(canvas, slopes, count, np.zeros(canvas.shape, bool), fit, PIECE, 1.0)
    good = [surface.gradient is not None and spans.size >= AREA and _bands(canvas, spans) >= least
            for surface, spans in zip(surfaces, spans_of(slopes, len(surfaces)))]
    if not _keep(slopes, good):
        return None
    surfaces = [surface for surface, kept in zip(surfaces, good) if kept]
    plateaus = find_plateaus(canvas, slopes >= 0)
    return Soft(canvas, slopes, surfaces, plateaus, choose_colours(canvas, plateaus, True), fit,
                np.full(canvas.keys.size, fit), None, False)


def _is_banded(canvas: Canvas, flat: np.ndarray) -> bool:
    """Whether flat areas of a picture of few colours touch others that are like them, but few that are not."""
    every = max(1, int(np.sqrt(flat.size / _SAMPLE)))
    row, col = (np.arange(0, size - 1, every, dtype=np.int32) for size in canvas.shape)
    row, col = row[:, None], col[None]
    cells = canvas.numbers(row, col)
    if np.unique(canvas.keys[cells]).size > REDUCED:
        return False
    close = far = hard = 0
    for down, across in ((0, 1), (1, 0)):
        beside = canvas.numbers(row + down, col + across)
        off = np.abs(canvas.colours(cells) - canvas.colours(beside)).max(axis=0)
        both = flat[row, col] & flat[row + down, col + across]
        close += int(np.count_nonzero(both & (off > ROUNDING) & (off <= STEP)))
        far += int(np.count_nonzero(off > FAR))
        hard += int(np.count_nonzero(both & (off > FAR)))
    return close > CLOSE * cells.size and hard <= HARD * far


def _linked(canvas: Canvas) -> Tuple[np.ndarray, int]:
    """Numbers (H, W) of the largest areas of 2 x 2 blocks without larger steps than from band to band, and how many."""
    values = planes(canvas.bare(canvas.keys), canvas.opaque)
    right, down = (np.abs(np.diff(values, axis=axis)).max(axis=0) <= STEP for axis in (2, 1))
    areas = block_areas(right[1:] & right[:-1] & down[:, 1:] & down[:, :-1])
    chosen = np.flatnonzero(areas.size >= AREA)
    chosen = chosen[np.argsort(-areas.size[chosen], kind="stable")[:MANY]]
    number = np.full(areas.size.size, -1, np.int16)
    number[chosen] = np.arange(chosen.size)
    slopes = no_ramps(canvas.shape).copy()
    areas.put(slopes.ravel(), number)
    return slopes, chosen.size


def _keep(slopes: np.ndarray, kept: Sequence[bool]) -> int:
    """Number the ramps that are kept anew, in place; and how many they are."""
    number = np.where(kept, np.cumsum(kept) - 1, -1)
    renumber(slopes, np.append(number, -1).astype(np.int32))
    return int(np.count_nonzero(kept))


def _bands(canvas: Canvas, spans: Spans) -> int:
    """How many colours fill a share of a ramp each."""
    _, counts = np.unique(canvas.bare(canvas.keys).ravel()[spans.every(1)], return_counts=True)
    return int(np.count_nonzero(counts >= WIDE * spans.size))


def _step(canvas: Canvas, slopes: np.ndarray) -> float:
    """A large one among the steps from band to band, levels of a channel."""
    values, ramp = planes(canvas.bare(canvas.keys), canvas.opaque), slopes >= 0
    steps = [np.abs(np.diff(values, axis=axis)).max(axis=0)[on] for axis, on in ((1, ramp[1:]), (2, ramp[:, 1:]))]
    every = np.concatenate(steps)
    return float(np.percentile(every[(every > 0) & (every <= STEP)], _LARGE))
