# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes and shades drawn on soft ramps, too narrow to be ramps or plateaus of their own.

On a ramp nothing is flat, so a stroke is what differs from the ramp's own colour there.
A pixel that no mix of the surfaces around it explains belongs to something drawn;
connected pixels that differ in the same direction are one thing.  Strokes thinner than a
pixel are left to the stage that knows flat colours, with the colours of their inks.
"""

from __future__ import annotations

from typing import List, Optional, Sequence, Tuple

import numpy as np

from . import shades
from .astride import part_astride
from .canvas import Canvas, planes
from .components import cell_components
from .gradient import PRICE
from .growing import Surface
from .hairlines import Inks
from .mixes import length, segment_distance
from .palette import MANY as MOST
from .palette import Plateaus
from .ridges import Ridges
from .sides import SLOTS, near_samples, window

LEAST = 10.0
"""Smallest distance of a drawn pixel from all mixes of what surrounds it, levels."""

FAINT = 7.0
"""The same for pixels connected with such: shades fade, and at the border of two ramps mixes come near them."""

AREA = 8
"""Smallest drawn thing, px²."""

BYTES = 180
"""Size of a path in the file, as many have it on average."""

MANY = 256
"""Most ramps and things drawn on them."""

WIDE = 64
"""A plateau colour with fewer pixels than this may be a piece of something drawn, px²."""

NARROW = 0.35
"""Share of a colour's pixels that are surrounded by it, below which it is that of narrow things."""

SLIDE, SLIDES = 3.0, 3
"""How near two plateaus are that touch and are of one thing, levels; and in how many pixels they do so at least."""

OWN = 0.7
"""Drawn with a flat colour of the picture is what holds at least this share of it."""

BLEEDING = 0.2
"""How far off mixes are in a picture that is not clean, as a share of the contrast of their sides."""

CLEAR, SHARE = 60.0, 0.1
"""In such a picture a stroke with this share of pixels that stand out more has an ink that can be told, levels."""

_PLAIN = 0.25


def flat_colours(canvas: Canvas, plateaus: Plateaus) -> np.ndarray:
    """The packed colours of large plateaus, but for those of narrow things whose colour changes little by little.

    A translucent stroke on a slow ramp consists of plateaus, too.
    """
    large = plateaus.counts >= WIDE
    asked = plateaus.keys[large & (plateaus.full < NARROW * plateaus.counts)]
    cells = canvas.cells(plateaus.core)
    cells = cells[np.isin(canvas.keys[cells], asked)]
    sliding = np.zeros(asked.size, np.int64)
    for step in window(canvas.stride, 1, 1) if asked.size else ():
        some = cells[canvas.keys[cells + step] != canvas.keys[cells]]
        some = some[np.abs(canvas.colours(some + step) - canvas.colours(some)).max(axis=0) <= SLIDE]
        some = some[np.isin(canvas.keys[some + step], plateaus.keys)]
        sliding += (canvas.keys[some][:, None] == asked).sum(axis=0)
    large &= ~np.isin(plateaus.keys, asked[sliding >= SLIDES])
    return plateaus.keys[large][:MOST]


def add_drawn(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface], keys: np.ndarray,
              labels: np.ndarray, doubt: Optional[np.ndarray] = None, rippled: float = 0.0) -> Tuple[int, np.ndarray]:
    """Number the things drawn on ramps like further ramps, in place.

    Parameters
    ----------
    ramps : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.
    surfaces : list of Surface
        The colours of each ramp.
    keys : ndarray of shape (K,) and dtype uint32
        Colours of large plateaus, packed.
    labels : ndarray of shape (P,) and dtype int16
        Which of them each pixel has, with the rim, else negative; not to be used any more.
    doubt : ndarray of shape (P,), optional
        How far pixels of a picture that is not clean may be from the colours they should have, levels.
    rippled : float
        How much pixels of strokes vary in a picture that is clean but for these, levels.

    Returns
    -------
    count : int
        How many ramps and drawn things there are.
    inks : ndarray of dtype uint32
        Colours of strokes thinner than a pixel, packed; these are not numbered, for
        their pixels vary by what they cover of them.
    """
    count = len(surfaces)
    known = labels
    np.add(known, np.int32(count), out=known, where=known >= 0)
    np.copyto(canvas.bare(known), ramps, where=ramps >= 0)
    cells = canvas.cells(canvas.bare(known) < 0)
    samples, _ = near_samples(known, cells, canvas.stride)
    beside = (samples >= 0) & (known[samples] < count)
    some = beside.any(axis=0)
    cells, samples = cells[some], samples[:, some]
    if not cells.size:
        return count, np.zeros(0, np.uint32)
    sides = side_colours(canvas, known, cells, samples, surfaces)
    here = canvas.colours(cells)
    nearest = beside[:, some].argmax(axis=0), np.arange(cells.size)
    base, ramp = sides[(slice(None), *nearest)], known[samples[nearest]]
    off = unexplained(here, sides, samples)
    if doubt is not None:
        off -= doubt[cells] + BLEEDING * _contrast(sides, samples)
    drawn = np.flatnonzero(off > FAINT)
    cells, here, base, off = cells[drawn], here[:, drawn], base[:, drawn], off[drawn]
    area = _areas(canvas, cells, here - base)
    clear = (np.bincount(area, off > LEAST) >= AREA)[area]
    drawn, cells, here, base, off = drawn[clear], cells[clear], here[:, clear], base[:, clear], off[clear]
    area = shades.part(canvas, cells, here - base, area[clear])
    area = part_astride(canvas, cells, area, ramp[drawn], surfaces)
    size = np.bincount(area)
    pays = np.bincount(area, off ** 2) >= PRICE * BYTES
    chosen = (size >= AREA) & pays & ~_flat(area, here, base, planes(keys, canvas.opaque))
    if doubt is not None:
        chosen &= (np.bincount(area, length(here - base) > CLEAR) < SHARE * size) & (size >= WIDE)
    chosen = np.flatnonzero(chosen)
    chosen = chosen[np.argsort(-size[chosen], kind="stable")[:max(MANY - count, 0)]]
    thin, inks = _thin(Inks(canvas, cells, sides[..., drawn], samples[:, drawn] >= 0, rippled), area, chosen)
    chosen = chosen[~thin]
    number = np.full(size.size, -1, np.int32)
    number[chosen] = np.arange(count, count + chosen.size)
    row, col = canvas.places(cells)
    ramps[row, col] = number[area]
    return count + chosen.size, inks


