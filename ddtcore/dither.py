# SPDX-License-Identifier: GPL-2.0-or-later
"""Dithered areas: dots of a few colours give way to the mixed colour that they stand for.

A picture whose colours were reduced, as in a GIF, has dots of two or more of the colours left
where it had one of those lost.  Which colours stand for others is told from lone dots near a
place: the mean of these colours alone, over what is not flat, is the colour they stand for.
So edges and strokes beside them stay as they are.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Optional, Tuple

import numpy as np

from .canvas import Canvas, count_keys, summed_keys, unpack, within
from .noise import REDUCED
from .palette import plain_colours
from .parts import in_parts
from .sides import window

SHARE = 0.01
"""Smallest share of a picture's area that is dithered."""

DOTTED = 0.006
"""Smallest share of its pixels that lie between two of another colour, in rows or in columns: strokes make fewer."""

BLOCK = 4
"""Which colours are mixed is told for squares with this side, from dots in it and the eight round it, px."""

LONE, EVIDENCE = 4, 8
"""What a dot among four equal pixels counts more than one between two, and how much two colours need to be mixed."""

CHAIN = 3
"""A dot between others of its colour on opposite sides, and so few in all, belongs to a line."""

REACH = 2
"""Means are taken over pixels up to so far away, twice, and squares that reach so far are flat if all equal, px."""

LEFT, SLOPING, STRONGEST = 6.0, 8.0, 12.0
"""How far means are from the colours that dots stand for: most of them in flat areas, on ramps, and at most, levels."""

LESS = 2.0
"""How much less they are so, where they are farther, than the dots themselves."""

_SAMPLE = 1 << 14
_ROUND = (-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)


