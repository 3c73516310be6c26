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

from .canvas import Canvas, planes, premultiply, unpack
from .merging import drop_unused, ward_groups
from .model import Labels
from .sides import segment_distance
from .threshold import mean_colours

MIXED = 10.0
"""How far off the line between two colours their mixes may lie, levels."""


ROUNDING = 2
"""How far a renderer's rounding may move a flat colour, levels."""

_PIECE = 12
_LIKE = 14


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
        Blocks of each that a single thin stroke cannot explain.
    """

    core: np.ndarray
    keys: np.ndarray
    counts: np.ndarray
    full: np.ndarray
    sound: np.ndarray


def find_plateaus(canvas: Canvas, skip: np.ndarray) -> Plateaus:
    """Find the plateaus of a picture and count the pixels of each colour, but for those in `skip` (H, W)."""
    key = canvas.bare(canvas.keys)
    down = key[1:] == key[:-1]
    block = (key[1:, 1:] == key[1:, :-1]) & down[:, :-1]
    block &= down[:, 1:]
    pairs = block[1:] & block[:-1]
    full = pairs[:, 1:] & pairs[:, :-1]
    core = np.zeros(key.shape, bool)
    core[:-1, :-1] = block
    core[1:, :-1] |= block
    core[:, 1:] |= core[:, :-1]
    core &= ~skip
    full &= ~skip[1:-1, 1:-1]
    block &= ~skip[:-1, :-1]

    keys, counts = count_keys(key[core])
    order = np.argsort(-counts, kind="stable")
    inner = tally(keys, *count_keys(key[1:-1, 1:-1][full]))
    weak = keys[inner == 0]
    sound = np.zeros(keys.size, np.int64)
    if weak.size:
        sound = tally(keys, *count_keys(_sound_blocks(canvas, block, weak)))
    return Plateaus(core, keys[order], counts[order], inner[order], sound[order])


def is_noisy(canvas: Canvas) -> bool:
    """Whether hardly any pixel equals its neighbours or continues a soft ramp: a photograph, dither, noise."""
    key = canvas.bare(canvas.keys)
    equal = key[:, 1:] == key[:, :-1]
    return np.count_nonzero(equal) < 0.3 * equal.size


def posterise(canvas: Canvas, most: int) -> Labels:
    """Label the pixels of a picture without flat colours by their nearest of few colours."""
    key = canvas.bare(canvas.keys)
    if np.unique(key.ravel()[::max(1, key.size // 4096)]).size <= most:
        exact, index = np.unique(key, return_inverse=True)
        if exact.size <= most:
            index = index.reshape(key.shape).astype(np.int32)
            return Labels(index, unpack(exact).astype(np.float64), np.zeros(index.shape, bool))
    bytes_ = unpack(key)
    bins = np.zeros(key.shape, np.int32)
    for channel in range(4):
        bins = bins << 4 | bytes_[..., channel] >> 4
    count = np.bincount(bins.ravel(), minlength=1 << 16)
    used = np.flatnonzero(count)
    number = np.zeros(1 << 16, np.int32)
    number[used] = np.arange(used.size)
    mean = mean_colours(canvas, number[bins])
    points = premultiply(mean)
    top = np.argsort(-count[used], kind="stable")[:256]
    group = ward_groups(points[top], count[used][top], min(most, top.size))
    centres = np.stack([np.bincount(group, points[top, c] * count[used][top]) for c in range(4)], axis=-1)
    centres /= np.bincount(group, count[used][top])[:, None]
    nearest = np.argmin(((points[:, None] - centres[None]) ** 2).sum(axis=-1), axis=1)
    index = nearest.astype(np.int32)[number][bins]
    return drop_unused(Labels(index, mean_colours(canvas, index), np.zeros(index.shape, bool)))


def count_keys(keys: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Different values of a 1-D array, sorted, and how often each occurs (by runs: quick where they are long)."""
    if not keys.size:
        return keys, np.zeros(0, np.int64)
    heads = np.concatenate([[0], np.flatnonzero(keys[1:] != keys[:-1]) + 1])
    lengths = np.diff(np.append(heads, keys.size))
    values, number = np.unique(keys[heads], return_inverse=True)
    return values, np.bincount(number, lengths, values.size).astype(np.int64)


