# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art that was saved as JPEG: what each pixel mixes, told together with the pixels round it.

A JPEG keeps how bright pixels are, but of their hue most often only the mean of 2 x 2 pixels:
it bleeds over edges, and thin strokes lose it.  Where all within reach is mixes of two known
colours, brightness tells their shares, and the shares tell the hue.  Which two colours, is
decided by how well their mixes explain the picture, after their hue has bled as its has.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Optional, Sequence, Tuple, Union

import numpy as np

from .canvas import LUMA, RIM, Canvas, planes, within
from .growing import Surface

LEFT = 0.75
"""How much pixels vary when mixes have taken their place, as a share of what they did."""

FOREIGN = 2.5
"""A pixel that is farther than this from its mix is none, as a multiple of the noise."""

SURE = 0.5
"""A mix that is nearer than this to one of its colours is that colour, as a multiple of the noise."""

COLOURS, SURFACES = 40, 16
"""Most flat colours and most ramps that are weighed."""

REACH = 8
"""How far from a square its colours are met, px."""

STROKES = 3
"""How many squares away the colours are looked for that strokes in one may have, if none nearer does."""

ONE_BY_ONE = 4
"""If it is no more colours than these that do so, each is tried without the others."""

TILE = 32
"""Side of the squares that are looked at together, px."""

_BLED = np.array([1, 4, 6, 4, 1], np.float32) / 16
_HUE = 0.1
_REACH = 3
_OWN = 0.3
_CAP = 60.0
_MIXED = 0.005
_RIM = _REACH + len(_BLED) // 2
_INNER = slice(_RIM, -_RIM)
_FEW = 4
_SAMPLE = 24
_PART = 128


def without_bleeding(canvas: Canvas, keys: np.ndarray, noise: float, slopes: Optional[np.ndarray] = None,
                     surfaces: Sequence[Surface] = ()) -> Canvas:
    """The picture with mixes of two of its colours in place of pixels that are nearly such.

    Parameters
    ----------
    canvas : Canvas
        An opaque picture.
    keys : ndarray of shape (K,) and dtype uint32
        Its colours, packed, the most important ones first.
    noise : float
        How far pixels of flat areas are from their colour, levels.
    slopes : ndarray of shape (H, W), optional
        Number of the ramp of each pixel, others than those from 0 on where there is none.
    surfaces : sequence of Surface
        The colours of the ramps.
    """
    colours = planes(keys[:COLOURS], True)
    paints = [*colours.T, *surfaces[:SURFACES]]
    tiles, (near, strange) = in_squares(canvas), _colours_near(canvas, colours, noise)
    if slopes is not None and surfaces:
        near = np.concatenate([near, [_met(slopes == number, _RIM) for number in range(len(paints) - len(near))]])
        strange[:] = False
    wide = within(near, STROKES, np.maximum)
    busy = np.argwhere((near.sum(axis=0) > 1) | strange & (wide.sum(axis=0) > 1))
    if not len(busy):
        return canvas
    some = busy[np.linspace(0, len(busy) - 1, min(len(busy), _SAMPLE)).astype(int)]
    costs = np.array([best_mixes(tiles, near, paints, some, bled)[1] for bled in (True, False)])
    # There are no mixes, and no costs, in squares of one colour.
    bled = bool(np.less(*np.where(np.isfinite(costs), costs, 0).sum(axis=(1, 2, 3))))
    keys = np.pad(canvas.bare(canvas.keys), [(0, -size % TILE) for size in canvas.shape], mode="constant")
    squares = keys.reshape(near.shape[1], TILE, near.shape[2], TILE).swapaxes(1, 2)
    for some in (busy[k:k + _PART] for k in range(0, len(busy), _PART)):
        row, col = some.T
        mixed, _, off = best_mixes(tiles, near, paints, some, bled, SURE * noise)
        # No pixel of thin strokes need have their colour, so it may be met farther away only.
        more = (off > FOREIGN * noise).sum(axis=(1, 2)) >= _FEW
        mixed[more], off[more] = _with_strokes(tiles, near, wide, paints, some[more], bled, noise)
        rgba = np.full((*off.shape, 4), 255, np.uint8)
        kept = np.where((off <= FOREIGN * noise)[:, None], np.rint(mixed), tiles[row, col][..., _INNER, _INNER])
        rgba[..., :3] = np.moveaxis(kept, 1, -1)
        squares[row, col] = rgba.view(np.uint32)[..., 0]
    return replace(canvas, keys=np.pad(keys[:canvas.shape[0], :canvas.shape[1]], RIM, mode="edge").ravel())


