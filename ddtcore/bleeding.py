# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art that was saved as JPEG: what each pixel mixes, told together with the pixels round it.

A JPEG keeps how bright pixels are, but of their hue most often only the mean of 2 x 2 pixels:
it bleeds over edges, and thin strokes lose it.  Where all within reach is mixes of two known
colours, brightness tells their shares, and the shares tell the hue.  Which two colours, is
decided by how well their mixes explain the picture, after their hue has bled as its has.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Tuple

import numpy as np

from .canvas import RIM, Canvas, planes

LEFT = 0.75
"""How much pixels vary when mixes have taken their place, as a share of what they did."""

FOREIGN = 2.5
"""A pixel that is farther than this from its mix is none, as a multiple of the noise."""

SURE = 0.5
"""A mix that is nearer than this to one of its colours is that colour, as a multiple of the noise."""

COLOURS = 16
"""Most colours that are weighed."""

TILE = 32
"""Side of the squares that are looked at together, px."""

_LUMA = np.array([0.299, 0.587, 0.114], np.float32)
_BLED = np.array([1, 4, 6, 4, 1], np.float32) / 16
_HUE = 0.1
_REACH = 3
_OWN = 0.3
_CAP = 60.0
_MIXED = 0.005
_RIM = _REACH + len(_BLED) // 2
_INNER = slice(_RIM, -_RIM)
_SAMPLE = 64
_PART = 128


def without_bleeding(canvas: Canvas, keys: np.ndarray, noise: float) -> Canvas:
    """The picture with mixes of two of its colours in place of pixels that are nearly such.

    Parameters
    ----------
    canvas : Canvas
        An opaque picture.
    keys : ndarray of shape (K,) and dtype uint32
        Its colours, packed, the most important ones first.
    noise : float
        How far pixels of flat areas are from their colour, levels.
    """
    colours = planes(keys[:COLOURS], True)
    tiles, near = _tiles(canvas), _colours_near(canvas, colours, noise)
    busy = np.argwhere(near.sum(axis=0) > 1)
    if not len(busy):
        return canvas
    some = busy[np.linspace(0, len(busy) - 1, min(len(busy), _SAMPLE)).astype(int)]
    row, col = some.T
    costs = [_explained(tiles[row, col], near[:, row, col], colours, bled)[1].sum() for bled in (True, False)]
    keys = np.pad(canvas.bare(canvas.keys), [(0, -size % TILE) for size in canvas.shape], mode="constant")
    squares = keys.reshape(near.shape[1], TILE, near.shape[2], TILE).swapaxes(1, 2)
    for row, col in (busy[k:k + _PART].T for k in range(0, len(busy), _PART)):
        colour = tiles[row, col]
        mixed, _, off = _explained(colour, near[:, row, col], colours, bool(costs[0] < costs[1]), SURE * noise)
        rgba = np.full((*off.shape, 4), 255, np.uint8)
        kept = np.where((off <= FOREIGN * noise)[:, None], np.rint(mixed), colour[..., _INNER, _INNER])
        rgba[..., :3] = np.moveaxis(kept, 1, -1)
        squares[row, col] = rgba.view(np.uint32)[..., 0]
    return replace(canvas, keys=np.pad(keys[:canvas.shape[0], :canvas.shape[1]], RIM, mode="edge").ravel())


def _tiles(canvas: Canvas) -> np.ndarray:
    """Squares of the picture, each with what lies round it, float32 (rows, columns, 3, S, S)."""
    rims = [(_RIM, _RIM + -size % TILE) for size in canvas.shape]
    values = np.pad(planes(canvas.bare(canvas.keys), True), [(0, 0), *rims], mode="edge")
    side = TILE + 2 * _RIM
    shape = (values.shape[1] - 2 * _RIM) // TILE, (values.shape[2] - 2 * _RIM) // TILE, 3, side, side
    channel, down, across = values.strides
    return np.lib.stride_tricks.as_strided(
        values, shape, (TILE * down, TILE * across, channel, down, across), writeable=False)


