# SPDX-License-Identifier: GPL-2.0-or-later
"""A limited number of connected areas: what stands out least is merged first.

Neighbouring areas are merged in the order of what that adds to the squared error, less
for longer borders (as Koepfler, Lopez and Morel, "A multiscale algorithm for image
segmentation by variational method", SIAM Journal on Numerical Analysis 31, 1994, who
divide by the length; by its root, small strong details last longer).  So small areas of
low contrast go first, and long borders hold only where they are strong.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .canvas import Canvas, mean_colours, planes, premultiply
from .components import components, label_components
from .merging import drop_unused
from .model import Labels
from .sorting import sorted_with_order

EVEN = 10.0
"""Largest range of a channel in a square that is taken as one from the start, levels."""

SQUARES = 2, 4
"""Sides of these squares, each twice as long as the one before, px."""

MANY = 8
"""How many times as many areas as wanted count as many."""

EAGER, PATIENT = 0.5, 0.08
"""Share of the areas that are merged with another one in a round while there are many, and then; more
is quicker, less is more exact."""

_AMONG = 3
"""How many times as many of the cheapest borders are looked at as are removed."""

ROOM = 32
"""Least mean size of the areas of a picture, px²."""


class _Areas(NamedTuple):
    """Areas and the borders between them.

    Attributes
    ----------
    size : ndarray of shape (R,)
        Pixels.
    total : ndarray of shape (C, R)
        Sums of their premultiplied colours.
    one, other : ndarray of shape (E,) and dtype int64
        Areas on both sides of each border; one < other.
    length : ndarray of shape (E,)
        Pixel edges.
    """

    size: np.ndarray
    total: np.ndarray
    one: np.ndarray
    other: np.ndarray
    length: np.ndarray

    def costs(self) -> np.ndarray:
        """What it costs to remove each border, float32 (E,)."""
        square = np.zeros(len(self.one))
        for plane in self.total / self.size:
            off = plane[self.one]
            off -= plane[self.other]
            off *= off
            square += off
        a, b = self.size[self.one], self.size[self.other]
        return np.asarray((square * (a * b / (a + b)) / np.sqrt(self.length)).astype(np.float32))


def label_areas(canvas: Canvas, most: int) -> Labels:
    """One label for each of at most `most` areas, with its mean colour; small pictures have fewer."""
    colour = planes(canvas.bare(canvas.keys), canvas.opaque)
    index = _squares(colour)
    count = int(index.max()) + 1
    size = np.bincount(index.ravel(), minlength=count).astype(np.float64)
    total = np.stack([np.bincount(index.ravel(), plane.ravel(), count) for plane in colour])
    areas = _Areas(size, total, *_borders(index))
    equal = np.flatnonzero(areas.costs() == 0)
    number = components(count, areas.one[equal], areas.other[equal]).astype(np.int64)
    group = _merged(_joined(areas, number), min(most, index.size // ROOM))
    index = group[number][index]
    return Labels(index, mean_colours(canvas, index), np.zeros(index.shape, bool))


def limit_areas(labels: Labels, most: int) -> Labels:
    """Merge connected areas until `most` are left; each takes the colour of its largest part."""
    area = label_components(labels.index, 8)
    size = np.bincount(area.ravel()).astype(np.float64)
    if size.size <= most:
        return labels
    label = np.zeros(size.size, np.int32)
    label[area.ravel()] = labels.index.ravel()
    total = premultiply(labels.palette).T[:, label] * size
    group = _merged(_Areas(size, total, *_borders(area)), most)
    order = np.argsort(size, kind="stable")
    largest = np.zeros(int(group.max()) + 1, np.int32)
    largest[group[order]] = label[order]
    index = largest[group][area]
    return drop_unused(Labels(index, labels.palette, labels.thin & (index == labels.index), labels.ramp))


def _squares(colour: np.ndarray) -> np.ndarray:
    """Number the largest even squares, and all other pixels, int32 (H, W)."""
    height, width = colour.shape[1:]
    row, col = np.arange(height, dtype=np.int32)[:, None], np.arange(width, dtype=np.int32)
    own = row * np.int32(width) + col
    number = own.copy()
    low = high = colour
    for side in SQUARES:
        low, high = _halved(low, np.minimum), _halved(high, np.maximum)
        even = np.repeat(np.repeat((high - low <= EVEN).all(axis=0), side, axis=0), side, axis=1)
        rows, cols = even.shape
        first = row[:rows] // side * side * np.int32(width) + col[:cols] // side * side
        np.copyto(number[:rows, :cols], first, where=even)
    head = number == own
    return np.asarray((np.cumsum(head.ravel(), dtype=np.int32) - 1)[number])


def _halved(planes: np.ndarray, least: np.ufunc) -> np.ndarray:
    """The least, or largest, value in each square of 2 x 2 pixels."""
    rows, cols = (side // 2 * 2 for side in planes.shape[1:])
    down = least(planes[:, :rows:2, :cols], planes[:, 1:rows:2, :cols])
    return np.asarray(least(down[:, :, ::2], down[:, :, 1::2]))


def _borders(index: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Areas on both sides of each border between two of them, and its length."""
    pairs = []
    for a, b in ((index[:, 1:], index[:, :-1]), (index[1:], index[:-1])):
        differ = a != b
        pairs.append((a[differ], b[differ]))
    a, b = (np.concatenate(side).astype(np.int64) for side in zip(*pairs))
    return _united(a, b, np.ones(len(a)), int(index.max()) + 1)


