# SPDX-License-Identifier: GPL-2.0-or-later
"""Samples of the colours of regions, and sums and quantiles over them."""

from __future__ import annotations

from typing import NamedTuple, Sequence, Tuple

import numpy as np

_WRONG = 1024.0
"""Squared error of a pixel that belongs to something else, levels."""

_SPAN = 1 << 17
"""Up to so many codes are counted in a table of all, for that is quicker than to sort them."""


class Samples(NamedTuple):
    """Colours of a region.

    Attributes
    ----------
    points : ndarray of shape (n, 2)
    colour : ndarray of shape (n, C)
        RGB, or premultiplied RGBA, 0 to 255.
    count : ndarray of shape (n,)
        Pixels that each sample stands for.
    """

    points: np.ndarray
    colour: np.ndarray
    count: np.ndarray  # type: ignore[assignment]


class Batch(NamedTuple):
    """Samples of some regions, one after the other.

    Attributes
    ----------
    samples : Samples
    region : ndarray of shape (n,)
        Number of the region of each sample, rising.
    starts : ndarray of shape (R,)
        Where each region begins; none is empty.
    """

    samples: Samples
    region: np.ndarray
    starts: np.ndarray

    @classmethod
    def of(cls, samples: Sequence[Samples]) -> Batch:
        """The samples of one or more regions."""
        size = np.array([len(some.count) for some in samples])
        points, colour = (np.concatenate([values.T for values in parts], axis=1).T for parts in
                          zip(*((some.points, some.colour) for some in samples)))
        count = np.concatenate([some.count for some in samples])
        return cls(Samples(points, colour, count), np.repeat(np.arange(len(size)), size), np.cumsum(size) - size)

    def some(self, chosen: np.ndarray) -> Batch:
        """Those of the regions that are set in a mask (R,)."""
        if chosen.all():
            return self
        each, size = chosen[self.region], np.diff(np.append(self.starts, len(self.region)))[chosen]
        points, colour, count = self.samples
        return Batch(Samples(points.T[:, each].T, colour.T[:, each].T, count[each]),
                     np.repeat(np.arange(len(size)), size), np.cumsum(size) - size)

    def sums(self, values: np.ndarray) -> np.ndarray:
        """Sums (..., R) of values (..., n) over each region."""
        return np.asarray(np.add.reduceat(values, self.starts, axis=-1))


def squares(points: np.ndarray, side: float, most: float = np.inf) -> Tuple[np.ndarray, int, float]:
    """Number of the square that each point (n, 2) lies in, how many have points, and their side.

    Where more than `most` had points, as in a narrow region or a sparse sample, squares are larger than asked for.
    """
    offset = points - points.min(axis=0)
    while True:
        column, row = np.floor(offset / side).astype(np.int64).T
        number, count = _ranks(row * (column.max() + 1) + column)
        if count <= most:
            return number, count, side
        # One and a half times as many are too many by chance.
        side *= float(np.sqrt(max(count / most, 1.5)))


def _ranks(codes: np.ndarray) -> Tuple[np.ndarray, int]:
    """Numbers from 0 on for the different codes (n,), in their order, and how many there are."""
    span = int(codes.max()) + 1
    if span > _SPAN:
        values, number = np.unique(codes, return_inverse=True)
        return number, len(values)
    used = np.zeros(span, bool)
    used[codes] = True
    rank = np.cumsum(used)
    return rank[codes] - 1, int(rank[-1])


def weighted_quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    """The value below which a share of all the weight lies."""
    order = np.argsort(values)
    return float(values[order[np.searchsorted(np.cumsum(weight[order]), share * weight.sum())]])


def total_errors(off: np.ndarray, batch: Batch) -> np.ndarray:
    """Sums (R,) of the squared differences (n, C) of colours, none counting more than a wrong pixel."""
    return batch.sums(batch.samples.count * np.minimum(np.einsum("nc,nc->n", off, off), _WRONG))


def total_error(off: np.ndarray, count: np.ndarray) -> float:
    """The same for one region."""
    return float(count.dot(np.minimum(np.einsum("nc,nc->n", off, off), _WRONG)))
