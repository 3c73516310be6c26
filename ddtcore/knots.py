# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours at the stops of gradients by least squares, and stops moved to where these err least.

Between two stops, the colour at a place is that of both by their shares in it, which add
up to 1; so the equations of the colours have nothing beside their diagonals and what is
next to these.  Gauss-Newton steps move the stops, with their colours eliminated (variable
projection: Golub and Pereyra, SIAM Journal on Numerical Analysis 10, 1973).

The last two axes of all arrays are R gradients and L lists of K stops, knots, for each.
"""

from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

GAP = 1 / 1024
"""Least distance between two stops."""

_STEPS = 7
"""Most Gauss-Newton steps of the stops."""

_GAINED = 0.005
"""Share of the error that a step must promise to lower it by."""

_STIFF = 1e-6
"""Pull of the mean colour on stops that few pixels speak for, as a share of all their weight."""

_BEYOND = 2.0
"""A place beyond all stops."""


class Sums(NamedTuple):
    """Colours along gradients as sums over all bins before each one: any range of bins is a difference of two.

    Red, green and blue have one weight, and alpha has another one: a group of channels each.

    Attributes
    ----------
    place : ndarray of shape (R, B)
        Rising; beyond all knots where a gradient has fewer bins.
    before : ndarray of shape (3, G + C, R, B + 1)
        Sums of what follows times the 0th to 2nd power of the place: first the weights of G
        groups, then weighted differences from the means of C channels.
    group : ndarray of shape (C,)
        That of each channel.
    mean : ndarray of shape (C, R)
    error : ndarray of shape (R,)
        That of the means.
    """

    place: np.ndarray
    before: np.ndarray
    group: np.ndarray
    mean: np.ndarray
    error: np.ndarray

    @property
    def groups(self) -> int:
        """How many groups of channels there are."""
        return int(self.before.shape[1] - len(self.group))

    @property
    def stiff(self) -> np.ndarray:
        """Weight (G, R) of the mean in the colour of each stop."""
        return np.asarray(_STIFF * self.before[0, :self.groups, :, -1])

    @classmethod
    def of(cls, places: Sequence[np.ndarray], colours: Sequence[np.ndarray], weights: Sequence[np.ndarray]) -> Sums:
        """The sums of the bins of some gradients, which need not have as many bins.

        Parameters
        ----------
        places : sequence of ndarray of shape (B,)
        colours, weights : sequence of ndarray of shape (B, C)
        """
        most, channels = max(len(place) for place in places), colours[0].shape[1]
        place = np.full((len(places), most), _BEYOND)
        colour, weight = np.zeros((2, channels, len(places), most))
        for region, size in enumerate(map(len, places)):
            place[region, :size] = places[region]
            colour[:, region, :size], weight[:, region, :size] = colours[region].T, weights[region].T
        mean = (weight * colour).sum(axis=2) / weight.sum(axis=2)
        off = colour - mean[..., None]
        values = np.concatenate([weight[::3], weight * off])
        before = np.zeros((3, *values.shape[:2], most + 1))
        np.cumsum(values * place ** np.arange(3)[:, None, None, None], axis=-1, out=before[..., 1:])
        return cls(place, before, np.arange(channels) // 3, mean, (weight * off**2).sum(axis=(0, 2)))

    def some(self, chosen: np.ndarray) -> Sums:
        """Those of the gradients that are chosen, by a mask or by their numbers."""
        return Sums(self.place[chosen], self.before[:, :, chosen], self.group, self.mean[:, chosen],
                    self.error[chosen])

    def at(self, knots: np.ndarray) -> np.ndarray:
        """The sums (3, G + C, K, R, L) before knots (K, R, L)."""
        number = np.arange(len(self.place))[:, None]
        apart = 2 * _BEYOND * number
        cut = np.searchsorted((self.place + apart).ravel(), knots + apart) + number
        return np.asarray(np.take(self.before.reshape(*self.before.shape[:2], -1), cut, axis=2))

    def each(self, values: np.ndarray) -> np.ndarray:
        """Values of each group as such of each channel, or such as stand for them."""
        return values if len(values) == 1 else values[self.group]


class _Equations(NamedTuple):
    """What gives the colours at knots by least squares."""

    sums: Sums
    ends: np.ndarray            # (2, G, K - 1, R, L) sums of the squared shares of the former and the latter of two
    both: np.ndarray            # (G, K - 1, R, L) of the products of both
    aims: np.ndarray            # (2, C, K - 1, R, L) of the shares times the colours
    right: np.ndarray           # (C, K, R, L) right-hand sides
    shares: List[np.ndarray]    # (C, R, L) of each pivot, but the last one, that are in the next one
    pivots: List[np.ndarray]    # (C, R, L) of each knot; C may be 1 if all channels are alike

    @classmethod
    def at(cls, sums: Sums, knots: np.ndarray) -> _Equations:
        """Those for some knots (K, R, L)."""
        groups, parts = sums.groups, sums.at(knots)
        begin = knots[:-1]
        wide = knots[1:] - begin
        one, x, square = parts[:, :, 1:] - parts[:, :, :-1]
        # The share of the latter of two knots is how far it is from the former, in the distance of both.
        x -= begin * one
        later = x / wide
        both = later[:groups] - (square - begin * (2 * x + begin * one))[:groups] / wide**2
        ends = np.empty((2, *later.shape))
        np.subtract(one, later, out=ends[0])
        ends[1] = later
        ends[:, :groups] -= both
        total = _added(ends)
        # Before the first knot and after the last one, the colour is theirs.
        total[:, 0] += parts[0, :, 0]
        total[:, -1] += sums.before[0, :, :, -1:] - parts[0, :, -1]
        diagonal, beside = sums.each(total[:groups] + sums.stiff[:, None, :, None]), sums.each(both)
        shares, pivots = [], [diagonal[:, 0]]
        for k in range(len(begin)):
            shares.append(beside[:, k] / pivots[k])
            pivots.append(diagonal[:, k + 1] - shares[k] * beside[:, k])
        return cls(sums, ends[:, :groups], both, ends[:, groups:], total[groups:], shares, pivots)

    def reduced(self, right: np.ndarray) -> np.ndarray:
        """What is left of right-hand sides (C, K, R, L) when all knots before each one are eliminated."""
        out = right.copy()
        for k, share in enumerate(self.shares):
            out[:, k + 1] -= share * out[:, k]
        return out

    def solved(self, right: np.ndarray) -> np.ndarray:
        """The solutions for right-hand sides (C, K, R, L)."""
        out = self.reduced(right)
        for k, pivot in enumerate(self.pivots):
            out[:, k] /= pivot
        for k in range(len(self.shares) - 1, -1, -1):
            out[:, k] -= self.shares[k] * out[:, k + 1]
        return out

    def explained(self) -> np.ndarray:
        """By how much (R, L) the best colours lower the error of the mean."""
        left = self.reduced(self.right)
        left *= left
        return np.asarray(sum((left[:, k] / pivot).sum(axis=0) for k, pivot in enumerate(self.pivots)))

    def pull(self, knots: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Normal equations of the steps of all knots (R, K) that lower the error, with the colours free to follow."""
        values, both = self.solved(self.right), self.sums.each(self.both)
        begin, end, (first, last) = values[:, :-1], values[:, 1:], map(self.sums.each, self.ends)
        # A knot that moves by 1 changes the colour by the slope there times its share.
        slope = (end - begin) / (knots.T[1:] - knots.T[:-1])[..., None]
        spans = slope * first, slope * both, slope * last
        moves = _banded(*spans)
        taken = self.solved(moves)
        # What keeps the colours near their mean has no part in it.
        stiff = self.sums.each(self.sums.stiff)[:, None, :, None]
        matrix = _banded(*((slope * span).sum(axis=0, keepdims=True) for span in spans))[0].swapaxes(0, 1)
        matrix = matrix - np.einsum("ckrp,ckrq->rpq", moves + stiff * taken, taken)
        off = self.aims.copy()
        off[0] -= first * begin + both * end
        off[1] -= both * begin + last * end
        pull = np.einsum("ckrp,ckrp->rp", taken, stiff * values) - _added((slope * off).sum(axis=1))[..., 0].T
        return matrix, pull


