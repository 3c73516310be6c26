# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours along a gradient, as two to four stops.

Between stops a gradient's colour is linear, and before the first and after the last
one it is constant: a continuous, piecewise linear function whose knots are the stops.
For given knots its values follow from least squares; the knots are found by trying
all places of a grid at once, one knot after the other, on finer and finer grids.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

MOST = 4
"""Most stops of a gradient."""

GAIN = 0.7
"""A further stop must lower the error at least to this share: less is luck, or noise."""

BINS = 128
"""Parts of equal length in which the colours along a gradient are averaged."""

_GRIDS = (12, 48, 192, 768)
"""Parts into which the gradient is divided to try places for stops: at first, and then nearby."""

_GAP = 1 / 1024
"""Least distance between two stops."""

_STIFF = 1e-6
"""Pull of the mean colour on stops that few pixels speak for, as a share of all their weight."""


class Profile(NamedTuple):
    """Colours along a gradient, in bins.

    Attributes
    ----------
    place : ndarray of shape (B,)
        From 0 to 1, rising.
    colour : ndarray of shape (B, C)
        Mean colours, not premultiplied: that is how stops are interpolated.
    weight : ndarray of shape (B, C)
        Errors of each are squared and multiplied by this.
    """

    place: np.ndarray
    colour: np.ndarray
    weight: np.ndarray


def profile(place: np.ndarray, colour: np.ndarray, count: np.ndarray) -> Profile:
    """Sort samples into bins.

    Parameters
    ----------
    place : ndarray of shape (n,)
        Where each sample lies along the gradient, from 0 to 1.
    colour : ndarray of shape (n, C)
        RGB, or premultiplied RGBA, 0 to 255.
    count : ndarray of shape (n,)
        Pixels that each sample stands for.
    """
    number = np.minimum((place * BINS).astype(np.intp), BINS - 1)
    size = np.bincount(number, count, BINS)
    sums = np.stack([np.bincount(number, count * channel, BINS) for channel in colour.T], axis=1)
    some = size > 0
    size, sums = size[some, None], sums[some]
    where = np.bincount(number, count * place, BINS)[some] / size[:, 0]
    if colour.shape[1] == 3:
        return Profile(where, sums / size, np.repeat(size, 3, axis=1))
    # An error of RGB shows in proportion to alpha.
    alpha = np.maximum(sums[:, 3:] / size / 255, 1e-3)
    straight = np.concatenate([sums[:, :3] / size / alpha, 255 * alpha], axis=1)
    weight = size * np.concatenate([np.repeat(alpha**2, 3, axis=1), np.ones_like(alpha)], axis=1)
    return Profile(where, np.minimum(straight, 255), weight)


def hats(place: np.ndarray, knots: np.ndarray) -> np.ndarray:
    """Share (..., n, K) of each knot (..., K) in the value at each place (n,); the shares add up to 1."""
    begin, end = knots[..., None, :-1], knots[..., None, 1:]
    passed = np.clip((place[:, None] - begin) / np.maximum(end - begin, 1e-9), 0, 1)
    edge = passed.shape[:-1] + (1,)
    passed = np.concatenate([np.ones(edge), passed, np.zeros(edge)], axis=-1)
    return passed[..., :-1] - passed[..., 1:]


def choose_stops(bins: Profile, price: float) -> Tuple[np.ndarray, np.ndarray]:
    """Place two to four stops, each further one where it is worth its price.

    Parameters
    ----------
    bins : Profile
    price : float
        By how much a stop must lower the weighted sum of squared errors.

    Returns
    -------
    knots : ndarray of shape (K,)
        From 0 to 1, rising.
    values : ndarray of shape (K, C)
        Colour of each stop, not premultiplied, 0 to 255.
    """
    places = np.linspace(0, 1, _GRIDS[0] + 1)
    first, last = np.triu_indices(len(places), 1)
    knots, _ = _best(bins, np.stack([places[first], places[last]], axis=1))
    knots, error = best, least = _settled(bins, knots)
    while len(knots) < MOST and least > price:
        free = places[np.abs(places[:, None] - knots).min(axis=1) > _GAP]
        more = np.broadcast_to(knots, (len(free), len(knots)))
        more, _ = _best(bins, np.sort(np.concatenate([more, free[:, None]], axis=1), axis=1))
        knots, error = _settled(bins, more)
        extra = len(knots) - len(best)
        if error + extra * price < least and error < GAIN**extra * least:
            best, least = knots, error
    values, _ = _fitted(bins, best[None])
    return best, np.clip(values[0], 0, 255)


def _settled(bins: Profile, knots: np.ndarray) -> Tuple[np.ndarray, float]:
    """Knots moved one after the other to the best places between their neighbours, and the error there."""
    error = np.inf
    for grid in _GRIDS[1:]:
        for _ in range(2):
            before = error
            for k in range(len(knots)):
                knots, error = _best(bins, _moves(knots, k, grid))
            if error > 0.99 * before:
                break
    return knots, error


def _moves(knots: np.ndarray, k: int, grid: int) -> np.ndarray:
    """The knots with number `k` where it is, and at as many places around as the first grid has parts."""
    low = knots[k - 1] + _GAP if k else 0.0
    high = knots[k + 1] - _GAP if k + 1 < len(knots) else 1.0
    moved = np.repeat(knots[None], _GRIDS[0] + 1, axis=0)
    moved[1:, k] += (np.arange(_GRIDS[0]) - (_GRIDS[0] - 1) / 2) / grid
    moved[:, k] = np.clip(moved[:, k], low, high)
    return moved


def _best(bins: Profile, knots: np.ndarray) -> Tuple[np.ndarray, float]:
    """The one of many (M, K) lists of knots with the smallest error, and that error."""
    _, error = _fitted(bins, knots)
    best = int(np.argmin(error))
    return knots[best], float(error[best])


def _fitted(bins: Profile, knots: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Values (M, K, C) at many lists of knots (M, K) by least squares, and the errors (M,)."""
    total = bins.weight.sum(axis=0)
    mean = (bins.weight * bins.colour).sum(axis=0) / total
    colour = bins.colour - mean
    share = hats(bins.place, knots)
    count = knots.shape[1]
    pairs = (share[..., :, None] * share[..., None, :]).reshape(len(knots), -1, count * count)
    # Red, green and blue have one weight, and alpha has another one.
    matrix = np.matmul(bins.weight[:, ::3].T, pairs).reshape(len(knots), -1, count, count)
    matrix = matrix[:, np.arange(len(mean)) // 3] + _STIFF * total[:, None, None] * np.eye(count)
    aim = np.matmul((bins.weight * colour).T, share)
    values = np.linalg.solve(matrix, aim[..., None])[..., 0]
    error = (bins.weight * colour**2).sum() - np.einsum("mck,mck->m", values, aim)
    return np.moveaxis(values, 1, 2) + mean, np.maximum(error, 0)