def beyond_ramps(canvas: Canvas, ramps: np.ndarray, surfaces: Sequence[Optional[Surface]], labels: np.ndarray,
                 ridges: Ridges) -> Ridges:
    """The ridge pixels near ramps (H, W) that no mixes of these and of the known labels (P,) round them explain."""
    known = np.where(labels >= 0, labels + np.int32(len(surfaces)), -1)
    np.copyto(canvas.bare(known), ramps, where=ramps >= 0)
    samples, _ = near_samples(known, ridges.cells, canvas.stride)
    near = np.flatnonzero(((samples >= 0) & (known[samples] < len(surfaces))).any(axis=0))
    sides = side_colours(canvas, known, ridges.cells[near], samples[:, near], surfaces)
    strange = np.ones(ridges.cells.size, bool)
    strange[near] = unexplained(ridges.colour[:, near], sides, samples[:, near]) > FAINT
    return ridges.some(np.flatnonzero(strange))


def side_colours(canvas: Canvas, known: np.ndarray, cells: np.ndarray, samples: np.ndarray,
                 surfaces: Sequence[Optional[Surface]]) -> np.ndarray:
    """The colours that the surfaces around each pixel have, or would have, there.

    Parameters
    ----------
    canvas : Canvas
    known : ndarray of shape (P,)
        Numbers with the rim; those of no surface count as flat, with the colour of the sample.
    cells : ndarray of shape (N,)
    samples : ndarray of shape (SLOTS, N)
        Pixels round each of them, -1 for none.
    surfaces : sequence of Surface or None

    Returns
    -------
    ndarray of shape (C, SLOTS, N)
    """
    sides = canvas.colours(samples)
    row, col = canvas.places(cells)
    points = np.stack([col, row], axis=1) + 0.5
    number = np.where(samples >= 0, known[samples], -1)
    order = np.argsort(number.ravel(), kind="stable")
    values, first = np.unique(number.ravel()[order], return_index=True)
    for value, part in zip(values.tolist(), np.split(order, first[1:])):
        surface = surfaces[value] if 0 <= value < len(surfaces) else None
        if surface is not None:
            slot, place = np.divmod(part, cells.size)
            sides[:, slot, place] = surface.colours(points[place]).T
    return sides


def unexplained(here: np.ndarray, sides: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Distance of each colour (C, N) from all mixes of two of its sides (C, SLOTS, N); infinite where it has none."""
    nearest = np.full(here.shape[1], np.inf, np.float32)
    for i in range(SLOTS):
        for j in range(i, SLOTS):
            both = np.flatnonzero((samples[i] >= 0) & (samples[j] >= 0))
            distance, _ = segment_distance(here[:, both], sides[:, i, both], sides[:, j, both])
            nearest[both] = np.minimum(nearest[both], distance)
    return nearest


def _contrast(sides: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """How much the sides (C, SLOTS, N) of each pixel differ, levels: the largest range of a channel."""
    present = samples >= 0
    span = np.where(present, sides, -np.inf).max(axis=1) - np.where(present, sides, np.inf).min(axis=1)
    return np.asarray(span.max(axis=0))


def _areas(canvas: Canvas, cells: np.ndarray, off: np.ndarray) -> np.ndarray:
    """Numbers of connected pixels that are all lighter, or all darker, than the ramp."""
    return cell_components(cells, off.sum(axis=0) > 0, canvas.stride)


def _thin(search: Inks, area: np.ndarray, chosen: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Which of some areas are strokes thinner than a pixel or scraps of such, bool; and their inks, packed."""
    members = np.split(np.argsort(area, kind="stable"), np.cumsum(np.bincount(area))[:-1])
    found = [search.find(members[k]) for k in chosen.tolist()]
    inks = np.unique(np.array([ink for ink in found if ink is not None], np.uint32))
    thin = [ink is not None or search.are_scraps(members[k], inks) for k, ink in zip(chosen.tolist(), found)]
    return np.array(thin, bool), inks


def _flat(area: np.ndarray, here: np.ndarray, base: np.ndarray, colours: np.ndarray) -> np.ndarray:
    """Which drawn areas have a flat colour of the picture, or nearly, in the half that stands out most."""
    height = length(here - base)
    total = np.bincount(area)
    strong = height >= _medians(height, area)[area]
    count = np.maximum(np.bincount(area, strong, total.size), 1)
    flat = np.zeros(total.size, bool)
    for colour in colours.T:
        distance, share = segment_distance(here, base, np.broadcast_to(colour[:, None], here.shape))
        held = strong & (distance < _PLAIN * height) & (share >= OWN)
        flat |= np.bincount(area, held, total.size) >= 0.5 * count
    return flat


def _medians(values: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The middle one of the values (N,) of each area; the lower one of two."""
    size = np.bincount(area)
    return np.asarray(values[np.lexsort((values, area))[np.cumsum(size) - size + (size - 1) // 2]])
