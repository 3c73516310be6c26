# SPDX-License-Identifier: GPL-2.0-or-later
"""Least-squares cubics for many ranges of points at once.

Each candidate, a range of points, is fitted to evenly chosen samples of them; what
serves the samples then answers to *all* the points it replaces.  The handles are
found as by Schneider, "An algorithm for automatically fitting digitized curves",
Graphics Gems, 1990, with distances taken across the curve (Wang, Pottmann and Liu,
"Fitting B-spline curves to point clouds by curvature-based squared distance
minimization", ACM TOG 25, 2006): a point may slide along it, so that handles and
parameters converge together.  Inside, points are complex numbers x + iy.
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

SAMPLES = 32
"""Points of a candidate that its handles are fitted to."""

BATCH = 1024
"""Candidates fitted at a time: what fits a processor's cache."""

PULL = 0.02
"""Weight of a third of the chord as the length of a handle, which settles what points leave open."""


_PAIRS, _SIGNS = [1, 0, 3, 2, 5], np.array([1, -1, 1, -1, 1])
"""How a quarter turn changes the parts across and along of two handles and of what is left to explain."""


class Fit(NamedTuple):
    """Candidate segments and how well they fit.

    Attributes
    ----------
    control : ndarray of shape (M, 4, 2)
    line : ndarray of shape (M,) and dtype bool
    error : ndarray of shape (M,)
        Largest distance of a replaced point, px; of those tried, where it is beyond the tolerance.
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


class Track(NamedTuple):
    """Points that candidates are ranges of.

    Attributes
    ----------
    place : ndarray of shape (N,) and dtype complex128
    weight : ndarray of shape (N,)
    walked : ndarray of shape (N,)
        Way along the points.
    """

    place: np.ndarray
    weight: np.ndarray
    walked: np.ndarray

    @classmethod
    def of(cls, points: np.ndarray, weight: np.ndarray) -> "Track":
        """The track of points (N, 2) with weights (N,)."""
        place = _complex(points)
        return cls(place, weight, np.cumsum(np.abs(np.diff(place, prepend=place[:1]))))


def fit_candidates(track: Track, first: np.ndarray, last: np.ndarray, ends: Ends, tolerance: np.ndarray) -> Fit:
    """Fit one cubic, or a line where that will do, to each range of points.

    Parameters
    ----------
    track : Track
    first, last : ndarray of shape (M,) and dtype int64
        Candidate k replaces the points from ``first[k]`` to ``last[k]``, its ends not among them.
    ends : Ends
    tolerance : ndarray of shape (M,)
        px; decides between lines and cubics.

    Returns
    -------
    Fit
    """
    control = bezier.from_line(ends.point[:, 0], ends.point[:, 1])
    fit = Fit(control, np.ones(len(first), bool), np.zeros(len(first)), np.full(len(first), -1, np.int64))
    some = np.flatnonzero(last > first)
    for k in range(0, len(some), BATCH):
        part = some[k:k + BATCH]
        spans = _spans(track, first[part], last[part], Ends(*(of[part] for of in ends)))
        handles, fit.line[part], fit.error[part], fit.worst[part] = _fit_spans(track, spans, tolerance[part])
        curved = ~fit.line[part]
        inner = (np.concatenate([spans.start, spans.end], axis=1) + handles)[curved]
        control[part[curved], 1:3] = np.stack([inner.real, inner.imag], axis=-1)
    return fit


class _Spans(NamedTuple):
    """Candidates and samples of their points."""

    first: np.ndarray        # (M,)
    last: np.ndarray         # (M,)
    start: np.ndarray        # (M, 1) complex
    end: np.ndarray          # (M, 1) complex
    tangent: np.ndarray      # (M, 2) complex
    smooth: np.ndarray       # (M, 2)
    index: np.ndarray        # type: ignore[assignment]  # (M, K) numbers of the samples
    place: np.ndarray        # (M, K) complex
    weight: np.ndarray       # (M, K)
    share: np.ndarray        # (M, K) of the way from start to end


def _take(spans: _Spans, which: np.ndarray) -> _Spans:
    return _Spans(*(part[which] for part in spans))


def _spans(track: Track, first: np.ndarray, last: np.ndarray, ends: Ends) -> _Spans:
    """Candidates with their samples; one of few points repeats its last, for no weight."""
    count = (last - first)[:, None]
    few = min(SAMPLES, int(count.max()))
    k = np.arange(few)
    offset = np.where(count <= few, k, (2 * k + 1) * count // (2 * few))
    index = first[:, None] + np.minimum(offset, count - 1)
    start, end = _complex(ends.point).T[..., None]
    before = np.abs(track.place[first][:, None] - start)
    walked = before + track.walked[index] - track.walked[first][:, None]
    whole = before + np.abs(end - track.place[last - 1][:, None])
    whole += (track.walked[last - 1] - track.walked[first])[:, None]
    return _Spans(first, last, start, end, _complex(ends.tangent), ends.smooth, index, track.place[index],
                  np.where(offset < count, track.weight[index], 0), walked / np.maximum(whole, 1e-9))


def _fit_spans(track: Track, spans: _Spans, tolerance: np.ndarray) -> Tuple[np.ndarray, ...]:
    """Handles (M, 2), whether they make a line, largest errors and the points that have them."""
    third = (spans.end - spans.start) / 3
    handles = np.concatenate([third, -third], axis=1)
    error, worst = _judge(track, spans, handles, spans.share, LINE_SHARE * tolerance)
    line = error <= LINE_SHARE * tolerance
    curved = np.flatnonzero(~line)
    part, t = _take(spans, curved), spans.share[curved]
    # A few rounds show what can't fit; what comes near is given more.
    for rounds in (2, 4):
        if not len(curved):
            break
        handles[curved], t = _fit(part, t, rounds)
        error[curved], worst[curved] = _judge(track, part, handles[curved], t, tolerance[curved])
        near = (error[curved] > tolerance[curved]) & (error[curved] < NEAR * tolerance[curved])
        curved, part, t = curved[near], _take(part, near), t[near]
    return handles, line, error, worst


def _judge(track: Track, spans: _Spans, handles: np.ndarray, t: np.ndarray,
           limit: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Largest distance, of all points where the samples are within the limit, and the point that has it."""
    power = _powers(spans, handles)
    t = _project(power, t, spans.place)
    away = np.abs(_along(power, t) - spans.place)
    row, at = np.arange(len(away)), away.argmax(axis=1)
    error, worst = away[row, at], spans.index[row, at]
    count = spans.last - spans.first
    asked = np.flatnonzero((error <= limit) & (count > t.shape[1]))
    if len(asked):
        heads = np.cumsum(count[asked]) - count[asked]
        owner = np.repeat(asked, count[asked])
        offset = np.arange(len(owner)) - np.repeat(heads, count[asked])
        place, power = track.place[spans.first[owner] + offset], power[:, owner, 0]
        all_t = _project(power, _between(t, owner, (offset + 0.5) * t.shape[1] / count[owner] - 0.5), place)
        away = np.abs(_along(power, all_t) - place)
        error[asked] = np.maximum.reduceat(away, heads)
        at = np.flatnonzero(away == error[owner])[::-1]
        worst[owner[at]] = spans.first[owner[at]] + offset[at]
    return error, worst


