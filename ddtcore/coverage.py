# SPDX-License-Identifier: GPL-2.0-or-later
"""What curves would look like as pixels: exact coverage along the outlines.

Each piece of an outline inside one pixel moves area from one face to the other;
the sum of these moves along a pixel row, from the left border of the picture, is
the colour of each pixel.  This is how font rasterisers accumulate
signed areas (R. Levien, "Inside the fastest font renderer in the world", 2016),
with colours in place of coverage and only for the pixels that outlines touch.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from . import bezier

CHORD = 0.95
"""Longest chord that stands for a bit of curve, px; below 1, so that it meets two grid lines at most."""

SAGITTA = 0.01
"""How far chords may stray from a curve, px."""


class Pieces(NamedTuple):
    """Pieces of segments, each within one pixel, in the order of the segments.

    Attributes
    ----------
    segment : ndarray of shape (M,) and dtype int64
    pixel : ndarray of shape (M,) and dtype int64
        ``row * width + col``.
    t : ndarray of shape (M,)
        Parameter at the middle of the piece.
    move : ndarray of shape (M, 2)
        From the beginning of the piece to its end, px.
    inset : ndarray of shape (M,)
        Distance of the middle from the left side of the pixel.
    """

    segment: np.ndarray
    pixel: np.ndarray
    t: np.ndarray
    move: np.ndarray
    inset: np.ndarray


def cut_into_pixels(control: np.ndarray, line: np.ndarray, shape: Tuple[int, int]) -> Pieces:
    """Flatten segments and cut them at the pixel grid.

    Parameters
    ----------
    control : ndarray of shape (S, 4, 2)
    line : ndarray of shape (S,) and dtype bool
    shape : (int, int)
        Rows and columns of the picture.

    Returns
    -------
    Pieces
    """
    fastest = 3 * np.hypot(*np.moveaxis(np.diff(control, axis=1), 2, 0)).max(axis=1)
    bend = np.where(line, 0, np.square(np.diff(control, n=2, axis=1)).sum(axis=2).max(axis=1))
    # A chord over 1/n of a cubic strays by 6/8 of its largest second difference / n² at most.
    count = np.ceil(np.maximum(fastest / CHORD, np.sqrt(0.75 / SAGITTA) * bend ** 0.25))
    count = np.maximum(count, 1).astype(np.int64)
    segment = np.repeat(np.arange(len(control)), count)
    step = np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)
    t0 = step / count[segment]
    dt = 1.0 / count[segment]
    start = bezier.evaluate(control, segment, t0)
    end = np.empty_like(start)
    end[:-1] = start[1:]
    tails = np.cumsum(count) - 1
    end[tails] = control[:, 3]
    cuts = np.stack([_grid_crossing(start[:, k], end[:, k]) for k in (0, 1)], axis=1)
    cuts.sort(axis=1)
    bounds = np.concatenate([np.zeros((len(cuts), 1)), cuts, np.ones((len(cuts), 1))], axis=1)
    share = np.diff(bounds, axis=1)
    chord, part = np.nonzero(share > 1e-9)
    width = share[chord, part]
    middle = bounds[chord, part] + width / 2
    move = (end - start)[chord]
    at = start[chord] + middle[:, None] * move
    cell = np.floor(at).astype(np.int64)
    # What bulges out on the left still bounds the row; elsewhere outside nothing is seen.
    np.maximum(cell[:, 0], 0, out=cell[:, 0])
    at[:, 0] = np.maximum(at[:, 0], 0)
    inside = (cell[:, 0] < shape[1]) & (cell[:, 1] >= 0) & (cell[:, 1] < shape[0])
    chord, cell = chord[inside], cell[inside]
    return Pieces(segment[chord], cell[:, 1] * shape[1] + cell[:, 0],
                  t0[chord] + middle[inside] * dt[chord], move[inside] * width[inside, None],
                  at[inside, 0] - cell[:, 0])


def _grid_crossing(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Where a chord shorter than 1 px crosses a line of the grid, as a share of it; else 1."""
    a, b = np.floor(start), np.floor(end)
    crossed = a != b
    grid = np.maximum(a, b)
    span = np.where(crossed, end - start, 1.0)
    return np.where(crossed, np.clip((grid - start) / span, 0, 1), 1.0)


def touched_pixels(pieces: Pieces, size: int) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels that pieces lie in, rising, and the number of each piece's pixel among them."""
    mask = np.zeros(size, bool)
    mask[pieces.pixel] = True
    pixels = np.flatnonzero(mask)
    return pixels, np.searchsorted(pixels, pieces.pixel)


def colours_along(pieces: Pieces, pixels: np.ndarray, number: np.ndarray, step: np.ndarray,
                  width: int) -> np.ndarray:
    """Colours of the touched pixels.

    Parameters
    ----------
    pieces : Pieces
        Of all outlines, those on the left border of the picture among them.
    pixels, number
        From `touched_pixels`.
    step : ndarray of shape (M, C)
        Colour on the left of each piece less that on its right; the outside of the
        picture is 0.
    width : int
        Columns of the picture.

    Returns
    -------
    ndarray of shape (P, C)
    """
    n = len(pixels)
    row = pixels // width
    head = np.searchsorted(row, row)
    drop = pieces.move[:, 1]
    here = drop * (1 - pieces.inset)
    colours = np.empty((n, step.shape[1]))
    for c in range(step.shape[1]):
        whole = np.cumsum(np.bincount(number, drop * step[:, c], n))
        part = np.bincount(number, here * step[:, c], n)
        before = np.concatenate([[0.0], whole])[:-1]
        colours[:, c] = before - before[head] + part
    return colours
