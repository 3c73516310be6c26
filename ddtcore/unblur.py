# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture as it would be if its edges were sharp.

Outlines are adjusted until their pixels are those of the picture.  Pixels of a scan, or of a
picture that was enlarged, hold more than the area of one pixel: thin strokes look wider and
paler, corners rounder.  How wide edges are tells how much more; that much of a blur is undone.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import premultiply
from .flatten import straightened
from .model import Labels

LEAST = 0.6
"""Smallest blur that is undone: standard deviation, px."""

MOST = 1.2
"""Largest blur that is undone, px."""

CONTRAST = 60.0
"""Smallest difference of the sides of an edge that is looked at, levels."""

EDGES = 50
"""Fewest such edges."""

_LINES = 256
_WIDE = 8
_ROUNDS = 2
_SAMPLE = 1 << 9
_FLAT = 0.1
_PURE = 20.0


def unblur(image: np.ndarray, labels: Labels) -> np.ndarray:
    """Undo the blur of a picture, as far as its edges tell of one.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        Without gradients: every label has one colour.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
        `image` itself where edges are sharp.

    Notes
    -----
    Van Cittert's iteration: what blurring takes away from the result is added to it.
    """
    width = blur_width(image, labels)
    if width < LEAST:
        return image
    colours = premultiply(image).astype(np.float32)
    kernel = _kernel(min(width, MOST))
    sharp = colours
    for _ in range(_ROUNDS):
        sharp = sharp + colours - _blurred(sharp, kernel)
    return straightened(sharp.reshape(-1, 4)).reshape(image.shape)


def blur_width(image: np.ndarray, labels: Labels) -> float:
    """How much wider the edges between flat colours are than a pixel makes them.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels

    Returns
    -------
    float
        Standard deviation of a Gaussian blur, px; 0 for sharp edges, or too few of them.
    """
    palette = premultiply(labels.palette)
    spreads = np.concatenate([_spreads(image, labels.index, palette),
                              _spreads(image.swapaxes(0, 1), labels.index.T, palette)])
    if spreads.size < EDGES:
        return 0.0
    # A Gaussian edge has the spread s / sqrt(pi); that of a pixel's own width is 1 / 12 as a variance.
    width = np.median(spreads) * np.sqrt(np.pi)
    return float(np.sqrt(max(width * width - 1 / 12, 0)))


def _spreads(image: np.ndarray, index: np.ndarray, palette: np.ndarray) -> np.ndarray:
    """Sums of share * (1 - share) across upright edges with nothing else near, at right angles to the edge."""
    row, col = _lone_edges(index)
    left, right = palette[index[row, col]], palette[index[row, col + _WIDE - 1]]
    span = left - right
    size = np.square(span).sum(axis=1)
    shares = []
    for down in (-1, 0, 1):
        off = premultiply(image[row[:, None] + down, col[:, None] + np.arange(_WIDE)]) - right[:, None]
        shares.append(np.einsum("nkc,nc->nk", off, span) / np.maximum(size, 1)[:, None])
        if down == 0:
            beside = np.abs(off - shares[-1][..., None] * span[:, None]).max(axis=(1, 2))
    above, share, below = shares
    slope = (below - above).sum(axis=1) / 2
    good = (beside < _PURE) & (size > CONTRAST ** 2) & (np.abs(slope) < 1)
    good &= (np.abs(share[:, 0] - 1) < _FLAT) & (np.abs(share[:, -1]) < _FLAT)
    return np.asarray(((share * (1 - share)).sum(axis=1) / np.hypot(1, slope))[good])


def _lone_edges(index: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Rows, and first of `_WIDE` columns, where labels change once, in the middle; a sample of them."""
    lines = np.linspace(1, len(index) - 2, min(max(len(index) - 2, 0), _LINES)).astype(int)
    some = index[lines]
    same = some[:, 1:] == some[:, :-1]
    places = max(same.shape[1] - _WIDE + 2, 0)
    alone = ~same[:, _WIDE // 2 - 1:][:, :places]
    for k in range(_WIDE - 1):
        if k != _WIDE // 2 - 1:
            alone &= same[:, k:k + places]
    row, col = np.nonzero(alone)
    few = slice(None, None, max(1, row.size // _SAMPLE))
    return lines[row[few]], col[few]


def _kernel(width: float) -> np.ndarray:
    """Weights (7,) of a Gaussian of a standard deviation."""
    place = np.arange(-3, 4)
    kernel = np.exp(-np.square(place / width) / 2)
    return np.asarray((kernel / kernel.sum()).astype(np.float32))


def _blurred(colours: np.ndarray, kernel: np.ndarray) -> np.ndarray:
    """Planes (H, W, C) after a blur along both axes."""
    for axis in (0, 1):
        pad = [(0, 0)] * 3
        pad[axis] = (3, 3)
        padded = np.pad(colours, pad, mode="edge").swapaxes(0, axis)
        n = colours.shape[axis]
        colours = sum(weight * padded[k:k + n] for k, weight in enumerate(kernel)).swapaxes(0, axis)
    return colours
