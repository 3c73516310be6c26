# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures without flat colours: photographs, dither, noise, and tiny sprites.

There is nothing in them that tells an edge from a texture pixel by pixel; a limited
number of colours chosen from a histogram gives a bounded result.
"""

from __future__ import annotations

import numpy as np

from .canvas import Canvas, mean_colours, planes, premultiply, unpack
from .merging import merge_specks, ward_groups
from .model import Labels
from .ramps import BEND, is_even

LEAST_AREA = 8.0
"""Smallest region of a posterised picture, px²."""

MOST_REGIONS = 25_000
"""A posterised picture has fewer regions than this, however large it is."""

ROUGH = 0.55
"""Share of rough steps from which a picture counts as noisy."""

_LINES = 128
_BINS = 256


def is_noisy(canvas: Canvas) -> bool:
    """Whether most steps from pixel to pixel, in a sample of rows and columns, are neither zero nor even."""
    key = canvas.bare(canvas.keys)
    return min(rough_share(lines, canvas.opaque) for lines in (key, key.T)) > ROUGH


def rough_share(lines: np.ndarray, opaque: bool) -> float:
    """Share of the steps along some lines of packed pixels that are neither zero nor small and even."""
    lines = lines[np.linspace(0, len(lines) - 1, min(len(lines), _LINES)).astype(int)]
    if lines.shape[1] < 4:
        return 0.0
    row, col = np.nonzero(lines[:, 1:-2] != lines[:, 2:-1])
    before, here, there, after = (planes(lines[row, col + k], opaque) for k in range(4))
    even = is_even(before, here, there, after, BEND)
    return float(np.count_nonzero(~even) / (len(lines) * (lines.shape[1] - 3)))


def posterise(canvas: Canvas, most: int) -> Labels:
    """Label each pixel by the nearest of at most `most` colours, or by its own if there are no more."""
    key = canvas.bare(canvas.keys)
    if np.unique(key.ravel()[::max(1, key.size // 4096)]).size <= most:
        own, index = np.unique(key, return_inverse=True)
        if own.size <= most:
            index = index.reshape(key.shape).astype(np.int32)
            return Labels(index, unpack(own).astype(np.float64), np.zeros(index.shape, bool))
    index = _nearest_colours(canvas, most)
    labels = Labels(index, mean_colours(canvas, index), np.zeros(index.shape, bool))
    return merge_specks(labels, max(LEAST_AREA, key.size / MOST_REGIONS))


def _nearest_colours(canvas: Canvas, most: int) -> np.ndarray:
    """Labels int32 (H, W) from a histogram of 16 levels per channel whose largest bins are grouped."""
    rgba = unpack(canvas.bare(canvas.keys))
    bins = np.zeros(canvas.shape, np.int32)
    for channel in range(4):
        bins = bins << 4 | rgba[..., channel] >> 4
    count = np.bincount(bins.ravel(), minlength=1 << 16)
    used = np.flatnonzero(count)
    number = np.zeros(count.size, np.int32)
    number[used] = np.arange(used.size)
    points = premultiply(mean_colours(canvas, number[bins]))
    top = np.argsort(-count[used], kind="stable")[:_BINS]
    weight = count[used][top].astype(np.float64)
    group = ward_groups(points[top], weight, min(most, top.size))
    sums = np.stack([np.bincount(group, weight * plane) for plane in points[top].T], axis=-1)
    centres = sums / np.bincount(group, weight)[:, None]
    nearest = np.zeros(used.size, np.int32)
    least = np.full(used.size, np.inf)
    for k, centre in enumerate(centres):
        square = ((points - centre) ** 2).sum(axis=-1)
        nearer = square < least
        nearest[nearer], least[nearer] = k, square[nearer]
    return nearest[number][bins]
