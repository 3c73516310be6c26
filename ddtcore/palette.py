# SPDX-License-Identifier: GPL-2.0-or-later
"""The flat colours of a picture: plateaus of equal pixels, and which of them are real.

A plateau is a 2 x 2 block of equal pixels.  An edge between two colours leaves none
in its anti-aliasing, except where a straight stroke under two pixels covers two rows
(or columns) equally: such a block lies between equal pixels and its colour is a mix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from . import narrow
from .canvas import RIM, Canvas, count_keys, planes, summed_keys
from .loops import ranges
from .mixes import segment_distance
from .parts import in_parts
from .sides import window

MANY = 256
"""Most colours of an automatic palette."""

MIXED = 10.0
"""How far off the line between two colours their mixes may lie, levels."""

TWIN = 8
"""How near two colours are that anti-aliasing makes hard to tell apart, levels."""

PIECE = 12
"""Where there are soft ramps: smallest plateau that is no piece of one, px²."""

LIKE = 14
"""How far apart pieces of a soft ramp may be, and shades that are no colours of their own, levels."""

ELBOWS = 3
"""Fewest corners of three equal pixels that make a colour without plateaus real."""

CORNERED = 0.1
"""Smallest share of such corners among the pixels of one that is a mix: of many equal mixes some meet by chance."""

SOUND = 1 / 8
"""Blocks that no thin stroke explains, for each pixel of a colour's plateaus, from which the colour is real."""

WIDE = 0.25
"""Share of surrounded pixels among those of a mixed colour from which it fills areas, not only strips."""

CLEAN = 2.0
"""Largest noise of a picture that isn't noisy, levels."""

HARD = 0.95
"""Share of palette colours among the pixels that are no plateaus from which edges count as hard."""

_WEIGHED = 48
_SAMPLE = 1 << 12
_FEW = 1 << 14
_CLEAR = 16


@dataclass(frozen=True)
class Plateaus:
    """Where a picture is flat, and the colours there, the most frequent first.

    Attributes
    ----------
    core : ndarray of shape (H, W) and dtype bool
        Pixels in a 2 x 2 block of equal ones.
    keys : ndarray of shape (K,) and dtype uint32
        Their different colours, packed.
    counts : ndarray of shape (K,) and dtype int64
        Pixels of each in `core`.
    full : ndarray of shape (K,) and dtype int64
        Pixels of each whose eight neighbours are all equal to it.
    sound : ndarray of shape (K,) and dtype int64
        Blocks that a single thin stroke cannot explain; counted only where `full` is 0.
    skipped : ndarray of shape (H, W) and dtype bool
        Pixels that were not asked.
    """

    core: np.ndarray
    keys: np.ndarray
    counts: np.ndarray
    full: np.ndarray
    sound: np.ndarray
    skipped: np.ndarray


def find_plateaus(canvas: Canvas, skip: np.ndarray) -> Plateaus:
    """Find the plateaus of a picture and count the pixels of each colour, but for those in `skip` (H, W)."""
    key = canvas.bare(canvas.keys)
    core, block, *counted = in_parts(lambda rows: _flat_rows(key, skip, rows), len(key), size=key.shape[1])
    keys, counts = summed_keys(*counted[:2])
    inner = _tally(keys, *counted[2:])
    sound = _tally(keys, *count_keys(_sound_blocks(canvas, block, keys[inner == 0], bool(skip.any()))))
    order = np.argsort(-counts, kind="stable")
    return Plateaus(core, keys[order], counts[order], inner[order], sound[order], skip)


def _flat_rows(key: np.ndarray, skip: np.ndarray, rows: slice) -> Tuple[np.ndarray, ...]:
    """Which pixels of some rows lie in 2 x 2 equal ones, which begin such a block, and two counts by colour:
    of the former, and of those whose eight neighbours are equal, too."""
    first, last = max(rows.start - 1, 0), min(rows.stop + 1, len(key))
    some, wanted = key[first:last], ~skip[first:last]
    down = some[1:] == some[:-1]
    blocks = (some[1:, 1:] == some[1:, :-1]) & down[:, :-1]
    blocks &= down[:, 1:]
    full = blocks[1:] & blocks[:-1]
    full = full[:, 1:] & full[:, :-1] & wanted[1:-1, 1:-1]
    top = rows.start - first
    own = wanted[top:top + rows.stop - rows.start]
    below, above = blocks[top:], blocks[:rows.stop - 1 - first]
    core = np.zeros(own.shape, bool)
    core[:len(below), :-1] = below
    core[len(core) - len(above):, :-1] |= above
    core[:, 1:] |= core[:, :-1]
    core &= own
    counts = count_keys(some[top:top + len(core)][core]), count_keys(some[1:-1, 1:-1][full])
    return (core, below & own[:len(below), :-1], *counts[0], *counts[1])


