# SPDX-License-Identifier: GPL-2.0-or-later
"""The colours that only thin strokes have, of which no pixel need be covered in full."""

from __future__ import annotations

import numpy as np

from .canvas import Canvas, planes, unpack
from .mixes import segment_distance, third_share
from .noise import ROUNDING
from .ridges import LEAST, Ridges, unexplained
from .sides import window

PURE = 8
"""How far from black or white the fullest pixel of a black or white stroke may be, levels."""

TWIN = 8.0
"""How far a new colour has to be from those known, levels."""

PALE = 0.25
"""Share of another colour in the fullest pixel of a stroke, in a picture that isn't clean, at most."""

DEEP = 0.4
"""Smallest share of black or white in the fullest pixel of a stroke of a blurred picture that may be such."""

_TRIES = 32
_REACH = 24


def new_colours(canvas: Canvas, cells: np.ndarray, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
                noise: float, blurred: bool = False) -> np.ndarray:
    """Colours that occur in thin strokes only, packed, uint32.

    The ridge pixel that stands out most among those no colour explains has nearly the
    colour of its stroke; it is taken if it explains others near it as well and the
    colours round it do not mix to it.  Exact is a frequent value close to it.

    Parameters
    ----------
    cells : ndarray of shape (N,)
        All pixels that are no plateaus.
    colours : ndarray of shape (C, K) and dtype float32
        The palette so far.
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    noise : float
        How much flat areas vary, levels.
    blurred : bool
        Whether no pixel of a stroke need be full, as in a scan.
    """
    doubt = noise - ROUNDING
    ridges = unexplained(ridges, colours, doubt)
    found, around = np.zeros(0, np.uint32), canvas.colours(cells) if ridges.cells.size else None
    for _ in range(_TRIES):
        if ridges.cells.size < 4:
            break
        highest = np.argmax(ridges.height)
        cell, colour = ridges.cells[highest], ridges.colour[:, highest, None]
        beside, share = third_share(ridges.colour, ridges.one, ridges.other, colour)
        fits = (beside[:, 0] < 12 + doubt) & (share[:, 0] > 0.3)
        fits[highest] = True
        fit_near = np.count_nonzero(fits & _within_reach(canvas, ridges.cells, cell))
        if fit_near >= 4 + doubt and not _mixed_near(canvas, cell, colours, labels, found.size):
            like = canvas.keys[cells[np.abs(around - colour).max(axis=0) < 10 + doubt]]
            key = _extreme(canvas, like, ridges.off[:, highest], canvas.keys[cell])
            key = _pure(key, PURE + min(8 * doubt, 3 * PURE))
            if blurred:
                key = _black(canvas, ridges.some(np.flatnonzero(fits)), beside[fits, 0] + doubt, key)
            exact = planes(key, canvas.opaque)
            if (np.abs(exact - colours).max(axis=0) >= TWIN + 2 * doubt).all():
                found, colours = np.append(found, key), np.append(colours, exact, axis=1)
        ridges = ridges.some(np.flatnonzero(~fits))
    return found[_fullest(colours, found.size)] if doubt > 0 and found.size > 1 else found


def _black(canvas: Canvas, ridges: Ridges, beside: np.ndarray, key: np.ndarray) -> np.ndarray:
    """The packed ink (1,) of some ridge pixels: black or white if mixes with that are nearer than `beside` (R,)."""
    for end in (0, 255):
        rgba = np.full((1, 4), (end, end, end, 255), np.uint8).view(np.uint32)[:, 0]
        off, share = third_share(ridges.colour, ridges.one, ridges.other, planes(rgba, canvas.opaque))
        if off.mean() <= beside.mean() and share.max() > DEEP:
            return rgba
    return key


def _fullest(colours: np.ndarray, count: int) -> np.ndarray:
    """Which of the last `count` colours (C, K) are not another one of them with a little of a third, bool (count,).

    Where pixels vary, those that stand out most need not be those that their stroke covers most.
    """
    inks = colours[:, -count:]
    kept = np.ones(count, bool)
    for k, other in np.ndindex(count, count):
        if k != other and kept[other]:
            ink, full = (np.broadcast_to(inks[:, n, None], colours.shape) for n in (k, other))
            off, share = segment_distance(ink, full, colours)
            kept[k] &= not ((off < LEAST) & (share > 0) & (share < PALE)).any()
    return kept


def _pure(keys: np.ndarray, margin: float) -> np.ndarray:
    """Packed colours with those that are nearly black or white made so: no pixel of a thin stroke is full."""
    rgba = unpack(keys).copy()
    for end in (0, 255):
        rgba[(np.abs(rgba[:, :3].astype(int) - end) <= margin).all(axis=1), :3] = end
    return rgba.view(np.uint32)[:, 0]


def _extreme(canvas: Canvas, keys: np.ndarray, away: np.ndarray, default: np.uint32) -> np.ndarray:
    """Of several like pixels the packed value (1,) that stands out most among the frequent ones."""
    values, counts = np.unique(keys, return_counts=True)
    values = values[counts > max(2, 0.3 * counts.max())]
    best = values[np.argmax(away @ planes(values, canvas.opaque))] if values.size else default
    return np.array([best], np.uint32)


def _within_reach(canvas: Canvas, cells: np.ndarray, cell: int) -> np.ndarray:
    """Which pixels lie near one of them."""
    row, col = canvas.places(cells)
    own_row, own_col = canvas.places(np.asarray(cell))
    return np.asarray(np.abs(row - own_row) + np.abs(col - own_col) <= _REACH)


def _mixed_near(canvas: Canvas, cell: int, colours: np.ndarray, labels: np.ndarray, inks: int) -> bool:
    """Whether a pixel's colour is a mix of two or three of the known colours within 7 x 7 and the last, the `inks`."""
    near = np.unique(labels[cell + window(canvas.stride, 1, 3)])
    count = colours.shape[1]
    near = colours[:, np.append(near[(near >= 0) & (near < count - inks)], np.arange(count - inks, count))]
    first, second = (near[:, side] for side in np.triu_indices(near.shape[1]))
    here = np.broadcast_to(canvas.colours(np.array([cell])), first.shape)
    beside, _ = third_share(here, first, second, near)
    return bool((beside < 14).any())
