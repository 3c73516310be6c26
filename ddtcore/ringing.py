# SPDX-License-Identifier: GPL-2.0-or-later
"""Art that was made smaller or larger: the ripples beside its edges are taken for what they are.

Good filters overshoot beside an edge, by a share of its contrast and over three pixels at
most; the ripples stand for nothing.  Away from edges flat colours and soft ramps stay as they
were, unlike in a JPEG or a scan.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Iterable, Iterator, Optional, Sequence, Tuple

import numpy as np

from .canvas import RIM, Canvas, pack, planes, within
from .growing import Surface
from .noise import REDUCED, ROUNDING, UNSTEADY, between_plateaus, rippled_share, unlike, zigzags
from .palette import Plateaus, find_plateaus, is_mixed
from .parts import in_parts
from .patches import Patches, find_patches
from .ramps import no_ramps

LEFT = 8.0
"""How much pixels vary at most when ripples have been taken off, levels."""

STROKES = 0.5
"""Share of that by which strokes may stand out: they ring beside themselves, not along their crests."""

SPECK = 6.0
"""Regions smaller than this are ripples all the same, px²."""

CALM = 24
"""Largest range of a channel within 7 x 7 pixels without an edge, levels."""

RARE = 0.01
"""Share of uneven pixels far from all edges from which there is more than ringing."""

BEYOND, SHORT = 0.13, 0.06
"""How far ringing goes beyond a flat colour, between two edges, and falls short of it: shares of the contrast."""

MARGIN = 0.1
"""How strong it is there as a rule, as a share of the contrast within 7 x 7 pixels."""

BESIDE = 0.08
"""How far it goes beyond a flat colour beside one straight edge, as a share of the contrast."""

OVERSHOOTING = 0.15
"""Share of edges beside which the colour overshoots, from which a picture rings,"""

RIPPLED = 0.012
"""if so many of its pixels that are no plateaus are ripples: on thin strokes there are edges that look like it."""

EDGES = 64
"""Fewest edges that tell."""

LOW = 40
"""Beside edges of less contrast ramps hardly ring, levels."""

PATCH = 16.0
"""How far pixels of narrow areas may be from their colour, as they ring from both sides, levels."""

_STRONG, _FIRST, _QUIET, _TURN = 48.0, 0.12, 0.16, 0.01
_SAMPLE = 1 << 13
_CORE = 4
_TWIN = 4.0
_MOST = 48
_FEW = 13


def is_ringing(canvas: Canvas) -> bool:
    """Whether all that is uneven keeps to edges."""
    core = find_plateaus(canvas, np.zeros(canvas.shape, bool)).core
    uneven = np.zeros(core.shape, bool)
    uneven[RIM:-RIM, RIM:-RIM] = ~core[RIM:-RIM, RIM:-RIM]
    cells = canvas.cells(uneven)
    if not cells.size:
        return False
    low, high = _ranges(canvas)
    span = (high[:, cells] - low[:, cells]).max(axis=0)
    calm = span <= CALM
    calm[calm] = ~between_plateaus(canvas, core, cells[calm], span[calm], RIM)
    return bool(np.mean(calm) < RARE)


def is_resized(canvas: Canvas, core: np.ndarray) -> bool:
    """Whether edges beside plateaus and ramps, `core` (H, W), overshoot, but there are neither ripples nor dots."""
    return (overshoots(canvas, core) > OVERSHOOTING and rippled_share(canvas, core) > RIPPLED
            and zigzags(canvas, 4) < UNSTEADY and np.unique(canvas.keys).size > REDUCED)


def overshoots(canvas: Canvas, core: np.ndarray) -> float:
    """Share of edges beside which the colour turns away from the other side before it goes there; 0 if there are few.

    Channels clipped at 0 or 255 do not tell.  What turns away by more than filters do is drawn.

    Parameters
    ----------
    canvas : Canvas
    core : ndarray of shape (H, W) and dtype bool
        Pixels of plateaus.
    """
    cells = canvas.cells(~core)
    cells = cells[::max(1, cells.size // _SAMPLE)]
    edges = turning = 0
    for step in (1, -1, canvas.stride, -canvas.stride):
        row = canvas.colours(cells + np.arange(-2, 3)[:, None] * step)
        clipped = ((row[:, :2] <= 0) | (row[:, :2] >= 255)).any(axis=1)
        most = np.where(clipped, -1, np.abs(row[:, 4] - row[:, 2])).argmax(axis=0)
        row = np.take_along_axis(row, most[np.newaxis, np.newaxis], axis=0)[0]
        first, second, third, fourth = np.diff(row, axis=0) * np.sign(row[4] - row[2])
        rise = third + fourth
        edge = (rise > _STRONG) & (third > _FIRST * rise) & ~clipped.all(axis=0)
        edge &= (np.abs(first) < _QUIET * rise) & (np.abs(second) < _QUIET * rise)
        edges += int(np.count_nonzero(edge))
        edge &= (first >= 0) & (second < -np.maximum(1, _TURN * rise)) & (second > -MARGIN * rise)
        turning += int(np.count_nonzero(edge))
    return turning / edges if edges >= EDGES else 0.0


def margins(canvas: Canvas) -> np.ndarray:
    """How strong ringing is as a rule round each pixel (P,), levels."""
    low, high = _ranges(canvas)
    return np.asarray(MARGIN * (high - low).max(axis=0))


def without_ringing(canvas: Canvas, ramps: Optional[np.ndarray] = None,
                    surfaces: Sequence[Surface] = ()) -> Tuple[Canvas, np.ndarray]:
    """The picture with flat colours and soft ramps up to its edges: what is off one by no more than ringing gets it.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W), optional
        Number of the ramp of each pixel, -1 where there is none.
    surfaces : sequence of Surface
        The colours of each ramp.

    Returns
    -------
    canvas : Canvas
    inks : ndarray of dtype uint32
        The packed colours of those that only thin strokes or narrow areas have, as far as they tell.
    """
    ramps = no_ramps(canvas.shape) if ramps is None else ramps
    plateaus = find_plateaus(canvas, ramps >= 0)
    known = np.array(unlike(canvas, plateaus.keys[plateaus.full >= _CORE], _TWIN)[:_MOST], np.uint32)
    cells = canvas.cells(~plateaus.core)
    low, high = (values[:, cells] for values in _ranges(canvas))
    inks = _clipped_strokes(canvas, cells, high - low, known)
    if surfaces:
        some = np.flatnonzero((high - low).max(axis=0) > LOW)
        cells, low, high = cells[some], low[:, some], high[:, some]
    ramp = within((ramps >= 0)[np.newaxis], RIM, np.maximum)[0]
    patches = find_patches(canvas, np.append(known, inks), PATCH, ~(plateaus.core | ramp))
    patches = patches._replace(keys=_even(canvas, plateaus, patches.keys))
    known = np.append(known, inks)
    bound = is_mixed(planes(known, canvas.opaque), planes(known, canvas.opaque))
    if surfaces:
        # Along a stroke on a ramp the colour may come near any other.
        bound[:known.size - inks.size] = True
    bound = np.append(bound, np.ones(patches.keys.size, bool))
    beside = np.append(_beside(canvas, plateaus.core, cells, known),
                       _near(canvas, _inside(canvas, patches), cells), axis=0)
    known = np.append(known, patches.keys)
    best, least = in_parts(
        lambda part: _settled(canvas, cells[part], low[:, part], high[:, part], known, beside[:, part], bound),
        cells.size)
    for number, surface in enumerate(surfaces):
        near = within((ramps == number)[np.newaxis], RIM, np.maximum)[0]
        row, col = canvas.places(cells)
        some = np.flatnonzero(near[row, col])
        colour = surface.colours(np.stack([col[some], row[some]], axis=1) + 0.5).T
        off = _unexplained(canvas.colours(cells[some]), colour, low[:, some], high[:, some])
        nearer = off < least[some]
        best[some[nearer]], least[some[nearer]] = pack(colour[:, nearer]), off[nearer]
    keys = canvas.keys.copy()
    keys[cells] = best
    inks = np.append(inks, patches.keys)
    return replace(canvas, keys=np.pad(canvas.bare(keys), RIM, mode="edge").ravel()), inks


def _beside(canvas: Canvas, core: np.ndarray, cells: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Which pixels (N,) are beside plateaus of which `known` colours, bool (K, N)."""
    flat = canvas.rimmed(core, False)
    return _near(canvas, (flat & (canvas.keys == key) for key in known), cells)