def _with_strokes(tiles: np.ndarray, near: np.ndarray, wide: np.ndarray,
                  paints: Sequence[Union[np.ndarray, Surface]], places: np.ndarray, bled: bool,
                  noise: float) -> Tuple[np.ndarray, np.ndarray]:
    """The best mixes in squares with strokes, and how far they are from the picture, as `best_mixes` has them.

    Strokes there have one more colour than those `near`, one of those met in a `wide` circle; or several
    if no one explains as much: else others would take the place of what mixes three.
    """
    limit = FOREIGN * noise
    mixed, _, off = best_mixes(tiles, wide, paints, places, bled, SURE * noise)
    most = (off > limit).sum(axis=(1, 2)) + _FEW
    least = np.full(len(places), np.inf)
    row, col = places.T
    more = (wide & ~near)[:, row, col]
    more &= more.sum(axis=0) <= ONE_BY_ONE
    for k in range(len(near)):
        some = np.flatnonzero(more[k])
        if some.size:
            asked = near.copy()
            asked[k, row[some], col[some]] = True
            one, cost, away = best_mixes(tiles, asked, paints, places[some], bled, SURE * noise)
            total = cost.sum(axis=(1, 2))
            better = (total < least[some]) & ((away > limit).sum(axis=(1, 2)) <= most[some])
            some = some[better]
            least[some], mixed[some], off[some] = total[better], one[better], away[better]
    return mixed, off


def in_squares(canvas: Canvas) -> np.ndarray:
    """Squares of the picture, each with what lies round it, float32 (rows, columns, 3, S, S)."""
    rims = [(_RIM, _RIM + -size % TILE) for size in canvas.shape]
    values = np.pad(planes(canvas.bare(canvas.keys), True), [(0, 0), *rims], mode="edge")
    side = TILE + 2 * _RIM
    shape = (values.shape[1] - 2 * _RIM) // TILE, (values.shape[2] - 2 * _RIM) // TILE, 3, side, side
    channel, down, across = values.strides
    return np.lib.stride_tricks.as_strided(
        values, shape, (TILE * down, TILE * across, channel, down, across), writeable=False)


def _colours_near(canvas: Canvas, colours: np.ndarray, noise: float) -> Tuple[np.ndarray, np.ndarray]:
    """Which colours occur in squares or beside them, bool (K, rows, columns), and where there are others, too."""
    values = planes(canvas.bare(canvas.keys), True)
    near, other = [], np.ones(canvas.shape, bool)
    for colour in colours.T:
        some = (np.abs(values - colour[:, None, None]) <= noise).all(axis=0)
        other &= ~some
        near.append(_met(some, REACH))
    strange = _met(other, 0)
    return np.array(near, bool).reshape(-1, *strange.shape), strange


def _met(mask: np.ndarray, reach: int) -> np.ndarray:
    """Which squares have pixels of a mask (H, W) in them or within reach, bool (rows, columns)."""
    rims = [(reach + 1, reach + -size % TILE) for size in mask.shape]
    total = np.pad(mask, rims, mode="constant").astype(np.int32).cumsum(axis=0).cumsum(axis=1)
    low = [np.arange(0, size, TILE) for size in mask.shape]
    high = [start + TILE + 2 * reach for start in low]
    met: np.ndarray = (total[np.ix_(*high)] + total[np.ix_(*low)] - total[np.ix_(low[0], high[1])]
                       - total[np.ix_(high[0], low[1])]) > 0
    return met


