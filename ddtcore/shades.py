# SPDX-License-Identifier: GPL-2.0-or-later
"""Things drawn on a ramp that touch each other, told apart by how they change its colour.

A shade and a stroke beside it are both darker than the ramp, and connected.  But they change
the colour in different directions, whatever each of them covers of a pixel.  The directions
are told by places that are covered in full, as a change that is even over 2 x 2 pixels shows;
and for strokes too narrow to have such, by pixels that none of these directions explains.
What is opaque changes each of two ramps in another direction, but to the same ink.
"""

from __future__ import annotations

from typing import List, NamedTuple, Sequence, Tuple

import numpy as np

from .canvas import Canvas
from .components import cell_components, components, next_among
from .mixes import length, segment_distance
from .sides import window

EVEN = 4.0
"""How far the changes in a block differ at most, levels of a channel."""

AREA = 8
"""Fewest pixels that show a direction, px²."""

OFF, SHARE = 6.0, 0.5
"""A change belongs to another direction that is farther than this from it, levels; and by this share of its length."""

PART = 0.15
"""Smallest share of an area that another direction explains than those of places covered in full."""

MANY = 256
"""Most areas that are looked at, the largest ones."""

CORES, KINDS = 64, 6
"""Most evenly changed places of an area that are looked at, the largest ones; and most directions."""

_FAR, _MOST = 1e3, 20.0


_Beside = Tuple[np.ndarray, np.ndarray]


class _Kinds(NamedTuple):
    """Ways in which things change the colour of a ramp."""

    along: np.ndarray    # (C, n) directions
    inks: np.ndarray     # (C, n) colours of places that are covered in full; NaN where there are none

    def with_one(self, change: np.ndarray, ink: np.ndarray) -> _Kinds:
        """These and one more, by a change and a colour (C, 1)."""
        along = change / max(float(length(change)[0]), 1e-9)
        return _Kinds(np.append(self.along, along, axis=1), np.append(self.inks, ink, axis=1))

    def distance(self, here: np.ndarray, off: np.ndarray) -> np.ndarray:
        """Distance (n, N) of changes (C, N) to colours (C, N) from rays in the directions, or from mixes with the inks.

        What is opaque changes each of two ramps beside it in another direction.
        """
        out = length(off[:, None] - self.along[:, :, None] * np.maximum(self.along.T.dot(off), 0))
        for k, ink in enumerate(self.inks.T):
            mixed, _ = segment_distance(here, here - off, np.broadcast_to(ink[:, None], here.shape))
            out[k] = np.fmin(out[k], mixed)
        return out


