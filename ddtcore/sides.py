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
from .mixes import segment_distance
from .parts import in_parts

SLOTS = 4
"""How many colours near a pixel are considered."""

_FAR = 50.0
_FEWEST, _TRIED = 16, 1 << 25
_ABSENT = 4.0
_DOUBTFUL = 25.0
_EXPLAINED = 12.0
_PAIRS = [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)]


def window(stride: int, low: int, high: int) -> np.ndarray:
    """Steps to the pixels whose larger distance in rows or columns is low..high, nearest first."""
    row, col = np.mgrid[-high:high + 1, -high:high + 1].reshape(2, -1)
    ring = np.maximum(abs(row), abs(col))
    order = np.lexsort((row * row + col * col, ring))
    order = order[(ring[order] >= low) & (ring[order] <= high)]
    return np.asarray((row * stride + col)[order].astype(np.int32))


def label_mixed(canvas: Canvas, sharp: Canvas, labels: np.ndarray, cells: np.ndarray,
                colours: np.ndarray) -> None:
    """Give pixels the label of the nearer of their two sides.

    Parameters
    ----------
    canvas, sharp : Canvas
        The picture, and the picture with its labelled pixels in full colour.
    labels : ndarray of shape (P,) and dtype int16
        Labels with the rim, negative where unknown; changed in place.
    cells : ndarray of shape (N,) and dtype int32
        The pixels that are unknown.
    colours : ndarray of shape (C, K) and dtype float32
    """
    if not cells.size:
        return
    pair, label, distance = _nearer_side(canvas, sharp, labels, cells)
    distance[pair[1] < 0] = np.inf
    doubtful = np.flatnonzero(distance > _DOUBTFUL)
    if doubtful.size:
        other, cost = _beside_one(canvas, sharp, labels, cells[doubtful], pair[0, doubtful], colours)
        better = cost < distance[doubtful]
        label[doubtful[better]] = other[better]
    labels[cells] = label


