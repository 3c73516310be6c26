# SPDX-License-Identifier: GPL-2.0-or-later
"""Corners of outlines: where they are, and where their two sides meet.

The pixels at a corner see both sides at once, so the outline is rounded there.
A corner is looked for in the turn between two chords that leave out those
pixels, and accepted only if the outline turns back from the point where its two
sides meet by as much as a sharp corner of that angle would.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from .arclength import Arclength
from .loops import kept_on
from .model import PlanarMap, Polylines

STEP = 0.5
"""Distance of the samples along an arc, px."""

ROUND = 0.6
"""How much rounder than a sharp corner a corner may look, px: points are up to a pixel apart."""

BACK = 2.7
"""Turn from which a corner that is too round for its angle may be the end of a bar, radians."""

NARROW = 0.7
"""Width from which the end of a bar has two corners, px."""


class Corners(NamedTuple):
    """Accepted corners, ordered along their arcs.

    Attributes
    ----------
    arc : ndarray of shape (C,) and dtype int64
    length : ndarray of shape (C,)
        Distance from the beginning of the arc, px.
    point : ndarray of shape (C, 2)
        Where the two sides meet.
    """

    arc: np.ndarray
    length: np.ndarray
    point: np.ndarray


def find_corners(planar: PlanarMap, lines: Polylines, along: Arclength, corner_angle: float) -> Corners:
    """Find the corners of all arcs.

    Parameters
    ----------
    planar : PlanarMap
    lines : Polylines
    along : Arclength
        Of `lines`.
    corner_angle : float
        Smallest turn that counts, degrees.

    Returns
    -------
    Corners
    """
    arc, length = _samples(along, np.flatnonzero((planar.left != 0) & ~lines.corners()))
    ring = planar.rings
    coarse, bent = _bends(along.places(arc, length), arc, ring)
    fine = np.zeros(len(arc))
    coarse[bent] = _turn(along, arc[bent], length[bent], skip=1.3, arm=4.0)
    fine[bent] = _turn(along, arc[bent], length[bent], skip=0.4, arm=1.2, curved=False)
    # Rings begin where they are straightest, so that no corner is cut in two.
    order = _straightest_first(arc, np.maximum(coarse, fine), ring[arc])
    coarse, fine, length = coarse[order], fine[order], length[order]
    length += np.where(length < length[_heads(arc)], along.total[arc], 0)
    chosen = _choose(arc, length, _peaks(coarse, arc, 0.38, 8), _peaks(fine, arc, 0.6, 3))
    margin = np.minimum(length, along.total[arc] - length)
    chosen = chosen[ring[arc[chosen]] | (margin[chosen] > 1.5)]
    meeting = _meet(along, ring, arc[chosen], length[chosen])
    # Pixels round a sharp corner off by about this much, the more the sharper it is.
    sharp = 0.29 / np.tan(np.maximum(np.pi - meeting.turn, 0.48) / 2)
    fits = meeting.rounding < 1.15 * sharp + ROUND
    back = meeting.turn > BACK
    keep = (meeting.turn > np.radians(corner_angle)) & fits & ~back
    caps = _caps(meeting, back, fits)
    found = Corners(*(np.concatenate(parts) for parts in zip((part[keep] for part in meeting.corners), *caps)))
    # The corners of a bar's end can lie beyond the end of an open arc.
    within = ring[found.arc] | ((found.length > 0) & (found.length < along.total[found.arc]))
    order = np.lexsort((found.length, found.arc))
    found = Corners(*(part[order[within[order]]] for part in found))
    apart = np.ones(len(found.arc), bool)
    apart[1:] = (np.diff(found.arc) != 0) | (np.hypot(*np.diff(found.point, axis=0).T) >= NARROW)
    return Corners(*(part[apart] for part in found))


def _samples(along: Arclength, inner: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Arc and distance of evenly spaced samples of the arcs `inner`."""
    count = np.maximum((along.total[inner] / STEP).astype(np.int64), 1)
    arc = np.repeat(inner, count)
    offset = np.arange(len(arc)) - np.repeat(np.cumsum(count) - count, count)
    return arc, (offset + 0.5) * along.total[arc] / np.repeat(count, count)


def _heads(arc: np.ndarray) -> np.ndarray:
    """Number of the first sample of each sample's arc."""
    fresh = np.append(True, arc[1:] != arc[:-1])[:len(arc)]
    return np.asarray(np.maximum.accumulate(np.where(fresh, np.arange(len(arc)), 0)))


def _straightest_first(arc: np.ndarray, turn: np.ndarray, ring: np.ndarray) -> np.ndarray:
    """Order of the samples in which each ring begins at its least turn."""
    head, count = _heads(arc), np.bincount(arc)[arc]
    starts = np.flatnonzero(head == np.arange(len(arc)))
    if not starts.size:
        return head
    straightest = np.flatnonzero(turn == np.repeat(np.minimum.reduceat(turn, starts), count[starts]))
    least = np.empty(len(arc), np.int64)
    least[head[straightest[::-1]]] = straightest[::-1]
    shift = np.where(ring, least[head] - head, 0)
    return np.asarray(head + (np.arange(len(arc)) - head + shift) % count)


