# SPDX-License-Identifier: GPL-2.0-or-later
"""A picture as the labelling stages look at it: packed pixels with a rim.

Anti-aliasing mixes premultiplied colours linearly, with "nothing" as (0, 0, 0, 0);
so in premultiplied colours a pixel on an edge lies on the line between its two
sides, whatever their opacity.  Whole-picture passes compare packed pixels, four
bytes each; colours are unpacked only where a stage looks at them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from .parts import in_parts
from .raster import is_opaque, pixel_keys

RIM = 3
"""Pixels added on each side, so that windows up to 7 x 7 stay inside the arrays."""

LUMA = np.array([0.299, 0.587, 0.114], np.float32)
"""Shares of the channels in how bright a pixel is."""

_ROWS = 256
"""Rows of a picture worked on at a time."""


@dataclass(frozen=True)
class Canvas:
    """A picture in flat arrays, addressed by one number per pixel.

    Attributes
    ----------
    shape : (int, int)
        Rows and columns of the picture without its rim.
    keys : ndarray of shape (P,) and dtype uint32
        RGBA of each pixel in one number, 0 for "nothing", with the rim (a repetition
        of the outermost pixels), row by row.
    opaque : bool
        Whether every pixel has alpha 255.
    """

    shape: Tuple[int, int]
    keys: np.ndarray
    opaque: bool

    @property
    def stride(self) -> int:
        """Step from a pixel to the one below it."""
        return self.shape[1] + 2 * RIM

    def bare(self, values: np.ndarray) -> np.ndarray:
        """The (H, W) view of a flat array without its rim."""
        return values.reshape(-1, self.stride)[RIM:-RIM, RIM:-RIM]

    def rimmed(self, values: np.ndarray, rim: int) -> np.ndarray:
        """A flat copy of a (H, W) array with a rim of one value."""
        return np.pad(values, RIM, mode="constant", constant_values=rim).ravel()

    def cells(self, mask: np.ndarray, top: int = 0) -> np.ndarray:
        """Numbers of the pixels set in a mask of all rows, or of those from `top` on; int32, in reading order."""
        def found(rows: slice) -> Tuple[np.ndarray]:
            row, col = np.divmod(np.flatnonzero(mask[rows]).astype(np.int32), np.int32(mask.shape[1]))
            return (self.numbers(row + np.int32(top + rows.start), col),)

        return in_parts(found, len(mask), size=mask.shape[1])[0]

    def numbers(self, row: np.ndarray, col: np.ndarray) -> np.ndarray:
        """Numbers of the pixels at rows and columns that do not count the rim."""
        number: np.ndarray = (row + RIM) * np.int32(self.stride) + (col + RIM)
        return number

    def places(self, cells: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Row and column of pixels, not counting the rim."""
        row, col = np.divmod(cells, np.int32(self.stride))
        return row - RIM, col - RIM

    def holds(self, cells: np.ndarray) -> np.ndarray:
        """Which pixels belong to the picture, not to its rim."""
        row, col = self.places(cells)
        return (row >= 0) & (row < self.shape[0]) & (col >= 0) & (col < self.shape[1])

    def colours(self, cells: np.ndarray) -> np.ndarray:
        """Premultiplied colours of pixels, float32 (C, ...); C is 3 for an opaque picture, else 4."""
        return planes(self.keys.take(cells), self.opaque)

    def mixing(self, rgba: np.ndarray) -> np.ndarray:
        """Premultiplied planes, float32 (C, K), of RGBA colours (K, 4)."""
        return np.ascontiguousarray(premultiply(rgba).T[:3 if self.opaque else 4], np.float32)


def prepare(image: np.ndarray) -> Canvas:
    """Lay out a uint8 (H, W, 4) RGBA picture for labelling."""
    opaque = is_opaque(image)
    keys = pixel_keys(image)
    if not opaque:
        keys = np.where(image[..., 3] == 0, np.uint32(0), keys)
    return Canvas(image.shape[:2], np.pad(keys, RIM, mode="edge").ravel(), opaque)