def _nearer_side(canvas: Canvas, sharp: Canvas, labels: np.ndarray,
                 cells: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Samples of both sides, int32 (2, N), label of the nearer one, and distance from their mixes."""
    def nearer(part: slice) -> Tuple[np.ndarray, ...]:
        some = cells[part]
        samples, close = near_samples(labels, some, canvas.stride)
        pair = _best_pairs(canvas, sharp, some, samples, close)
        distance, share = segment_distance(canvas.colours(some), sharp.colours(pair[0]), sharp.colours(pair[1]))
        return pair, labels[np.where(share < 0.5, pair[0], pair[1])], distance

    pair, label, distance = in_parts(nearer, cells.size, axis=-1)
    return pair, label, distance


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

    def scan(steps: np.ndarray, some: np.ndarray) -> None:
        at, have, known = cells[some], count[some], found[:, some]
        for step in steps:
            near = labels.take(at + step)
            new = (near >= 0) & (have < SLOTS)
            for slot in known:
                new &= near != slot
            hit = np.flatnonzero(new)
            known[have[hit], hit] = near[hit]
            samples[have[hit], some[hit]] = at[hit] + step
            have[hit] += 1
        found[:, some], count[some] = known, have

    everything = np.arange(cells.size)
    scan(window(stride, 1, 1), everything)
    close = samples >= 0
    scan(window(stride, 2, 2), everything)
    scan(window(stride, 3, 3), np.flatnonzero(count < 2))
    return samples, close


def _best_pairs(canvas: Canvas, sharp: Canvas, cells: np.ndarray, samples: np.ndarray,
                close: np.ndarray) -> np.ndarray:
    """The two samples whose mixes explain each pixel's neighbourhood best, int32 (2, N); -1 for none."""
    pair = samples[:2].copy()
    many = np.flatnonzero(samples[2] >= 0)
    if not many.size:
        return pair
    around = canvas.colours(cells[many] + np.append(window(canvas.stride, 1, 1), 0)[:, None])
    sides = sharp.colours(samples[:, many])
    least = np.full(many.size, np.inf, np.float32)
    for i, j in _PAIRS:
        some = np.flatnonzero(samples[j, many] >= 0)
        at = many[some]
        distance, _ = segment_distance(around[:, :, some], sides[:, None, i, some], sides[:, None, j, some])
        np.minimum(distance, _FAR, out=distance)
        cost = distance[:-1].sum(axis=0) + 4 * distance[-1]
        cost += _ABSENT * (2.0 - close[i, at] - close[j, at])
        better = cost < least[some]
        least[some[better]] = cost[better]
        pair[0, at[better]], pair[1, at[better]] = samples[i, at[better]], samples[j, at[better]]
    return pair


def _beside_one(canvas: Canvas, sharp: Canvas, labels: np.ndarray, cells: np.ndarray, sample: np.ndarray,
                colours: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Labels of pixels beside one known colour, or none: the nearer side of its best mix with any other.

    Colours that are met within 18 pixels are preferred.  Returns what the mixes cost, too.
    """
    # Of many colours for many pixels, only the first are tried.
    colours = colours[:, :max(_FEWEST, _TRIED // cells.size)]
    here, alone = canvas.colours(cells), sample < 0
    one = np.where(alone, here, sharp.colours(sample))
    absent = ~met_around(canvas, labels, cells, colours.shape[1])
    best = np.where(alone, 0, labels[sample])
    least = np.full(cells.size, np.inf, np.float32)
    for k in range(colours.shape[1]):
        other = np.broadcast_to(colours[:, k, None], here.shape)
        distance, share = segment_distance(here, one, other)
        plain, _ = segment_distance(here, other, other)
        cost = np.where(alone, plain, distance + 0.05 * plain) + _FAR * absent[k]
        better = cost < least
        least[better] = cost[better]
        best[better] = np.where(alone | (share >= 0.5), k, labels[sample])[better]
    return best, least


def met_around(canvas: Canvas, labels: np.ndarray, cells: np.ndarray, count: int) -> np.ndarray:
    """Which labels below `count` are met on the way from pixels in eight directions, bool (count, N)."""
    met = np.zeros((count, cells.size), bool)
    row, col = canvas.places(cells)
    everything = np.arange(cells.size)
    for radius in (1, 2, 3, 5, 8, 12, 18):
        for down, across in ((-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)):
            there = canvas.numbers(np.clip(row + radius * down, 0, canvas.shape[0] - 1),
                                   np.clip(col + radius * across, 0, canvas.shape[1] - 1))
            label = labels[there]
            known = (label >= 0) & (label < count)
            met[label[known], everything[known]] = True
    return met


def join_islands(canvas: Canvas, sharp: Canvas, labels: np.ndarray, cells: np.ndarray) -> int:
    """Relabel one or two pixels alone in their label, where other labels near explain them; in place.

    Parameters
    ----------
    cells : ndarray of shape (N,)
        The pixels that were not known from the start, rising.

    Returns
    -------
    int
        How many such pixels nothing near explains.
    """
    here, ties, beside = labels[cells], np.zeros(cells.size, np.int8), cells.copy()
    for step in window(canvas.stride, 1, 1):
        same = labels[cells + step] == here
        ties += same
        beside[same] += step
    # Of two, each has the other one beside it and nothing else; one alone is beside itself.
    few = np.flatnonzero(ties <= 1)
    place = np.minimum(np.searchsorted(cells, beside[few]), cells.size - 1)
    alone = few[(cells[place] == beside[few]) & (ties[place] == ties[few])]
    before = labels[cells[alone]]
    labels[cells[alone]] = -1
    pair, label, distance = _nearer_side(canvas, sharp, labels, cells[alone])
    explained = (pair[1] >= 0) & (distance < _EXPLAINED)
    labels[cells[alone]] = np.where(explained, label, before)
    return int(alone.size - np.count_nonzero(explained))
