# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that were enlarged to twice or four times their size get their own pixels back.

Programs enlarge by one of few filters.  Which one it was tells by what is left over when the
picture is explained as an enlarged one; its inverse then gives the pixels as they were,
without the blur and the ringing.  Very blurred pictures hold no more than half of their
pixels could, either: their halves are less blurred, and tell as much.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Callable, Dict, Optional, Tuple

import numpy as np

from .canvas import premultiply
from .flatten import straightened
from .raster import is_opaque

LOST = 0.145
"""Largest share of the steps between pixels that an enlarged picture may leave unexplained."""

LEAST = 128
"""Shortest side of a picture that is halved, px."""

LARGEST = 5_000_000
"""Larger pictures are taken as they are: to halve a million pixels takes about a second, px."""

ROUNDED = 4
"""How far pixels may be from their colour after what rounding lost is enlarged by the inverse, levels."""

CLIPPED = 12
"""As `ROUNDED`, where values beyond black or white were cut off."""

SPECK = 6.0
"""Regions smaller than this may be what rounding lost, px²."""

_LINES, _FEW_LINES = 96, 24
_MOST = 4
_REACH = 3
_INVERSE = 10
_ROUNDS = 10
_STEP = 1.8
_BLOCK = 16
_PIECE = 256
_STRIP = 64
_RARE = 16
_SETTLE = 2


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
    while factor < _MOST and min(image.shape[:2]) >= LEAST and image.shape[0] * image.shape[1] <= LARGEST:
        name = enlarged_by(image)
        if name is None:
            break
        image, factor = halved(image, name), 2 * factor
    return image, factor


def enlarged_by(image: np.ndarray) -> Optional[str]:
    """The name of the filter in `FILTERS` by which a picture was enlarged to twice its size; None if by none."""
    # A first look tells the many that are nothing like it.
    if lost_by_halving(image, "lanczos", 1, _FEW_LINES) > 2 * LOST:
        return None
    lost = {name: lost_by_halving(image, name) for name in FILTERS}
    # That others might overshoot black and white makes them fit where this one was used.
    best = min(lost, key=lambda name: lost[name] / (1.5 if name == "linear" else 1))
    return best if lost[best] < LOST else None


def halved(image: np.ndarray, name: str) -> np.ndarray:
    """The picture of half the size from which a filter gives this one."""
    odd = [(0, size % 2) for size in image.shape[:2]]
    image = np.pad(image, (*odd, (0, 0)), mode="edge")
    values = _planes(image)
    # Programs enlarge rows first, and round what they get.
    for last in (False, True):
        values = values.swapaxes(1, 2)
        values = np.concatenate([_halved(values[:, k:k + _STRIP], name) for k in range(0, values.shape[1], _STRIP)],
                                axis=1)
        if not last and len(values) == 3:
            values = np.rint(values)
    half = np.full((*values.shape[1:], 4), 255, np.float32)
    half[..., :len(values)] = np.moveaxis(values, 0, -1)
    clipped = (image == 0) | (image == 255)
    clipped = clipped[::2] | clipped[1::2]
    doubtful = clipped[:, ::2] | clipped[:, 1::2]
    return _settled(straightened(half.reshape(-1, 4)).reshape(half.shape), np.where(doubtful, CLIPPED, ROUNDED))


def _settled(image: np.ndarray, margin: np.ndarray) -> np.ndarray:
    """Pixels within a margin (H, W, 4) of a neighbour's colour get it if it is far more frequent."""
    shape = image.shape[:2]
    keys = np.ascontiguousarray(image).view(np.uint32)[..., 0].ravel()
    colours, index, counts = np.unique(keys, return_inverse=True, return_counts=True)
    index = index.reshape(shape)
    values = colours.view(np.uint8).reshape(-1, 4).astype(np.int16)
    for _ in range(_SETTLE):
        framed = np.pad(index, 1, mode="edge")
        best = index.copy()
        for down in range(3):
            for across in range(3):
                beside = framed[down:down + shape[0], across:across + shape[1]]
                asked = np.nonzero((counts[beside] > _RARE * counts[index]) & (counts[beside] > counts[best]))
                own, other = index[asked], beside[asked]
                near = (np.abs(values[own] - values[other]) <= margin[asked]).all(axis=1)
                best[tuple(axis[near] for axis in asked)] = other[near]
        index = best
    return colours[index].view(np.uint8).reshape(image.shape)


def lost_by_halving(image: np.ndarray, name: str, rounds: int = _ROUNDS, count: int = _LINES) -> float:
    """What of a picture cannot come from one of half the size, in relation to its steps from pixel to pixel.

    A sample of rows and columns is looked at; that of the two directions which loses more counts.
    """
    return max(_lost(lines[np.linspace(0, len(lines) - 1, min(len(lines), count)).astype(int)], name, rounds)
               for lines in (image, image.swapaxes(0, 1)))


