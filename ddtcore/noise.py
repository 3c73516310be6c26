# SPDX-License-Identifier: GPL-2.0-or-later
"""How much the flat colours of a picture vary: by rounding only, or by JPEG and resizing.

Clean flat art changes at its edges only, by large steps.  JPEG and resampling filters
leave small, uneven ripples at some distance from edges too.
"""

from __future__ import annotations

from typing import List, Optional, Tuple

import numpy as np

from .canvas import LUMA, RIM, Canvas, count_keys, planes, unpack, within
from .mixes import segment_distance
from .palette import MIXED, Plateaus, is_mixed
from .sides import window

ROUNDING = 2.0
"""How far a renderer's rounding may move a flat colour, levels."""

STRONGEST = 24.0
"""Largest noise that is reckoned with, levels."""

UNSTEADY = 0.0015
"""Least share of zigzags of four steps in a picture with ripples: a stroke with a light and a dark side has three."""

SOFT = 24.0
"""Largest range of a channel within 7 x 7 pixels where zigzags are looked for, levels."""

SPECK = 12.0
"""Regions smaller than this in a noisy picture are ripples, px²."""

REDUCED = 64
"""Most colours on the edges of a picture whose colours were reduced."""

SLOPING = 0.1
"""Share of a picture's area that its ramps have if they are no ripples."""

EVEN = 0.25, 0.5
"""How even in brightness pixels are that are asked for colours nearly like others, as shares of the noise."""

APART = 1.5
"""How much brighter or darker such colours are at least, as a multiple of that."""

_LOW = 32
_HIGH = 48
_UNEVEN = 2
_TURN = 2
_APART = 8
_SAMPLE = 1 << 14
_VOTES = 1 << 16
_FEW = 13
_MINOR = 200.0
_RARE = 1000.0
_SMALL = 24
_JUDGED = 500
_WIDE = 32
_MANY = 64
_SHIFTS = 2
_BLED = 1.5


def noise_level(canvas: Canvas, core: np.ndarray, slopes: np.ndarray) -> Tuple[float, bool]:
    """How far pixels of flat areas may be from their colour, levels; `ROUNDING` for a clean picture.

    And whether there are ripples at all, be it between ramps only.

    Parameters
    ----------
    core : ndarray of shape (H, W) and dtype bool
        Pixels of plateaus.
    slopes : ndarray of shape (H, W) and dtype int16
        Number of the soft ramp of each pixel, -1 where there is none.
    """
    if slopes.max(initial=-1) >= 0 and zigzags(canvas, 4) >= UNSTEADY:
        core = core | _even_parts(canvas, slopes)
    level = ripple_level(canvas, core)
    if level > ROUNDING and sloping_area(canvas, slopes) > SLOPING * slopes.size:
        return ROUNDING, True
    return level, level > ROUNDING


def ripple_level(canvas: Canvas, core: np.ndarray) -> float:
    """How high ripples beside the plateaus `core` (H, W) are, levels; `ROUNDING` where there are none."""
    uneven, span, share = _uneven(canvas, core)
    rippled = np.mean(uneven & (span <= _LOW)) if uneven.size else 0.0
    if rippled < 0.05 or rippled * share < 0.005:
        return ROUNDING
    return float(min(STRONGEST, 1.3 * np.median(span[uneven])))


def rippled_share(canvas: Canvas, core: np.ndarray) -> float:
    """Share of the pixels that are no plateaus, `core` (H, W), where there are ripples."""
    uneven, span, _ = _uneven(canvas, core)
    return float(np.mean(uneven & (span <= _LOW))) if uneven.size else 0.0


