# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that hold less than their pixels could: enlarged ones, and very blurred ones.

If a picture survives being halved and smoothly enlarged again, the half of it tells as much,
with edges as sharp as they were when it was drawn.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import premultiply
from .flatten import straightened

LOST = 0.145
"""Largest share of the steps between pixels that may be lost by halving."""

LEAST = 128
"""Shortest side of a picture that is halved, px."""

_LINES = 96
_MOST = 4


def original(image: np.ndarray) -> Tuple[np.ndarray, int]:
    """The picture before it was enlarged, as far as that can be told.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8

    Returns
    -------
    image : ndarray of shape (h, w, 4) and dtype uint8
    factor : int
        How many pixels a pixel of it is wide: 1, 2 or 4.
    """
    factor = 1
    while factor < _MOST and min(image.shape[:2]) >= LEAST and lost_by_halving(image) < LOST:
        image, factor = halved(image), 2 * factor
    return image, factor


def halved(image: np.ndarray) -> np.ndarray:
    """The picture of half the size from which this one may have been enlarged.

    Means of blocks are a little blurred; what they lack when they are enlarged again is added.
    """
    odd = [(0, size % 2) for size in image.shape[:2]]
    whole = premultiply(np.pad(image, (*odd, (0, 0)), mode="edge")).astype(np.float32)
    half = _block_mean(whole)
    grown = _doubled(_doubled(half).swapaxes(0, 1)).swapaxes(0, 1)
    half += _block_mean(whole - grown)
    return straightened(half.reshape(-1, 4)).reshape(half.shape)


def _block_mean(values: np.ndarray) -> np.ndarray:
    """Means of 2 x 2 pixels."""
    return np.asarray((values[::2, ::2] + values[::2, 1::2] + values[1::2, ::2] + values[1::2, 1::2]) / 4)


def _doubled(half: np.ndarray) -> np.ndarray:
    """Lines of pixels (n, size, C) enlarged to twice their length."""
    count = half.shape[1]
    framed = np.pad(half, ((0, 0), (3, 3), (0, 0)), mode="edge")
    whole = np.zeros((len(half), 2 * count, half.shape[2]), np.float32)
    for side, weights in enumerate((_WEIGHTS, _WEIGHTS[::-1])):
        for k, weight in enumerate(weights):
            whole[:, side::2] += weight * framed[:, k + side:k + side + count]
    return whole


def lost_by_halving(image: np.ndarray) -> float:
    """What a picture would lose at half its resolution, in relation to its steps from pixel to pixel.

    A sample of rows and columns is looked at; that of the two directions which loses more counts.
    """
    return max(_lost(lines[np.linspace(0, len(lines) - 1, min(len(lines), _LINES)).astype(int)])
               for lines in (image, image.swapaxes(0, 1)))


def _lost(lines: np.ndarray) -> float:
    """What some lines of pixels (n, size, 4) would lose."""
    count = lines.shape[1] // 2
    values = lines[:, :2 * count].astype(np.float32)
    values[..., :3] *= values[..., 3:] / 255
    steps = np.square(np.diff(values, axis=1)).sum()
    if not steps:
        return 1.0
    off = np.square(values - _doubled((values[:, ::2] + values[:, 1::2]) / 2)).sum()
    return float(np.sqrt(off / steps))


def _lanczos(places: np.ndarray) -> np.ndarray:
    """Weights of the pixels at some distances, px, when a picture is enlarged."""
    weights = np.sinc(places) * np.sinc(places / 3)
    return np.asarray((weights / weights.sum()).astype(np.float32))


_WEIGHTS = _lanczos(np.arange(6) - 2.75)
