# SPDX-License-Identifier: GPL-2.0-or-later
"""Strips along the picture's border that cover less than half of the outermost pixels.

Where an edge leaves the picture at a flat angle, or a frame ends a fraction of a pixel
inside, the colour beyond has no pixel of its own: all that is seen of it is a mix in the
outermost row.  There is no row further out that it could be told from, so the mix itself
is the evidence, if it goes on along the border.
"""

from __future__ import annotations

from typing import Iterator, Tuple

import numpy as np

from .canvas import Canvas
from .mixes import segment_distance
from .noise import ROUNDING

LEAST = 12.0
"""Smallest difference of a strip's pixel from the colour inside, levels."""

FAINT = 0.08
"""Smallest coverage of a strip's pixel."""

MIXED = 8.0
"""How far off the mixes with the strip's colour its pixels may lie, levels."""

RUN = 3
"""Fewest pixels of a strip; steeper edges are told from the rows further inside."""

_WEIGHED = 48


def label_strips(canvas: Canvas, labels: np.ndarray, thin: np.ndarray, colours: np.ndarray,
                 noise: float) -> None:
    """Give the pixels of such strips the label of the strip, and mark them as thin; in place.

    Parameters
    ----------
    labels : ndarray of shape (P,) and dtype int16
        Labels with the rim.
    thin : ndarray of shape (P,) and dtype bool
    colours : ndarray of shape (C, K) and dtype float32
        Premultiplied flat colours; labels from K on are ramps.
    noise : float
        How much flat areas vary, levels.
    """
    for cells, inward in _sides(canvas):
        strip = _strips(canvas, labels, cells, inward, colours[:, :_WEIGHED], noise - ROUNDING)
        found = strip >= 0
        labels[cells[found]] = strip[found]
        thin[cells[found]] = True


def _sides(canvas: Canvas) -> Iterator[Tuple[np.ndarray, int]]:
    """Pixels of each outermost row and column, in order, and the step to those further inside."""
    rows, cols = (np.arange(size, dtype=np.int32) for size in canvas.shape)
    yield canvas.numbers(rows[:1], cols), canvas.stride
    yield canvas.numbers(rows[-1:], cols), -canvas.stride
    yield canvas.numbers(rows, cols[:1]), 1
    yield canvas.numbers(rows, cols[-1:]), -1


def _strips(canvas: Canvas, labels: np.ndarray, cells: np.ndarray, inward: int, colours: np.ndarray,
            doubt: float) -> np.ndarray:
    """The label of the strip at each pixel of one side, -1 where there is none.

    Of several colours that explain a run, one that goes on beside it is the best, else
    the one that explains the longest run, else the most frequent.
    """
    strip = np.full(cells.size, -1, labels.dtype)
    inner = labels[cells + inward]
    flat = np.flatnonzero((labels[cells] == inner) & (inner >= 0) & (inner < colours.shape[1]))
    inside = colours[:, inner[flat]]
    off = canvas.colours(cells[flat]) - inside
    some = np.square(off).sum(axis=0) > (LEAST + 2 * doubt) ** 2
    at, inside, off = flat[some], inside[:, some, None], off[:, some]
    if at.size < RUN:
        return strip
    span = colours[:, None] - inside
    zero = np.zeros((1, 1, 1), np.float32)
    distance, share = segment_distance(np.broadcast_to(off[..., None], span.shape), zero, span)
    fits = np.zeros((cells.size, colours.shape[1]), bool)
    fits[at] = (distance < MIXED + doubt) & (share > FAINT)
    length, touching = _runs(fits, inner, labels[cells])
    score = np.where(length >= RUN, length + cells.size * touching, 0)
    best = np.argmax(score, axis=1)
    found = score[np.arange(cells.size), best] > 0
    strip[found] = best[found]
    return strip


def _runs(fits: np.ndarray, inner: np.ndarray, outer: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Runs of pixels that one colour explains before the same label further inside.

    Parameters
    ----------
    fits : ndarray of shape (N, K) and dtype bool
        Which colours explain which pixels of one side.
    inner, outer : ndarray of shape (N,)
        Labels of the pixels further inside, and of the pixels themselves.

    Returns
    -------
    length : ndarray of shape (N, K)
        Length of the run that each pixel belongs to, 0 where the colour does not explain it.
    touching : ndarray of shape (N, K) and dtype bool
        Whether the pixel before or after the run has the label of the colour.
    """
    size, count = fits.shape
    linked = fits[1:] & fits[:-1] & (inner[1:] == inner[:-1])[:, None]
    apart = np.ones((1, count), bool)
    place = np.arange(size)[:, None]
    head = np.maximum.accumulate(np.where(np.concatenate([apart, ~linked]), place, 0))
    tail = np.minimum.accumulate(np.where(np.concatenate([~linked, apart]), place, size)[::-1])[::-1]
    framed = np.concatenate([[-1], outer, [-1]])
    touching = (framed[head] == np.arange(count)) | (framed[tail + 2] == np.arange(count))
    return np.where(fits, tail - head + 1, 0), fits & touching
