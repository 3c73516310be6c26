# SPDX-License-Identifier: GPL-2.0-or-later
"""Lawson's edge flips with look-ahead, many at a time (paper, section III).

An edge is flipped if that lowers the total cost of the mesh; with look-ahead, it is also
flipped together with one of the four sides round it.  The letters are those of the diagram
in `ribbon`.

This goes in *rounds*: first all gains are computed, then all flips done that don't disturb
each other.  The gain of a flip depends on the triangles it changes, its *core*, and on their
neighbours.  Flips are ranked by gain; one wins if it has the highest rank of all whose cores
touch or neighbour its own.  The cores of two winners are neither equal nor adjacent, so
their gains add exactly and the total cost falls with every round; as there are finitely many
triangulations, the rounds end.
"""

from __future__ import annotations

from typing import Iterator, NamedTuple, Tuple

import numpy as np

from .ribbon import (
    Corners,
    Ribbon,
    corners,
    edges_of,
    flip_edges,
    flippable,
    flipped_planes,
    following,
    one_each,
    preceding,
    sides,
    with_neighbours,
)

LEAST_GAIN = 1e-3
"""Smaller gains count as none: costs are squared levels, this is a rounding error."""

SINGLE, PAIR = 5, 7
"""How many edges change their cost in a flip, and in a pair of flips."""

_BLOCK = 1 << 13
"""Edges looked at together, so that what is computed stays in the processor's cache."""


def flip_rounds(ribbon: Ribbon, budget: int, look_ahead: bool = False) -> Iterator[int]:
    """Flip edges, round by round, until no flip lowers the cost.

    Parameters
    ----------
    ribbon : Ribbon
        Changed in place.
    budget : int
        How many edge costs may be computed in all.  If more are needed, the rounds end
        early and ``ribbon.finished`` becomes False.
    look_ahead : bool
        Also flip pairs of edges, until no pair lowers the cost either.

    Yields
    ------
    int
        Edges flipped in the round, at least 1.
    """
    price = SINGLE + 4 * PAIR * look_ahead
    edges = edges_of(ribbon, np.arange(ribbon.outside))
    while len(edges) and ribbon.finished:
        affordable = max(0, budget - ribbon.work) // price
        if affordable < len(edges):
            ribbon.finished = False
            edges = edges[:affordable]
        gains, second = best_flips(ribbon, edges, look_ahead)
        gaining = np.flatnonzero(gains > LEAST_GAIN)
        gains, edges, second = gains[gaining], edges[gaining], second[gaining]
        core, around = _patches(ribbon, edges, second)
        wins = _winners(ribbon, gains, edges, core, around)
        flipped = _flip(ribbon, edges[wins], second[wins])
        if flipped:
            yield flipped
        stale = with_neighbours(ribbon, core[:, wins].ravel())
        if look_ahead:
            stale = with_neighbours(ribbon, stale)
        edges = one_each(ribbon, np.concatenate([edges[~wins], edges_of(ribbon, stale)]))


def best_flips(ribbon: Ribbon, edges: np.ndarray, look_ahead: bool) -> Tuple[np.ndarray, np.ndarray]:
    """The best flip, or pair of flips, for each edge.

    Parameters
    ----------
    ribbon : Ribbon
    edges : ndarray of shape (n,) and dtype int64
        One half-edge each.
    look_ahead : bool
        Whether to think of pairs.

    Returns
    -------
    gains : ndarray of shape (n,) and dtype float64
        What the total cost falls by; -inf where no flip is possible.
    second : ndarray of shape (n,) and dtype int64
        The side to flip as well, a row of `pair_gains`; -1 for none.
    """
    gains, second = np.empty(len(edges)), np.full(len(edges), -1)
    for start in range(0, len(edges), _BLOCK):
        block = slice(start, start + _BLOCK)
        gains[block] = single_gains(ribbon, edges[block])
        if look_ahead:
            pairs = pair_gains(ribbon, edges[block])
            best = pairs.max(axis=0)
            better = best > np.maximum(gains[block], 0) + LEAST_GAIN
            gains[block][better] = best[better]
            second[block][better] = pairs.argmax(axis=0)[better]
    return gains, second


def single_gains(ribbon: Ribbon, edges: np.ndarray) -> np.ndarray:
    """What the total cost falls by if an edge is flipped.

    Parameters
    ----------
    ribbon : Ribbon
    edges : ndarray of shape (n,) and dtype int64
        One half-edge each.

    Returns
    -------
    ndarray of shape (n,) and dtype float64
        Squared levels; -inf where the edge cannot be flipped.
    """
    gains = np.full(len(edges), -np.inf)
    able, around = flippable(ribbon, corners(ribbon, edges))
    gains[able] = 0
    creased = _creased(ribbon.planes_of(edges[able]), ribbon.planes_of(ribbon.twins[edges[able]]))
    able, around = able[creased], tuple(vertices[creased] for vertices in around)
    now = _look(ribbon, edges[able], around)
    b, m, c, n = now.beyond
    between = ribbon.cost.between
    gains[able] = now.cost - between(now.t_flipped, now.u_flipped + b + m) - between(now.u_flipped, c + n)
    ribbon.work += SINGLE * len(able)
    return gains


