# SPDX-License-Identifier: GPL-2.0-or-later
"""Anti-aliased pixels between the two flat colours at their sides.

A pixel that is no plateau is a mix of two colours found near it.  Which two, is
decided by the pair that explains its whole 3 x 3 neighbourhood as mixes: a colour
that merely lies near the mix explains one pixel of an edge, not the next one.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import Canvas

SLOTS = 4
"""How many colours near a pixel are considered."""

_FAR = 50.0
_ABSENT = 4.0
_PAIRS = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)]


def window(stride: int, low: int, high: int) -> np.ndarray:
    """Steps to the pixels whose larger distance in rows or columns is low..high, nearest first."""
    row, col = np.mgrid[-high:high + 1, -high:high + 1].reshape(2, -1)
    ring = np.maximum(abs(row), abs(col))
    keep = (ring >= low) & (ring <= high)
    order = np.lexsort((row * row + col * col, ring))
    return (row * stride + col)[order][keep[order]].astype(np.int32)


def near_samples(labels: np.ndarray, cells: np.ndarray, stride: int) -> Tuple[np.ndarray, np.ndarray]:
    """The nearest pixel of each of the labels within 5 x 5 (7 x 7 where that holds fewer than two).

    Parameters
    ----------
    labels : ndarray of shape (P,)
        Labels with a rim, negative where unknown.
    cells : ndarray of shape (N,)

    Returns
    -------
    samples : ndarray of shape (SLOTS, N) and dtype int32
        Pixel numbers, -1 where there are no more labels.
    close : ndarray of shape (SLOTS, N) and dtype bool
        Whether the sample lies within 3 x 3.
    """
    samples = np.full((SLOTS, cells.size), -1, np.int32)
    found = np.full((SLOTS, cells.size), -1, labels.dtype)
    count = np.zeros(cells.size, np.int8)

    def scan(steps: np.ndarray, which: np.ndarray) -> None:
        for step in steps:
            near = labels[cells[which] + step]
            new = near >= 0
            for slot in found:
                new &= near != slot[which]
            new &= count[which] < SLOTS
            hit = which[new]
            found[count[hit], hit] = near[new]
            samples[count[hit], hit] = cells[hit] + step
            count[hit] += 1

    everything = np.arange(cells.size)
    scan(window(stride, 1, 1), everything)
    close = samples >= 0
    scan(window(stride, 2, 2), everything)
    scan(window(stride, 3, 3), np.flatnonzero(count < 2))
    return samples, close


def segment_distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of colours (C, ...) from the segments a-b, and how far along it the nearest point is (0 to 1)."""
    along = b - a
    off = points - a
    share = np.einsum("i...,i...->...", off, along)
    share /= np.maximum(np.einsum("i...,i...->...", along, along), 1e-6)
    np.clip(share, 0, 1, out=share)
    off -= share * along
    return np.sqrt(np.einsum("i...,i...->...", off, off)), share


def best_pairs(canvas: Canvas, sharp: Canvas, cells: np.ndarray, samples: np.ndarray, close: np.ndarray) -> np.ndarray:
    """Choose the two samples that explain each pixel's neighbourhood.

    Returns
    -------
    ndarray of shape (2, N) and dtype int32
        Two pixel numbers; -1 where fewer than two labels are near.
    """
    pair = samples[:2].copy()
    pair[:, samples[1] < 0] = -1
    many = np.flatnonzero(samples[2] >= 0)
    if not many.size:
        return pair
    steps = np.append(window(canvas.stride, 1, 1), 0)
    around = canvas.colours(cells[many] + steps[:, None])
    sides = sharp.colours(samples[:, many])
    least = np.full(many.size, np.inf, np.float32)
    for i, j in _PAIRS:
        some = np.flatnonzero(samples[j, many] >= 0)
        distance, _ = segment_distance(around[:, :, some], sides[:, None, i, some], sides[:, None, j, some])
        np.minimum(distance, _FAR, out=distance)
        cost = distance[:-1].sum(axis=0) + 4 * distance[-1]
        cost += _ABSENT * (2.0 - close[i, many[some]] - close[j, many[some]])
        better = cost < least[some]
        least[some[better]] = cost[better]
        pair[:, many[some[better]]] = samples[[i, j]][:, many[some[better]]]
    return pair
