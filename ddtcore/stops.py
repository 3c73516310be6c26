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

_ENDS = np.array([0.25, 0.5, 0.75])
"""Further places in the first and the last of these parts."""

_STEPS = 7
"""Most Gauss-Newton steps of the stops."""

_GAINED = 0.005
"""Share of the error that a step must promise to lower it by."""

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
    sums = _Sums.of(bins)
    places = np.linspace(0, 1, _PLACES + 1)
    # A stop at the very end could not be moved by steps: nothing changes until it passes the first pixels.
    places = np.sort(np.concatenate([places, _ENDS * places[1], 1 - _ENDS * places[1]]))
    first, last = np.triu_indices(len(places), 1)
    knots, error = best, least = _settled(sums, _best(sums, np.stack([places[first], places[last]], axis=1)))
    # What stops at all the places leave, a few will hardly explain.
    floor = float(_fitted(sums, places[None]).error[0])
    while len(knots) < MOST and least > price + floor and GAIN * least > floor:
        free = places[np.abs(places[:, None] - knots).min(axis=1) > _GAP]
        more = np.broadcast_to(knots, (len(free), len(knots)))
        more = np.sort(np.concatenate([more, free[:, None]], axis=1), axis=1)
        knots, error = _settled(sums, _best(sums, more))
        if error > price:
            knots, error = _settled(sums, _elsewhere(sums, knots))
        extra = len(knots) - len(best)
        if error + extra * price < least and error < GAIN**extra * least:
            best, least = knots, error
    return best, np.clip(_fitted(sums, best[None]).values[:, 0].T + sums.mean, 0, 255)


class _Sums(NamedTuple):
    """A profile as sums over all bins before each one: any range of bins is a difference of two.

    Red, green and blue have one weight, and alpha has another one: a group of channels each.
    """

    place: np.ndarray    # (B,)
    powers: np.ndarray   # (3, G, B + 1) of weights, times the 0th to 2nd power of the place
    colour: np.ndarray   # (2, C, B + 1) of weighted differences from the mean, times the 0th and 1st one
    group: np.ndarray    # (C,)
    mean: np.ndarray     # (C,)
    error: float         # of the mean

    @property
    def stiff(self) -> np.ndarray:
        """Weight (G, 1) of the mean in the colour of each stop."""
        return np.asarray(_STIFF * self.powers[0, :, -1:])

    @classmethod
    def of(cls, bins: Profile) -> _Sums:
        """The sums of a profile."""
        weight, colour = bins.weight.T, bins.colour.T
        group = np.arange(len(colour)) // 3
        mean = (weight * colour).sum(axis=1) / weight.sum(axis=1)
        off = colour - mean[:, None]
        powers = bins.place ** np.arange(3)[:, None, None]
        return cls(bins.place, _before(weight[::3] * powers), _before(weight * off * powers[:2]),
                   group, mean, float((weight * off**2).sum()))


def _before(values: np.ndarray) -> np.ndarray:
    """The sums of all values (..., B) before each one, and of all."""
    out = np.zeros(values.shape[:-1] + (values.shape[-1] + 1,))
    np.cumsum(values, axis=-1, out=out[..., 1:])
    return out


class _Fit(NamedTuple):
    """The colours at stops by least squares, for many lists of knots.

    Between two stops, the colour at a place is that of both by their shares in it, which add up to 1.
    """

    values: np.ndarray   # (C, M, K), less the mean of all colours
    error: np.ndarray    # (M,)
    inner: np.ndarray    # (G, M, K, K) sums of the products of two shares
    spans: np.ndarray    # (3, G, M, K - 1) those between two stops: of the former, of both, of the latter
    aims: np.ndarray     # (2, C, M, K - 1) sums of shares times colours between two stops, likewise


