# SPDX-License-Identifier: GPL-2.0-or-later
"""Connected components of graphs and of pixel grids, by whole-array union-find.

Roots are hooked onto neighbouring roots and paths are halved until every node
points at its root (Shiloach and Vishkin, "An O(log n) parallel connectivity
algorithm", J. Algorithms 3, 1982).  On a grid the nodes are runs of linked
pixels of a row, which leaves few of them in a picture of flat colours.
"""

from __future__ import annotations

from typing import Callable, NamedTuple, Optional, Tuple

import numpy as np

from .parts import in_parts

_MIX = np.uint32(2654435761)

_Links = Callable[[int, int], Tuple[np.ndarray, np.ndarray]]
"""Links to the right and downwards, as for `link_components`, of the rows from a first to before a last one."""

_CHUNK = 1 << 20
"""Pixels written at a time, and a run more."""


def components(n: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Number the connected components of a graph.

    Parameters
    ----------
    n : int
        Count of nodes.
    a, b : ndarray of shape (E,) and an integer dtype
        Edge k joins the nodes ``a[k]`` and ``b[k]``.

    Returns
    -------
    ndarray of shape (n,) and dtype int32
        Component of each node, numbered from 0 in the order of their first nodes.

    Notes
    -----
    In each round a root hooks onto a neighbour of lower priority.  Priorities are
    drawn anew per round, so that half of the roots that still have neighbours are
    expected to vanish whatever the graph: O(log n) rounds.
    """
    parent = np.arange(n, dtype=np.int32)
    a, b = np.asarray(a), np.asarray(b)
    turn = 0
    while True:
        a, b = parent[a], parent[b]
        apart = np.flatnonzero(a != b)
        if not apart.size:
            return _renumber(parent)
        a, b = a[apart], b[apart]
        swap = _priority(a, turn) > _priority(b, turn)
        parent[np.where(swap, a, b)] = np.where(swap, b, a)
        _flatten(parent)
        turn += 1


def _priority(node: np.ndarray, turn: int) -> np.ndarray:
    """A pseudo-random number per node and round; different nodes never share one."""
    mixed = (node.astype(np.uint32) ^ np.uint32(turn * 0x9E3779B1 & 0xFFFFFFFF)) * _MIX
    return (mixed ^ mixed >> np.uint32(15)) * _MIX


def _flatten(parent: np.ndarray) -> None:
    """Let every node point at its root, in place."""
    while True:
        grand = parent[parent]
        if np.array_equal(grand, parent):
            return
        parent[:] = grand


def _renumber(root: np.ndarray) -> np.ndarray:
    """Consecutive numbers for the roots, in the order of the first node of each."""
    nodes = np.arange(root.size, dtype=np.int32)
    first = np.full(root.size, root.size, np.int32)
    first[root[::-1]] = nodes[::-1]
    number = np.cumsum(first[root] == nodes, dtype=np.int32) - 1
    return np.asarray(number[first[root]])


def link_components(right: np.ndarray, down: np.ndarray, down_right: Optional[np.ndarray] = None,
                    down_left: Optional[np.ndarray] = None) -> np.ndarray:
    """Number the connected components of a grid of pixels with given links.

    Parameters
    ----------
    right : ndarray of shape (H, W - 1) and dtype bool
        Whether pixel (r, c) is linked with (r, c + 1).
    down : ndarray of shape (H - 1, W) and dtype bool
        Whether (r, c) is linked with (r + 1, c).
    down_right : ndarray of shape (H - 1, W - 1) and dtype bool, optional
        Whether (r, c) is linked with (r + 1, c + 1).
    down_left : ndarray of shape (H - 1, W - 1) and dtype bool, optional
        Whether (r, c + 1) is linked with (r + 1, c).

    Returns
    -------
    ndarray of shape (H, W) and dtype int32
        Component of each pixel, numbered from 0 in reading order.
    """
    height, width = right.shape[0], down.shape[1]
    start = np.ones((height, width), bool)
    np.logical_not(right, out=start[:, 1:])
    run = np.cumsum(start.ravel(), dtype=np.int32).reshape(height, width)
    run -= 1

    # A link is left out where other links join the same runs.
    needed = down.copy()
    needed[:, 1:] &= ~(down[:, :-1] & right[:-1] & right[1:])
    pairs = [(run[:-1][needed], run[1:][needed])]
    if down_right is not None:
        needed = down_right & ~(right[:-1] & down[:, 1:]) & ~(down[:, :-1] & right[1:])
        pairs.append((run[:-1, :-1][needed], run[1:, 1:][needed]))
    if down_left is not None:
        needed = down_left & ~(right[:-1] & down[:, :-1]) & ~(down[:, 1:] & right[1:])
        pairs.append((run[:-1, 1:][needed], run[1:, :-1][needed]))
    a, b = (np.concatenate(side) for side in zip(*pairs))
    count = int(run[-1, -1]) + 1 if run.size else 0
    return components(count, a, b)[run]


class Areas(NamedTuple):
    """Connected areas of a grid of pixels, as runs: a picture of flat colours has few of them.

    Attributes
    ----------
    heads, tails : ndarray of shape (R,) and dtype int64
        First pixel of each run, and the one after its last, numbered ``row * width + col``; rising.
    number : ndarray of shape (R,) and dtype int32
        Area of each run, numbered from 0 in reading order.
    size : ndarray of shape (n,) and dtype int64
        Pixels of each area.
    """

    heads: np.ndarray
    tails: np.ndarray
    number: np.ndarray
    size: np.ndarray

    def at(self, cells: np.ndarray) -> np.ndarray:
        """The area of each of some pixels, -1 where there is none."""
        run = np.searchsorted(self.heads, cells, side="right") - 1
        inside = run >= 0
        inside[inside] = cells[inside] < self.tails[run[inside]]
        out = np.full(cells.shape, -1, np.int32)
        out[inside] = self.number[run[inside]]
        return out

    def put(self, values: np.ndarray, given: np.ndarray) -> None:
        """Write ``given[k]`` to the pixels of area k in a flat array, in place, unless it is negative."""
        runs = np.flatnonzero(given[self.number] >= 0)
        length = self.tails[runs] - self.heads[runs]
        ends = np.cumsum(length)
        cuts = np.searchsorted(ends, np.arange(_CHUNK, ends[-1] if runs.size else 0, _CHUNK))
        for some, size in zip(np.split(runs, cuts), np.split(length, cuts)):
            before = np.cumsum(size) - size
            cells = np.arange(size.sum()) + np.repeat(self.heads[some] - before, size)
            values[cells] = np.repeat(given[self.number[some]], size)


def linked_areas(right: np.ndarray, down: np.ndarray) -> Areas:
    """Number the connected components of the pixels that are linked at all.

    Parameters
    ----------
    right : ndarray of shape (H, W - 1) and dtype bool
    down : ndarray of shape (H - 1, W) and dtype bool
        As for `link_components`.

    Returns
    -------
    Areas
    """
    return _areas(lambda first, last: (right[first:last], down[first:last]), len(right), down.shape[1])


def _areas(links: _Links, height: int, width: int) -> Areas:
    # Only where runs of linked pixels begin and end something is to be done.
    heads, tails, upper = in_parts(
        lambda rows: _run_ends(*links(max(rows.start - 1, 0), min(rows.stop + 1, height)), rows), height, size=width)
    a, b = (np.searchsorted(heads, cells, side="right") - 1 for cells in (upper, upper + width))
    number = components(heads.size, a, b)
    return Areas(heads, tails, number, np.bincount(number, tails - heads).astype(np.int64))


def _run_ends(right: np.ndarray, down: np.ndarray, rows: slice) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """First pixels of the runs in some rows, those after their last, and pixels linked to a run below.

    Links are those of these rows, and of one row more above and below where there is one.
    """
    top, count = min(rows.start, 1), rows.stop - rows.start
    beside, below, above = right[top:top + count], down[top:top + count], down[:top + count - 1]
    linked = np.zeros((count, down.shape[1]), bool)
    linked[:, :-1] = beside
    linked[:, 1:] |= beside
    linked[:len(below)] |= below
    linked[count - len(above):] |= above
    begins, ends = linked.copy(), linked
    begins[:, 1:] &= ~beside
    ends[:, :-1] &= ~beside
    needed = below.copy()
    needed[:, 1:] &= ~(below[:, :-1] & beside[:len(below)] & right[top + 1:top + 1 + len(below)])
    first = rows.start * down.shape[1]
    return np.flatnonzero(begins) + first, np.flatnonzero(ends) + first + 1, np.flatnonzero(needed) + first


def mask_areas(mask: np.ndarray) -> Areas:
    """Number the connected areas of the pixels set in a mask (H, W); lone pixels are none."""
    return linked_areas(mask[:, 1:] & mask[:, :-1], mask[1:] & mask[:-1])


def block_areas(block: np.ndarray) -> Areas:
    """Number the connected areas that 2 x 2 blocks cover; blocks are connected where they share a pixel.

    Parameters
    ----------
    block : ndarray of shape (H - 1, W - 1) and dtype bool
        Whether pixels (r, c) to (r + 1, c + 1) are a block.
    """
    height, width = block.shape[0] + 1, block.shape[1] + 1

    def links(first: int, last: int) -> Tuple[np.ndarray, np.ndarray]:
        below, above = block[first:last], block[max(first - 1, 0):last - 1]
        right, down = np.zeros((last - first, width - 1), bool), np.zeros((len(below), width), bool)
        right[:len(below)] = below
        right[len(right) - len(above):] |= above
        down[:, :-1] = below
        down[:, 1:] |= below
        return right, down

    return _areas(links, height, width)


def cell_components(cells: np.ndarray, values: np.ndarray, stride: int) -> np.ndarray:
    """Number the connected areas of equal values among some pixels of a picture, corners included.

    Parameters
    ----------
    cells : ndarray of shape (n,)
        Numbers of the pixels, rising, in a picture with a rim.
    values : ndarray of shape (n,)
    stride : int
        Step from a pixel to the one below it.

    Returns
    -------
    ndarray of shape (n,) and dtype int32
        Component of each pixel, numbered from 0 in reading order.
    """
    edges = [(np.zeros(0, np.intp), np.zeros(0, np.intp))]
    for step in (1, stride - 1, stride, stride + 1):
        place = next_among(cells, step)
        near = np.flatnonzero((place >= 0) & (values[place] == values))
        edges.append((near, place[near]))
    return components(cells.size, *(np.concatenate(ends) for ends in zip(*edges)))


def places_among(cells: np.ndarray, aims: np.ndarray) -> np.ndarray:
    """The places of some pixels among others, which rise and hold at least one; -1 for those that are none of them."""
    place = np.searchsorted(cells, aims)
    place[place == cells.size] = 0
    place[cells[place] != aims] = -1
    return np.asarray(place)


def next_among(cells: np.ndarray, step: int) -> np.ndarray:
    """For each of some pixels, rising, the place among them of the one that is a step farther, -1 if it's none."""
    return places_among(cells, cells + cells.dtype.type(step)) if cells.size else np.zeros(0, np.intp)


def label_components(labels: np.ndarray, connectivity: int = 4) -> np.ndarray:
    """Number the connected areas of equal labels.

    Parameters
    ----------
    labels : ndarray of shape (H, W)
    connectivity : {4, 8}
        Whether pixels that touch only at a corner are neighbours (8).

    Returns
    -------
    ndarray of shape (H, W) and dtype int32
        Component of each pixel, numbered from 0 in reading order.
    """
    if connectivity not in (4, 8):
        raise ValueError(f"connectivity must be 4 or 8, not {connectivity!r}")
    right = labels[:, 1:] == labels[:, :-1]
    down = labels[1:] == labels[:-1]
    if connectivity == 4:
        return link_components(right, down)
    return link_components(right, down, labels[1:, 1:] == labels[:-1, :-1],
                           labels[1:, :-1] == labels[:-1, 1:])
