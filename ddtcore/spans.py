# SPDX-License-Identifier: GPL-2.0-or-later
"""The pixels of numbered areas as spans, runs of pixels of a row: a large area has few of them.

So a sample of an area's pixels, or the rows and columns that it takes, are had without a list
of all of them.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

_ROWS = 256
"""Rows of a picture worked on at a time."""


class Spans(NamedTuple):
    """The pixels of an area.

    Attributes
    ----------
    heads : ndarray of shape (n,)
        First pixel of each span, numbered ``row * width + col``.
    ends : ndarray of shape (n,)
        Pixels up to the end of each span, those of all before it included.
    """

    heads: np.ndarray
    ends: np.ndarray

    @property
    def size(self) -> int:
        """Pixels of the area."""
        return int(self.ends[-1]) if self.ends.size else 0

    def every(self, step: int) -> np.ndarray:
        """Every `step`-th pixel."""
        return self.at(np.arange(0, self.size, step))

    def at(self, place: np.ndarray) -> np.ndarray:
        """The pixels at some places, counted in reading order."""
        span = np.searchsorted(self.ends, place, side="right")
        return np.asarray(self.heads[span] + place - np.append(0, self.ends)[span])

    def and_those_of(self, other: Spans) -> Spans:
        """The pixels of two areas, one after the other."""
        return Spans(np.concatenate([self.heads, other.heads]), np.concatenate([self.ends, self.size + other.ends]))

    def window(self, shape: Tuple[int, int], margin: int) -> Tuple[slice, slice]:
        """The rows and columns that the area takes, and some more on all sides."""
        row, col = np.divmod(self.heads, shape[1])
        last = col + np.diff(self.ends, prepend=0)
        return (slice(max(int(row.min()) - margin, 0), min(int(row.max()) + 1 + margin, shape[0])),
                slice(max(int(col.min()) - margin, 0), min(int(last.max()) + margin, shape[1])))


def renumber(areas: np.ndarray, number: np.ndarray) -> None:
    """Give areas other numbers (count + 1,) in place; the last one is for pixels that belong to none."""
    for start in range(0, len(areas), _ROWS):
        areas[start:start + _ROWS] = number[areas[start:start + _ROWS]]


def spans_of(areas: np.ndarray, count: int) -> List[Spans]:
    """The pixels of each of some areas.

    Parameters
    ----------
    areas : ndarray of shape (H, W) and an integer dtype
        Number of the area of each pixel, negative where there is none.
    count : int
        How many there are.
    """
    begins = np.ones(areas.shape, bool)
    np.not_equal(areas[:, 1:], areas[:, :-1], out=begins[:, 1:])
    heads = np.flatnonzero(begins)
    number = areas.ravel()[heads]
    length = np.diff(np.append(heads, areas.size))
    some = np.flatnonzero(number >= 0)
    some = some[np.argsort(number[some], kind="stable")]
    cut = np.cumsum(np.bincount(number[some], minlength=count))[:-1]
    if not count:
        return []
    return [Spans(first, np.cumsum(size)) for first, size in
            zip(np.split(heads[some], cut), np.split(length[some], cut))]
