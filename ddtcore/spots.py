# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours of spots so small that no pixel need be covered in full: lips, eyes, buttons.

No two pixels of such a spot are alike, so neither plateaus nor frequent values tell its colour.  But
all of them are mixes of one colour with those round it, and no mixes of these alone: it is the one
among them with which the most others can be mixed.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import Canvas
from .mixes import third_share
from .ridges import Ridges, unexplained
from .sides import met_around

REACH = 4
"""How far from its middle a spot is looked at, px."""

FOREIGN = 20.0
"""How far off all mixes of the colours round it the pixels of a spot are, levels."""

LIKE = 12.0
"""How far off mixes with the colour of the spot they may be, levels."""

HALF = 0.5
"""Share of the spot's colour in a pixel that counts."""

PIXELS = 6
"""Fewest such pixels."""

_SIDES = 8
_TRIES = 8


def find_spots(canvas: Canvas, cells: np.ndarray, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
               doubt: float) -> np.ndarray:
    """Pixels in the colours of spots that nothing else explains, one of each colour.

    Parameters
    ----------
    canvas : Canvas
    cells : ndarray of shape (N,)
        All pixels that are no plateaus and on no ramps, rising.
    ridges : Ridges
        What stands out among them, those at least that no known colour explains.
    colours : ndarray of shape (C, K) and dtype float32
        The palette so far.
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    doubt : float
        By how many levels pixels vary more than in a clean picture.
    """
    found = np.zeros(0, cells.dtype)
    ridges = unexplained(ridges, colours, doubt)
    for _ in range(_TRIES):
        if not (ridges.cells.size and colours.size):
            break
        cell = ridges.cells[np.argmax(ridges.height)]
        near = _around(canvas, cell)
        spot = _fullest(canvas, near, cells, colours, labels, doubt)
        if spot.size:
            found, colours = np.append(found, spot), np.append(colours, canvas.colours(spot), axis=1)
        ridges = ridges.some(np.flatnonzero(~np.isin(ridges.cells, near)))
    return found


def _around(canvas: Canvas, cell: int) -> np.ndarray:
    """Numbers of the pixels of the picture within `REACH` of one of them."""
    row, col = canvas.places(np.array([cell]))
    down, across = np.mgrid[-REACH:REACH + 1, -REACH:REACH + 1].reshape(2, -1)
    row, col = row + down, col + across
    inside = (row >= 0) & (row < canvas.shape[0]) & (col >= 0) & (col < canvas.shape[1])
    return np.asarray(canvas.numbers(row[inside], col[inside]))


def _fullest(canvas: Canvas, near: np.ndarray, cells: np.ndarray, colours: np.ndarray, labels: np.ndarray,
             doubt: float) -> np.ndarray:
    """The one of some pixels with whose colour the most that no others explain can be mixed, (1,), or none."""
    asked = np.isin(near, cells)
    if (labels[near[~asked]] < 0).any():
        # A soft ramp has more colours than those known.
        return near[:0]
    met = met_around(canvas, labels, near[near.size // 2:][:1], colours.shape[1])[:, 0]
    # Thin strokes have no labels to be met.
    sides = colours[:, np.argsort(~met, kind="stable")[:_SIDES]]
    here = canvas.colours(near[asked])
    foreign = _from_mixes(here, sides, sides)[0].min(axis=1) > FOREIGN + 2 * doubt
    some, here = near[asked][foreign], here[:, foreign]
    if some.size < PIXELS:
        return near[:0]
    off, share = _from_mixes(here, sides, here)
    count = ((off < LIKE + doubt) & (share > HALF)).sum(axis=0)
    best = np.lexsort((np.minimum(off, 2 * LIKE).sum(axis=0), -count))[:1]
    return np.asarray(some[best[count[best] >= PIXELS + doubt / 2]])


def _from_mixes(points: np.ndarray, sides: np.ndarray, thirds: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of colours (C, N) from the nearest mix of any two sides and each third, and its share, (N, K)."""
    least = np.full((points.shape[1], thirds.shape[1]), np.inf, np.float32)
    share = np.zeros_like(least)
    for first, second in zip(*np.triu_indices(sides.shape[1])):
        one, other = (np.broadcast_to(sides[:, side, None], points.shape) for side in (first, second))
        off, part = third_share(points, one, other, thirds)
        nearer = off < least
        least[nearer], share[nearer] = off[nearer], part[nearer]
    return least, share