def _colours_near(canvas: Canvas, colours: np.ndarray, noise: float) -> np.ndarray:
    """Which colours occur in squares or in those beside them, bool (K, rows, columns)."""
    values = planes(canvas.bare(canvas.keys), True)
    rims = [(0, -size % TILE) for size in canvas.shape]
    found = []
    for colour in colours.T:
        alike = np.pad((np.abs(values - colour[:, None, None]) <= noise).all(axis=0), rims, mode="constant")
        has = alike.reshape(alike.shape[0] // TILE, TILE, -1, TILE).any(axis=(1, 3))
        framed = np.pad(has, 1, mode="constant")
        found.append(np.any([framed[down:down + has.shape[0], across:across + has.shape[1]]
                             for down in range(3) for across in range(3)], axis=0))
    return np.array(found).reshape(-1, *(-(-size // TILE) for size in canvas.shape))


def _explained(colour: np.ndarray, near: np.ndarray, colours: np.ndarray, bled: bool,
               sure: float = 0.0) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The best mixes in some squares, what they cost, and how far they are from the picture.

    Parameters
    ----------
    colour : ndarray of shape (n, 3, S, S)
        The squares with what lies round them.
    near : ndarray of shape (K, n) and dtype bool
        Which of the `colours` (3, K) are asked for each.
    bled : bool
        Whether hue bleeds.
    sure : float
        How near to one of its colours a mix is that colour, levels.

    Returns
    -------
    mixed : ndarray of shape (n, 3, TILE, TILE) and dtype float32
    cost, off : ndarray of shape (n, TILE, TILE) and dtype float32
        `off` is in levels, and infinite where there are no two colours.
    """
    least = np.full((len(colour), TILE, TILE), np.inf, np.float32)
    off, mixed = least.copy(), np.zeros((len(colour), 3, TILE, TILE), np.float32)
    for one, other in zip(*np.triu_indices(len(near), 1)):
        some = np.flatnonzero(near[one] & near[other])
        if not some.size:
            continue
        a, b = colours[:, one], colours[:, other]
        share, cost, away = _mixes(colour[some], a, b, bled)
        end = min(sure / max(np.abs(b - a).max(), 1), 0.5)
        share[share < end], share[share > 1 - end] = 0, 1
        better = cost < least[some]
        least[some], off[some] = np.where(better, (cost, away), (least[some], off[some]))
        mixes = a[:, None, None] + share[:, None] * (b - a)[:, None, None]
        mixed[some] = np.where(better[:, None], mixes, mixed[some])
    return mixed, least, off


def _mixes(colour: np.ndarray, a: np.ndarray, b: np.ndarray,
           bled: bool) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shares of b in mixes with a, what they cost, and how far the mixes are from the picture, (n, TILE, TILE)."""
    span, step = b - a, _LUMA.dot(b - a)
    # Brightness, and a little of the hue, in case there is no difference in brightness.
    weights = step * _LUMA + _HUE ** 2 * (span - step - (span - step).sum() * _LUMA)
    weights = weights / max(weights.dot(span), 1e-6)
    share = np.clip(np.einsum("c,nchw->nhw", weights, colour) - weights.dot(a), 0, 1)
    hue = _bled(share) if bled else share
    off = np.zeros_like(share)
    for channel in range(3):
        seen = np.clip(a[channel] + step * share + (span[channel] - step) * hue, 0, 255)
        np.maximum(off, np.abs(seen - colour[:, channel]), out=off)
    # Of what explains as much, that is right which mixes less.
    square = np.minimum(off, _CAP) ** 2 + _MIXED * span.dot(span) * share * (1 - share)
    share, off = share[:, _INNER, _INNER], off[:, _INNER, _INNER]
    return share, _means(square) + _OWN * square[:, _INNER, _INNER], off


def _bled(share: np.ndarray) -> np.ndarray:
    """Planes (n, S, S) as hue is when it has bled; pixels at the sides, whose surroundings aren't known, stay."""
    reach = len(_BLED) // 2
    for axis in (1, 2):
        lines = share.swapaxes(1, axis)
        out, size = lines.copy(), lines.shape[1] - 2 * reach
        out[:, reach:-reach] = sum(weight * lines[:, k:k + size] for k, weight in enumerate(_BLED))
        share = out.swapaxes(1, axis)
    return share


def _means(values: np.ndarray) -> np.ndarray:
    """Means over 7 x 7 of planes (n, S, S), without what lies round the squares."""
    rim = _RIM - _REACH
    values = values[:, rim:-rim, rim:-rim]
    for axis in (1, 2):
        lines = values.swapaxes(1, axis)
        values = np.asarray(sum(lines[:, k:k + TILE] for k in range(2 * _REACH + 1))).swapaxes(1, axis)
    return np.asarray(values / np.float32((2 * _REACH + 1) ** 2))