def _near(canvas: Canvas, places: Iterable[np.ndarray], cells: np.ndarray) -> np.ndarray:
    """Which pixels (N,) are near the places, bool (P,) each, of each of K colours, bool (K, N)."""
    near = [within(inside.reshape(1, -1, canvas.stride), RIM, np.maximum).ravel()[cells] for inside in places]
    return np.array(near, bool).reshape(-1, cells.size)


def _inside(canvas: Canvas, patches: Patches) -> Iterator[np.ndarray]:
    """The pixels (P,) well inside the narrow areas of each colour."""
    for k in range(patches.keys.size):
        inside = np.zeros(canvas.keys.size, bool)
        inside[patches.cells[patches.number == k]] = True
        yield inside


def _even(canvas: Canvas, plateaus: Plateaus, keys: np.ndarray) -> np.ndarray:
    """Packed colours, or the most frequent ones of plateaus that are nearly the same: what does not ring is exact."""
    some = plateaus.keys[plateaus.full > 0]
    off = np.abs(planes(keys, canvas.opaque)[:, :, None] - planes(some, canvas.opaque)[:, None]).max(axis=0)
    near = off <= PATCH / 2
    return np.where(near.any(axis=1), some[near.argmax(axis=1)], keys) if some.size else keys


def _settled(canvas: Canvas, cells: np.ndarray, low: np.ndarray, high: np.ndarray, known: np.ndarray,
             beside: np.ndarray, bound: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Packed colours of pixels, the nearest `known` one where ringing explains the rest, and that.

    That are `bound` (K,) only `beside` their plateaus: mixes of others elsewhere are what two rows of a
    thin stroke have.  What the plateau beside it explains as one straight edge does is no other colour.
    """
    here = canvas.colours(cells)
    best: np.ndarray = canvas.keys[cells]
    least = np.full(best.size, np.inf, np.float32)
    plain = np.zeros(best.size, bool)
    reach = ROUNDING + BESIDE * (high - low)
    for key, colour, near, only in zip(known, planes(known, canvas.opaque).T, beside, bound):
        off = _unexplained(here, colour[:, None], low, high)
        ringing = near & (np.abs(here - colour[:, None]) <= reach).all(axis=0)
        nearer = (near | ~only) & (off < least) & (ringing | ~plain | (off <= ROUNDING))
        nearer |= ringing & ~plain & np.isfinite(off) & (least > ROUNDING)
        best[nearer], least[nearer], plain[nearer] = key, off[nearer], ringing[nearer]
    return best, least


def _unexplained(here: np.ndarray, colour: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """How far pixels (C, N) are from colours; infinite where ringing between the lowest and highest explains less."""
    off = here - colour
    beyond = off * (colour - (high + low) / 2) > 0
    off = np.abs(off)
    explained = (off <= ROUNDING + np.where(beyond, BEYOND, SHORT) * (high - low)).all(axis=0)
    return np.where(explained, off.max(axis=0), np.float32(np.inf))


def _clipped_strokes(canvas: Canvas, cells: np.ndarray, span: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Packed colours of thin strokes in black, white, or another colour that clipping keeps from ringing.

    They need no plateaus to be known: beside a single edge none of the `known` colours rings
    as far as that, and the strokes of no other colour would all end there.
    """
    values, index, counts = np.unique(canvas.keys[cells], return_inverse=True, return_counts=True)
    channels = planes(values, True)
    clipped = ((channels == 0) | (channels == 255)).all(axis=0)
    found = []
    for k in np.flatnonzero((counts >= _FEW) & clipped):
        off = np.abs(planes(values[k:k + 1], canvas.opaque) - planes(known, canvas.opaque))
        far = (off[:, :, None] > ROUNDING + BESIDE * span[:, None, index == k]).any(axis=0).all(axis=0)
        if np.count_nonzero(far) >= _FEW:
            found.append(values[k])
    return np.array(found, np.uint32)


def _ranges(canvas: Canvas) -> Tuple[np.ndarray, np.ndarray]:
    """Lowest and highest values of each channel within 7 x 7 of each pixel, int16 (C, P)."""
    values = planes(canvas.keys.reshape(-1, canvas.stride), canvas.opaque).astype(np.int16)
    low, high = (within(values, RIM, extreme).reshape(len(values), -1) for extreme in (np.minimum, np.maximum))
    return low, high
