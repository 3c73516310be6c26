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

SAGITTA = 0.005
"""How far chords may stray from a curve that is to be exact, px."""


class Pieces(NamedTuple):
    """Pieces of segments, each within one pixel, in the order of the segments.

    Attributes
    ----------
    segment : ndarray of shape (M,) and dtype int64
    pixel : ndarray of shape (M,) and dtype int64
        ``row * width + col``.
    t : ndarray of shape (M,)
        Parameter at the middle of the piece.
    move : ndarray of shape (2, M)
        From the beginning of the piece to its end, px.
    inset : ndarray of shape (M,)
        Distance of the middle from the left side of the pixel.
    """

    segment: np.ndarray
    pixel: np.ndarray
    t: np.ndarray
    move: np.ndarray
    inset: np.ndarray


def cut_into_pixels(control: np.ndarray, line: np.ndarray, shape: Tuple[int, int],
                    sagitta: float = SAGITTA) -> Pieces:
    """Flatten segments and cut them at the pixel grid.

    Parameters
    ----------
    control : ndarray of shape (S, 4, 2)
    line : ndarray of shape (S,) and dtype bool
    shape : (int, int)
        Rows and columns of the picture.
    sagitta : float
        How far chords may stray from the curves, px.

    Returns
    -------
    Pieces
    """
    bend = np.where(line, 0, np.square(np.diff(control, n=2, axis=1)).sum(axis=2).max(axis=1))
    # A chord over 1/n of a cubic strays by 6/8 of its largest second difference / n² at most.
    count = np.maximum(np.ceil(np.sqrt(0.75 / sagitta) * bend ** 0.25), 1).astype(np.int64)
    segment = np.repeat(np.arange(len(control)), count)
    dt = 1 / count[segment]
    t0 = (np.arange(len(segment)) - np.repeat(np.cumsum(count) - count, count)) * dt
    start = bezier.evaluate(control, segment, t0).T
    end = np.empty_like(start)
    end[:, :-1] = start[:, 1:]
    end[:, np.cumsum(count) - 1] = control[:, 3].T
    chord, begin, width = _cut_at_grid(start, end)
    middle = begin + width / 2
    move = (end - start).take(chord, axis=1)
    x, y = start.take(chord, axis=1) + middle * move
    # What bulges out on the left still bounds the row; elsewhere outside nothing is seen.
    np.maximum(x, 0, out=x)
    col, row = x.astype(np.int64), np.floor(y).astype(np.int64)
    pieces = Pieces(segment[chord], row * shape[1] + col, t0[chord] + middle * dt[chord], move * width, x - col)
    inside = (col < shape[1]) & (row >= 0) & (row < shape[0]) & (width > 1e-9)
    return pieces if inside.all() else Pieces(*(part[..., inside] for part in pieces))


def _cut_at_grid(start: np.ndarray, end: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Pieces of chords between the lines of the grid: chord, where on it each begins, its share of it."""
    cuts = [np.arange(start.shape[1], dtype=np.float64)]
    for a, b in zip(start, end):
        first = np.floor(np.minimum(a, b)) + 1
        count = np.maximum(np.ceil(np.maximum(a, b)) - first, 0).astype(np.int64)
        chord = np.repeat(np.arange(len(a)), count)
        line = first[chord] + np.arange(len(chord)) - np.repeat(np.cumsum(count) - count, count)
        share = (line - a[chord]) / (b - a)[chord]
        cuts.append(chord + np.clip(share, 0, 1 - 1e-9))
    cut = np.sort(np.concatenate(cuts))
    chord = cut.astype(np.int64)
    begin = cut - chord
    return chord, begin, np.minimum(np.append(cut[1:], np.inf) - chord, 1) - begin


def touched_pixels(pieces: Pieces, size: int) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels that pieces lie in, rising, and the number of each piece's pixel among them."""
    mask = np.zeros(size, bool)
    mask[pieces.pixel] = True
    pixels = np.flatnonzero(mask)
    number = np.empty(size, np.int32)
    number[pixels] = np.arange(len(pixels))
    return pixels, number[pieces.pixel]


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
    fresh = np.diff(row, prepend=-1) > 0
    head = np.flatnonzero(fresh)[np.cumsum(fresh) - 1]
    drop = pieces.move[1]
    here = drop * (1 - pieces.inset)
    colours = np.empty((n, step.shape[1]))
    for c in range(step.shape[1]):
        whole = np.cumsum(np.bincount(number, drop * step[:, c], n))
        part = np.bincount(number, here * step[:, c], n)
        before = np.concatenate([[0.0], whole])[:-1]
        colours[:, c] = before - before[head] + part
    return colours