def _added(ends: np.ndarray) -> np.ndarray:
    """What knots (..., K, R, L) have of the spaces (2, ..., K - 1, R, L) after them and before them."""
    out = np.zeros((*ends.shape[1:-3], ends.shape[-3] + 1, *ends.shape[-2:]))
    out[..., :-1, :, :] = ends[0]
    out[..., 1:, :, :] += ends[1]
    return out


def _banded(first: np.ndarray, both: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Symmetric matrices (C, K, R, K) of what lies between two consecutive knots each, (C, K - 1, R, 1)."""
    channels, count, regions, _ = both.shape
    count += 1
    out = np.zeros((channels, count, regions, count))
    for k in range(count - 1):
        out[:, k, :, k] += first[:, k, :, 0]
        out[:, k + 1, :, k + 1] += last[:, k, :, 0]
        out[:, k, :, k + 1] = out[:, k + 1, :, k] = both[:, k, :, 0]
    return out


def explained(sums: Sums, knots: np.ndarray) -> np.ndarray:
    """By how much (R, L) the best colours at knots (K, R, L) lower the error of the mean."""
    return _Equations.at(sums, knots).explained()


def colours(sums: Sums, knots: np.ndarray) -> np.ndarray:
    """The best colours (C, K) at the knots (K,) of a single gradient."""
    equations = _Equations.at(sums, knots[:, None, None])
    return np.asarray(equations.solved(equations.right)[..., 0, 0] + sums.mean)


def settled(sums: Sums, knots: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Knots moved to where the errors are least, near where they are.

    Parameters
    ----------
    sums : Sums
    knots : ndarray of shape (R, K)
        From 0 to 1, rising.

    Returns
    -------
    knots : ndarray of shape (R, K)
    errors : ndarray of shape (R,)
        Those there.
    """
    knots, damping = knots.copy(), np.full(len(knots), 1e-3)
    errors, equations = _errors(sums, knots)
    matrix, pull = equations.pull(knots)
    error, left = errors.copy(), np.arange(len(knots))
    for _ in range(_STEPS):
        # What hardly matters, like a stop at the very end, stays where it is.
        steep = np.einsum("rkk->rk", matrix)
        stiff = damping[:, None] * steep + 1e-4 * steep.max(axis=1, keepdims=True) + 1e-12
        step = np.linalg.solve(matrix + stiff[..., None] * np.eye(knots.shape[1]), pull[..., None])[..., 0]
        some = np.einsum("rk,rk->r", pull, step) >= _GAINED * error
        if not some.any():
            break
        if not some.all():
            left, sums, step = left[some], sums.some(some), step[some]
            error, matrix, pull, damping = error[some], matrix[some], pull[some], damping[some]
        moved = _apart(knots[left] + step)
        off, equations = _errors(sums, moved)
        better = off < error
        if better.any():
            error[better], knots[left[better]] = off[better], moved[better]
            for now, then in zip((matrix, pull), equations.pull(moved)):
                now[better] = then[better]
        errors[left] = error
        damping *= np.where(better, 0.1, 20)
    return knots, errors


def _errors(sums: Sums, knots: np.ndarray) -> Tuple[np.ndarray, _Equations]:
    """The errors (R,) of the best colours at knots (R, K), and what gives these."""
    equations = _Equations.at(sums, knots.T[..., None])
    return np.maximum(sums.error - equations.explained()[:, 0], 0), equations


def _apart(knots: np.ndarray) -> np.ndarray:
    """The knots (R, K) within 0 and 1, rising by some distance at least."""
    spread = GAP * np.arange(knots.shape[1])
    apart: np.ndarray = np.clip(np.maximum.accumulate(knots - spread, axis=1), 0, 1 - spread[-1]) + spread
    return apart