def _united(a: np.ndarray, b: np.ndarray, length: np.ndarray,
            count: int) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """One border for all that lie between the same two areas."""
    key, order = sorted_with_order(np.minimum(a, b) * count + np.maximum(a, b), count * count)
    first = np.flatnonzero(np.append(True, key[1:] != key[:-1])[:len(key)])
    sums = np.add.reduceat(length[order], first) if len(first) else length
    one, other = np.divmod(key[first], count)
    return one, other, sums


def _merged(areas: _Areas, most: int) -> np.ndarray:
    """Group number of each area, int32 (R,), of at most `most` groups, numbered without gaps."""
    group = np.arange(len(areas.size))
    most = max(1, most)
    while len(areas.size) > most and len(areas.one):
        share = EAGER if len(areas.size) > MANY * most else PATIENT
        chosen = _cheapest(areas, max(1, min(len(areas.size) - most, int(share * len(areas.size)))))
        number = components(len(areas.size), areas.one[chosen], areas.other[chosen]).astype(np.int64)
        areas = _joined(areas, number)
        group = number[group]
    return group.astype(np.int32)


def _cheapest(areas: _Areas, most: int) -> np.ndarray:
    """At most so many of the cheapest borders that are the cheapest one of an area; they close no circles."""
    cost = areas.costs()
    # The cheapest borders of areas are among the cheapest of all.
    first = min(_AMONG * most, cost.size - 1)
    some = np.flatnonzero(cost <= np.partition(cost, first)[first])
    # Costs are not negative: as whole numbers their bits have the same order.
    highest = np.iinfo(np.int32).max
    order = some[sorted_with_order(highest - cost[some].view(np.int32), highest + 1)[1]]
    rank = np.arange(order.size)
    best = np.full((2, len(areas.size)), -1)
    # The last one written, the cheapest, is what stays.
    best[0, areas.one[order]] = rank
    best[1, areas.other[order]] = rank
    lowest = best.max(axis=0)
    asked = np.zeros(order.size, bool)
    asked[lowest[lowest >= 0]] = True
    return np.asarray(order[asked][::-1][:most])


def _joined(areas: _Areas, number: np.ndarray) -> _Areas:
    """The areas with those of one number joined."""
    count = int(number.max()) + 1
    size = np.bincount(number, areas.size, count)
    total = np.stack([np.bincount(number, plane, count) for plane in areas.total])
    one, other = number[areas.one], number[areas.other]
    apart = one != other
    return _Areas(size, total, *_united(one[apart], other[apart], areas.length[apart], count))