def _lost(lines: np.ndarray, name: str, rounds: int) -> float:
    """What some lines of pixels (n, size, 4) would lose."""
    values = _planes(lines[:, :lines.shape[1] // 2 * 2])
    steps = np.square(np.diff(values, axis=2)).sum()
    if not steps:
        return 1.0
    off = np.square(values - _filtered(_halved(values, name, rounds), *_doubling(name)).clip(0, 255)).sum()
    return float(np.sqrt(off / steps))


def _planes(image: np.ndarray) -> np.ndarray:
    """Premultiplied colours as planes (3, H, W), or (4, H, W) where there is transparency."""
    opaque = is_opaque(image)
    values = image[..., :3] if opaque else premultiply(image)
    return np.ascontiguousarray(np.moveaxis(values, -1, 0)).astype(np.float32)


def _halved(whole: np.ndarray, name: str, rounds: int = _ROUNDS) -> np.ndarray:
    """Lines of half the length that give some lines (C, n, size) when they are enlarged.

    Landweber's iteration.  Where a filter overshoots black or white the excess is lost; there
    it may be anything.
    """
    double, halve = _doubling(name), _halving(name)
    half = _filtered(whole, *halve).clip(0, 255)
    black, white = whole <= 0, whole >= 255
    half[black[..., ::2] | black[..., 1::2]] = 0
    half[white[..., ::2] | white[..., 1::2]] = 255
    least, most = np.where(white, 0, np.float32(-np.inf)), np.where(black, 0, np.float32(np.inf))
    for _ in range(rounds):
        off = np.clip(whole - _filtered(half, *double), least, most)
        half = (half + _STEP * _filtered(off, *halve)).clip(0, 255)
    return half


def _filtered(lines: np.ndarray, matrix: np.ndarray, reach: int) -> np.ndarray:
    """Lines (C, n, size) of twice or half the length: blocks and `reach` more on either side, times a matrix."""
    step = len(matrix) - 2 * reach
    size = lines.shape[2]
    blocks = -(-size // step)
    framed = np.pad(lines, ((0, 0), (0, 0), (reach, reach + blocks * step - size)), mode="edge")
    windows = np.lib.stride_tricks.as_strided(framed, (*lines.shape[:2], blocks, len(matrix)),
                                              (*framed.strides[:2], step * framed.strides[2], framed.strides[2]))
    flat = windows.reshape(-1, len(matrix))
    out = np.repeat(flat[:, :1], matrix.shape[1], axis=1)
    # A flat block stays flat, and most are.
    busy = np.flatnonzero((flat != flat[:, :1]).any(axis=1))
    # Products so small that no threads are started for them.
    pieces = np.resize(busy, (-(-busy.size // _PIECE), _PIECE))
    out[pieces] = flat[pieces] @ matrix
    return out.reshape(*lines.shape[:2], -1)[..., :size * matrix.shape[1] // step]


@lru_cache(maxsize=None)
def _doubling(name: str, block: int = _BLOCK) -> Tuple[np.ndarray, int]:
    """What enlarges a block of pixels, and how many pixels on either side have a say."""
    place = np.arange(-_REACH, _REACH + 1)
    matrix = np.zeros((block + 2 * _REACH, 2 * block), np.float32)
    for side, off in enumerate((0.25, -0.25)):
        weights = FILTERS[name](np.abs(place + off))
        for k, weight in enumerate(weights / weights.sum()):
            matrix[np.arange(block) + k, 2 * np.arange(block) + side] = weight
    return matrix, _REACH


@lru_cache(maxsize=None)
def _halving(name: str) -> Tuple[np.ndarray, int]:
    """What gives a block of pixels back, by least squares, and how many pixels on either side have a say."""
    middle = _REACH + 2 * _INVERSE
    inverse = np.linalg.pinv(_doubling(name, 4 * _INVERSE)[0])[:, middle]
    first = 2 * (middle - _REACH) - _INVERSE
    weights = inverse[first:first + 2 * _INVERSE + 2]
    matrix = np.zeros((2 * _BLOCK + 2 * _INVERSE, _BLOCK), np.float32)
    for k in range(_BLOCK):
        matrix[2 * k:2 * k + len(weights), k] = weights / weights.sum()
    return matrix, _INVERSE


def _cubic(sharpness: float) -> Callable[[np.ndarray], np.ndarray]:
    """Cubic convolution (Keys 1981) with the slope `-sharpness` at a distance of one pixel."""
    def weight(place: np.ndarray) -> np.ndarray:
        near = ((2 - sharpness) * place - (3 - sharpness)) * place ** 2 + 1
        far = -sharpness * (((place - 5) * place + 8) * place - 4)
        return np.where(place < 1, near, np.where(place < 2, far, 0))
    return weight


FILTERS: Dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "linear": lambda place: np.maximum(1 - place, 0),
    "cubic": _cubic(0.5),
    "sharp cubic": _cubic(0.75),
    "lanczos": lambda place: np.where(place < 3, np.sinc(place) * np.sinc(place / 3), 0)}
"""The usual filters: the weight of a pixel at some distance, px."""