def _elsewhere(sums: _Sums, knots: np.ndarray) -> np.ndarray:
    """The knots with one of them moved to the best place between its neighbours."""
    ends = np.concatenate([[-_GAP], knots, [1 + _GAP]])
    share = np.linspace(0, 1, _PLACES // 2 + 1)[:, None, None]
    moved = (1 - share) * (ends[:-2, None] + _GAP) + share * (ends[2:, None] - _GAP)
    return _best(sums, np.where(np.eye(len(knots), dtype=bool), moved, knots).reshape(-1, len(knots)))


def _settled(sums: _Sums, knots: np.ndarray) -> Tuple[np.ndarray, float]:
    """Knots moved to where the error is least, near where they are, and the error there."""
    fit = _fitted(sums, knots[None])
    matrix, pull = _pull(sums, fit, knots)
    damping = 1e-3
    for _ in range(_STEPS):
        # What hardly matters, like a stop at the very end, stays where it is.
        steep = np.diag(matrix)
        step = np.linalg.solve(matrix + np.diag(damping * steep + 1e-4 * steep.max() + 1e-12), pull)
        if pull.dot(step) < _GAINED * fit.error[0]:
            break
        moved = _apart(knots + step)
        ahead = _fitted(sums, moved[None])
        if ahead.error[0] >= fit.error[0]:
            damping *= 20
            continue
        knots, fit, damping = moved, ahead, damping / 10
        matrix, pull = _pull(sums, fit, knots)
    return knots, float(fit.error[0])


def _apart(knots: np.ndarray) -> np.ndarray:
    """The knots within 0 and 1, rising by some distance at least."""
    spread = _GAP * np.arange(len(knots))
    apart: np.ndarray = np.clip(np.maximum.accumulate(knots - spread), 0, 1 - spread[-1]) + spread
    return apart


def _pull(sums: _Sums, fit: _Fit, knots: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Normal equations of the step of all knots that lowers the error, with the colours free to follow."""
    values, spans = fit.values[:, 0], fit.spans[:, sums.group, 0]
    begin, end = values[:, :-1], values[:, 1:]
    # A knot that moves by 1 changes the colour by the slope there times its share.
    slope = (end - begin) / (knots[1:] - knots[:-1])
    moves = _banded(slope * spans)
    taken = np.linalg.solve(fit.inner[sums.group, 0], moves)
    # What keeps the colours near their mean has no part in it.
    stiff = sums.stiff[sums.group, :, None]
    matrix = _banded((slope * slope * spans).sum(axis=1))
    matrix -= np.matmul(taken.swapaxes(1, 2), moves + stiff * taken).sum(axis=0)
    off = fit.aims[:, :, 0] - spans[:2] * begin - spans[1:] * end
    pull = (taken * (stiff * values[:, :, None])).sum(axis=(0, 1))
    return matrix, pull - _added((slope * off).sum(axis=1))


def _banded(spans: np.ndarray) -> np.ndarray:
    """Symmetric matrices (..., K, K) of what lies between two consecutive stops each, (3, ..., K - 1)."""
    count = spans.shape[-1] + 1
    out = np.zeros(spans.shape[1:-1] + (count * count,))
    out[..., :-1:count + 1] += spans[0]
    out[..., count + 1::count + 1] += spans[2]
    out[..., 1::count + 1] = out[..., count::count + 1] = spans[1]
    return out.reshape(out.shape[:-1] + (count, count))


def _added(spans: np.ndarray) -> np.ndarray:
    """Vectors (..., K) of what lies between two consecutive stops each, (2, ..., K - 1)."""
    out = np.zeros(spans.shape[1:-1] + (spans.shape[-1] + 1,))
    out[..., :-1] += spans[0]
    out[..., 1:] += spans[1]
    return out


def _best(sums: _Sums, knots: np.ndarray) -> np.ndarray:
    """The one of many (M, K) lists of knots with the smallest error."""
    return np.asarray(knots[int(np.argmin(_fitted(sums, knots).error))])


def _fitted(sums: _Sums, knots: np.ndarray) -> _Fit:
    """Values and errors at many lists of knots (M, K)."""
    cut = np.searchsorted(sums.place, knots)
    powers, colour = sums.powers[..., cut], sums.colour[..., cut]
    begin, wide = knots[:, :-1], knots[:, 1:] - knots[:, :-1]
    one, x, square = powers[..., 1:] - powers[..., :-1]
    # The share of the latter of two stops is how far it is from the former, in the distance of both.
    later = (x - begin * one) / wide
    both = (square - begin * (2 * x - begin * one)) / (wide * wide)
    spans = np.stack([one - 2 * later + both, later - both, both])
    one, x = colour[..., 1:] - colour[..., :-1]
    later = (x - begin * one) / wide
    aims = np.stack([one - later, later])
    inner, aim = _banded(spans), _added(aims)
    # Before the first stop and after the last one, the colour is theirs.
    inner[..., 0, 0] += powers[0, ..., 0]
    inner[..., -1, -1] += sums.powers[0, :, -1:] - powers[0, ..., -1]
    inner.reshape(*inner.shape[:-2], -1)[..., ::knots.shape[1] + 1] += sums.stiff[..., None]
    aim[..., 0] += colour[0, ..., 0]
    aim[..., -1] += sums.colour[0, :, -1:] - colour[0, ..., -1]
    values = np.linalg.solve(inner[sums.group], aim[..., None])[..., 0]
    return _Fit(values, np.maximum(sums.error - np.einsum("cmk,cmk->m", values, aim), 0), inner, spans, aims)