def _uneven(canvas: Canvas, core: np.ndarray) -> Tuple[np.ndarray, np.ndarray, float]:
    """Which of a sample of pixels that are no plateaus are uneven, their `_spans`, and the share of all such pixels."""
    mixed = np.zeros(core.shape, bool)
    # What goes on along the border is a strip of another colour, not a ripple.
    mixed[1:-1, 1:-1] = ~core[1:-1, 1:-1]
    cells = canvas.cells(mixed)
    share = cells.size / core.size
    cells = cells[::max(1, cells.size // _SAMPLE)]
    here, span = canvas.colours(cells), _spans(canvas, cells)
    bends = [canvas.colours(cells - step) + canvas.colours(cells + step) - 2 * here
             for step in (1, canvas.stride)]
    uneven = (np.abs(bends).max(axis=(0, 1)) > _UNEVEN) & (span <= _HIGH)
    uneven[uneven] = ~between_plateaus(canvas, core, cells[uneven], span[uneven], 2)
    return uneven, span, share


def _even_parts(canvas: Canvas, slopes: np.ndarray) -> np.ndarray:
    """Pixels (H, W) of the colour that half of a ramp has: a flat area with ripples along it, not more."""
    some = np.flatnonzero(slopes.ravel() >= 0)
    some = some[::max(1, some.size // _SAMPLE)]
    keys, ramp = canvas.bare(canvas.keys), slopes.ravel()[some].astype(np.uint64)
    pairs, counts = np.unique(ramp << np.uint64(32) | keys.ravel()[some], return_counts=True)
    ramp = (pairs >> np.uint64(32)).astype(np.intp)
    most = 2 * counts > np.bincount(ramp, counts)[ramp]
    if not most.any():
        return np.zeros(slopes.shape, bool)
    even, own = np.zeros(int(slopes.max()) + 2, bool), np.zeros(int(slopes.max()) + 2, np.uint32)
    even[ramp[most]], own[ramp[most]] = True, pairs[most].astype(np.uint32)
    return np.asarray(even[slopes] & (own[slopes] == keys))


def zigzags(canvas: Canvas, count: int) -> float:
    """Share of the pixels of soft areas where so many steps in a row, 3 or 4, go up and down by turns."""
    cells = canvas.cells(np.ones(canvas.shape, bool))
    cells = cells[::max(1, cells.size // (2 * _SAMPLE))]
    around = canvas.colours(cells + np.append(window(canvas.stride, 1, RIM), 0)[:, None])
    span = (around.max(axis=1) - around.min(axis=1)).max(axis=0)
    cells = cells[(span > ROUNDING) & (span <= SOFT)]
    turning = np.zeros(cells.size, bool)
    for step in (1, canvas.stride):
        places = (np.arange(count + 1) - count // 2) * step
        steps = np.diff(canvas.colours(cells + places[:, None]), axis=1)
        steps[:, ::2] *= -1
        for sign in (1, -1):
            turning |= (sign * steps >= _TURN).all(axis=1).any(axis=0)
    return float(turning.sum() / max(turning.size, 1))


def mixing_error(canvas: Canvas, labels: np.ndarray, cells: np.ndarray) -> float:
    """How far most pixels on edges are from mixes of their two sides, levels; `ROUNDING` if no farther.

    Far in a picture of few colours that took the place of the mixes, as in a GIF.

    Parameters
    ----------
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    cells : ndarray of shape (N,)
        Pixels that are no plateaus.
    """
    cells = cells[labels[cells] < 0]
    cells = cells[::max(1, cells.size // _SAMPLE)]
    if np.unique(canvas.keys[cells]).size > REDUCED:
        return ROUNDING
    errors = []
    for step in (1, canvas.stride):
        for before, after in ((1, 1), (1, 2), (2, 1)):
            one, other = labels[cells - before * step], labels[cells + after * step]
            at = cells[(one >= 0) & (other >= 0) & (one != other)]
            sides = canvas.colours(at - before * step), canvas.colours(at + after * step)
            errors.append(segment_distance(canvas.colours(at), *sides)[0])
    error = np.concatenate(errors)
    # What is farther off belongs to strokes between the two sides.
    near = error[error < STRONGEST]
    if near.size < max(_JUDGED, 0.5 * error.size):
        return ROUNDING
    return max(ROUNDING, float(np.percentile(near, 75)))


def _spans(canvas: Canvas, cells: np.ndarray) -> np.ndarray:
    """How much the colours within 3 x 3 of pixels differ, levels: the largest range of a channel."""
    around = canvas.colours(cells + np.append(window(canvas.stride, 1, 1), 0)[:, None])
    return np.asarray((around.max(axis=1) - around.min(axis=1)).max(axis=0))


def between_plateaus(canvas: Canvas, core: np.ndarray, cells: np.ndarray, span: np.ndarray,
                     reach: int) -> np.ndarray:
    """Whether pixels lie between plateaus, within reach, that differ as much as their surroundings: faint edges."""
    around = cells + window(canvas.stride, 1, reach)[:, None]
    colours, flat = canvas.colours(around), canvas.rimmed(core, False)[around]
    highest = np.where(flat, colours, -np.inf).max(axis=1)
    lowest = np.where(flat, colours, np.inf).min(axis=1)
    apart = (highest - lowest).max(axis=0)
    return np.asarray((apart > _APART) & (apart >= 0.8 * span))


def noisy_colours(canvas: Canvas, plateaus: Plateaus, noise: float, original: float,
                  skip: Optional[np.ndarray] = None) -> np.ndarray:
    """The packed colours of a noisy picture: those of large plateaus, then others that fill areas.

    What lies near a colour already found is taken for a variation of it: plateaus within
    `noise`, other pixels within twice that.  These have to be flat within 3 x 3, the more
    so where other colours mix to theirs.  The flatter pixels are, the less they vary: many
    that are twice as flat may be half as far from a colour and none of its variations.
    What the `original` noise, before it was averaged away, may have moved away from black
    and white, or either end of a channel, lies there.  Pixels in `skip` (H, W) do not count.
    """
    least = max(_WIDE, 0.0002 * plateaus.core.size)
    found = unlike(canvas, plateaus.keys[(plateaus.full >= least) | (plateaus.counts >= 4 * least)], noise)
    cells = canvas.cells(np.ones(canvas.shape, bool) if skip is None else ~skip)
    cells = cells[::max(1, cells.size // _VOTES)]
    keys, spans = canvas.keys[cells], _spans(canvas, cells)
    if original == noise and skip is None and canvas.opaque:
        _add_told_apart(canvas, found, noise)
    for margin in (noise / 2, noise) if original == noise else (noise,):
        flat = spans <= 2 * margin
        crowds: List[float] = []
        for known in found:
            off = _apart(canvas, keys, known)
            flat &= off > 2 * margin
            crowds.append(margin < noise and np.count_nonzero((spans <= margin) & (off <= margin)) / _MINOR)
        _gather(canvas, keys[flat], spans[flat], found, crowds, margin, noise, original)
    return _clipped(np.array(found, np.uint32), original / 4)


def _add_told_apart(canvas: Canvas, found: List[np.uint32], noise: float) -> None:
    """Add the colours that brightness tells from those found that are nearly like them.

    It is the hue that JPEG moves most: in small areas pixels are hardly ever flat in all channels,
    but often in brightness, and ripples there are no larger than these pixels differ from each other.
    """
    levels = planes(canvas.bare(canvas.keys), True)
    levels = np.concatenate([levels, np.tensordot(LUMA, levels, 1)[np.newaxis]])
    spans = within(levels, 1, np.maximum) - within(levels, 1, np.minimum)
    smooth = spans.max(axis=0) <= noise
    for margin in noise * np.array(EVEN):
        keys, counts = count_keys(canvas.bare(canvas.keys)[smooth & (spans[-1] <= margin)])
        _gather_told_apart(canvas, keys, counts, found, margin, noise)


def _gather_told_apart(canvas: Canvas, keys: np.ndarray, counts: np.ndarray, found: List[np.uint32], margin: float,
                       noise: float) -> None:
    """The same for packed colours (N,) of which there are `counts`, and which are flat within a margin."""
    crowds = [counts[_is_alike(keys, known, margin, noise)].sum() for known in found]
    left = ~np.any([_is_alike(keys, known, margin, noise) for known in found] or [np.zeros(keys.size, bool)], axis=0)
    for _ in range(_MANY):
        if counts[left].sum() < _SMALL:
            break
        centre = mode = keys[np.argmax(counts * left)]
        for _ in range(_SHIFTS):
            alike = left & _is_alike(keys, centre, margin, noise)
            centre = _centre(np.repeat(keys[alike], counts[alike]), noise) if alike.any() else centre
        alike, known = left & _is_alike(keys, centre, margin, noise), np.array(found, np.uint32)
        near = _apart(canvas, known, centre) <= 2 * noise
        least = max(_SMALL, (near * crowds).max(initial=0) / _RARE)
        if counts[alike].sum() >= least and not _is_alike(known, centre, margin, noise).any():
            found.append(centre)
            crowds.append(counts[alike].sum())
        left &= ~alike & (keys != mode)


def _is_alike(keys: np.ndarray, key: np.uint32, margin: float, noise: float) -> np.ndarray:
    """Which packed colours differ from one of them by ripples only, in brightness by few."""
    off = planes(keys, True) - planes(np.array([key], np.uint32), True)
    return np.asarray((np.abs(off).max(axis=0) <= 2 * noise) & (np.abs(LUMA @ off) <= APART * margin))


def _gather(canvas: Canvas, keys: np.ndarray, spans: np.ndarray, found: List[np.uint32], crowds: List[float],
            margin: float, noise: float, original: float) -> None:
    """Add the colours round which pixels (N,) gather to those found.

    `crowds` tells for each colour found how many flat pixels there have to be of one next to
    it, none if a colour that is no mix needs no flat ones.
    """
    while keys.size and len(found) < _MANY:
        values, counts = np.unique(keys, return_counts=True)
        centre = mode = values[np.argmax(counts)]
        # From the most frequent of noisy values to where most of them are round it.
        for _ in range(_SHIFTS):
            off = _apart(canvas, keys, centre)
            centre = _centre(keys[off <= noise], original) if (off <= noise).any() else centre
        alike = off <= margin
        known, own = (planes(np.array(some, np.uint32), canvas.opaque) for some in (found, [centre]))
        apart = np.abs(known - own).max(axis=0)
        least = crowds[apart.argmin()] if found else 0
        flat = np.count_nonzero(alike & (spans <= margin))
        mixed = is_mixed(own, known, max(MIXED, _BLED * noise))[0]
        # Means of what the original noise made alike are mixes, too.
        told = not mixed or apart.min() > original
        if told and (flat if least or mixed else np.count_nonzero(alike)) >= max(_FEW, least):
            found.append(centre)
            crowds.append(least and flat / _MINOR)
        left = (off > 2 * margin) & (keys != mode)
        keys, spans = keys[left], spans[left]


def _clipped(keys: np.ndarray, margin: float) -> np.ndarray:
    """Packed colours with channels at 0 or 255 that are nearly so, which is by far the most likely value there."""
    rgba = unpack(keys).copy()
    rgba[..., :3][rgba[..., :3] <= margin] = 0
    rgba[rgba >= 255 - margin] = 255
    return rgba.view(np.uint32)[:, 0]


def _centre(keys: np.ndarray, noise: float) -> np.uint32:
    """The median colour of packed ones; black or white if near that, 0 or 255 where many are clipped."""
    rgba = unpack(keys)
    middle = np.median(rgba, axis=0).astype(np.uint8)
    for end in (0, 255):
        if np.abs(middle[:3].astype(int) - end).max() <= noise / 3:
            middle[:3] = end
        middle[(rgba == end).mean(axis=0) > 0.25] = end
    return np.uint32(middle.view(np.uint32)[0])


def unlike(canvas: Canvas, keys: np.ndarray, margin: float) -> List[np.uint32]:
    """The packed colours that differ by more than a margin from all before them."""
    found: List[np.uint32] = []
    while keys.size and len(found) < _MANY:
        found.append(keys[0])
        keys = keys[_apart(canvas, keys, keys[0]) > margin]
    return found


def _apart(canvas: Canvas, keys: np.ndarray, key: np.uint32) -> np.ndarray:
    """Largest difference of a channel between packed colours and one of them."""
    off = planes(keys, canvas.opaque) - planes(np.array([key], np.uint32), canvas.opaque)
    return np.asarray(np.abs(off).max(axis=0))


def sloping_area(canvas: Canvas, slopes: np.ndarray) -> int:
    """Area, px², of the ramps that are no flat areas with ripples: none of their colours has half of it."""
    some = slopes >= 0
    ramp = slopes[some].astype(np.uint64)
    pairs, counts = count_keys(ramp << np.uint64(32) | canvas.bare(canvas.keys)[some])
    area = np.bincount(slopes[some])
    most = np.zeros(area.size, np.int64)
    np.maximum.at(most, (pairs >> np.uint64(32)).astype(np.intp), counts)
    return int(area[2 * most < area].sum())
