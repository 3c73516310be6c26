# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours along a gradient, as two to four stops.

Between stops a gradient's colour is linear, and before the first and after the last
one it is constant: a continuous, piecewise linear function whose knots are the stops.
For given knots its values follow from least squares; the knots are found by trying
all places of a grid at once, and Gauss-Newton steps from the best ones (variable
projection: Golub and Pereyra, SIAM Journal on Numerical Analysis 10, 1973).
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

_PLACES = 16
"""Parts into which the gradient is divided to try places for stops, before they are moved to the best ones."""

_STEPS = 7
"""Most Gauss-Newton steps of the stops."""

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
    return np.asarray(passed[..., :-1] - passed[..., 1:])


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
    places = np.linspace(0, 1, _PLACES + 1)
    first, last = np.triu_indices(len(places), 1)
    knots, _ = _best(bins, np.stack([places[first], places[last]], axis=1))
    knots, error = best, least = _settled(bins, knots)
    while len(knots) < MOST and least > price:
        free = places[np.abs(places[:, None] - knots).min(axis=1) > _GAP]
        more = np.broadcast_to(knots, (len(free), len(knots)))
        more, _ = _best(bins, np.sort(np.concatenate([more, free[:, None]], axis=1), axis=1))
        knots, error = _settled(bins, more)
        if error > price:
            knots, error = _settled(bins, _elsewhere(bins, knots))
        extra = len(knots) - len(best)
        if error + extra * price < least and error < GAIN**extra * least:
            best, least = knots, error
    values, _ = _fitted(bins, best[None])
    return best, np.clip(values[0], 0, 255)


def _elsewhere(bins: Profile, knots: np.ndarray) -> np.ndarray:
    """The knots with one of them moved to the best place between its neighbours."""
    ends = np.concatenate([[-_GAP], knots, [1 + _GAP]])
    share = np.linspace(0, 1, _PLACES // 2 + 1)[:, None, None]
    moved = (1 - share) * (ends[:-2, None] + _GAP) + share * (ends[2:, None] - _GAP)
    return _best(bins, np.where(np.eye(len(knots), dtype=bool), moved, knots).reshape(-1, len(knots)))[0]


def _settled(bins: Profile, knots: np.ndarray) -> Tuple[np.ndarray, float]:
    """Knots moved to where the error is least, near where they are, and the error there."""
    values, error = _fitted(bins, knots[None])
    damping = 1e-3
    for _ in range(_STEPS):
        matrix, pull = _pull(bins, knots, values[0])
        # What hardly matters, like a stop at the very end, stays where it is.
        steep = np.diag(matrix)
        step = np.linalg.solve(matrix + np.diag(damping * steep + 1e-4 * steep.max() + 1e-12), pull)
        moved = _apart(knots + step)
        values_there, ahead = _fitted(bins, moved[None])
        if ahead[0] >= error[0]:
            damping *= 20
            continue
        done = ahead[0] > 0.98 * error[0]
        knots, values, error, damping = moved, values_there, ahead, damping / 10
        if done:
            break
    return knots, float(error[0])


def _apart(knots: np.ndarray) -> np.ndarray:
    """The knots within 0 and 1, rising by some distance at least."""
    spread = _GAP * np.arange(len(knots))
    apart: np.ndarray = np.clip(np.maximum.accumulate(knots - spread), 0, 1 - spread[-1]) + spread
    return apart


def _pull(bins: Profile, knots: np.ndarray, values: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Normal equations of the step of all knots that lowers the error, with the colours free to follow."""
    share = hats(bins.place, knots)
    off = bins.colour - share.dot(values)
    slope = np.diff(values, axis=0) / np.diff(knots)[:, None]
    none = np.zeros((1, values.shape[1]))
    before, after = np.concatenate([none, slope]), np.concatenate([slope, none])
    passed = (bins.place[:, None] > knots)[..., None]
    change = -share[..., None] * np.where(passed, after, before)
    matrix, pull = np.zeros((len(knots), len(knots))), np.zeros(len(knots))
    # Red, green and blue have one weight, and alpha has another one.
    for one in (slice(0, 3), slice(3, 4))[:1 + (values.shape[1] > 3)]:
        weight = bins.weight[:, one][:, :1]
        held = (weight * share).T
        inner = held.dot(share) + _STIFF * weight.sum() * np.eye(len(knots))
        move = change[..., one].reshape(len(share), -1)
        move = (move - share.dot(np.linalg.solve(inner, held.dot(move)))).reshape(len(share), len(knots), -1)
        matrix = matrix + np.einsum("b,bkc,blc->kl", weight[:, 0], move, move)
        pull = pull + np.einsum("b,bkc,bc->k", weight[:, 0], move, off[:, one])
    return matrix, pull


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
