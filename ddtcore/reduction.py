# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures made smaller by a whole factor, and their drawings made larger again.

Each pixel of the smaller picture is the mean of a block of pixels (a box filter), which is
what a renderer's anti-aliasing does too, so that the stages after it measure edges as well
as ever.  Colours are averaged premultiplied: what lies under transparent pixels has no say.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Optional, Tuple

import numpy as np

from .model import Drawing, Gradient, Loop

_STRIP = 64
"""Rows of the smaller picture computed at a time."""


def reduce(image: np.ndarray, factor: int) -> np.ndarray:
    """The picture at a fraction of its resolution.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    factor : int
        Pixels along the side of a block; blocks that the picture does not fill are filled
        by its outermost pixels.

    Returns
    -------
    ndarray of shape (ceil(H / factor), ceil(W / factor), 4) and dtype uint8
        `image` itself if the factor is 1.
    """
    if factor == 1:
        return image
    height, width = (-(-size // factor) for size in image.shape[:2])
    out = np.empty((height, width, 4), np.uint8)
    for first in range(0, height, _STRIP):
        rows = image[first * factor:(first + _STRIP) * factor]
        missing = -len(rows) % factor, -image.shape[1] % factor
        rows = np.pad(rows, ((0, missing[0]), (0, missing[1]), (0, 0)), mode="edge")
        out[first:first + _STRIP] = _block_means(rows, factor)
    return out


def _block_means(rows: np.ndarray, factor: int) -> np.ndarray:
    """Mean colours of blocks, uint8 (h, w, 4), of whole blocks of pixels."""
    alpha = rows[..., 3:]
    if (alpha == 255).all():
        sums, weight = _block_sums(rows.astype(np.uint32), factor), factor ** 2
        return ((2 * sums + weight) // (2 * weight)).astype(np.uint8)
    sums = _block_sums(rows * alpha.astype(np.uint32), factor)
    cover = _block_sums(alpha.astype(np.uint32), factor)
    out: np.ndarray = (2 * sums + cover) // np.maximum(2 * cover, 1)
    out[..., 3:] = (2 * cover + factor ** 2) // (2 * factor ** 2)
    return out.astype(np.uint8)


def _block_sums(values: np.ndarray, factor: int) -> np.ndarray:
    """Sums over blocks; strided sums of a few large arrays, not one sum for each block."""
    rows = sum(values[k::factor] for k in range(1, factor)) + values[::factor]
    sums: np.ndarray = sum(rows[:, k::factor] for k in range(1, factor)) + rows[:, ::factor]
    return sums


def enlarge(drawing: Drawing, factor: Tuple[float, float], width: int, height: int) -> Drawing:
    """The drawing of a reduced picture at the size of the whole one.

    Parameters
    ----------
    drawing : Drawing
    factor : tuple of float
        By which the picture was reduced across and down.
    width, height : int
        Size of the whole picture; what blocks that it did not fill have added is pushed back
        to its rim.

    Returns
    -------
    Drawing
    """
    size, both = np.array([width, height], float), np.array(factor)
    shapes = tuple(
        replace(shape, loops=tuple(Loop(_within(loop.control * both, size), loop.degree) for loop in shape.loops),
                area=shape.area * factor[0] * factor[1], gradient=scaled(shape.gradient, factor))
        for shape in drawing.shapes)
    triangles = drawing.triangles
    if triangles is not None:
        triangles = replace(triangles, points=np.minimum(triangles.points * both, size))
    return replace(drawing, width=width, height=height, shapes=shapes, triangles=triangles)


def _within(control: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Control points (n, 4, 2) with ends no farther than `size`; handles go with their ends, but may lie beyond."""
    moved = np.maximum(control[:, [0, 3]] - size, 0)
    return np.asarray(control - moved[:, [0, 0, 1, 1]])


def scaled(gradient: Optional[Gradient], factor: Tuple[float, float]) -> Optional[Gradient]:
    """The gradient of a picture that is larger by a factor across, and by one down."""
    if gradient is None:
        return None
    wide, high = factor
    start, end = ((x * wide, y * high) for x, y in (gradient.start, gradient.end))
    across = gradient.across and (gradient.across[0] * wide, gradient.across[1] * high)
    return replace(gradient, start=start, end=end, across=across)