def best_mixes(tiles: np.ndarray, near: np.ndarray, paints: Sequence[Union[np.ndarray, Surface]], places: np.ndarray,
               bled: bool, sure: float = 0.0) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The best mixes in some squares, what they cost, and how far they are from the picture.

    Parameters
    ----------
    tiles : ndarray of shape (rows, columns, 3, S, S)
        All squares with what lies round them.
    near : ndarray of shape (K, rows, columns) and dtype bool
        Which of the paints are asked for each.
    paints : sequence of length K of ndarray of shape (3,) or Surface
        Flat colours and those of ramps.
    places : ndarray of shape (n, 2)
        Rows and columns of the squares.
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
    row, col = places.T
    colour, near = tiles[row, col], near[:, row, col]
    least = np.full((len(colour), TILE, TILE), np.inf, np.float32)
    off, mixed = least.copy(), np.zeros((len(colour), 3, TILE, TILE), np.float32)
    painted = [_painted(paint, places, asked) for paint, asked in zip(paints, near)]
    for one, other in zip(*np.triu_indices(len(near), 1)):
        some = np.flatnonzero(near[one] & near[other])
        if not some.size:
            continue
        a, b = (painted[k] if len(painted[k]) < len(near[k]) else painted[k][some] for k in (one, other))
        share, cost, away = _mixes(colour[some], a, b, bled)
        a, b = without_rim(a), without_rim(b)
        end = np.minimum(sure / np.maximum(np.abs(b - a).max(axis=1), 1), 0.5)
        share[share < end], share[share > 1 - end] = 0, 1
        better = cost < least[some]
        least[some], off[some] = np.where(better, (cost, away), (least[some], off[some]))
        mixed[some] = np.where(better[:, None], a + share[:, None] * (b - a), mixed[some])
    return mixed, least, off


def _painted(paint: Union[np.ndarray, Surface], places: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """The colours of a paint in squares with what lies round them, as far as they are `asked`, float32 (n, 3, S, S).

    Those of a flat colour are (1, 3, 1, 1).
    """
    if isinstance(paint, np.ndarray):
        return paint.reshape(1, 3, 1, 1)
    side = TILE + 2 * _RIM
    out = np.zeros((len(places), 3, side, side), np.float32)
    row, col = (TILE * start[:, None] + np.arange(side) - _RIM for start in places[asked].T)
    shape = len(row), side, side
    points = np.stack([np.broadcast_to(col[:, None], shape), np.broadcast_to(row[:, :, None], shape)], axis=-1) + 0.5
    out[asked] = np.moveaxis(paint.colours(points.reshape(-1, 2)).reshape(*shape, 3), -1, 1)
    return out


def without_rim(colours: np.ndarray) -> np.ndarray:
    """Colours (n, 3, S, S) without what lies round the squares."""
    return colours if colours.shape[-1] == 1 else colours[..., _INNER, _INNER]


def _mixes(colour: np.ndarray, a: np.ndarray, b: np.ndarray,
           bled: bool) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Shares of b in mixes with a, what they cost, and how far the mixes are from the picture, (n, TILE, TILE)."""
    span = b - a
    step = np.tensordot(LUMA, span, (0, 1))[:, None]
    # Brightness, and a little of the hue, in case there is no difference in brightness.
    luma = LUMA[:, None, None]
    weights = step * luma + _HUE ** 2 * (span - step - (span - step).sum(axis=1, keepdims=True) * luma)
    weights = weights / np.maximum((weights * span).sum(axis=1, keepdims=True), 1e-6)
    seen = np.einsum("nchw,nchw->nhw", np.broadcast_to(weights, colour.shape), colour)
    share = np.clip(seen - (weights * a).sum(axis=1), 0, 1)
    hue = bleed(share) if bled else share
    off = np.zeros_like(share)
    for channel in range(3):
        own = a[:, channel] + step[:, 0] * share + (span[:, channel] - step[:, 0]) * hue
        np.maximum(off, np.abs(np.clip(own, 0, 255) - colour[:, channel]), out=off)
    # Of what explains as much, that is right which mixes less.
    square = np.minimum(off, _CAP) ** 2 + _MIXED * (span * span).sum(axis=1) * share * (1 - share)
    share, off = share[:, _INNER, _INNER], off[:, _INNER, _INNER]
    return share, _means(square) + _OWN * square[:, _INNER, _INNER], off


def bleed(share: np.ndarray) -> np.ndarray:
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