def _between(t: np.ndarray, row: np.ndarray, column: np.ndarray) -> np.ndarray:
    """Parameters between those of samples, by fractional column."""
    left = np.clip(np.floor(column).astype(np.int64), 0, t.shape[1] - 2)
    before = t[row, left]
    return np.asarray(np.clip(before + (column - left) * (t[row, left + 1] - before), 0, 1))


def _fit(spans: _Spans, t: np.ndarray, rounds: int) -> Tuple[np.ndarray, np.ndarray]:
    """Handles (M, 2) and parameters of the samples, each in turn."""
    handles = _solve(spans, t, np.ones((1, 1), complex), 1.0)
    for left in range(rounds - 1, -1, -1):
        power = _powers(spans, handles)
        t = _project(power, t, spans.place)
        if left:
            slope = power[1] + t * (2 * power[2] + 3 * t * power[3])
            handles = _solve(spans, t, slope.conj() / np.maximum(np.abs(slope), 1e-9), SLIDE)
    return handles, t


def _powers(spans: _Spans, handles: np.ndarray) -> np.ndarray:
    """Coefficients (4, M, 1) of 1, t, t² and t³."""
    chord = spans.end - spans.start
    begin, end = handles[:, :1], handles[:, 1:]
    return np.stack([spans.start, 3 * begin, 3 * (chord + end - 2 * begin), 3 * (begin - end) - 2 * chord])


