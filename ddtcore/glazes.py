# SPDX-License-Identifier: GPL-2.0-or-later
"""Translucent strokes drawn on a ramp, followed round their bends.

A border or a gloss drawn on a ramp mixes one colour, in one share, with whatever lies below.
Its straight parts are ramps or plateaus, each of another kind; in its bends few pixels are
covered in full.  But one mix with the colours of the ramp below explains them all, and
where one part shows which, the others are found by their colours.
"""

from __future__ import annotations

from typing import List, Optional, Sequence, Tuple

import numpy as np

from .canvas import Canvas, within
from .components import mask_areas
from .growing import FIT, Surface, distance, fitted_surfaces, gradient_surface
from .overlays import NARROW
from .palette import Plateaus
from .samples import Samples
from .spans import Spans, renumber, spans_of
from .tint import tinted

AREA = 24
"""Fewest pixels that tell a mix, px²."""

STRANGE = 0.1
"""Share of a part's pixels that may be farther from the mix than the others."""

CONTRAST = 12.0
"""What is below has to change by so much along a part that is to tell a mix, levels as seen through it."""

OFF = 3.0
"""How far pixels of other parts may be from the mix, levels."""

OWN = 0.5
"""A flat colour is part of a stroke if at least this share of its pixels fit in."""

REACH = 8
"""How far beyond the rows and columns of the ramp below a stroke may lie, px."""

_TOLD = 1 << 11
_WORK = 1 << 24


def follow(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface],
           plateaus: Plateaus) -> Tuple[np.ndarray, List[Surface], bool]:
    """Join the parts of strokes, and give them the pixels that their mix explains, in place.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none.
    surfaces : list of Surface
        The colours of each ramp.
    plateaus : Plateaus
        The flat colours of the pixels that belong to none.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int16
    surfaces : list of Surface
        Those of the ramps that are left.
    any : bool
        Whether there are such strokes.
    """
    spans = spans_of(ramps, len(surfaces))
    below = _below(ramps, [each.size for each in spans], surfaces)
    into = np.arange(len(surfaces))
    met = np.unique(below[below >= 0]).tolist()
    bases = dict(zip(met, fitted_surfaces((_pixels(canvas, ramps, spans[k]) for k in met), REACH)))
    mixes: List[Tuple[int, int, Surface]] = []
    for number in sorted(np.flatnonzero(below >= 0).tolist(), key=lambda k: -spans[k].size):
        points, colour = _pixels(canvas, ramps, spans[number])
        base = int(below[number])
        same = [k for k, other, surface in mixes if other == base and _explains(surface, points, colour)]
        if same:
            into[number] = same[0]
            continue
        mix = _mix(bases[base], points, colour)
        if mix is not None:
            mixes.append((number, base, mix))
    kept, renumbered = np.unique(into, return_inverse=True)
    if kept.size < into.size:
        renumber(ramps, np.append(renumbered.ravel(), -1).astype(np.int32))
    surfaces = [surfaces[k] for k in kept.tolist()]
    if mixes:
        free, work = _free(canvas, ramps, plateaus), _WORK
        for number, base, mix in mixes:
            window = spans[base].window(ramps.shape, REACH)
            work -= ramps[window].size
            if work >= 0:
                place = int(renumbered.ravel()[number])
                _extend(canvas, ramps, place, mix, plateaus, free, window)
                surfaces[place] = _better(canvas, ramps, place, mix)
    return ramps, surfaces, bool(mixes)