def pair_gains(ribbon: Ribbon, edges: np.ndarray) -> np.ndarray:
    """What the total cost falls by if an edge is flipped and then one of the sides round it.

    Parameters
    ----------
    ribbon : Ribbon
    edges : ndarray of shape (n,) and dtype int64
        One half-edge each.

    Returns
    -------
    ndarray of shape (4, n) and dtype float64
        Gains with the sides b, m, c and n as second edges; -inf where impossible, or where
        the second flip would change nothing as its triangles are coplanar.
    """
    gains = np.full((4, len(edges)), -np.inf)
    first, around = flippable(ribbon, corners(ribbon, edges))
    now = _look(ribbon, edges[first], around)
    p, q, r, s = around
    # The diagram holds for the second flip too: its p and q are the ends of the side, its r
    # completes the flipped triangle, its s lies behind the side.
    ends = ((r, p, s), (p, s, r), (s, q, r), (q, r, s))
    for side, half_edges in enumerate(sides(ribbon, edges[first])):
        behind = ribbon.twins[half_edges]
        able, second = flippable(ribbon, ends[side] + (ribbon.origins[preceding(behind)],))
        near = (now.t_flipped if side < 2 else now.u_flipped)
        creased = _creased(near.take(able, axis=1), now.beyond[side].take(able, axis=1))
        able, second = able[creased], tuple(vertices[creased] for vertices in second)
        after = _cost_of_pair(ribbon, now, side, able, behind[able], second)
        gains[side, first[able]] = now.cost[able] - after
        ribbon.work += PAIR * len(able)
    return gains


class _View(NamedTuple):
    """What is seen round edges: planes of t and u, before and after a flip, and beyond the sides.

    `cost` is that of the edge and the four sides now.
    """

    t_flipped: np.ndarray
    u_flipped: np.ndarray
    beyond: Tuple[np.ndarray, ...]
    cost: np.ndarray


def _look(ribbon: Ribbon, edges: np.ndarray, around: Corners) -> _View:
    t, u = ribbon.planes_of(edges), ribbon.planes_of(ribbon.twins[edges])
    b, m, c, n = (ribbon.planes_of(ribbon.twins[side]) for side in sides(ribbon, edges))
    cost = ribbon.cost.between(t, u + b + n) + ribbon.cost.between(u, m + c)
    return _View(*flipped_planes(ribbon, t, u, around), (b, m, c, n), cost)


def _creased(planes: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Where two planes differ: elsewhere a flip changes nothing."""
    return np.flatnonzero((planes != others).any(axis=0))


def _cost_of_pair(ribbon: Ribbon, now: _View, side: int, edge: np.ndarray, behind: np.ndarray,
                  around: Corners) -> np.ndarray:
    """Cost of the seven edges after both flips, less that of the two behind the side now.

    Parameters
    ----------
    side : int
        The second edge: 0 to 3 for b, m, c, n.
    edge : ndarray of shape (k,) and dtype int64
        Index of the first edge in `now`.
    behind : ndarray of shape (k,) and dtype int64
        Twin of the second edge.
    around : Corners
        Of the second flip.
    """
    near, far = now.t_flipped, now.u_flipped
    if side >= 2:
        near, far = far, near
    near, far, third, beside, opposite, diagonal = (planes.take(edge, axis=1) for planes in (
        near, far, *(now.beyond[side ^ k] for k in range(4))))
    t, u = flipped_planes(ribbon, near, third, around)
    # Beyond m and c of the second flip nothing has changed; of b and n one is the first edge.
    m, c = (ribbon.planes_of(ribbon.twins[h]) for h in (following(behind), preceding(behind)))
    b, n = (far, beside) if side in (0, 2) else (beside, far)
    between = ribbon.cost.between
    cost: np.ndarray = (between(t, u + b + m) + between(u, c + n) + between(far, opposite + diagonal)
                        - between(third, m + c))
    return cost


def _patches(ribbon: Ribbon, edges: np.ndarray, second: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Triangles that flips change, (2 or 3, n), and those around them, (4 or 6, n)."""
    rounds = np.stack(sides(ribbon, edges))
    core, around = [edges, ribbon.twins[edges]], list(ribbon.twins[rounds])
    if (second >= 0).any():
        behind = ribbon.twins[np.where(second < 0, edges, rounds[second, np.arange(len(edges))])]
        core.append(behind)
        around += [ribbon.twins[following(behind)], ribbon.twins[preceding(behind)]]
    return np.stack(core) // 3, np.stack(around) // 3


def _winners(ribbon: Ribbon, gains: np.ndarray, edges: np.ndarray, core: np.ndarray,
             around: np.ndarray) -> np.ndarray:
    """Which flips have the highest rank near them, bool (n,)."""
    # Equal gains along a straight boundary must not wait for each other, so a millionth of each
    # is left to chance: to the middle of the edge, which no flip moves.
    middle = ribbon.origins[edges] + ribbon.origins[ribbon.twins[edges]]
    chance = (middle * 2654435761 & 0xFFFFFFFF) / 2.0 ** 32
    order = np.argsort(gains * (1 + 1e-6 * chance), kind="stable")
    rank = np.empty(len(gains), np.int64)
    rank[order] = np.arange(1, len(gains) + 1)
    # Of the ranks written to one triangle the last one, the highest, stays.
    board = np.zeros(ribbon.outside + 1, np.int64)
    board[core[:, order].T] = rank[order][:, np.newaxis]
    highest = np.maximum(board[core].max(axis=0), board[around].max(axis=0))
    return np.asarray(highest == rank)


def _flip(ribbon: Ribbon, edges: np.ndarray, second: np.ndarray) -> int:
    """Flip edges, and then the sides of theirs that are not -1; returns how many in all."""
    b, _, c, _ = sides(ribbon, edges)
    # The sides m and n have become the half-edges that the edge and its twin have been.
    moved = np.stack([b, edges, c, ribbon.twins[edges]])
    pairs = np.flatnonzero(second >= 0)
    flip_edges(ribbon, edges)
    flip_edges(ribbon, moved[second[pairs], pairs])
    return len(edges) + len(pairs)
