# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes too thin to have a fully covered pixel.

Across an anti-aliased edge the colour runs straight from one side to the other, so
a pixel lies on the line between its neighbours' colours.  On a thin stroke, in a thin
gap or at the tip of a wedge it lies beside that line; how far and in which
direction tells the colour of the stroke, whatever the colours at its two sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Tuple

import numpy as np

from .canvas import Canvas
from .sides import segment_distance, window

_DIRECTIONS = [(0, 1), (1, 0), (1, 1), (1, -1)]
_LEAST_EXCESS = 12.0
_MONOTONE = 14.0


@dataclass(frozen=True)
class Ridges:
    """Pixels whose colour stands out from both sides.

    Attributes
    ----------
    cells : ndarray of shape (R,) and dtype int32
        Pixel numbers, rising.
    colour : ndarray of shape (C, R) and dtype float32
    one, other : ndarray of shape (C, R) and dtype float32
        Colours at the two sides.
    excess : ndarray of shape (C, R) and dtype float32
        Colour of the pixel minus the nearest mix of the two sides.
    """

    cells: np.ndarray
    colour: np.ndarray
    one: np.ndarray
    other: np.ndarray
    excess: np.ndarray

    @property
    def strength(self) -> np.ndarray:
        """Length of the excess, float32 (R,)."""
        return _length(self.excess)

    def some(self, which: np.ndarray) -> "Ridges":
        """A part of the ridge pixels."""
        return Ridges(self.cells[which], self.colour[:, which], self.one[:, which], self.other[:, which],
                      self.excess[:, which])


def _length(vectors: np.ndarray) -> np.ndarray:
    return np.sqrt(_dot(vectors, vectors))


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.einsum("i...,i...->...", a, b)


def find_ridges(canvas: Canvas, cells: np.ndarray) -> Ridges:
    """Find the pixels among `cells` that no monotone edge explains."""
    here = canvas.colours(cells)
    number = np.full(canvas.keys.size, -1, np.int32)
    number[cells] = np.arange(cells.size)
    strength = np.zeros(cells.size, np.float32)
    one, other = here.copy(), here.copy()
    for row, col in _DIRECTIONS:
        step = np.int32(row * canvas.stride + col)
        before, after = number[cells - step], number[cells + step]
        a, b = _two_sides(canvas, cells, here, before, after, step)
        off = _excess(here, a, b)
        size = _length(off)
        peak = (size > _LEAST_EXCESS) & (size > strength) & canvas.holds(cells - step) & canvas.holds(cells + step)
        peak &= (size >= size[before]) | (before < 0) | (_dot(off, off[:, before]) <= 0)
        peak &= (size > size[after]) | (after < 0) | (_dot(off, off[:, after]) <= 0)
        strength[peak] = size[peak]
        one[:, peak], other[:, peak] = a[:, peak], b[:, peak]
    kept = np.flatnonzero(strength > 0)
    here, one, other = here[:, kept], one[:, kept], other[:, kept]
    return Ridges(cells[kept], here, one, other, _excess(here, one, other))


def _two_sides(canvas: Canvas, cells: np.ndarray, here: np.ndarray, before: np.ndarray, after: np.ndarray,
               step: np.int32) -> Tuple[np.ndarray, np.ndarray]:
    """Colours at both sides of each pixel in one direction, those from which it stands out most.

    A stroke that covers two pixels in part is seen past its other half, where the colour
    runs straight from the pixel through that half to the far side, or where the other half
    stands out in the same direction.
    """
    sides = [canvas.colours(cells - step), canvas.colours(cells + step)]
    best = [sides[0].copy(), sides[1].copy()]
    off = _excess(here, *sides)
    size = _dot(off, off)
    for far, sign, next_ in ((1, 1, after), (0, -1, before)):
        near, half = sides[1 - far], sides[far]
        beyond = canvas.colours(cells + 2 * sign * step)
        off, twin = _excess(here, near, beyond), _excess(half, near, beyond)
        square = _dot(off, off) * np.float32(0.998)
        agree = _dot(off, twin)
        passed = (next_ >= 0) & (agree > 0) & (agree * agree > 0.5 * square * _dot(twin, twin))
        passed |= segment_distance(half, here, beyond)[0] < _MONOTONE
        better = np.flatnonzero(passed & (square > size))
        best[far][:, better] = beyond[:, better]
        best[1 - far][:, better] = near[:, better]
        size[better] = square[better]
    return best[0], best[1]