def part(canvas: Canvas, cells: np.ndarray, off: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Part the areas in which there are several things.

    Parameters
    ----------
    canvas : Canvas
    cells : ndarray of shape (N,)
        Numbers of the drawn pixels.
    off : ndarray of shape (C, N)
        By how much their colours differ from what they are drawn on.
    area : ndarray of shape (N,)
        Number of the connected area of each.

    Returns
    -------
    ndarray of shape (N,)
        Numbers of areas, or of parts of them, each of one thing.
    """
    core, size = cores(canvas, cells, off, area)
    inside = core >= 0
    owner = np.full(size.size, -1, area.dtype)
    owner[core[inside]] = area[inside]
    here = canvas.colours(cells)
    change, inks = (np.stack([np.bincount(core[inside], plane[inside], size.size) for plane in planes]) / size
                    for planes in (off, here))
    near = neighbours(canvas, cells, area)
    alike = _alike(near, off)
    unlikeness = np.full((KINDS, area.size), _FAR)
    unlikeness[0] = 0
    count = np.bincount(area)
    members = np.split(np.argsort(area, kind="stable"), np.cumsum(count)[:-1])
    largest = np.argsort(-count, kind="stable")[:MANY]
    for number in largest[count[largest] >= 2 * AREA].tolist():
        own = np.flatnonzero(owner == number)
        own = own[np.argsort(-size[own], kind="stable")[:CORES]]
        some, there = off[:, members[number]], here[:, members[number]]
        kinds = _kinds(change[:, own], inks[:, own], size[own])
        while kinds.along.shape[1] < KINDS:
            beside, unlike = _beside(there, some, kinds)
            unlike &= alike[members[number]]
            if np.count_nonzero(unlike) < max(AREA, PART * unlike.size):
                break
            most = unlike & (beside >= np.percentile(beside[unlike], 75))
            kinds = kinds.with_one(some[:, most].sum(axis=1, keepdims=True), np.full((len(some), 1), np.nan))
        unlikeness[:kinds.along.shape[1], members[number]] = np.minimum(kinds.distance(there, some), _MOST)
    kind = smooth(near, unlikeness).argmin(axis=0)
    for _ in range(2):
        scrap = np.flatnonzero(_sizes(canvas, cells, area * KINDS + kind) < AREA)
        unlikeness[kind[scrap], scrap] = _FAR
        kind = smooth(near, unlikeness).argmin(axis=0)
    return np.unique(area * KINDS + kind, return_inverse=True)[1].ravel()


def cores(canvas: Canvas, cells: np.ndarray, off: np.ndarray, area: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Number of the evenly changed place that each pixel belongs to, -1 for none, and the sizes of these."""
    right, down = (next_among(cells, step) for step in (1, canvas.stride))
    across, along = (_even(place, off, area) for place in (right, down))
    corner = np.flatnonzero(across & along)
    first, second = right[corner], down[corner]
    block = along[first] & across[second]
    corner, first, second = corner[block], first[block], second[block]
    last = down[first]
    inside = np.zeros(cells.size, bool)
    for some in (corner, first, second, last):
        inside[some] = True
    core = components(cells.size, np.tile(corner, 3), np.concatenate([first, second, last]))
    number = np.full(cells.size, -1, np.int64)
    _, number[inside] = np.unique(core[inside], return_inverse=True)
    return number, np.bincount(number[inside])


def _even(place: np.ndarray, off: np.ndarray, area: np.ndarray) -> np.ndarray:
    """Which pixels have one beside them, given its place among all or -1, in the same area and changed alike."""
    even = place >= 0
    a, b = np.flatnonzero(even), place[even]
    even[a] = (area[a] == area[b]) & (np.abs(off[:, a] - off[:, b]).max(axis=0) <= EVEN)
    return even


def _kinds(changes: np.ndarray, inks: np.ndarray, size: np.ndarray) -> _Kinds:
    """Those of some changes (C, K) to colours (C, K), in their order, that are unlike all before and not rare."""
    none = np.zeros((len(changes), 0))
    kinds, total = _Kinds(none, none), np.zeros(0)
    for change, ink, pixels in zip(changes.T[:, :, None], inks.T[:, :, None], size.tolist()):
        _, unlike = _beside(ink, change, kinds)
        if not unlike[0]:
            total[kinds.distance(ink, change).argmin()] += pixels
        elif kinds.along.shape[1] < KINDS:
            kinds, total = kinds.with_one(change, ink), np.append(total, pixels)
    return _Kinds(*(some[:, total >= AREA] for some in kinds))


def _beside(here: np.ndarray, off: np.ndarray, kinds: _Kinds) -> Tuple[np.ndarray, np.ndarray]:
    """Distance (N,) of changes (C, N) to colours (C, N) from the nearest kind, and which of them belong to none."""
    size = length(off)
    beside = np.minimum(kinds.distance(here, off).min(axis=0), size) if kinds.along.size else size
    return beside, beside > np.maximum(OFF, SHARE * size)


def smooth(near: Sequence[_Beside], values: np.ndarray) -> np.ndarray:
    """Sums of the values (n, N) of each pixel and of the pixels of its area round it."""
    total = 2 * values
    for same, beside in near:
        total[:, same] += values[:, beside]
    return total


def _alike(near: Sequence[_Beside], off: np.ndarray) -> np.ndarray:
    """Which pixels are changed like one beside them in their area."""
    alike = np.zeros(off.shape[1], bool)
    for same, beside in near:
        alike[same] |= np.abs(off[:, beside] - off[:, same]).max(axis=0) <= EVEN
    return alike


def neighbours(canvas: Canvas, cells: np.ndarray, area: np.ndarray) -> List[_Beside]:
    """For each of eight directions, which pixels have a neighbour in their area, and which one."""
    found = []
    for step in window(canvas.stride, 1, 1).tolist():
        beside = next_among(cells, step)
        same = np.flatnonzero((beside >= 0) & (area[beside] == area)).astype(np.int32)
        found.append((same, beside[same].astype(np.int32)))
    return found


def _sizes(canvas: Canvas, cells: np.ndarray, number: np.ndarray) -> np.ndarray:
    """How many connected pixels with equal numbers each of some pixels belongs to."""
    piece = cell_components(cells, number, canvas.stride)
    return np.asarray(np.bincount(piece)[piece])
