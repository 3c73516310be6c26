# SPDX-License-Identifier: GPL-2.0-or-later
"""Least-squares cubics for many ranges of points at once.

Every candidate is a range of points; its sums and its largest error come from
`reduceat`, so each candidate answers to *all* the points it replaces.  The
handles are found as by Schneider, "An algorithm for automatically fitting
digitized curves", Graphics Gems, 1990.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from . import bezier

LINE_SHARE = 0.6
"""A chord serves as a line if its points stray no further than this share of the tolerance."""


SLIDE = 0.2
"""How much a distance along the curve counts against one across it."""

NEAR = 3.0
"""A cubic that misses the tolerance by no more than this factor may fit after more rounds."""


class Fit(NamedTuple):
    """Candidate segments and how well they fit.

    Attributes
    ----------
    control : ndarray of shape (M, 4, 2)
    line : ndarray of shape (M,) and dtype bool
    error : ndarray of shape (M,)
        Largest distance of a replaced point, px.
    worst : ndarray of shape (M,) and dtype int64
        Number of that point; -1 where a candidate replaces none.
    """

    control: np.ndarray
    line: np.ndarray
    error: np.ndarray
    worst: np.ndarray


class Ends(NamedTuple):
    """Where candidates begin and end.

    Attributes
    ----------
    point : ndarray of shape (M, 2, 2)
        Position at the beginning and at the end.
    tangent : ndarray of shape (M, 2, 2)
        Unit vectors that point into the segment, at the beginning and at the end.
    smooth : ndarray of shape (M, 2) and dtype bool
        Whether the tangent must be kept, because the curve goes on smoothly.
    """

    point: np.ndarray
    tangent: np.ndarray
    smooth: np.ndarray


def fit_candidates(points: np.ndarray, weight: np.ndarray, first: np.ndarray, last: np.ndarray,
                   ends: Ends, tolerance: np.ndarray) -> Fit:
    """Fit one cubic, or a line where that will do, to each range of points.

    Parameters
    ----------
    points : ndarray of shape (N, 2)
    weight : ndarray of shape (N,)
    first, last : ndarray of shape (M,) and dtype int64
        Candidate k replaces ``points[first[k]:last[k]]``, its ends not among them.
    ends : Ends
    tolerance : ndarray of shape (M,)
        px; decides between lines and cubics.

    Returns
    -------
    Fit
    """
    index, owner, heads = _ranges(first, last)
    target = points[index]
    line_error, line_worst = _worst(_line_distance(target, ends, owner), index, owner, heads, len(first))
    line = line_error < LINE_SHARE * tolerance
    control = bezier.from_line(ends.point[:, 0], ends.point[:, 1])
    curved = np.flatnonzero(~line)
    # A few rounds show what can't fit; what comes near is given more.
    for rounds in (3, 6):
        if not len(curved):
            break
        fitted = _fit(points, weight, first[curved], last[curved], Ends(*(part[curved] for part in ends)), rounds)
        control[curved], line_error[curved], line_worst[curved] = fitted
        error = line_error[curved]
        curved = curved[(error > tolerance[curved]) & (error < NEAR * tolerance[curved])]
    return Fit(control, line, line_error, line_worst)


def _fit(points: np.ndarray, weight: np.ndarray, first: np.ndarray, last: np.ndarray, ends: Ends,
         rounds: int) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cubics, their largest errors and the points that have them; handles and parameters in turn."""
    index, owner, heads = _ranges(first, last)
    target, w = points[index], weight[index]
    t = _chord_parameters(target, ends, owner, heads)
    metric = np.broadcast_to(np.eye(2), (len(t), 2, 2))
    for _ in range(rounds):
        fitted = _solve(target, w, t, owner, heads, ends, metric)
        t = bezier.reproject(fitted, owner, t, target)
        metric = _across(bezier.derivative(fitted, owner, t))
    away = bezier.evaluate(fitted, owner, t) - target
    return (fitted, *_worst(np.hypot(away[:, 0], away[:, 1]), index, owner, heads, len(first)))


def _across(tangent: np.ndarray) -> np.ndarray:
    """Axes (N, 2, 2) that measure distances across the curve, and little of those along it.

    A point may slide along the curve: with that left out, handles and parameters
    converge together (tangent distance; Wang, Pottmann and Liu, "Fitting B-spline
    curves to point clouds by curvature-based squared distance minimization", ACM TOG
    25, 2006).
    """
    along = tangent / np.maximum(np.hypot(*tangent.T), 1e-9)[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=1)
    return np.stack([across, SLIDE * along], axis=1)