def _excess(here: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    _, share = segment_distance(here, a, b)
    return here - a - share * (b - a)


def explain(ridges: Ridges, colours: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """How well strokes of given colours explain ridge pixels: as mixes with one or both sides.

    Parameters
    ----------
    ridges : Ridges
    colours : ndarray of shape (C, K) and dtype float32

    Returns
    -------
    beside : ndarray of shape (K, R) and dtype float32
        Distance of the pixel from the nearest such mix, levels.
    share : ndarray of shape (K, R) and dtype float32
        Coverage of the stroke there, 0 to 1.
    """
    shape = (colours.shape[1], ridges.cells.size)
    beside, share = np.empty(shape, np.float32), np.empty(shape, np.float32)
    off, across = ridges.colour - ridges.one, ridges.other - ridges.one
    long = _dot(across, across)
    for k in range(shape[0]):
        colour = colours[:, k, None]
        beside[k], share[k] = segment_distance(ridges.colour, ridges.one, np.broadcast_to(colour, off.shape))
        distance, part = segment_distance(ridges.colour, ridges.other, np.broadcast_to(colour, off.shape))
        nearer = distance < beside[k]
        beside[k, nearer], share[k, nearer] = distance[nearer], part[nearer]
        distance, part = _unmix(off, across, long, colour - ridges.one)
        nearer = distance < beside[k]
        beside[k, nearer], share[k, nearer] = distance[nearer], part[nearer]
    return beside, share


def _unmix(off: np.ndarray, across: np.ndarray, long: np.ndarray, to: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of `off` from the triangle 0, `across`, `to`, and the share of `to`; infinite outside it."""
    cross, square = _dot(across, to), _dot(to, to)
    det = long * square - cross * cross
    flat = det <= 0.02 * long * square
    det = np.where(flat, 1, det)
    x, y = _dot(off, across), _dot(off, to)
    along = (x * square - y * cross) / det
    part = (y * long - x * cross) / det
    left = off - along * across - part * to
    inside = ~flat & (along >= 0) & (part >= 0) & (along + part <= 1)
    return np.where(inside, _length(left), np.inf), part


def new_colours(canvas: Canvas, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
                tries: int = 32) -> np.ndarray:
    """Colours that occur in thin strokes only, packed.

    The ridge pixel that stands out most among those no colour explains has nearly the
    colour of its stroke; it is taken if it explains others near it as well and the
    colours round it do not mix to it.
    """
    found = []
    if colours.shape[1]:
        beside, _ = explain(ridges, colours)
        fits = (beside < 0.4 * ridges.strength) | (beside < 30)
        ridges = ridges.some(np.flatnonzero(~fits.any(axis=0)))
    for _ in range(tries):
        if ridges.cells.size < 3:
            break
        worst = np.argmax(ridges.strength)
        colour = ridges.colour[:, worst, None]
        beside, share = explain(ridges, colour)
        fits = (beside[0] < 12) & (share[0] > 0.3)
        fits[worst] = True
        row, col = np.divmod(ridges.cells, canvas.stride)
        close = np.abs(row - row[worst]) + np.abs(col - col[worst]) <= 24
        if np.count_nonzero(fits & close) >= 4 and not _mixed_near(canvas, ridges.cells[worst], colours, labels):
            near = fits & (np.abs(ridges.colour - colour).max(axis=0) < 10)
            values, counts = np.unique(canvas.keys[ridges.cells[near]], return_counts=True)
            found.append(values[np.argmax(counts)] if counts.max() > 2 else canvas.keys[ridges.cells[worst]])
        ridges = ridges.some(np.flatnonzero(~fits))
    return np.array(found, np.uint32)


def _mixed_near(canvas: Canvas, cell: int, colours: np.ndarray, labels: np.ndarray) -> bool:
    """Whether a pixel's colour is a mix of any three of the known colours within 7 x 7."""
    near = np.unique(labels[cell + window(canvas.stride, 1, 3)])
    near = colours[:, near[(near >= 0) & (near < colours.shape[1])]]
    here = canvas.colours(np.array([cell]))
    n = near.shape[1]
    i, j, k = (axis.ravel() for axis in np.mgrid[:n, :n, :n])
    first = near[:, i]
    off, across, to = here - first, near[:, j] - first, near[:, k] - first
    inside, _ = _unmix(off, across, _dot(across, across), to)
    edge, _ = segment_distance(np.broadcast_to(here, first.shape), first, near[:, j])
    return bool(((inside < 14) | (edge < 14)).any())


def stroke_labels(canvas: Canvas, ridges: Ridges, colours: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """The colour of each ridge pixel's stroke.

    Parameters
    ----------
    colours : ndarray of shape (C, K) and dtype float32
        Premultiplied palette.
    labels : ndarray of shape (P,)
        Known labels with a rim, negative where unknown.

    Returns
    -------
    ndarray of shape (R,) and dtype int32
        Label of the stroke, -1 where no colour explains the pixel.
    """
    beside, share = explain(ridges, colours)
    size = ridges.strength
    base = ridges.colour - ridges.excess
    same = _dot(colours[:, :, None] - base[:, None], colours[:, :, None] - base[:, None]) < 400
    near = np.zeros(beside.shape, bool)
    rows = np.arange(ridges.cells.size)
    for step in window(canvas.stride, 1, 2):
        label = labels[ridges.cells + step]
        known = (label >= 0) & (label < colours.shape[1])
        near[label[known], rows[known]] = True
    cost = np.minimum(beside, 60) + 40 * same + np.float32(5) * ~near
    vote = _diffuse(canvas, ridges, cost * np.minimum(size, 120))
    choice = np.argmin(vote + 0.3 * beside, axis=0)
    beside, share = beside[choice, rows], share[choice, rows]
    good = (beside < 0.25 * size + 10) & (share > 0.16)
    return np.where(good, choice, -1).astype(np.int32)


def _diffuse(canvas: Canvas, ridges: Ridges, vote: np.ndarray, rounds: int = 8) -> np.ndarray:
    """Average the votes (K, R) along chains of ridge pixels that stand out in the same direction."""
    number = np.full(canvas.keys.size, -1, np.int32)
    number[ridges.cells] = np.arange(ridges.cells.size)
    unit = ridges.excess / ridges.strength
    pairs, weights = [], []
    for step in window(canvas.stride, 1, 1):
        other = number[ridges.cells + step]
        agree = _dot(unit, unit[:, other])
        agree = np.where((other >= 0) & (agree > 0), agree * agree, 0)
        pairs.append(np.where(agree > 0, other, 0))
        weights.append(agree.astype(np.float32))
    total = 1 + sum(weights)
    for _ in range(rounds):
        vote = (vote + sum(w * vote[:, other] for other, w in zip(pairs, weights))) / total
    return vote
