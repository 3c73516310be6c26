# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that were enlarged get their own pixels back.

Programs enlarge by one of few filters.  Which one it was, and by how much, tells by what is left
over when the picture is explained as an enlarged one; its inverse then gives the pixels as they
were, without the blur and the ringing.  Very blurred pictures hold no more than half of their
pixels could, either: their halves are less blurred, and tell as much.
"""

from __future__ import annotations

from typing import Optional, Tuple

import numpy as np

from .canvas import premultiply
from .flatten import straightened
from .raster import is_opaque
from .resampling import FILTERS, Blocks, enlarging, shrinking

LOST = {3.0: 0.145, 2.0: 0.145, 1.5: 0.1}
"""Largest share of the steps between pixels that a picture enlarged by each factor may leave unexplained."""

LOOK = {3.0: 0.29, 2.0: 0.17, 1.5: 0.115}
"""The same for a first look with one of the filters.  Scans come near to what is enlarged by a half."""

BENT = {3.0: 0.8, 2.0: 1.2, 1.5: 1.2}
"""How much steps from pixel to pixel change at most in such pictures, as a multiple of themselves."""

LEAST = 128
"""Shortest side of a picture that is taken for an enlarged one, px."""

LARGEST = 5_000_000
"""Larger pictures are taken as they are: to shrink a million pixels takes about a second, px."""

ROUNDED = 4
"""How far pixels may be from their colour after what rounding lost is enlarged by the inverse, levels."""

CLIPPED = 12
"""As `ROUNDED`, where values beyond black or white were cut off."""

SPECK = 6.0
"""Regions smaller than this may be what rounding lost, px²."""

_LINES, _FEW_LINES = 96, 24
_MOST = 4
_ROUNDS = 10
_STEP = 1.8
_STRIP = 64
_RARE = 16
_SETTLE = 2


def original(image: np.ndarray) -> Tuple[np.ndarray, Tuple[float, float]]:
    """The picture before it was enlarged, as far as that can be told.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8

    Returns
    -------
    image : ndarray of shape (h, w, 4) and dtype uint8
    times : tuple of float
        How many pixels a pixel of it is wide and high: 1 if the picture was not enlarged.
    """
    across = down = 1.0
    while across < _MOST and min(image.shape[:2]) >= LEAST and image.shape[0] * image.shape[1] <= LARGEST:
        found = enlarged_by(image)
        if found is None:
            break
        small, (factor, _) = shrunk(image, *found), found
        down *= factor if factor.is_integer() else image.shape[0] / small.shape[0]
        across *= factor if factor.is_integer() else image.shape[1] / small.shape[1]
        image = small
    return image, (across, down)


def enlarged_by(image: np.ndarray) -> Optional[Tuple[float, str]]:
    """The factor by which a picture was enlarged, and the name of the filter in `FILTERS`; None if by none."""
    bend = bent(image)
    # What was enlarged by more could be so by a half.
    for factors in ((3.0, 2.0), (1.5,)):
        lost, name, factor = min((*_filter_of(image, factor, bend), factor) for factor in factors)
        if lost < np.inf:
            return factor, name
    return None


def _filter_of(image: np.ndarray, factor: float, bend: float) -> Tuple[float, str]:
    """What is lost by the filter that explains most, and its name; infinite if none explains enough."""
    # First looks tell the many that are nothing like it.
    if bend <= BENT[factor] and lost_by_shrinking(image, factor, "lanczos", 1, _FEW_LINES) <= LOOK[factor]:
        lost = {name: lost_by_shrinking(image, factor, name) for name in FILTERS}
        # That others might overshoot black and white makes them fit where this one was used.
        best = min(lost, key=lambda name: lost[name] / (1.5 if name == "linear" else 1))
        if lost[best] < LOST[factor]:
            return lost[best], best
    return np.inf, ""


def shrunk(image: np.ndarray, factor: float, name: str) -> np.ndarray:
    """The smaller picture from which a filter gives this one."""
    if factor.is_integer():
        rest = [(0, -size % int(factor)) for size in image.shape[:2]]
        image = np.pad(image, (*rest, (0, 0)), mode="edge")
    values = _planes(image)
    # Programs enlarge rows first, and round what they get.
    for last, size in enumerate(image.shape[:2]):
        there, back = _both(size, factor, name)
        values = values.swapaxes(1, 2)
        values = np.concatenate([_shrunk(values[:, k:k + _STRIP], there, back)
                                 for k in range(0, values.shape[1], _STRIP)], axis=1)
        if not last and len(values) == 3:
            values = np.rint(values)
    small = np.full((*values.shape[1:], 4), 255, np.float32)
    small[..., :len(values)] = np.moveaxis(values, 0, -1)
    doubtful = _met((image == 0) | (image == 255), small.shape[:2])
    return _settled(straightened(small.reshape(-1, 4)).reshape(small.shape), np.where(doubtful, CLIPPED, ROUNDED))


def _met(some: np.ndarray, shape: Tuple[int, int]) -> np.ndarray:
    """Which pixels of a smaller picture (h, w, 4) have some of those of the larger one (H, W, 4) below them."""
    for axis in (0, 1):
        begin = np.arange(shape[axis]) * some.shape[axis] // shape[axis]
        some = np.logical_or.reduceat(some, begin, axis=axis)
    return some


def _both(large: int, factor: float, name: str) -> Tuple[Blocks, Blocks]:
    """What makes lines of so many pixels by a factor, and what takes them back."""
    small = round(large / factor)
    return enlarging(small, large, name), shrinking(small, large, name)


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


def lost_by_shrinking(image: np.ndarray, factor: float, name: str, rounds: int = _ROUNDS,
                      count: int = _LINES) -> float:
    """What of a picture cannot come from a smaller one, in relation to its steps from pixel to pixel.

    A sample of rows and columns is looked at; that of the two directions which loses more counts.
    """
    return max(_lost(lines, factor, name, rounds) for lines in _sampled(image, count))


def bent(image: np.ndarray) -> float:
    """How much the steps from pixel to pixel change along some lines of a picture, as a multiple of themselves."""
    bends = steps = 0.0
    for lines in _sampled(image, _FEW_LINES):
        step = np.diff(_planes(lines), axis=2)
        bends, steps = bends + np.square(np.diff(step, axis=2)).sum(), steps + np.square(step).sum()
    return bends / max(steps, 1.0)


def _sampled(image: np.ndarray, count: int) -> Tuple[np.ndarray, ...]:
    """Some rows and some columns (n, size, 4) of a picture."""
    return tuple(lines[np.linspace(0, len(lines) - 1, min(len(lines), count)).astype(int)]
                 for lines in (image, image.swapaxes(0, 1)))


def _lost(lines: np.ndarray, factor: float, name: str, rounds: int) -> float:
    """What some lines of pixels (n, size, 4) would lose."""
    if factor.is_integer():
        lines = lines[:, :int(lines.shape[1] // factor * factor)]
    values = _planes(lines)
    steps = np.square(np.diff(values, axis=2)).sum()
    if not steps:
        return 1.0
    there, back = _both(values.shape[2], factor, name)
    off = np.square(values - there(_shrunk(values, there, back, rounds)).clip(0, 255)).sum()
    return float(np.sqrt(off / steps))


def _planes(image: np.ndarray) -> np.ndarray:
    """Premultiplied colours as planes (3, H, W), or (4, H, W) where there is transparency."""
    opaque = is_opaque(image)
    values = image[..., :3] if opaque else premultiply(image)
    return np.ascontiguousarray(np.moveaxis(values, -1, 0)).astype(np.float32)


def _shrunk(whole: np.ndarray, there: Blocks, back: Blocks, rounds: int = _ROUNDS) -> np.ndarray:
    """The shorter lines that give some lines (C, n, size) when they are enlarged.

    Landweber's iteration.  Where a filter overshoots black or white the excess is lost; there
    it may be anything.
    """
    part = back(whole).clip(0, 255)
    black, white = whole <= 0, whole >= 255
    begin = np.arange(part.shape[2]) * whole.shape[2] // part.shape[2]
    part[np.logical_or.reduceat(black, begin, axis=2)] = 0
    part[np.logical_or.reduceat(white, begin, axis=2)] = 255
    least, most = np.where(white, 0, np.float32(-np.inf)), np.where(black, 0, np.float32(np.inf))
    for _ in range(rounds):
        off = np.clip(whole - there(part), least, most)
        part = (part + _STEP * back(off)).clip(0, 255)
    return part
