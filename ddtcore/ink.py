# SPDX-License-Identifier: GPL-2.0-or-later
"""Black and white: ink on paper, with the threshold found in the picture.

The threshold parts the histogram of grey levels so that the variance between its two
parts is largest (Otsu, "A threshold selection method from gray-level histograms", IEEE
Transactions on Systems, Man, and Cybernetics 9, 1979).  Where the picture has one level
of ink and one of paper, it lies half-way between them, where anti-aliasing puts an edge.
Then levels are stretched so that ink is black, paper is white and the threshold is in
the middle: what was anti-aliased still is.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Tuple

import numpy as np

from .canvas import LUMA
from .model import LINE, Drawing, Labels, Loop, Shape
from .options import TraceOptions
from .perception import nearest
from .raster import is_opaque
from .recolour import snap

MIDDLE = 127.5
"""The threshold of a stretched picture."""

PEAK = 0.2
"""Least share of the darker or lighter pixels that have its level, for ink or paper to have one."""

WIDTH = 5
"""How many levels such a peak is wide."""

BLACK = np.array([0, 0, 0, 255])
PAPER = (255, 255, 255)


def stretch(image: np.ndarray, level: float) -> np.ndarray:
    """The picture in grey, ink black, paper white, the threshold in the middle.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    level : float
        What is darker becomes black, percent; 0 to choose.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
    """
    rgb = image[..., :3].astype(np.float32)
    grey = rgb @ LUMA
    levels = np.clip(np.rint(grey[image[..., 3] > 0]), 0, 255).astype(np.int64)
    if not levels.size:
        return image
    ink, middle, paper = _levels(np.bincount(levels, minlength=256), 255 * level / 100)
    tone = np.interp(np.arange(256), [ink, middle, paper], [0, MIDDLE, 255])
    out = image.copy()
    out[..., :3] = np.interp(grey, np.arange(256), np.rint(tone))[..., None] + 0.5
    return out


def otsu(count: np.ndarray) -> float:
    """The threshold between levels, of which each occurs `count` (256,) times; between two of them."""
    level = np.arange(len(count))
    below, total = np.cumsum(count).astype(np.float64), count.sum()
    sums = np.cumsum(count * level)
    above = total - below
    gap = sums / np.maximum(below, 1) - (sums[-1] - sums) / np.maximum(above, 1)
    between = below * above * gap ** 2
    best = np.flatnonzero(between >= between.max() * (1 - 1e-9))
    return float(best.mean()) + 0.5


def _levels(count: np.ndarray, level: float) -> Tuple[float, float, float]:
    """Levels of ink, threshold and paper, rising."""
    middle = otsu(count)
    place = int(middle) + 1
    (ink, sharp), (paper, too) = _peak(count[:place], 0), _peak(count[place:], place)
    if level:
        middle = level
    elif sharp and too:
        middle = (ink + paper) / 2
    return min(ink, middle - 1), middle, max(paper, middle + 1)


def _peak(count: np.ndarray, first: int) -> Tuple[float, bool]:
    """The most frequent of some levels, and whether it has a good share of them."""
    if not count.any():
        return float(first), False
    window = np.convolve(count, np.ones(WIDTH), mode="same")
    near = slice(max(0, int(np.argmax(window)) - WIDTH // 2), int(np.argmax(window)) + WIDTH // 2 + 1)
    best = near.start + int(np.argmax(count[near]))
    return float(first + best), bool(window.max() >= PEAK * count.sum())


def separate(image: np.ndarray, labels: Labels) -> Tuple[np.ndarray, Labels]:
    """Make ink of all that is darker than the threshold, and white or nothing of the rest.

    Paper is nothing where the whole picture is opaque: it can be one rectangle then.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        Stretched.
    labels : Labels
        With `gradients`.
    """
    white = [*PAPER, 0 if is_opaque(image) else 255]
    return snap(image, labels, np.array([BLACK, white]), lambda rgb: (rgb[:, 0] > MIDDLE).astype(np.int64))


def on_paper(drawing: Drawing, options: TraceOptions) -> Drawing:
    """Join all ink of a picture without transparency to one shape, on a white rectangle unless that is dropped.

    Parameters
    ----------
    drawing : Drawing
        Shapes that are all of one colour and touch nowhere.
    options : TraceOptions
    """
    shapes = []
    if options.background == "keep":
        paper = options.swatches or [PAPER]
        rgb = paper[int(nearest(np.array([PAPER]), np.array(paper))[0])]
        size = drawing.width, drawing.height
        name = "#{:02x}{:02x}{:02x} 1".format(*rgb)
        shapes.append(Shape(name, rgb, 1.0, (_rectangle(*size),), float(size[0] * size[1])))
    if drawing.shapes:
        loops = tuple(loop for shape in drawing.shapes for loop in shape.loops)
        shapes.append(replace(drawing.shapes[0], loops=loops, area=sum(shape.area for shape in drawing.shapes)))
    return replace(drawing, shapes=tuple(shapes))


def _rectangle(width: float, height: float) -> Loop:
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], float)
    ends = np.roll(corners, -1, axis=0)
    return Loop(np.stack([corners, corners, ends, ends], axis=1), np.full(4, LINE, np.uint8))