def _tally(keys: np.ndarray, values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """How often each of `keys` (rising) was counted among some values, all of which are such."""
    return np.bincount(np.searchsorted(keys, values), counts, keys.size).astype(np.int64)


def _sound_blocks(canvas: Canvas, block: np.ndarray, weak: np.ndarray, strips: bool) -> np.ndarray:
    """Colours of the blocks of `weak` ones (rising) that do not lie between two equal pairs of pixels.

    In `strips` with unlike sides, too, where these are not asked again: pairs further along one do not count.
    """
    if not weak.size:
        return weak
    key, down = canvas.keys, canvas.stride

    def weak_ones(rows: slice) -> Tuple[np.ndarray]:
        here = canvas.bare(key)[rows, :block.shape[1]]
        heads = np.ones(here.shape, bool)
        np.not_equal(here[:, 1:], here[:, :-1], out=heads[:, 1:])
        begin, colour = np.flatnonzero(heads), here[heads]
        count = np.diff(np.append(begin, here.size))
        some = np.flatnonzero(weak.take(np.searchsorted(weak, colour), mode="clip") == colour)
        found = ranges(begin[some], count[some])
        row, col = np.divmod(found[block[rows].ravel()[found]].astype(np.int32), np.int32(here.shape[1]))
        return (canvas.numbers(row + np.int32(rows.start), col),)

    at, = in_parts(weak_ones, len(block), size=canvas.stride)
    sound = np.ones(at.size, bool)
    for across, along in ((down, 1), (1, down)):
        side = key[at - across]
        pair = side == key[at + 2 * across]
        pair &= side == key[at - across + along]
        pair &= side == key[at + 2 * across + along]
        if strips:
            pair &= side != key[at]
        sound &= ~pair
    return np.asarray(key[at[sound]])


def plain_colours(canvas: Canvas) -> np.ndarray:
    """The packed colours, the most frequent first, of a picture that has few and no mixes of them; else none.

    There is no anti-aliasing in such a picture: each pixel is what it says, however small its area.
    """
    none = np.zeros(0, np.uint32)
    if np.unique(canvas.keys[::max(1, canvas.keys.size // _SAMPLE)]).size > _WEIGHED:
        return none
    keys, counts = count_keys(canvas.keys)
    colours = planes(keys[:_WEIGHED], canvas.opaque)
    if keys.size > _WEIGHED or is_mixed(colours, colours).any() or _has_twin(colours).any():
        return none
    return keys[np.argsort(-counts, kind="stable")]


def choose_colours(canvas: Canvas, plateaus: Plateaus, ramps: bool) -> np.ndarray:
    """The packed colours that are real, the most frequent first.

    A colour with a fully surrounded pixel is real.  Others need blocks that no thin
    stroke explains: one, or several where other colours mix to theirs.  Where there
    are soft `ramps`, small plateaus like a larger one are pieces of a thin ramp.
    """
    colours = planes(plateaus.keys, canvas.opaque)
    keep = plateaus.full > 0
    weak = np.flatnonzero(~keep & (plateaus.sound > 0))[:MANY]
    needed = np.maximum(3, SOUND * plateaus.counts[weak])
    unmixed = ~is_mixed(colours[:, weak], colours[:, keep])
    # Those that stay below it are asked again when the colours of strokes are known.
    needed[unmixed] = 1 if ramps else np.maximum(1, SOUND * plateaus.counts[weak[unmixed]])
    keep[weak[plateaus.sound[weak] >= needed]] = True
    if ramps:
        keep &= plateaus.counts >= PIECE
        for k in np.flatnonzero(keep & (plateaus.full < PIECE)):
            off = np.abs(colours[:, :k][:, keep[:k]] - colours[:, k:k + 1]).max(axis=0)
            keep[k] = not (off < LIKE).any()
    chosen = plateaus.keys[keep][:MANY]
    return chosen if ramps else np.append(chosen, _elbow_colours(canvas, plateaus, chosen))[:MANY]


def unmixed_colours(canvas: Canvas, plateaus: Plateaus, chosen: np.ndarray) -> np.ndarray:
    """Packed colours of plateaus that a thin stroke could explain, but none in colours already `chosen`."""
    some = plateaus.keys[(plateaus.full == 0) & (plateaus.sound < SOUND * plateaus.counts)][:MANY]
    colours, known = planes(some, canvas.opaque), planes(chosen, canvas.opaque)
    alike = (np.abs(colours[:, :, None] - known[:, None]).max(axis=0) < LIKE).any(axis=1)
    return np.asarray(some[~alike & ~is_mixed(colours, known)])


def _elbow_colours(canvas: Canvas, plateaus: Plateaus, chosen: np.ndarray) -> np.ndarray:
    """Packed colours unlike those `chosen` that occur several times in three equal pixels round a corner.

    Anti-aliasing of one edge makes no such three, and strokes too narrow for plateaus do.
    """
    cells, key, down = canvas.cells(~plateaus.core), canvas.keys, canvas.stride
    here = key[cells]
    elbow = (here == key[cells + 1]) | (here == key[cells - 1])
    elbow &= (here == key[cells + down]) | (here == key[cells - down])
    elbow[elbow] = _interior(canvas, cells[elbow])
    keys, counts = np.unique(here[elbow], return_counts=True)
    several = (counts >= ELBOWS) & ~np.isin(keys, plateaus.keys)
    keys, counts = keys[several], counts[several]
    colours, known = planes(keys, canvas.opaque), planes(chosen, canvas.opaque)
    unlike = ~(np.abs(colours[:, :, None] - known[:, None]).max(axis=0) < LIKE).any(axis=1)
    keys, counts = keys[unlike], counts[unlike]
    mixed = is_mixed(colours[:, unlike], known)
    if mixed.any():
        _, total = count_keys(here[np.isin(here, keys[mixed])])
        mixed[mixed] = counts[mixed] < CORNERED * total
    return np.asarray(keys[~mixed])


def _interior(canvas: Canvas, cells: np.ndarray) -> np.ndarray:
    """Which pixels do not lie on the picture's outermost rows and columns."""
    row, col = canvas.places(cells)
    return (row > 0) & (row < canvas.shape[0] - 1) & (col > 0) & (col < canvas.shape[1] - 1)


def is_mixed(colours: np.ndarray, among: np.ndarray, margin: float = MIXED) -> np.ndarray:
    """Which colours (C, N) lie near a line between two others of `among` (C, K), and not near its ends.

    How far off it mixes may lie is a `margin`, levels.  Only the first colours of `among` are
    weighed, so that the work stays bounded.
    """
    among = among[:, :_WEIGHED]
    first, second = (among[:, side] for side in np.triu_indices(among.shape[1], 1))
    mixed = np.zeros(colours.shape[1], bool)
    for k, colour in enumerate(colours.T):
        colour = np.broadcast_to(colour[:, None], first.shape)
        distance, share = segment_distance(colour, first, second)
        end = (first == colour).all(axis=0) | (second == colour).all(axis=0)
        mixed[k] = bool(((distance < margin) & (share > 0.04) & (share < 0.96) & ~end).any())
    return mixed


def known_labels(canvas: Canvas, plateaus: Plateaus, keys: np.ndarray, noise: float) -> np.ndarray:
    """Labels of the pixels that surely have one of the colours `keys`, int16 (P,) with the rim, else -1.

    Sure are plateaus, also those where pixels vary by the level of `noise`; and pixels of
    a colour that is no mix of others, wherever two of them touch; in a picture without
    anti-aliasing all that have a colour of the palette.
    """
    if not keys.size:
        return np.full(canvas.keys.size, -1, np.int16)
    colours, labels = planes(keys, canvas.opaque), _exact_labels(canvas, keys)
    mixed, twins = is_mixed(colours, colours), _has_twin(colours)
    plain = ~(mixed | twins)
    plain[_WEIGHED:] = False
    bare, core, skipped = canvas.bare(labels), plateaus.core, plateaus.skipped
    asked, = in_parts(
        lambda rows: (canvas.cells(((bare[rows] < 0) | ~core[rows]) & ~skipped[rows], rows.start),),
        canvas.shape[0], size=canvas.stride)
    if skipped.any():
        bare[skipped] = -1
    exact = labels[asked] >= 0
    hard = np.count_nonzero(exact) > HARD * asked.size
    if hard:
        sure = exact
    else:
        sure = exact & np.append(plain, False)[labels[asked]]
        sure[sure] = _touches_equal(labels, asked[sure], canvas.stride)
    labels[asked], = in_parts(lambda part: (_nearest_within(canvas, asked[part], colours, noise),), asked.size)
    asked = asked[~sure & (labels[asked] >= 0)]
    inside, = in_parts(lambda part: (_in_block(labels, asked[part], canvas.stride),), asked.size)
    labels[asked[~inside]] = -1
    if noise <= CLEAN and not hard and not skipped.any():
        narrow.clear_strips(canvas, labels, mixed & ~twins & _in_strips(plateaus, keys))
    return labels


def _in_strips(plateaus: Plateaus, keys: np.ndarray) -> np.ndarray:
    """Which colours `keys` fill few pixels that all eight neighbours equal, bool (K,)."""
    narrow_ones = plateaus.keys[plateaus.full < WIDE * plateaus.counts]
    return np.isin(keys, narrow_ones)


def _exact_labels(canvas: Canvas, keys: np.ndarray) -> np.ndarray:
    """Labels (P,) of the pixels that equal one of the colours `keys`; -1 elsewhere and on the rim."""
    order = np.argsort(keys).astype(np.int16)
    framed = canvas.keys.reshape(-1, canvas.stride)

    def of(rows: slice) -> Tuple[np.ndarray]:
        flat = framed[rows].ravel()
        heads = np.flatnonzero(np.append(True, flat[1:] != flat[:-1]))
        value = flat[heads]
        place = np.minimum(np.searchsorted(keys[order], value), keys.size - 1)
        label = np.where(keys[order][place] == value, order[place], np.int16(-1))
        return (np.repeat(label, np.diff(np.append(heads, flat.size))).reshape(-1, canvas.stride),)

    labels, = in_parts(of, len(framed), size=canvas.stride)
    labels[:RIM], labels[-RIM:], labels[:, :RIM], labels[:, -RIM:] = -1, -1, -1, -1
    return labels.ravel()


def _has_twin(colours: np.ndarray) -> np.ndarray:
    """Which colours (C, K) are hard to tell from another one."""
    off = np.abs(colours[:, :, None] - colours[:, None]).max(axis=0)
    return np.asarray((off < TWIN).sum(axis=0) > 1)


def _nearest_within(canvas: Canvas, cells: np.ndarray, colours: np.ndarray, margin: float) -> np.ndarray:
    """The label whose colour is within a margin of the pixel's in each channel, else or if undecided -1."""
    # Along a row of a ramp, pixels equal the one before them more often than not.
    keys = canvas.keys[cells]
    heads = np.flatnonzero(np.append(True, keys[1:] != keys[:-1])[:cells.size])
    here = planes(keys[heads], canvas.opaque)
    label = np.full(heads.size, -1, np.int16)
    least = np.full(heads.size, margin + 0.5, np.float32)
    for k, colour in enumerate(colours.T):
        off = np.abs(here[0] - colour[0])
        for plane, level in zip(here[1:], colour[1:]):
            np.maximum(off, np.abs(plane - level), out=off)
        label[off == least] = -1
        nearer = off < least
        label[nearer], least[nearer] = k, off[nearer]
    return np.repeat(label, np.diff(np.append(heads, cells.size)))


def _touches_equal(labels: np.ndarray, cells: np.ndarray, stride: int) -> np.ndarray:
    """Which pixels have the label of one of their eight neighbours."""
    here = labels[cells]
    equal = np.zeros(cells.size, bool)
    for step in window(stride, 1, 1):
        equal |= labels[cells + step] == here
    return equal


def _in_block(labels: np.ndarray, cells: np.ndarray, stride: int) -> np.ndarray:
    """Which pixels lie in a 2 x 2 block of equal labels."""
    here = labels[cells]
    inside = np.zeros(cells.size, bool)
    for down in (-stride, stride):
        vertical = labels[cells + down] == here
        for across in (-1, 1):
            inside |= vertical & (labels[cells + across] == here) & (labels[cells + down + across] == here)
    return inside
