# SPDX-License-Identifier: GPL-2.0-or-later
"""Pixel art: every pixel counts, and enlarged pixels are pixels.

An enlarged sprite is reduced to its own size first.  Each colour is a label.  Where two
colours cross like a chessboard, a figure stays connected and the ground does not; between
figures, the one that is rarer there (Kopf and Lischinski, "Depixelizing pixel art", ACM
Transactions on Graphics 30, 2011).
"""

from __future__ import annotations

from math import gcd

import numpy as np

from .canvas import Canvas, unpack
from .model import Labels
from .raster import packed

AROUND = 3
"""How far round a crossing the pixels of its two colours are counted, px."""


def block_size(image: np.ndarray) -> int:
    """The size of the squares that a picture consists of, px; 1 if there are none.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8

    Returns
    -------
    int
        The largest number that divides both sides and all places where the colour changes.
    """
    size = gcd(*image.shape[:2])
    # A few rows and columns tell most pictures that are not made of squares.
    for step in (max(1, min(image.shape[:2]) // 16), 1):
        for lines in (image[::step], image.swapaxes(0, 1)[::step]):
            if size > 1:
                key = packed(lines)
                for place in np.flatnonzero((key[:, 1:] != key[:, :-1]).any(axis=0)).tolist():
                    size = gcd(size, place + 1)
    return size if size < min(image.shape[:2]) else 1


def reduced(image: np.ndarray, size: int) -> np.ndarray:
    """One pixel for each square of a size, (H // size, W // size, 4)."""
    return np.ascontiguousarray(image[::size, ::size])


def label_sprite(canvas: Canvas) -> Labels:
    """One label for each colour; what is to stay connected at crossings counts as thin."""
    own, index = np.unique(canvas.bare(canvas.keys), return_inverse=True)
    index = np.ascontiguousarray(index.reshape(canvas.shape), np.int32)
    palette = unpack(own).astype(np.float64)
    clear = np.flatnonzero(palette[:, 3] == 0)
    rim = np.bincount(np.concatenate([index[0], index[-1], index[:, 0], index[:, -1]]))
    ground = int(clear[0] if clear.size else np.argmax(rim))
    return Labels(index, palette, figures_at_crossings(index, ground))


def figures_at_crossings(index: np.ndarray, ground: int) -> np.ndarray:
    """Pixels that stay connected where two colours cross.

    Parameters
    ----------
    index : ndarray of shape (H, W) and an integer dtype
        Number of the colour of each pixel.
    ground : int
        The colour behind the figures; of two others the one that is rarer nearby stays connected.

    Returns
    -------
    ndarray of shape (H, W) and dtype bool
    """
    figure = np.zeros(index.shape, bool)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    row, col = np.nonzero((a == d) & (b == c) & (a != b))
    if not row.size:
        return figure
    reach = np.arange(2 * AROUND)
    framed = np.pad(index, AROUND - 1, mode="constant", constant_values=-1)
    around = framed[row[:, None, None] + reach[:, None], col[:, None, None] + reach]
    falling, rising = a[row, col], b[row, col]
    more = ((around == falling[:, None, None]).sum(axis=(1, 2))
            - (around == rising[:, None, None]).sum(axis=(1, 2)))
    more[falling == ground], more[rising == ground] = 1, -1
    for chosen, side in ((more < 0, 0), (more > 0, 1)):
        figure[row[chosen], col[chosen] + side] = True
        figure[row[chosen] + 1, col[chosen] + 1 - side] = True
    return figure