def _pixels(canvas: Canvas, ramps: np.ndarray, spans: Spans) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and colours (n, C) of some pixels of a ramp."""
    row, col = np.divmod(spans.every(-(-spans.size // _TOLD)), ramps.shape[1])
    return np.stack([col, row], axis=1) + 0.5, canvas.colours(canvas.numbers(row, col)).T.astype(np.float64)


def _below(ramps: np.ndarray, size: Sequence[int], surfaces: Sequence[Surface]) -> np.ndarray:
    """The larger ramp with a gradient that each ramp meets most, -1 for none."""
    count = len(surfaces)
    if not count:
        return np.zeros(0, np.intp)
    met = np.zeros(count * count, np.int64)
    for step in (2, 3):
        for one, other in ((ramps[step:], ramps[:-step]), (ramps[:, step:], ramps[:, :-step])):
            both = (one >= 0) & (other >= 0) & (one != other)
            one, other = one[both].astype(np.int64), other[both].astype(np.int64)
            met += np.bincount(one * count + other, minlength=met.size)
            met += np.bincount(other * count + one, minlength=met.size)
    pairs = met.reshape(count, count)
    larger = np.array(size)[None, :] > np.array(size)[:, None]
    pairs *= larger & np.array([surface.gradient is not None for surface in surfaces], bool)[None, :]
    enough = (pairs.max(axis=1) >= AREA) & (np.array(size) >= AREA)
    return np.asarray(np.where(enough, pairs.argmax(axis=1), -1))


def _explains(surface: Surface, points: np.ndarray, colour: np.ndarray) -> bool:
    return bool(np.mean(distance(surface, points, colour) > FIT) < STRANGE)


def _mix(base: Surface, points: np.ndarray, colour: np.ndarray) -> Optional[Surface]:
    """What explains colours (n, C) as a mix with those of the ramp below, if anything does."""
    tint = tinted(base.gradient, Samples(points, colour, np.ones(len(points)))) if base.gradient else None
    if tint is None:
        return None
    mix = gradient_surface(tint, colour.shape[1])
    told = np.ptp(mix.colours(points), axis=0).max() >= CONTRAST
    return mix if told and _explains(mix, points, colour) else None


def _free(canvas: Canvas, ramps: np.ndarray, plateaus: Plateaus) -> np.ndarray:
    """Pixels that belong neither to ramps nor to flat areas, but for narrow ones, (H, W)."""
    free = ramps < 0
    flat = np.flatnonzero(free & plateaus.core)
    narrow = np.sort(plateaus.keys[plateaus.full < NARROW * plateaus.counts])
    free.ravel()[flat] = np.isin(canvas.bare(canvas.keys).ravel()[flat], narrow)
    return np.asarray(free)


def _extend(canvas: Canvas, ramps: np.ndarray, number: int, mix: Surface, plateaus: Plateaus, free: np.ndarray,
            window: Tuple[slice, slice]) -> None:
    """Give a stroke the free pixels in a window that its mix explains and that hardly anything parts from it."""
    here = ramps[window]
    row, col = np.nonzero(free[window] & (here < 0))
    cells = canvas.numbers(row + window[0].start, col + window[1].start)
    points = np.stack([col + window[1].start, row + window[0].start], axis=1) + 0.5
    fits = distance(mix, points, canvas.colours(cells).T) < OFF
    row, col, cells = row[fits], col[fits], cells[fits]
    own = _own_colours(canvas, plateaus, cells, plateaus.core[window][row, col])
    row, col = row[own], col[own]
    stroke = here == number
    reached = stroke.copy()
    reached[row, col] = True
    areas = mask_areas(within(reached[np.newaxis], 1, np.maximum)[0])
    met = np.full(areas.size.size, -1)
    met[areas.at(np.flatnonzero(stroke))] = 1
    whole = np.zeros(here.shape, bool)
    areas.put(whole.ravel(), met)
    some = whole[row, col]
    here[row[some], col[some]] = number


def _own_colours(canvas: Canvas, plateaus: Plateaus, cells: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """Which pixels are not flat, or have a flat colour of which they are a large share."""
    keys, place, count = np.unique(canvas.keys[cells[flat]], return_inverse=True, return_counts=True)
    order = np.argsort(plateaus.keys, kind="stable")
    total = plateaus.counts[order[np.searchsorted(plateaus.keys[order], keys)]]
    own = np.ones(cells.size, bool)
    own[flat] = (count >= OWN * total)[place.ravel()]
    return own


def _better(canvas: Canvas, ramps: np.ndarray, number: int, mix: Surface) -> Surface:
    """The mix, or the gradient of its own of a stroke, whichever is nearer to its pixels."""
    points, colour = _pixels(canvas, ramps, spans_of(np.where(ramps == number, 0, -1), 1)[0])
    own, = fitted_surfaces([(points, colour)])
    nearer = own.gradient is not None and distance(own, points, colour).mean() < distance(mix, points, colour).mean()
    return own if nearer else mix