def tally(keys: np.ndarray, values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """The counts of `values` in the order of `keys` (sorted, different), 0 where missing."""
    out = np.zeros(keys.size, np.int64)
    out[np.searchsorted(keys, values)] = counts
    return out


def _sound_blocks(canvas: Canvas, block: np.ndarray, weak: np.ndarray) -> np.ndarray:
    """Colours of the blocks of `weak` ones that do not lie between two equal pairs of pixels."""
    row, col = np.nonzero(block)
    at = (row + 3) * canvas.stride + col + 3
    key = canvas.keys
    at = at[np.isin(key[at], weak)]
    s = canvas.stride
    across = [((-1, 0), (2, 0), (0, 1)), ((0, -1), (0, 2), (1, 0))]
    sound = np.ones(at.size, bool)
    for (r0, c0), (r1, c1), (dr, dc) in across:
        one, other, along = r0 * s + c0, r1 * s + c1, dr * s + dc
        here = key[at + one]
        stroke = (here == key[at + other]) & (here == key[at + one + along]) & (here == key[at + other + along])
        sound &= ~stroke
    return key[at[sound]]


def choose_colours(canvas: Canvas, plateaus: Plateaus, ramps: bool) -> np.ndarray:
    """The packed colours that are real, the most frequent first.

    A colour with a fully surrounded pixel is real.  Others need blocks that no thin
    stroke explains: one, or several where other colours mix to theirs.  Where there
    are soft `ramps`, small plateaus like a larger one are pieces of a thin ramp.
    """
    keep = plateaus.full > 0
    colours = planes(plateaus.keys, canvas.opaque)
    for k in np.flatnonzero(~keep):
        blocks = plateaus.counts[k] / 2
        mixed = is_mixed(colours[:, k:k + 1], colours[:, keep])[0]
        keep[k] = plateaus.sound[k] >= max(3, blocks / 4) if mixed else plateaus.sound[k] > 0
    if ramps:
        keep &= plateaus.counts >= _PIECE
        for k in np.flatnonzero(keep & (plateaus.full < _PIECE)):
            off = np.abs(colours[:, :k][:, keep[:k]] - colours[:, k:k + 1]).max(axis=0)
            keep[k] = not (off < _LIKE).any()
    return plateaus.keys[keep]


def is_mixed(colours: np.ndarray, among: np.ndarray, margin: float = MIXED) -> np.ndarray:
    """Which colours (C, N) lie near a line between two of `among` (C, K), not near its ends."""
    first, second = np.triu_indices(among.shape[1], 1)
    mixed = np.zeros(colours.shape[1], bool)
    for k in range(colours.shape[1]):
        c = colours[:, k, None]
        distance, share = segment_distance(c, among[:, first], among[:, second])
        own = ((among[:, first] == c).all(axis=0)) | ((among[:, second] == c).all(axis=0))
        mixed[k] = bool(((distance < margin) & (share > 0.04) & (share < 0.96) & ~own).any())
    return mixed


def known_labels(canvas: Canvas, plateaus: Plateaus, keys: np.ndarray) -> np.ndarray:
    """Labels (H, W) int16 of the pixels that surely have one of the colours `keys`, else -1.

    Sure are plateaus, also those where the renderer's rounding varies by a level or
    two; and pixels of a colour that is no mix of others, wherever they stand.
    """
    key = canvas.bare(canvas.keys)
    labels = np.full(key.shape, -1, np.int16)
    if not keys.size:
        return labels
    order = np.argsort(keys)
    ranked = keys[order]
    place = np.searchsorted(ranked, key)
    np.minimum(place, keys.size - 1, out=place)
    same = ranked[place] == key
    label = order[place].astype(np.int16)
    labels[same] = label[same]
    colours = planes(keys, canvas.opaque)
    mixable = is_mixed(colours, colours) | _has_twin(colours)

    rimmed = canvas.rimmed(labels, -1)
    cells = canvas.cells(~plateaus.core)
    sure = (rimmed[cells] >= 0) & ~mixable[rimmed[cells]]
    rimmed[cells] = _nearest_within(canvas, cells, keys, ROUNDING)
    sure |= (rimmed[cells] >= 0) & _in_block(rimmed, cells, canvas.stride)
    rimmed[cells[~sure]] = -1
    return canvas.bare(rimmed)


def _nearest_within(canvas: Canvas, cells: np.ndarray, keys: np.ndarray, margin: int) -> np.ndarray:
    """The label whose colour differs least in any channel, if by no more than `margin` levels, else -1."""
    here = unpack(canvas.keys[cells]).astype(np.int16)
    label = np.full(cells.size, -1, np.int16)
    least = np.full(cells.size, margin + 1, np.int16)
    for k, colour in enumerate(unpack(keys).astype(np.int16)):
        off = np.abs(here - colour).max(axis=-1)
        label[off == least] = -1
        nearer = off < least
        label[nearer] = k
        least[nearer] = off[nearer]
    return label


def _has_twin(colours: np.ndarray) -> np.ndarray:
    """Which colours (C, K) are hard to tell from another one."""
    off = np.abs(colours[:, :, None] - colours[:, None]).max(axis=0)
    return (off < 4 * ROUNDING).sum(axis=0) > 1


def _in_block(labels: np.ndarray, cells: np.ndarray, stride: int) -> np.ndarray:
    """Which pixels lie in a 2 x 2 block of equal labels."""
    here = labels[cells]
    inside = np.zeros(cells.size, bool)
    for down in (-stride, stride):
        vertical = labels[cells + down] == here
        for across in (-1, 1):
            inside |= vertical & (labels[cells + across] == here) & (labels[cells + down + across] == here)
    return inside
