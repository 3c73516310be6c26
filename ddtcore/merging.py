# SPDX-License-Identifier: GPL-2.0-or-later
"""Fewer labels: a limit for the palette, twins of a colour, and specks that join a neighbour.

All work on the labels, before any boundary exists, so they cannot leave gaps.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, Optional, Tuple

import numpy as np

from .canvas import premultiply
from .components import label_components
from .model import Labels
from .parts import in_parts

MANY = 512
"""Most colours that are grouped by all their distances."""

TWIN = 2.0
"""How far apart colours are that nobody can tell from each other, levels."""

MEETING = 8
"""Shortest boundary between two colours that is worth a merge, px."""


def limit_colours(labels: Labels, most: int) -> Labels:
    """Merge the colours whose loss is least until `most` remain besides "nothing".

    The cost of a merge is that of Ward's method, the growth of the squared error
    weighted by pixels.  A merged colour is that of its most frequent member.
    """
    counts = np.bincount(labels.index.ravel(), minlength=len(labels.palette))
    painted = np.flatnonzero(labels.palette[:, 3] > 0)
    if painted.size <= most:
        return labels
    into = np.arange(len(labels.palette))
    groups = _groups(premultiply(labels.palette[painted]), counts[painted], most)
    frequent = painted[np.lexsort((-counts[painted], groups))]
    leader = frequent[np.searchsorted(np.sort(groups), np.arange(groups.max() + 1))]
    into[painted] = leader[groups]
    ramp = labels.ramp
    if ramp is not None:
        ramp = ramp & (np.bincount(into, minlength=into.size) == 1)
    return drop_unused(replace(labels, index=into.astype(labels.index.dtype)[labels.index], ramp=ramp))


def _groups(points: np.ndarray, weights: np.ndarray, most: int) -> np.ndarray:
    """Group numbers by Ward's method of the most frequent points, the others with the nearest of these."""
    if len(points) <= MANY:
        return ward_groups(points, weights, most)
    top = np.sort(np.argsort(-weights, kind="stable")[:MANY])
    nearest = np.zeros(len(points), np.int64)
    least = np.full(len(points), np.inf)
    for k, centre in enumerate(points[top]):
        square = ((points - centre) ** 2).sum(axis=1)
        nearer = square < least
        nearest[nearer], least[nearer] = k, square[nearer]
    return ward_groups(points[top], np.bincount(nearest, weights, len(top)), most)[nearest]


def merge_twins(labels: Labels, colours: np.ndarray) -> Labels:
    """Merge flat colours that nobody can tell apart and that border on each other.

    A boundary between them costs as much as any other and is never seen.  Twins that
    nowhere meet cost nothing and keep their own colours.  Colours are merged into a more frequent
    one only, so that no chain of twins leads to a colour that looks different.

    Parameters
    ----------
    labels : Labels
    colours : ndarray of shape (C, K) and dtype float32
        The palette, premultiplied.
    """
    count = len(labels.palette)
    near = np.abs(colours[:, :, None] - colours[:, None]).max(axis=0) <= TWIN
    if labels.ramp is not None:
        ramp = np.zeros(count, bool) if labels.ramp is None else labels.ramp
    near &= ~(ramp[:, None] | ramp)
    if np.count_nonzero(near) <= count:
        return labels
    one, other = borders(labels.index)
    near &= np.bincount(one * count + other, minlength=count * count).reshape(count, count) >= MEETING
    into = np.arange(count, dtype=labels.index.dtype)
    free = np.ones(count, bool)
    label, length = _label_runs(labels)
    for k in np.argsort(-np.bincount(label, length, count), kind="stable"):
        if free[k]:
            joined = near[k] & free
            into[joined] = k
            free[joined] = free[k] = False
    return _renumbered(labels, into, label, length)


def ward_groups(points: np.ndarray, weights: np.ndarray, most: int) -> np.ndarray:
    """Group weighted points (K, C) by Ward's method; group numbers (K,) from 0 to most - 1."""
    points = points.astype(np.float64)
    weights = np.maximum(weights, 1).astype(np.float64)
    group = np.arange(len(points))
    alive = np.ones(len(points), bool)
    cost = _ward_cost(points, weights, points, weights)
    np.fill_diagonal(cost, np.inf)
    for _ in range(len(points) - most):
        i, j = np.unravel_index(np.argmin(cost), cost.shape)
        total = weights[i] + weights[j]
        points[i] = (weights[i] * points[i] + weights[j] * points[j]) / total
        weights[i] = total
        group[group == j] = i
        alive[j] = False
        cost[j], cost[:, j] = np.inf, np.inf
        row = _ward_cost(points[i:i + 1], weights[i:i + 1], points, weights)[0]
        row[~alive] = np.inf
        row[i] = np.inf
        cost[i], cost[:, i] = row, row
    return np.unique(group, return_inverse=True)[1]


def _ward_cost(a: np.ndarray, wa: np.ndarray, b: np.ndarray, wb: np.ndarray) -> np.ndarray:
    square = ((a[:, None] - b[None]) ** 2).sum(axis=-1)
    return np.asarray(square * (wa[:, None] * wb / (wa[:, None] + wb)))


