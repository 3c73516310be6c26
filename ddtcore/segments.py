# SPDX-License-Identifier: GPL-2.0-or-later
"""Runs of points become segments: split where one misses its points, merged where one serves for two.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from .cubic import Ends, Fit, Track, fit_candidates
from .runs import Runs, end_lines, parabolas

HALVED = 4.0
"""A piece that misses its tolerance by less than this factor is parted in its middle, others where they miss most."""


class Segments(NamedTuple):
    """The segments of all runs, in order.

    Attributes
    ----------
    run : ndarray of shape (S,) and dtype int64
    first, last : ndarray of shape (S,) and dtype int64
        The points each segment replaces.
    ends : Ends
    fit : Fit
    """

    run: np.ndarray
    first: np.ndarray
    last: np.ndarray
    ends: Ends
    fit: Fit


def fit_runs(runs: Runs, tolerance: np.ndarray) -> Segments:
    """Fit each run with as few segments as the tolerance allows.

    Parameters
    ----------
    runs : Runs
    tolerance : ndarray of shape (R,)
        Of each run, px.

    Returns
    -------
    Segments
    """
    track = Track.of(runs.points, runs.weight)
    return merge(track, _split(runs, track, _whole(runs), tolerance), tolerance)


def _whole(runs: Runs) -> Tuple[np.ndarray, np.ndarray, np.ndarray, Ends]:
    """One candidate for each whole run."""
    point, tangent, _ = end_lines(runs)
    point = runs.places[runs.knots]
    smooth = np.repeat(runs.smooth[:, None], 2, axis=1)
    ring = np.flatnonzero(runs.smooth)
    middle = (runs.low[ring] + runs.high[ring]) // 2
    place, direction = _node(runs, middle, runs.low[ring], runs.high[ring])
    point[ring] = place[:, None]
    tangent[ring] = np.stack([direction, -direction], axis=1)
    return np.arange(len(runs.arc)), runs.first, runs.last, Ends(point, tangent, smooth)


def _node(runs: Runs, at: np.ndarray, low: np.ndarray, high: np.ndarray,
          reach: int = 4) -> Tuple[np.ndarray, np.ndarray]:
    """Position and unit tangent at points `at`, from a parabola through their neighbours."""
    index = at[:, None] + np.arange(-reach, reach + 1)
    valid = (index >= low[:, None]) & (index < high[:, None])
    index = np.clip(index, 0, len(runs.points) - 1)
    side = parabolas(runs.points.take(index, axis=0), np.where(valid, runs.weight[index], 0), 0.05, reach)
    tangent = side[:, 1]
    return side[:, 0], tangent / np.maximum(np.hypot(*tangent.T), 1e-9)[:, None]


def _split(runs: Runs, track: Track, whole: Tuple[np.ndarray, np.ndarray, np.ndarray, Ends],
           tolerance: np.ndarray) -> Segments:
    """Split runs where they miss their points, until all are met."""
    run, first, last, ends = whole
    done = []
    while len(run):
        fit = fit_candidates(track, first, last, ends, tolerance[run])
        bad = (fit.error > tolerance[run]) & (last - first >= 3)
        done.append(_take(Segments(run, first, last, ends, fit), ~bad))
        run, first, last, ends, fit = _take(Segments(run, first, last, ends, fit), bad)
        margin = np.minimum(3, (last - first - 1) // 2)
        # The error of a smooth piece that nearly fits swings: the middle parts it evenly, a crest of it does not.
        near = fit.error < HALVED * tolerance[run]
        at = np.clip(np.where(near, (first + last) // 2, fit.worst), first + margin, last - 1 - margin)
        place, tangent = _node(runs, at, runs.low[run], runs.high[run])
        before, after = _cut(ends, place, tangent)
        run = np.concatenate([run, run])
        first, last = np.concatenate([first, at + 1]), np.concatenate([at, last])
        ends = Ends(*(np.concatenate(pair) for pair in zip(before, after)))
    segments = _join(done)
    return _take(segments, np.lexsort((segments.last, segments.first, segments.run)))


def _cut(ends: Ends, place: np.ndarray, tangent: np.ndarray) -> Tuple[Ends, Ends]:
    """Ends of the two parts of segments that are cut at a smooth node."""
    m = len(place)
    yes = np.ones(m, bool)
    before = Ends(np.stack([ends.point[:, 0], place], axis=1), np.stack([ends.tangent[:, 0], -tangent], axis=1),
                  np.stack([ends.smooth[:, 0], yes], axis=1))
    after = Ends(np.stack([place, ends.point[:, 1]], axis=1), np.stack([tangent, ends.tangent[:, 1]], axis=1),
                 np.stack([yes, ends.smooth[:, 1]], axis=1))
    return before, after


def merge(track: Track, segments: Segments, tolerance: np.ndarray) -> Segments:
    """Merge neighbours of one run where a single curve serves both, best first.

    Parameters
    ----------
    track : Track
        What the segments' `first` and `last` are points of.
    segments : Segments
    tolerance : ndarray of shape (R,)
        Of each run, px.

    Returns
    -------
    Segments
    """
    refused = np.zeros(len(segments.run), bool)
    while True:
        left = np.flatnonzero((segments.run[1:] == segments.run[:-1]) & ~refused[:-1])
        if not len(left):
            return segments
        ends = _union(segments.ends, left)
        allowed = tolerance[segments.run[left]]
        fit = fit_candidates(track, segments.first[left], segments.last[left + 1], ends, allowed)
        good = fit.error <= allowed
        refused[left[~good]] = True
        price = np.full(len(segments.run) + 1, np.inf)
        price[left[good]] = fit.error[good]
        best = good & (price[left] < price[left - 1]) & (price[left] <= price[left + 1])
        if not best.any():
            return segments
        keep = np.ones(len(segments.run), bool)
        keep[left[best] + 1] = False
        for part, value in zip(segments.fit, fit):
            part[left[best]] = value[best]
        for part, value in zip(segments.ends, ends):
            part[left[best]] = value[best]
        segments.last[left[best]] = segments.last[left[best] + 1]
        # What was refused may fit now that one side has changed: ask again.
        refused[np.maximum(left[best] - 1, 0)] = False
        refused[left[best]] = False
        segments, refused = _take(segments, keep), refused[keep]


def _union(ends: Ends, left: np.ndarray) -> Ends:
    return Ends(*(np.stack([part[left, 0], part[left + 1, 1]], axis=1) for part in ends))


def _take(segments: Segments, which: np.ndarray) -> Segments:
    return Segments(segments.run[which], segments.first[which], segments.last[which],
                    Ends(*(part[which] for part in segments.ends)), Fit(*(part[which] for part in segments.fit)))


def _join(parts: List[Segments]) -> Segments:
    def cat(which: List[np.ndarray]) -> np.ndarray:
        return np.concatenate(which)

    return Segments(cat([p.run for p in parts]), cat([p.first for p in parts]), cat([p.last for p in parts]),
                    Ends(*(cat(list(f)) for f in zip(*(p.ends for p in parts)))),
                    Fit(*(cat(list(f)) for f in zip(*(p.fit for p in parts)))))