def unpack(keys: np.ndarray) -> np.ndarray:
    """The RGBA bytes of packed pixels, uint8 (..., 4)."""
    return np.ascontiguousarray(keys)[..., None].view(np.uint8)


def pack(colours: np.ndarray) -> np.ndarray:
    """Premultiplied colours (C, N) as packed pixels (N,), uint32."""
    rgba = np.full((colours.shape[1], 4), 255.0)
    rgba[:, :len(colours)] = colours.T
    rgba[:, :3] *= 255 / np.maximum(rgba[:, 3:], 1)
    return np.asarray(np.rint(rgba).clip(0, 255).astype(np.uint8).view(np.uint32)[:, 0])


def count_keys(keys: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Different values of a 1-D array, rising, and how often each occurs; quick for long runs."""
    return summed_keys(*in_parts(lambda part: _counted_runs(keys[part]), keys.size))


def _counted_runs(keys: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    heads = np.flatnonzero(np.append(True, keys[1:] != keys[:-1])[:keys.size])
    return summed_keys(keys[heads], np.diff(np.append(heads, keys.size)))


def summed_keys(keys: np.ndarray, counts: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Different values of a 1-D array, rising, and the sum of the counts of each."""
    values, number = np.unique(keys, return_inverse=True)
    return values, np.bincount(number, counts, values.size).astype(np.int64)


def premultiply(rgba: np.ndarray) -> np.ndarray:
    """Premultiplied colours of RGBA ones (..., 4), 0 to 255."""
    return np.concatenate([rgba[..., :3] * (rgba[..., 3:] / 255), rgba[..., 3:]], axis=-1)


def planes(keys: np.ndarray, opaque: bool) -> np.ndarray:
    """Premultiplied channels of packed pixels, float32 (C, ...), 0 to 255."""
    rgba = unpack(keys)
    out = np.empty((3 if opaque else 4, *keys.shape), np.float32)
    for channel, plane in enumerate(out):
        plane[...] = rgba[..., channel]
    if not opaque:
        out[:3] *= out[3] * np.float32(1 / 255)
    return out


def within(values: np.ndarray, reach: int, combine: np.ufunc) -> np.ndarray:
    """Sums, or highest or lowest values, of planes (C, H, W) in the squares that reach so far from each pixel."""
    for axis in (1, 2):
        values = values.swapaxes(1, axis)
        padded = np.pad(values, [(0, 0), (reach, reach), (0, 0)], mode="edge")
        values = combine.reduce([padded[:, k:k + values.shape[1]] for k in range(2 * reach + 1)]).swapaxes(1, axis)
    return values


def mean_colours(canvas: Canvas, index: np.ndarray) -> np.ndarray:
    """Mean colour of the pixels of each label.

    Parameters
    ----------
    index : ndarray of shape (H, W) and an integer dtype
        Labels; pixels with a negative one are left out.

    Returns
    -------
    ndarray of shape (K, 4) and dtype float64
        RGBA, not premultiplied; weighted by alpha.
    """
    total = np.zeros((6, int(index.max()) + 1 if index.size else 0))
    for start in range(0, len(index), _ROWS):
        some = index[start:start + _ROWS] >= 0
        total += _sums(index[start:start + _ROWS][some], unpack(canvas.bare(canvas.keys)[start:start + _ROWS][some]),
                       canvas.opaque, total.shape[1])
    mean = total[:4].T
    mean[:, :3] /= np.maximum(total[4:5].T, 1e-9)
    mean[:, 3] = 255 * total[4] / np.maximum(total[5], 1)
    return mean


def _sums(label: np.ndarray, rgba: np.ndarray, opaque: bool, count: int) -> np.ndarray:
    """Sums (6, count) of what pixels of each label have of four channels, weighted by alpha, of alpha, and of 1."""
    out, label = np.empty((6, count)), label.astype(np.intp)
    out[5] = np.bincount(label, minlength=count)
    alpha = None if opaque else rgba[:, 3] / 255.0
    out[3] = out[4] = out[5] if alpha is None else np.bincount(label, alpha, count)
    for channel in range(3):
        out[channel] = np.bincount(label, rgba[:, channel] if alpha is None else rgba[:, channel] * alpha, count)
    return out