def undithered(canvas: Canvas, core: np.ndarray) -> Optional[Tuple[Canvas, np.ndarray]]:
    """A picture without dithering, and how far dots round each pixel (P,) were from it, levels, if it has such areas.

    Parameters
    ----------
    canvas : Canvas
    core : ndarray of shape (H, W) and dtype bool
        Pixels in 2 x 2 blocks of equal ones.
    """
    if min(core.shape) < 2 * REACH + 1 or not _is_dotted(canvas, core):
        return None
    palette, _ = count_keys(canvas.keys)
    # Where no colour is a mix of others, each pixel is what it says.
    if palette.size > REDUCED or plain_colours(canvas).size:
        return None
    index = np.searchsorted(palette, canvas.bare(canvas.keys)).astype(np.int16)
    mixed = _mixed_colours(index, palette)
    flat = _flat(index)
    row, col = np.nonzero(~flat)
    owner = (row // BLOCK * (-(-index.shape[1] // BLOCK)) + col // BLOCK) * palette.size + index[row, col]
    place = np.minimum(np.searchsorted(mixed.owner, owner), max(mixed.owner.size - 1, 0))
    some = np.flatnonzero(mixed.owner[place] == owner) if mixed.owner.size else place[:0]
    if some.size < SHARE * core.size:
        return None
    index[flat] = mixed.partners.shape[0] * 64 - 1
    near = canvas.rimmed(index, mixed.partners.shape[0] * 64 - 1)
    dots, keys = canvas.numbers(row[some], col[some]), canvas.keys
    for _ in range(2):
        keys = _averaged(canvas, keys, dots, near, mixed.partners[:, place[some]])
    moved = np.abs(unpack(keys).astype(np.int16) - unpack(canvas.keys)).max(axis=1)
    return replace(canvas, keys=keys), within(moved.reshape(1, -1, canvas.stride), REACH, np.maximum).ravel()


def _is_dotted(canvas: Canvas, core: np.ndarray) -> bool:
    """Whether a picture of few colours, as far as a sample tells, has many pixels between two of another colour."""
    cells = canvas.cells(~core)
    sample = cells[::max(1, cells.size // _SAMPLE)]
    here = canvas.keys[sample]
    if cells.size < SHARE * core.size or np.unique(here).size > REDUCED:
        return False
    between = np.zeros(sample.size, bool)
    for step in (1, canvas.stride):
        side = canvas.keys[sample - step]
        between |= (side == canvas.keys[sample + step]) & (side != here)
    return bool(between.mean() * cells.size >= DOTTED * core.size)


class _Mixed(NamedTuple):
    """Which colours are mixed with which others, block by block."""

    owner: np.ndarray      # (n,) number of the block times the number of colours, and the colour, rising
    partners: np.ndarray   # (words, n) bits of the colours that it is mixed with, itself among them


def _mixed_colours(index: np.ndarray, palette: np.ndarray) -> _Mixed:
    """The colours (H, W) of the `palette` that dots in and round each block tell to be mixed."""
    count, words = palette.size, palette.size // 64 + 1
    row, col, own, other, weight = _dots(index, palette)
    high, wide = (-(-size // BLOCK) for size in index.shape)
    # A rim of blocks keeps those beside the last and the first of a row apart.
    block = (row // BLOCK + 1) * (wide + 2) + col // BLOCK + 1
    codes, sums = summed_keys((block * count + np.minimum(own, other)) * count + np.maximum(own, other), weight)
    around = np.array([down * (wide + 2) + across for down, across in (*_ROUND, (0, 0))]) * count * count
    codes, sums = summed_keys((codes + around[:, None]).ravel(), np.tile(sums, len(around)))
    codes = codes[_enough(codes, sums, count)]
    block, pair = np.divmod(codes, count * count)
    down, across = (place - 1 for place in np.divmod(block, wide + 2))
    inside = (down >= 0) & (down < high) & (across >= 0) & (across < wide)
    block, (one, two) = (down * wide + across)[inside], np.divmod(pair[inside], count)
    owner = np.concatenate([block * count + one, block * count + two])
    partner = np.concatenate([two, one])
    order = np.argsort(owner, kind="stable")
    owners, first = np.unique(owner[order], return_index=True)
    bits = np.zeros((words, owners.size), np.uint64)
    if owners.size:
        partner, itself = partner[order], owners % count
        for word in range(words):
            bit = np.where(partner // 64 == word, np.uint64(1) << (partner % 64).astype(np.uint64), np.uint64(0))
            bits[word] = np.bitwise_or.reduceat(bit, first)
            bits[word] |= np.where(itself // 64 == word, np.uint64(1) << (itself % 64).astype(np.uint64), np.uint64(0))
    return _Mixed(owners, bits)


def _enough(codes: np.ndarray, sums: np.ndarray, count: int) -> np.ndarray:
    """Which pairs of colours in blocks there is enough evidence for: half of it if both are mixed with others, too."""
    block, pair = np.divmod(codes, count * count)
    _, number = np.unique(np.concatenate([block * count + pair // count, block * count + pair % count]),
                          return_inverse=True)
    number = number.reshape(2, -1)
    total = np.bincount(number.ravel(), np.tile(sums, 2))
    return np.asarray((sums >= EVIDENCE) | (2 * sums >= EVIDENCE) & (total[number] >= EVIDENCE).all(axis=0))


def _dots(index: np.ndarray, palette: np.ndarray) -> Tuple[np.ndarray, ...]:
    """Row and column of dots, their colour, that at both sides, and how much they count."""
    def beside(down: int, across: int) -> np.ndarray:
        return index[2 + down:len(index) - 2 + down, 2 + across:index.shape[1] - 2 + across]

    inner = beside(0, 0)
    same = {step: beside(*step) == inner for step in _ROUND}
    few = np.sum(list(same.values()), axis=0, dtype=np.int8) <= CHAIN
    found = []
    for down, across in ((0, 1), (1, 0)):
        one = beside(down, across)
        dot = (one == beside(-down, -across)) & ~same[down, across] & (palette[one] > 0) & (palette[inner] > 0)
        chained = few.copy()
        for side in (1, -1):
            chained &= np.any([same[k] for k in _ROUND if k[0] * across + k[1] * down == side], axis=0)
        # Lines with others of their colour at both sides are stripes of dots.
        chained &= (beside(2 * down, 2 * across) != inner) | (beside(-2 * down, -2 * across) != inner)
        dot &= ~chained
        lone = dot & (beside(across, down) == one) & (beside(-across, -down) == one)
        row, col = np.nonzero(dot)
        # Lone dots are met in both directions.
        found.append((row + 2, col + 2, inner[row, col], one[row, col], 1 + lone[row, col] * (LONE // 2)))
    row, col, own, other, weight = (np.concatenate(values) for values in zip(*found))
    return row, col, own.astype(np.int64), other.astype(np.int64), weight


def _flat(index: np.ndarray) -> np.ndarray:
    """Pixels (H, W) in squares of one colour."""
    plane = index[None]
    equal = within(plane, REACH, np.minimum) == within(plane, REACH, np.maximum)
    return np.asarray(within(equal, REACH, np.maximum)[0])


def _averaged(canvas: Canvas, keys: np.ndarray, dots: np.ndarray, near: np.ndarray,
              partners: np.ndarray) -> np.ndarray:
    """Packed pixels (P,) with `dots` (n,) in the mean of the colours near them that are mixed with theirs."""
    rgba = unpack(keys)

    def means(part: slice) -> Tuple[np.ndarray]:
        some, bits = dots[part], partners[:, part]
        total, count = np.zeros((some.size, 4), np.int32), np.zeros((some.size, 1), np.int32)
        for step in np.append(window(canvas.stride, 1, REACH), 0):
            beside = near[some + step].astype(np.uint64)
            word = bits[0] if len(bits) == 1 else bits[(beside >> np.uint64(6)).astype(np.intp), np.arange(some.size)]
            held = (word >> (beside & np.uint64(63)) & np.uint64(1)).astype(np.int32)[:, None]
            total += rgba[some + step] * held
            count += held
        return ((total + count // 2) // count,)

    mean, = in_parts(means, dots.size)
    out = rgba.copy()
    out[dots] = mean
    return np.asarray(out.view(np.uint32)[:, 0])
