# SPDX-License-Identifier: GPL-2.0-or-later
"""The pixels of regions, and which of them tell a region's colours: those that it covers in full, as far as any are."""

from __future__ import annotations

from typing import Iterator, NamedTuple, Tuple

import numpy as np

from .canvas import premultiply
from .raster import is_opaque
from .sides import window

_FEW = 16
_NARROW = 0.35
"""Regions with fewer pixels off their border, or a smaller share of all, are narrow."""

_EVEN = 4.0
"""How far the colours in a block of 2 x 2 fully covered pixels differ at most, levels of a channel."""

_ENOUGH = 1 << 15
"""Pixels that are as good as all of a region."""

_ROWS = 256
"""Rows of the picture worked on at a time."""

_STRONG = 0.93
"""Pixels of a narrow region stand out that differ from what is round it by this share of the most."""


class Pixels(NamedTuple):
    """Pixels of some regions, in reading order."""

    cells: np.ndarray    # (n,) number of the pixel
    points: np.ndarray   # (n, 2) its centre
    region: np.ndarray   # (n,)
    inside: np.ndarray   # (n,) whether all its neighbours belong to the same region

    @classmethod
    def of(cls, regions: np.ndarray, some: np.ndarray) -> Pixels:
        """The pixels in an array (H, W) of the regions that are set in a mask; of large ones, some."""
        cells = _chosen(regions, some)
        row, col = np.divmod(cells, regions.shape[1])
        points = np.stack([col + 0.5, row + 0.5], axis=1)
        return cls(cells, points, regions.ravel()[cells], surrounded(regions).ravel()[cells])

    def groups(self) -> Iterator[Tuple[int, np.ndarray]]:
        """Each region, and the places of its pixels."""
        order = np.argsort(self.region, kind="stable")
        values, first = np.unique(self.region[order], return_index=True)
        return zip(values.tolist(), np.split(order, first[1:]))

    @property
    def narrow(self) -> np.ndarray:
        """Which of the regions consist of their border, or nearly."""
        inner = np.bincount(self.region, self.inside)
        return np.asarray(inner < np.maximum(_FEW, _NARROW * np.bincount(self.region)))

    def colours(self, image: np.ndarray) -> np.ndarray:
        """Their premultiplied colours in a uint8 picture (H, W, 4)."""
        return premultiply(image.reshape(-1, 4)[self.cells].astype(np.float64))


def _chosen(regions: np.ndarray, some: np.ndarray) -> np.ndarray:
    """Numbers of the pixels of some regions; of the largest, those of every n-th row and column."""
    width = regions.shape[1]
    size = sum(np.bincount(row, minlength=len(some)) for row in _strips(regions.ravel(), width))
    step = np.maximum(np.ceil(np.sqrt(size / _ENOUGH)).astype(np.int32), 1)
    chosen = []
    for number, strip in enumerate(_strips(regions.ravel(), width)):
        cells = np.flatnonzero(some[strip])
        row, col = np.divmod(cells, width)
        each = step[strip[cells]]
        kept = ((row + number * _ROWS) % each == 0) & (col % each == 0)
        chosen.append(cells[kept] + number * _ROWS * width)
    return np.concatenate(chosen)


def _strips(values: np.ndarray, width: int) -> Iterator[np.ndarray]:
    """The values of some rows after the other: what is computed of them needs little memory."""
    return (values[start:start + _ROWS * width] for start in range(0, len(values), _ROWS * width))


def surrounded(values: np.ndarray) -> np.ndarray:
    """Which pixels have eight equal neighbours, but for those beyond the border of the picture."""
    same = np.ones(values.shape, bool)
    equal = values[1:] == values[:-1]
    same[1:] &= equal
    same[:-1] &= equal
    column = same.copy()
    equal = values[:, 1:] == values[:, :-1]
    same[:, 1:] &= equal & column[:, :-1]
    same[:, :-1] &= equal & column[:, 1:]
    return same


def sure_pixels(image: np.ndarray, regions: np.ndarray, pixels: Pixels) -> np.ndarray:
    """Which pixels (n,) tell the colours of their region: they are covered by it in full, as far as any are."""
    sure = pixels.inside.copy()
    some = np.flatnonzero(pixels.narrow[pixels.region])
    if not some.size:
        return sure
    cells = pixels.cells[some]
    even = _even(image, regions, cells)
    height = _height(image, regions, cells)
    strong = height >= _STRONG * _most_near(height, regions, cells)
    # Where a region is so narrow that nothing is even, what stands out most there is the best there is.
    sure[some] = even | strong & (_most_near(even.astype(np.float64), regions, cells) == 0)
    return sure


def _even(image: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Which pixels lie in a block of 2 x 2 of the same region and nearly the same colour."""
    colours, own = image.reshape(-1, 4), regions.ravel()[cells]
    here = premultiply(colours[cells].astype(np.float32))
    like = {}
    for step, near, inside in _around(cells, regions.shape, 1):
        off = np.abs(premultiply(colours[near].astype(np.float32)) - here).max(axis=1)
        like[step] = inside & (regions.ravel()[near] == own) & (off <= _EVEN)
    even = np.zeros(cells.size, bool)
    for down in (-1, 1):
        for across in (-1, 1):
            even |= like[down, 0] & like[0, across] & like[down, across]
    return even


def _height(image: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """How far the colours of pixels are from the mean of those of other regions within 7 x 7."""
    colours, own = image.reshape(-1, 4), regions.ravel()[cells]
    opaque = is_opaque(image)

    def colours_of(some: np.ndarray) -> np.ndarray:
        rgba = colours[some].astype(np.float32)
        return rgba if opaque else premultiply(rgba)

    total, count = np.zeros((cells.size, 4), np.float32), np.zeros((cells.size, 1), np.float32)
    for _, near, _ in _around(cells, regions.shape, 3):
        other = (regions.ravel()[near] != own)[:, None]
        total += colours_of(near) * other
        count += other
    off = colours_of(cells) - total / np.maximum(count, 1)
    return np.asarray(np.sqrt((off ** 2).sum(axis=1)))


def _most_near(height: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The largest of the values (n,) of some pixels of the same region within 5 x 5 of each."""
    own = regions.ravel()[cells]
    most = height.copy()
    for _, near, inside in _around(cells, regions.shape, 2):
        place = np.minimum(np.searchsorted(cells, near), cells.size - 1)
        same = np.flatnonzero(inside & (cells[place] == near) & (own[place] == own))
        most[same] = np.maximum(most[same], height[place[same]])
    return most


def _around(cells: np.ndarray, shape: Tuple[int, int],
            reach: int) -> Iterator[Tuple[Tuple[int, int], np.ndarray, np.ndarray]]:
    """Steps to all pixels nearby, the pixels there, or the nearest in the picture, and whether they are in it."""
    row, col = np.divmod(cells, shape[1])
    # Steps in a picture so wide tell how far down and across they go.
    wide = 4 * reach
    for step in (window(wide, 1, reach) + 2 * reach).tolist():
        down, across = step // wide, step % wide - 2 * reach
        below, beside = np.clip(row + down, 0, shape[0] - 1), np.clip(col + across, 0, shape[1] - 1)
        yield (down, across), below * shape[1] + beside, (below == row + down) & (beside == col + across)
