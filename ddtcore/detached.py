# SPDX-License-Identifier: GPL-2.0-or-later
"""Pieces of a ramp that something drawn on it cuts off from the rest.

Between two strokes, a ramp goes on in a strip that nothing connects with it, and that may be
too narrow to be found by its own slopes.  What shows that it belongs there is its colour:
that of the ramp's surface at its place, over some area.  One gradient then serves all pieces.
"""

from __future__ import annotations

from typing import List, Tuple

import numpy as np

from .canvas import Canvas
from .components import components, next_among
from .growing import Surface
from .spans import renumber, spans_of

OFF = 3.0
"""How far from its surface a pixel of a piece may be, levels of a channel."""

AREA = 8
"""Smallest piece, px²."""

STRANGE = 0.03
"""Share of the pixels of a ramp that may be farther from the surface that it joins."""

REACH = 32
"""How far beyond its rows and columns pieces of a ramp are looked for, px."""

_ASKED = 64
"""Pixels of a ramp that tell whether a surface explains it."""

_WORK = 1 << 24
"""Colours of surfaces are computed for this many pixels at most."""


def join_detached(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface],
                  free: np.ndarray) -> Tuple[np.ndarray, List[Surface]]:
    """Join the pieces of ramps, those that were found as ramps and those among free pixels.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none; changed in place.
    surfaces : list of Surface
        The colours of each ramp.
    free : ndarray of shape (H, W) and dtype bool
        Pixels that belong neither to ramps nor to flat areas.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int16
    surfaces : list of Surface
        Those of the ramps that are left.
    """
    into = _explained(canvas, ramps, surfaces)
    kept, number = np.unique(into, return_inverse=True)
    if kept.size < into.size:
        renumber(ramps, np.append(number.ravel(), -1).astype(np.int32))
    surfaces = [surfaces[k] for k in kept.tolist()]
    _add_free(canvas, ramps, surfaces, free)
    return ramps, surfaces


def _explained(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface]) -> np.ndarray:
    """For each ramp a larger one whose surface explains it as well, or itself."""
    into = np.arange(len(surfaces))
    if not surfaces:
        return into
    spans = spans_of(ramps, len(surfaces))
    size = np.array([each.size for each in spans])
    share = (np.arange(_ASKED) + 0.5) / _ASKED
    asked = np.stack([each.at((each.size * share).astype(np.intp)) for each in spans])
    row, col = np.divmod(asked, ramps.shape[1])
    points = np.stack([col, row], axis=-1) + 0.5
    colour = np.moveaxis(canvas.colours(canvas.numbers(row, col)), 0, -1)
    left = np.argsort(-size, kind="stable")
    while left.size > 1:
        number, left = left[0], left[1:]
        if surfaces[number].gradient is None:
            continue
        off = surfaces[number].colours(points[left].reshape(-1, 2)).reshape(colour[left].shape) - colour[left]
        joins = np.mean(np.abs(off).max(axis=-1) > OFF, axis=1) < STRANGE
        into[left[joins]] = number
        left = left[~joins]
    return into


def _add_free(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface], free: np.ndarray) -> None:
    """Give the pieces of ramps among free pixels the number of their ramp, in place."""
    row, col = np.nonzero(free)
    colour = canvas.colours(canvas.numbers(row, col)).T
    points = np.stack([col, row], axis=1) + 0.5
    least = np.full(row.size, OFF)
    best = np.full(row.size, -1, np.int32)
    work = _WORK
    for number, spans in enumerate(spans_of(ramps, len(surfaces))):
        rows, cols = spans.window(ramps.shape, REACH)
        first, last = np.searchsorted(row, [rows.start, rows.stop])
        some = first + np.flatnonzero((col[first:last] >= cols.start) & (col[first:last] < cols.stop))
        work -= some.size
        if surfaces[number].gradient is None or work < 0:
            continue
        off = np.abs(surfaces[number].colours(points[some]) - colour[some]).max(axis=1)
        nearer = off < least[some]
        least[some[nearer]], best[some[nearer]] = off[nearer], number
    found = np.flatnonzero(best >= 0)
    found = found[_in_pieces(canvas, row[found], col[found], best[found])]
    ramps[row[found], col[found]] = best[found]


def _in_pieces(canvas: Canvas, row: np.ndarray, col: np.ndarray, best: np.ndarray) -> np.ndarray:
    """Which pixels, in reading order, belong to areas of one number that are neither small nor one pixel narrow."""
    cells = canvas.numbers(row, col)
    right, down = (next_among(cells, step) for step in (1, canvas.stride))
    across, along = (np.flatnonzero((place >= 0) & (best[place] == best)) for place in (right, down))
    area = components(cells.size, np.append(across, along), np.append(right[across], down[along]))
    block = np.zeros((2, cells.size), bool)
    block[0, across] = block[1, along] = True
    wide = across[block[1, across] & block[1, right[across]]]
    wide = wide[block[0, down[wide]]]
    kept = np.zeros(cells.size, bool)
    kept[area[wide]] = True
    kept &= np.bincount(area, minlength=cells.size) >= AREA
    return np.asarray(kept[area])
