# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours along gradients, as two to four stops each.

Between stops a gradient's colour is linear, and before the first and after the last
one it is constant: a continuous, piecewise linear function whose knots are the stops.
For given knots its values follow from least squares; the knots are found by trying
all places of a grid at once, and moved from the best ones.  The stops of many gradients
are found at a time: those of one are little work, but many calls.
"""

from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .knots import GAP, Sums, colours, explained, settled

MOST = 4
"""Most stops of a gradient."""

GAIN = 0.7
"""A further stop must lower the error at least to this share: less is luck, or noise."""

BINS = 128
"""Parts of equal length in which the colours along a gradient are averaged."""

_PLACES = 16
"""Parts into which the gradient is divided to try places for stops, before they are moved to the best ones."""

# A stop at the very end could not be moved by steps: nothing changes until it passes the first pixels.
_TRIED = np.linspace(0, 1, _PLACES + 1)
_TRIED = np.sort(np.concatenate([_TRIED, *([k / 4 / _PLACES, 1 - k / 4 / _PLACES] for k in (1, 2, 3))]))
"""All these places, with further ones in the first and the last of these parts."""

_PAIRS = np.stack([_TRIED[end] for end in np.triu_indices(len(_TRIED), 1)])
"""Any two of them, (2, L)."""


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


def choose_stops(profiles: Sequence[Profile], price: float) -> List[Tuple[np.ndarray, np.ndarray]]:
    """Place two to four stops along each gradient, each further one where it is worth its price.

    Parameters
    ----------
    profiles : sequence of Profile
        One for each gradient, all with as many channels.
    price : float
        By how much a stop must lower the weighted sum of squared errors.

    Returns
    -------
    list of (knots, values)
        For each gradient, the places of its K stops, (K,) from 0 to 1, rising, and their
        colours, (K, C), not premultiplied, 0 to 255.
    """
    sums = Sums.of(*zip(*profiles))
    every, regions = sums, np.arange(len(profiles))
    # What stops at all the places leave, a few will hardly explain.
    floor = sums.error - explained(sums, _alike(_TRIED[:, None], len(profiles)))[:, 0]
    knots, least = settled(sums, _best(sums, _alike(_PAIRS, len(profiles)))[0])
    best = list(knots)
    while knots.shape[1] < MOST:
        some = (least[regions] > price + floor[regions]) & (GAIN * least[regions] > floor[regions])
        if not some.any():
            break
        regions, sums, knots = regions[some], sums.some(some), knots[some]
        knots, error = settled(sums, _best(sums, _with_one_more(knots))[0])
        poor = error > price
        if poor.any():
            other, off = _best(sums, _elsewhere(knots))
            poor &= off < error
        if poor.any():
            knots[poor], error[poor] = settled(sums.some(poor), other[poor])
        for own, off, region in zip(knots, error.tolist(), regions.tolist()):
            extra = len(own) - len(best[region])
            if off + extra * price < least[region] and off < GAIN**extra * least[region]:
                best[region], least[region] = own, off
    return [(own, np.clip(colours(every.some(np.array([region])), own).T, 0, 255)) for region, own in enumerate(best)]


def _alike(knots: np.ndarray, regions: int) -> np.ndarray:
    """The same lists of knots (K, L) for some regions, (K, R, L)."""
    return np.broadcast_to(knots[:, None], (len(knots), regions, knots.shape[1]))


def _with_one_more(knots: np.ndarray) -> np.ndarray:
    """Knots (R, K) with one of the places that are tried, (K + 1, R, L)."""
    more = np.broadcast_to(_TRIED, (1, len(knots), len(_TRIED)))
    return np.sort(np.concatenate([np.repeat(knots.T[..., None], len(_TRIED), axis=2), more]), axis=0)


def _elsewhere(knots: np.ndarray) -> np.ndarray:
    """Knots (R, K) with one of them moved to places between its neighbours, (K, R, L)."""
    count = knots.shape[1]
    ends = np.concatenate([np.full((len(knots), 1), -GAP), knots, np.full((len(knots), 1), 1 + GAP)], axis=1)
    share = np.linspace(0, 1, _PLACES // 2 + 1)[:, None, None]
    moved = (1 - share) * (ends[:, :-2] + GAP) + share * (ends[:, 2:] - GAP)
    lists = np.where(np.eye(count, dtype=bool)[:, None], moved[:, None], knots)
    return np.asarray(lists.transpose(3, 2, 0, 1).reshape(count, len(knots), -1))


def _best(sums: Sums, knots: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """The list (R, K) of each region's knots (K, R, L) with the smallest error, and that."""
    with np.errstate(divide="ignore", invalid="ignore"):
        gain = explained(sums, knots)
    # Where two knots are at one place, there is one less than thought.
    gain[(knots[1:] - knots[:-1] < 0.99 * GAP).any(axis=0)] = -1
    best = np.argmax(gain, axis=1)
    number = np.arange(len(best))
    return knots[:, number, best].T, sums.error - gain[number, best]
