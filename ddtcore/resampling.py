# SPDX-License-Identifier: GPL-2.0-or-later
"""Lines of pixels enlarged by the usual filters, and enlarged lines made small again.

Both are done in blocks, each of which is a product with a matrix.  Where the factor is a simple
fraction all blocks have the same one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Callable, Dict, List, NamedTuple, Tuple

import numpy as np

_BLOCK = 16
_REACH = 4
_INVERSE = 10
_AROUND = 5
_PARTS = 16
_PIECE = 256


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


class Blocks(NamedTuple):
    """A linear map of lines in blocks, each times one of some matrices.

    Attributes
    ----------
    size : int
        Length of the lines it gives.
    first, begin : ndarray of shape (B,)
        Where the pixels that each block needs begin, and those that it gives.
    matrix : list of ndarray of shape (k, m)
    which : ndarray of shape (B,)
        Number of each block's matrix.
    """

    size: int
    first: np.ndarray
    begin: np.ndarray
    matrix: List[np.ndarray]
    which: np.ndarray

    def __call__(self, lines: np.ndarray) -> np.ndarray:
        """Lines (C, n, size) after the map; they go on as they end."""
        reach, given = self.matrix[0].shape
        before, after = -self.first.min(), max(0, self.first.max() + reach - lines.shape[2])
        framed = np.pad(lines, ((0, 0), (0, 0), (before, after)), mode="edge")
        if len(self.matrix) == 1:
            step = self.first[1] - self.first[0] if self.first.size > 1 else 1
            windows = np.lib.stride_tricks.as_strided(
                framed, (*lines.shape[:2], self.first.size, reach),
                (*framed.strides[:2], step * framed.strides[2], framed.strides[2]))
            return _product(windows, self.matrix[0]).reshape(*lines.shape[:2], -1)[:, :, :self.size]
        out = np.empty((*lines.shape[:2], self.begin.max() + given), lines.dtype)
        for first, begin, number in zip(before + self.first, self.begin, self.which):
            windows = framed[:, :, first:first + reach]
            out[:, :, begin:begin + given] = _product(windows, self.matrix[number])
        return out[:, :, :self.size]


def _product(windows: np.ndarray, matrix: np.ndarray) -> np.ndarray:
    """Windows (..., k) times a matrix (k, m) with columns whose sum is 1."""
    flat = windows.reshape(-1, len(matrix))
    out = np.repeat(flat[:, :1], matrix.shape[1], axis=1)
    # A flat block stays flat, and most are.
    busy = np.flatnonzero((flat != flat[:, :1]).any(axis=1))
    # Products so small that no threads are started for them.
    pieces = np.resize(busy, (-(-busy.size // _PIECE), _PIECE))
    out[pieces] = flat[pieces] @ matrix
    return out.reshape(*windows.shape[:-1], -1)


def enlarging(small: int, large: int, name: str) -> Blocks:
    """What makes lines of `small` pixels `large` by a filter."""
    source, target, begin = _grid(small, large)
    given = int(np.diff(target).max())
    matrices = [_forward(name, large / small, offset, given) for offset in (begin - target)[:-1].tolist()]
    return _blocks(large, source[:-1] - _REACH, target[:-1], matrices)


def shrinking(small: int, large: int, name: str) -> Blocks:
    """What gives the `small` lines back from the `large` ones that a filter made of them, nearly by least squares.

    The factor is taken for a whole number of halves within a block, and places for parts of a pixel.
    """
    source, target, begin = _grid(small, large)
    reach = _AROUND * -(-large // small)
    given = int(np.diff(target).max()) + 2 * reach
    factor = round(2 * large / small) / 2
    matrices = [_backward(name, factor, offset / _PARTS, reach, given)
                for offset in np.rint((begin - target)[:-1] * _PARTS).tolist()]
    return _blocks(small, target[:-1] - reach, source[:-1], matrices)


def _grid(small: int, large: int) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Where blocks begin in small lines, in large ones, and exactly there; last where they end, (B + 1,) each."""
    source = np.arange(-(-small // _BLOCK) + 1) * _BLOCK
    return source, source * large // small, source * (large / small)


def _blocks(size: int, first: np.ndarray, begin: np.ndarray, matrices: List[np.ndarray]) -> Blocks:
    """The map of such blocks; blocks have the same matrix where that is the same object."""
    distinct = {id(matrix): matrix for matrix in matrices}
    number = {key: k for k, key in enumerate(distinct)}
    return Blocks(size, first, begin, list(distinct.values()), np.array([number[id(matrix)] for matrix in matrices]))


def _weights(name: str, factor: float, offset: float, source: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Weights (len(source), len(target)) of a block's pixels in those of the large line from `offset` before it."""
    centre = (target + 0.5 - offset) / factor - 0.5
    weights = FILTERS[name](np.abs(centre - source[:, None]))
    return np.asarray(weights / weights.sum(axis=0))


@lru_cache(maxsize=256)
def _forward(name: str, factor: float, offset: float, given: int) -> np.ndarray:
    """What enlarges a block of pixels, and `_REACH` more on either side."""
    return _weights(name, factor, offset, np.arange(-_REACH, _BLOCK + _REACH), np.arange(given)).astype(np.float32)


@lru_cache(maxsize=256)
def _backward(name: str, factor: float, offset: float, reach: int, given: int) -> np.ndarray:
    """What gives a block of pixels back from those of the large line, and `reach` more on either side."""
    around = int(_INVERSE * factor) + reach
    target = np.arange(-around, given - 2 * reach + around)
    source = np.arange(-2 * _INVERSE, _BLOCK + 2 * _INVERSE)
    inverse = np.linalg.pinv(_weights(name, factor, offset, source, target))
    inverse = inverse[around - reach:around - reach + given, 2 * _INVERSE:2 * _INVERSE + _BLOCK]
    return np.asarray((inverse / inverse.sum(axis=0)).astype(np.float32))