def _along(power: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Points of the curves."""
    return np.asarray(power[0] + t * (power[1] + t * (power[2] + t * power[3])))


def _project(power: np.ndarray, t: np.ndarray, place: np.ndarray) -> np.ndarray:
    """One Newton step of each parameter towards the foot of the perpendicular from its point."""
    steep, step = _fall(power.real, t, place.real)
    for part, more in zip((steep, step), _fall(power.imag, t, place.imag)):
        part += more
    steep[steep <= 1e-9] = np.inf
    step /= steep
    return _clipped(t - _clipped(step, -0.2, 0.2), 0.0, 1.0)


def _fall(power: np.ndarray, t: np.ndarray, place: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Second and first derivative of half the squared distance in one coordinate; in place, as arrays are large."""
    away = t * power[3]
    bend = 3 * away
    slope = bend + 2 * power[2]
    away += power[2]
    for part, lower in ((away, power[1]), (away, power[0]), (slope, power[1])):
        part *= t
        part += lower
    away -= place
    bend += bend
    bend += 2 * power[2]
    bend *= away
    away *= slope
    slope *= slope
    slope += bend
    return slope, away


def _clipped(value: np.ndarray, low: float, high: float) -> np.ndarray:
    np.minimum(value, high, out=value)
    return np.asarray(np.maximum(value, low, out=value))


def _solve(spans: _Spans, t: np.ndarray, turn: np.ndarray, slide: float) -> np.ndarray:
    """Least-squares handles (M, 2): each a length along its tangent, and a little across at free ends.

    `turn` brings the direction of the curve at each sample to the real axis.
    """
    s, m = 1 - t, len(t)
    lead = turn * np.sqrt(spans.weight)
    rest = lead * (spans.place - spans.end + s * s * (1 + 2 * t) * (spans.end - spans.start))
    begin, end = 3 * s * s * t * lead * spans.tangent[:, :1], 3 * s * t * t * lead * spans.tangent[:, 1:]
    parts = np.empty((m, 3, 2, t.shape[1]))
    for k, column in enumerate((begin, end, rest)):
        parts[:, k, 0], parts[:, k, 1] = column.imag, column.real
    # A quarter turn brings what lies along the curve across it.
    across = parts.reshape(m, 6, -1) @ parts[:, :2].reshape(m, 4, -1).transpose(0, 2, 1)
    along = (across[:, _PAIRS] * _SIGNS[:, None])[:, :, _PAIRS[:4]] * _SIGNS[:4]
    normal = across[:, :4] + slide * slide * along[:, :4]
    right = across[:, 4] + slide * slide * along[:, 4]
    chord = np.maximum(np.abs(spans.end - spans.start), 1e-6)
    normal[:, [0, 2], [0, 2]] += PULL
    right[:, [0, 2]] += PULL * chord / 3
    normal[:, [1, 3], [1, 3]] += np.where(spans.smooth, 1e6, 0.03)
    handle = np.linalg.solve(normal, right[..., None]).reshape(m, 2, 2)
    wild = (handle[..., 0] < 0.03 * chord) | (handle[..., 0] > 1.6 * chord)
    along = np.where(wild, chord / 3, handle[..., 0])
    return np.asarray((along + 1j * np.where(wild, 0, handle[..., 1])) * spans.tangent)


def _complex(points: np.ndarray) -> np.ndarray:
    """Points (..., 2) as complex numbers (...)."""
    return points[..., 0] + 1j * points[..., 1]