def _ranges(first: np.ndarray, last: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """All indices of the ranges one after the other, the range of each, where each range begins."""
    count = last - first
    heads = np.cumsum(count) - count
    owner = np.repeat(np.arange(len(first)), count)
    return np.arange(len(owner)) + (first - heads)[owner], owner, heads


def _worst(distance: np.ndarray, index: np.ndarray, owner: np.ndarray, heads: np.ndarray,
           m: int) -> Tuple[np.ndarray, np.ndarray]:
    """Largest distance per range and the point that has it; 0 and -1 for empty ranges."""
    error, worst = np.zeros(m), np.full(m, -1, np.int64)
    filled = np.zeros(m, bool)
    filled[owner] = True
    if len(index):
        error[filled] = np.maximum.reduceat(distance, heads[filled])
        at = np.flatnonzero(distance == error[owner])
        worst[owner[at[::-1]]] = index[at[::-1]]
    return error, worst


def _line_distance(target: np.ndarray, ends: Ends, owner: np.ndarray) -> np.ndarray:
    """Distance of points from the chord of their candidate."""
    start, chord = ends.point[:, 0], ends.point[:, 1] - ends.point[:, 0]
    away = target - start[owner]
    square = np.maximum(np.einsum("md,md->m", chord, chord), 1e-12)[owner]
    along = np.clip(np.einsum("nd,nd->n", away, chord[owner]) / square, 0, 1)
    away -= along[:, None] * chord[owner]
    return np.hypot(away[:, 0], away[:, 1])


def _chord_parameters(target: np.ndarray, ends: Ends, owner: np.ndarray, heads: np.ndarray) -> np.ndarray:
    """First guess of t: the share of the way along the polyline."""
    previous = np.empty_like(target)
    previous[1:] = target[:-1]
    filled = np.unique(owner)
    previous[heads[filled]] = ends.point[filled, 0]
    piece = np.hypot(*(target - previous).T)
    walked = np.cumsum(piece)
    before = walked[heads[filled]] - piece[heads[filled]]
    tails = np.append(heads[filled][1:], len(target)) - 1
    base, whole = np.zeros(len(heads)), np.ones(len(heads))
    base[filled] = before
    whole[filled] = walked[tails] - before + np.hypot(*(ends.point[filled, 1] - target[tails]).T)
    return (walked - base[owner]) / np.maximum(whole, 1e-9)[owner]


def _solve(target: np.ndarray, weight: np.ndarray, t: np.ndarray, owner: np.ndarray, heads: np.ndarray,
           ends: Ends, metric: np.ndarray) -> np.ndarray:
    """Least-squares handles: each a length along its tangent, and a little across at free ends."""
    m = len(heads)
    b = bezier.basis(t)
    chord = np.maximum(np.hypot(*(ends.point[:, 1] - ends.point[:, 0]).T), 1e-6)
    fixed = (b[:, :2].sum(1)[:, None] * ends.point[owner, 0] + b[:, 2:].sum(1)[:, None] * ends.point[owner, 1])
    rest = np.einsum("nkd,nd->nk", metric, target - fixed)
    across = np.stack([-ends.tangent[..., 1], ends.tangent[..., 0]], axis=-1)
    frame = np.stack([ends.tangent[:, 0], across[:, 0], ends.tangent[:, 1], across[:, 1]], axis=1)
    columns = np.einsum("nkd,njd->njk", metric, frame[owner]) * b[:, [1, 1, 2, 2], None]
    normal, right = np.zeros((m, 4, 4)), np.zeros((m, 4))
    filled = np.unique(owner)
    weighted = columns * weight[:, None, None]
    for i in range(4):
        right[filled, i] = np.add.reduceat(np.einsum("nd,nd->n", weighted[:, i], rest), heads[filled])
        for j in range(i, 4):
            normal[filled, i, j] = normal[filled, j, i] = np.add.reduceat(
                np.einsum("nd,nd->n", weighted[:, i], columns[:, j]), heads[filled])
    # A weak pull to a third of the chord settles what the points leave open.
    pull = 0.02
    for end in (0, 1):
        normal[:, 2 * end, 2 * end] += pull
        right[:, 2 * end] += pull * chord / 3
        normal[:, 2 * end + 1, 2 * end + 1] += np.where(ends.smooth[:, end], 1e6, 0.03)
    handle = np.linalg.solve(normal, right[..., None])[..., 0]
    for end in (0, 1):
        length = handle[:, 2 * end]
        wild = (length < 0.03 * chord) | (length > 1.6 * chord)
        handle[wild, 2 * end] = chord[wild] / 3
        handle[wild, 2 * end + 1] = 0
    control = np.empty((m, 4, 2))
    control[:, 0], control[:, 3] = ends.point[:, 0], ends.point[:, 1]
    for end, slot in ((0, 1), (1, 2)):
        control[:, slot] = ends.point[:, end] + np.einsum(
            "mk,mkd->md", handle[:, 2 * end:2 * end + 2], frame[:, 2 * end:2 * end + 2])
    return control