def _bends(points: np.ndarray, arc: np.ndarray, ring: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """A rough turn at each sample, and the samples near which it is large: there may be corners."""
    head, count, closed = _heads(arc), np.bincount(arc)[arc], ring[arc]
    offset = np.arange(len(arc)) - head

    def beside(step: int) -> np.ndarray:
        return np.asarray(points[head + kept_on(offset + step, count, closed)])

    def turn(k: int) -> np.ndarray:
        return np.asarray((beside(k) - points) * (points - beside(-k)).conj())

    rough, close = np.abs(np.angle(turn(6))), turn(2)
    bent = (rough > 0.2) | (np.abs(close.imag) > np.tan(0.4) * close.real)
    near = bent.copy()
    for k in range(1, 9):
        near[k:] |= bent[:-k]
        near[:-k] |= bent[k:]
    return rough, np.flatnonzero(near)


def _turn(along: Arclength, arc: np.ndarray, length: np.ndarray, skip: float, arm: float,
          curved: bool = True) -> np.ndarray:
    """Turn between two chords beside each sample, less what the sides' own curvature explains."""
    mid, end = skip + arm / 2, skip + arm
    steps = (-end, -mid, -skip, skip, mid, end) if curved else (-end, -skip, skip, end)
    place = {step: along.places(arc, length + step) for step in steps}

    def chord(a: float, b: float) -> np.ndarray:
        step = place[b] - place[a]
        # Beyond the end of an arc there is no way to go: any is as good.
        step[step == 0] = 1
        return np.asarray(step)

    turn = np.angle(chord(skip, end) * chord(-end, -skip).conj())
    if curved:
        before = np.angle(chord(-mid, -skip) * chord(-end, -mid).conj())
        after = np.angle(chord(mid, end) * chord(skip, mid).conj())
        turn -= 0.8 * (before + after) / 2 * (2 * skip + arm) / (arm / 2)
    return np.asarray(np.abs(turn))


def _peaks(turn: np.ndarray, arc: np.ndarray, least: float, reach: int) -> np.ndarray:
    """Samples that turn by at least `least`, and most within `reach` samples of their arc."""
    best = turn > least
    for k in range(1, reach + 1):
        same = arc[k:] == arc[:-k]
        best[:-k] &= ~same | (turn[:-k] >= turn[k:])
        best[k:] &= ~same | (turn[k:] > turn[:-k])
    return np.flatnonzero(best)


def _choose(arc: np.ndarray, length: np.ndarray, coarse: np.ndarray, fine: np.ndarray) -> np.ndarray:
    """Fine corners where they stand close together or no coarse one is near; else coarse ones."""
    place = arc * 1e7 + length
    fine = fine[(_nearest(place[fine], place[fine], own=True) < 5) | (_nearest(place[fine], place[coarse]) > 3)]
    coarse = coarse[_nearest(place[coarse], place[fine]) > 3]
    return np.sort(np.concatenate([coarse, fine]))


def _nearest(place: np.ndarray, others: np.ndarray, own: bool = False) -> np.ndarray:
    """Distance from each place to the nearest of the sorted `others`."""
    padded = np.concatenate([[-1e9], others, [1e18]])
    index = np.searchsorted(padded, place)
    after = padded[index + 1] if own else padded[index]
    return np.asarray(np.minimum(after - place, place - padded[index - 1]))


class _Meeting(NamedTuple):
    corners: Corners
    turn: np.ndarray         # (C,) radians
    rounding: np.ndarray     # (C,) distance of the outline from the point, px
    side: np.ndarray         # (C, 2 sides, 2) a point on either side
    toward: np.ndarray       # (C, 2 sides, 2) unit vectors from there to the corner
    path: np.ndarray         # (C, 25, 2) the outline near the corner
    near: np.ndarray         # (25,) distances along it


def _meet(along: Arclength, ring: np.ndarray, arc: np.ndarray, length: np.ndarray) -> _Meeting:
    """Extend both sides of each corner to where they meet."""
    room_before, room_after = _room(along, ring, arc, length)
    before = _side(along, arc, length, -1, room_before)
    after = _side(along, arc, length, 1, room_after)
    a, b = np.zeros(len(arc)), np.zeros(len(arc))
    for _ in range(4):
        (pa, da), (pb, db) = _parabola(before, a), _parabola(after, b)
        gap, cross = pb - pa, _cross(da, db)
        cross = np.where(np.abs(cross) < 0.05, 0.05, cross)
        a = np.clip(a + _cross(gap, db) / cross, -2.5, 1.0)
        b = np.clip(b + _cross(gap, da) / cross, -2.5, 1.0)
    (pa, da), (pb, db) = _parabola(before, a), _parabola(after, b)
    point, turn = (pa + pb) / 2, np.abs(np.angle(-db * da.conj()))
    near = np.linspace(-3, 3, 25)
    path = along.places(np.repeat(arc, 25), (length[:, None] + near).ravel()).reshape(-1, 25)
    distance = np.abs(path - point[:, None])
    corners = Corners(arc, length + near[np.argmin(distance, axis=1)], _pairs(point))
    sides = [_parabola(side, np.full(len(arc), 1.3)) for side in (before, after)]
    toward = np.stack([-d / np.maximum(np.abs(d), 1e-9) for _, d in sides], axis=1)
    side = np.stack([p for p, _ in sides], axis=1)
    return _Meeting(corners, turn, distance.min(axis=1), _pairs(side), _pairs(toward), _pairs(path), near)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.asarray(a.imag * b.real - a.real * b.imag)


def _pairs(places: np.ndarray) -> np.ndarray:
    """Points (..., 2) from complex numbers (...)."""
    return np.ascontiguousarray(places)[..., np.newaxis].view(np.float64)


def _caps(meeting: _Meeting, back: np.ndarray, sharp: np.ndarray) -> List[Corners]:
    """Two corners each, where the outline turns back round the blunt end of a bar; one if it is narrow."""
    arc, length, meet = (part[back] for part in meeting.corners)
    side, toward, path = meeting.side[back], meeting.toward[back], meeting.path[back]
    ahead = toward.sum(axis=1)
    ahead /= np.maximum(np.hypot(*ahead.T), 1e-9)[:, None]
    tip = np.einsum("ckd,cd->ck", path, ahead).max(axis=1)
    short = tip[:, None] - np.einsum("csd,cd->cs", side, ahead)
    point = side + toward * (short / np.maximum(np.einsum("csd,cd->cs", toward, ahead), 0.5))[..., None]
    width = np.einsum("cd,cd->c", point[:, 1] - point[:, 0], side[:, 1] - side[:, 0])
    width /= np.maximum(np.hypot(*(side[:, 1] - side[:, 0]).T), 1e-9)
    wide = width > NARROW
    middle = np.where(sharp[back, None], meet, point.mean(axis=1))
    half = np.where(wide, width / 2, 0)
    centre = length + meeting.near[np.argmin(np.hypot(*np.moveaxis(path - middle[:, None], 2, 0)), axis=1)]
    first = np.where(wide[:, None], point[:, 0], middle)
    return [Corners(arc, np.maximum(centre - half, 0), first),
            Corners(arc[wide], (centre + half)[wide], point[wide, 1])]


def _room(along: Arclength, ring: np.ndarray, arc: np.ndarray,
          length: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """How far each corner's sides reach before the next corner or the end of the arc."""
    before, after = length.copy(), along.total[arc] - length
    same = arc[1:] == arc[:-1]
    gap = np.diff(length)
    before[1:][same] = gap[same]
    after[:-1][same] = gap[same]
    first = np.r_[True, ~same] if len(arc) else np.zeros(0, bool)
    last = np.r_[~same, True] if len(arc) else np.zeros(0, bool)
    wrap = ring[arc[first]]
    turn_round = np.maximum(along.total[arc[first]] - length[last] + length[first], 0)
    before[first] = np.where(wrap, turn_round, before[first])
    after[last] = np.where(wrap, turn_round, after[last])
    return before, after


def _side(along: Arclength, arc: np.ndarray, length: np.ndarray, sign: int,
          room: np.ndarray) -> np.ndarray:
    """Coefficients (3, C) of a parabola through one side, by distance from the corner."""
    begin = np.minimum(1.3, 0.3 * room)
    wide = np.clip(room - 0.7, begin + 0.6, 5.3) - begin
    # From the middle of the side, in its length, all samples are at the same distances, on both sides of it.
    share = np.linspace(-0.5, 0.5, 9)
    middle = begin + wide / 2
    at = length[:, None] + sign * (middle[:, None] + wide[:, None] * share)
    points = along.places(np.repeat(arc, 9), at.ravel()).reshape(-1, 9)
    total, along_it, squares = points.dot(np.stack([np.ones(9), share, share**2], axis=1).astype(complex)).T
    square = (share**2).sum() * wide**2
    # Of the three equations only the first and the last have a term in common.
    bend = (wide**2 * squares - square * total / 9) / ((share**4).sum() * wide**4 + 0.3 * 9 - square**2 / 9)
    slope = wide * along_it / square
    start = (total - square * bend) / 9
    return np.stack([start - middle * (slope - middle * bend), slope - 2 * middle * bend, bend])


def _parabola(side: np.ndarray, u: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Points and derivatives of parabolas at distances `u`."""
    return side[0] + u * (side[1] + u * side[2]), side[1] + 2 * u * side[2]
