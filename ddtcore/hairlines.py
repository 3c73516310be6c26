# SPDX-License-Identifier: GPL-2.0-or-later
"""The ink of strokes thinner than a pixel, on soft ramps and round them.

Such a stroke covers no pixel, so how far its pixels differ from what is round them says
how much of them it covers, not what colour it has.  Each is a mix of the surfaces at its
two sides, whose colours are known there, and of the ink; the ink is the one colour that
all of them are mixed with.
"""

from __future__ import annotations

from typing import Optional, Tuple

import numpy as np

from .canvas import Canvas, planes
from .mixes import dot, excess, length, third_share
from .sides import window

WIDTH = 1.3
"""A stroke that is wider than this covers some pixels in full, px."""

COVERED = 0.35
"""Coverage of the crest of a stroke, in the middle, at least; a shade that lets more through is no ink."""

OFF = 4.0
"""How far from mixes with its ink the pixels of a stroke are at most, in the middle, levels."""

CERTAIN, STRONG = 1.0, 100.0
"""Surely an ink is what explains a stroke to so many levels that stands out so much, levels."""

PALEST = 0.25
"""Then less coverage will do, too;"""

WIDEST, FULL = 2.0, 0.9
"""and the stroke may be wider, px, where so much of its fullest pixels is covered."""

AREA = 24
"""Fewest pixels that tell an ink, px²."""

CLEAR = 40.0
"""A stroke that nowhere stands out so much has no ink that could be told, levels."""

FULLEST = 90
"""Percentage of the pixels on the crest of a stroke that cover no more than its fullest ones."""

_TOPS = 1.0, 0.75
_CREST = 0.8
_SURE = 0.5
_PURE = np.array([0xFF000000, 0xFFFFFFFF], np.uint32)
_BEYOND = np.array([0, 0.15, 0.3, 0.5, 0.75, 1, 1.5, 2.5])


class Inks:
    """Looks for the inks of drawn areas.

    Parameters
    ----------
    canvas : Canvas
    cells : ndarray of shape (N,)
        Numbers of all drawn pixels.
    sides : ndarray of shape (C, S, N)
        Colours that the surfaces round each pixel have there.
    present : ndarray of shape (S, N) and dtype bool
        Which of them there are; the first is present everywhere.
    rippled : float
        How much pixels vary, levels.
    """

    def __init__(self, canvas: Canvas, cells: np.ndarray, sides: np.ndarray, present: np.ndarray,
                 rippled: float = 0.0) -> None:
        self._canvas, self._cells, self._sides, self._present = canvas, cells, sides, present
        self._cover = np.zeros(canvas.keys.size)
        self._certain, self._tops = CERTAIN + rippled, _TOPS if rippled else _TOPS[:1]

    def find(self, some: np.ndarray) -> Optional[np.uint32]:
        """The ink of a stroke that some of the pixels, by their places among all, are; packed.

        Returns
        -------
        uint32, optional
            None if they are no thin stroke of one ink.
        """
        if some.size < AREA:
            return None
        here = self._canvas.colours(self._cells[some])
        sides, present = self._sides[..., some], self._present[:, some]
        off = excess(here, sides[:, 0], np.where(present[1], sides[:, 1], sides[:, 0]))
        height = length(off).max()
        if height < CLEAR:
            return None
        for inks in (_PURE, *(_beyond(here, off, top) for top in self._tops)):
            off, share = mixes_with(here, sides, present, planes(inks, self._canvas.opaque))
            middle = np.median(off, axis=0)
            best = int(np.argmax(middle <= middle.min() + _SURE))
            crest, width = profile(self._cover, self._cells[some], share[:, best], self._canvas.stride)
            if crest.any() and np.median(off[crest, best]) <= OFF:
                cover = share[crest, best]
                full = np.percentile(cover, FULLEST)
                sure = height >= STRONG and max(middle[best], np.median(off[crest, best])) <= self._certain
                thin = width <= (WIDEST if sure and full >= FULL else WIDTH) * full
                return inks[best] if thin and np.median(cover) >= (PALEST if sure else COVERED) else None
        return None

    def are_scraps(self, some: np.ndarray, inks: np.ndarray) -> bool:
        """Whether pixels are too few to tell an ink, and mixes with one of those (K,) that were found."""
        if some.size >= AREA or not inks.size:
            return False
        off, _ = mixes_with(self._canvas.colours(self._cells[some]), self._sides[..., some], self._present[:, some],
                            planes(inks, self._canvas.opaque))
        return bool(np.median(off, axis=0).min() <= OFF)


def _beyond(here: np.ndarray, off: np.ndarray, share: float) -> np.ndarray:
    """The colour that stands out more than a share of them, and those that would do so more, packed.

    Where strokes ring, that which does most is none of their ink.
    """
    order = np.argsort(dot(off, off), kind="stable")
    top = order[int(np.ceil(share * order.size)) - 1]
    rgba = np.full((_BEYOND.size, 4), 255, np.uint8)
    rgba[:, :3] = np.clip(np.rint(here[:3, top] + _BEYOND[:, None] * off[:3, top]), 0, 255)
    return rgba.view(np.uint32)[:, 0]


def mixes_with(here: np.ndarray, sides: np.ndarray, present: np.ndarray,
               inks: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of each colour (C, N) from the nearest mix of two sides and an ink, and its share, (N, K)."""
    nearest = np.full((here.shape[1], inks.shape[1]), np.inf, np.float32)
    share = np.zeros_like(nearest)
    for i in range(len(present)):
        for j in range(i, len(present)):
            both = np.flatnonzero(present[i] & present[j])
            off, part = third_share(here[:, both], sides[:, i, both], sides[:, j, both], inks)
            better = off < nearest[both]
            nearest[both] = np.where(better, off, nearest[both])
            share[both] = np.where(better, part, share[both])
    return nearest, share


def profile(cover: np.ndarray, cells: np.ndarray, share: np.ndarray, stride: int) -> Tuple[np.ndarray, float]:
    """Which pixels lie on the crest of a stroke, and how much is covered across it there, px.

    Parameters
    ----------
    cover : ndarray of shape (P,)
        0 everywhere, with the rim; to work in, and 0 again afterwards.
    cells, share : ndarray of shape (N,)
        Pixels of the stroke, and how much of each it covers.
    stride : int
        Step from a pixel to the one below it.
    """
    cover[cells] = share
    near = cover[cells + window(stride, 1, 1)[:, None]]
    cover[cells] = 0
    crest = (share > 0) & (share >= _CREST * near.max(axis=0))
    return crest, float(np.average(near.sum(axis=0) + share, weights=crest * share + 1e-9)) / 3