def merge_specks(labels: Labels, area: float,
                 spare: Optional[Callable[[np.ndarray, np.ndarray], np.ndarray]] = None) -> Labels:
    """Give small connected regions the label of the neighbour with the longest shared border.

    Parameters
    ----------
    area : float
        Regions with fewer px² are small.
    spare : callable, optional
        ``spare(mask, index)`` tells which of the pixels set in a (H, W) mask are too unlike the
        labels `index` (n,) they would get; regions with such, inside one other region, stay.
    """
    index = labels.index
    while True:
        region = label_components(index, 8)
        size = np.bincount(region.ravel())
        small = size < area
        if not small.any():
            break
        into = _best_neighbours(region, size, area)
        first = np.zeros(size.size, index.dtype)
        first[region.ravel()] = index.ravel()
        if spare is not None:
            mask = (small & _inside_one(region))[region]
            kept = region[mask][spare(mask, first[into][region[mask]])]
            into[kept] = kept
        merged = first[into][region]
        if np.array_equal(merged, index):
            break
        index = merged
    return drop_unused(replace(labels, index=index, thin=labels.thin & (index == labels.index)))


def merge_like_pieces(labels: Labels, colours: np.ndarray, area: float, margin: float) -> Labels:
    """Give small connected regions the label of a larger neighbour that has nearly their colour, if there is one.

    Parameters
    ----------
    labels : Labels
    colours : ndarray of shape (C, K) and dtype float32
        The palette, premultiplied.
    area : float
        Regions with fewer px² are small.
    margin : float
        How far apart colours may be that are nearly the same, levels.
    """
    region = label_components(labels.index, 8)
    size = np.bincount(region.ravel())
    first = np.zeros(size.size, labels.index.dtype)
    first[region.ravel()] = labels.index.ravel()
    flat = ~labels.ramp[first] if labels.ramp is not None else np.ones(size.size, bool)
    small, other = borders(region)
    some = (size[small] < area) & (size[other] >= area) & flat[small] & flat[other]
    small, other = small[some], other[some]
    like = np.abs(colours[:, first[small]] - colours[:, first[other]]).max(axis=0) <= margin
    edge, length = np.unique(small[like] * size.size + other[like], return_counts=True)
    small, other = np.divmod(edge[np.argsort(length, kind="stable")], size.size)
    first[small] = first[other]
    index = first[region]
    return drop_unused(replace(labels, index=index, thin=labels.thin & (index == labels.index)))


def borders(region: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Regions on both sides of each pixel edge between two of them, seen from either side, int64."""
    def found(rows: slice) -> Tuple[np.ndarray, np.ndarray]:
        some, pairs = region[rows.start:rows.stop + 1], []
        own = some[:rows.stop - rows.start]
        for a, b in ((own[:, 1:], own[:, :-1]), (some[1:], some[:-1])):
            differ = a != b
            pairs += [(a[differ], b[differ]), (b[differ], a[differ])]
        one, other = (np.concatenate(side).astype(np.int64) for side in zip(*pairs))
        return one, other

    one, other = in_parts(found, len(region), size=region.shape[1])
    return one, other


def _inside_one(region: np.ndarray) -> np.ndarray:
    """Which regions border on one other only, bool (R,)."""
    one, other = borders(region)
    count = int(region.max()) + 1
    return np.asarray(np.bincount(np.unique(one * count + other) // count, minlength=count) == 1)


def _best_neighbours(region: np.ndarray, size: np.ndarray, area: float) -> np.ndarray:
    """Per small region the larger neighbour with the longest shared border, chains followed, or itself."""
    small, other = borders(region)
    rank = np.empty(size.size, np.int64)
    rank[np.argsort(size, kind="stable")] = np.arange(size.size)
    use = (size[small] < area) & (rank[other] > rank[small])
    edge, length = np.unique(small[use] * size.size + other[use], return_counts=True)
    small, other = np.divmod(edge, size.size)
    order = np.argsort(length, kind="stable")
    into = np.arange(size.size)
    into[small[order]] = other[order]
    while not np.array_equal(into[into], into):
        into = into[into]
    return into


def drop_unused(labels: Labels) -> Labels:
    """Remove the colours that no pixel has."""
    return _renumbered(labels, np.arange(len(labels.palette)), *_label_runs(labels))


def _renumbered(labels: Labels, into: np.ndarray, label: np.ndarray, length: np.ndarray) -> Labels:
    """Labels (K,), of which there are these runs, replaced by others of them, and those that no pixel has removed."""
    used = np.zeros(len(labels.palette), bool)
    used[into[label]] = True
    number = (np.cumsum(used) - 1).astype(labels.index.dtype)[into]
    if (number == np.arange(len(number))).all():
        return labels
    index = np.repeat(number[label], length).reshape(labels.index.shape)
    ramp = None if labels.ramp is None else labels.ramp[used]
    gradients = labels.gradients and tuple(labels.gradients[k] for k in np.flatnonzero(used).tolist())
    return replace(labels, index=index, palette=labels.palette[used], ramp=ramp, gradients=gradients)


def _label_runs(labels: Labels) -> Tuple[np.ndarray, np.ndarray]:
    """The label and the length of runs of pixels, row after row."""
    def found(rows: slice) -> Tuple[np.ndarray, np.ndarray]:
        flat = labels.index[rows].ravel()
        heads = np.flatnonzero(np.append(True, flat[1:] != flat[:-1])[:flat.size])
        return flat[heads], np.diff(np.append(heads, flat.size))

    label, length = in_parts(found, len(labels.index), size=labels.index.shape[1])
    return label, length
