# SPDX-License-Identifier: GPL-2.0-or-later
"""What the labels of a picture with soft ramps do not explain once every pixel has one.

Translucent strokes over ramps, and ramps too narrow or too steep to be found, have no colour
of their own that could be known beforehand.  Their pixels then go to a colour that they are
mixed with at best.  It is not theirs if a whole area is too wide to be covered in part only,
or if its pixels are no mixes with what is beside them either.
"""

from __future__ import annotations

from typing import List, Optional, Sequence, Tuple

import numpy as np

from .canvas import Canvas, unpack
from .components import cell_components, components, next_among
from .gradient import PRICE
from .growing import Surface
from .hairlines import FULLEST, WIDTH, mixes_with, profile
from .mixes import length, segment_distance
from .overlays import BYTES, LEAST, side_colours
from .sides import near_samples, window

FULL = 0.9
"""The fullest pixels of a stroke that is known by its colour cover at least so much."""

STRAIGHT, ROWS = 2.05, 4
"""A stroke along the rows or columns may cover two of these alike; what spans so many of both is no such, px."""

AREA = 8
"""Smallest area, px²."""

LIKE = 16.0
"""Largest difference of neighbours in an area, levels of a channel."""

GAP = 2
"""How far apart pixels of an area may be, px."""

MANY = 128
"""Most areas that are looked at, the largest ones."""

_CREST = 0.8


def unexplained_areas(canvas: Canvas, known: np.ndarray, labels: np.ndarray, colours: np.ndarray,
                      surfaces: Sequence[Optional[Surface]]) -> Tuple[np.ndarray, np.ndarray]:
    """Areas whose labels are none of theirs.

    Parameters
    ----------
    canvas : Canvas
    known : ndarray of shape (P,)
        Labels with the rim, negative where they were told by the pixels beside.
    labels : ndarray of shape (P,)
        Labels of all pixels, with the rim.
    colours : ndarray of shape (C, K)
        The colour of each label.
    surfaces : sequence of Surface or None
        Those of labels that are gradients.

    Returns
    -------
    cells : ndarray of shape (N,)
        Pixels, rising, that should have labels of their own.
    area : ndarray of shape (N,)
        The area of each, numbered from 0.
    """
    cells = canvas.cells(canvas.bare(known) < 0)
    wide = _too_wide(canvas, known, labels, cells, colours, surfaces)
    off = _off(canvas, labels, cells, colours, surfaces)
    off[wide] = np.maximum(off[wide], length(canvas.colours(cells[wide]) - colours[:, labels[cells[wide]]]))
    some = np.flatnonzero(off > LEAST)
    cells, off = cells[some], off[some]
    area = _alike(canvas, cells)
    size = np.bincount(area)
    saved = np.bincount(area, off**2) * (size >= AREA)
    kept = np.argsort(-saved, kind="stable")[:min(np.count_nonzero(saved >= PRICE * BYTES), MANY)]
    number = np.full(size.size, -1, np.int32)
    number[kept] = np.arange(kept.size)
    inside = number[area] >= 0
    return cells[inside], number[area[inside]]


def mean_of(canvas: Canvas, cells: np.ndarray, area: np.ndarray) -> np.ndarray:
    """The mean RGBA of numbered areas, (A, 4)."""
    rgba = unpack(canvas.keys[cells]).astype(np.float64)
    return np.stack([np.bincount(area, channel) for channel in rgba.T], axis=1) / np.bincount(area)[:, None]


def _too_wide(canvas: Canvas, known: np.ndarray, labels: np.ndarray, cells: np.ndarray, colours: np.ndarray,
              surfaces: Sequence[Optional[Surface]]) -> np.ndarray:
    """Places among some pixels of those in strokes of a flat colour that are too wide not to show it in full."""
    label = labels[cells]
    own = np.array([surface is None for surface in surfaces])[label]
    for step in window(canvas.stride, 1, 1):
        own &= known[cells + step] != label
    some = np.flatnonzero(own)
    area = cell_components(cells[some], label[some], canvas.stride)
    size = np.bincount(area)
    largest = np.argsort(-size, kind="stable")[:MANY]
    chosen = np.zeros(size.size, bool)
    chosen[largest] = size[largest] >= AREA
    some, area = some[chosen[area]], area[chosen[area]]
    share = _shares(canvas, known, label[some], cells[some], colours, surfaces)
    order = np.argsort(area, kind="stable")
    found: List[np.ndarray] = [np.zeros(0, np.intp)]
    cover = np.zeros(known.size)
    for own in np.split(order, np.flatnonzero(np.diff(area[order])) + 1) if order.size else ():
        crest, width = profile(cover, cells[some[own]], share[own], canvas.stride)
        if crest.any():
            most = np.percentile(share[own[crest]], FULLEST)
            if most < FULL and width > (WIDTH if _slanted(canvas, cells[some[own]]) else STRAIGHT) * most:
                found.append(some[own[share[own] >= _CREST * most]])
    return np.concatenate(found)


def _shares(canvas: Canvas, known: np.ndarray, label: np.ndarray, cells: np.ndarray, colours: np.ndarray,
            surfaces: Sequence[Optional[Surface]]) -> np.ndarray:
    """How much of pixels is covered by the colour of their label, on the known ones round them, (N,); 0 without any."""
    samples, _ = near_samples(known, cells, canvas.stride)
    sides = side_colours(canvas, known, cells, samples, surfaces)
    present = (samples >= 0) & (known[samples] != label)
    share = np.zeros(cells.size)
    for ink in np.unique(label).tolist():
        own = np.flatnonzero((label == ink) & present.any(axis=0))
        here = canvas.colours(cells[own])
        share[own] = mixes_with(here, sides[..., own], present[:, own], colours[:, [ink]])[1][:, 0]
    return share


def _slanted(canvas: Canvas, cells: np.ndarray) -> bool:
    """Whether pixels span several rows and several columns."""
    return bool(min(np.ptp(place) for place in canvas.places(cells)) + 1 >= ROWS)


def _off(canvas: Canvas, labels: np.ndarray, cells: np.ndarray, colours: np.ndarray,
         surfaces: Sequence[Optional[Surface]]) -> np.ndarray:
    """Distance of pixels from all mixes of their label's colour and that of one beside them, levels."""
    here = canvas.colours(cells)
    row, col = canvas.places(cells)
    points = np.stack([col, row], axis=1) + 0.5
    own = _colours(labels[cells], points, colours, surfaces)
    off = length(here - own)
    far = np.flatnonzero(off > LEAST)
    here, own, left = here[:, far], own[:, far], off[far]
    for step in window(canvas.stride, 1, 1):
        beside = labels[cells[far] + step]
        there = np.flatnonzero((beside >= 0) & (beside != labels[cells[far]]))
        other = _colours(beside[there], points[far[there]], colours, surfaces)
        left[there] = np.minimum(left[there], segment_distance(here[:, there], own[:, there], other)[0])
    off[far] = left
    return off


def _colours(label: np.ndarray, points: np.ndarray, colours: np.ndarray,
             surfaces: Sequence[Optional[Surface]]) -> np.ndarray:
    """The colours (C, N) that labels (N,) have at points (N, 2)."""
    out = colours[:, label]
    for value in np.unique(label).tolist():
        surface = surfaces[value]
        if surface is not None:
            some = label == value
            out[:, some] = surface.colours(points[some]).T
    return out


def _alike(canvas: Canvas, cells: np.ndarray) -> np.ndarray:
    """Numbers of areas of pixels whose neighbours are like them."""
    here = canvas.colours(cells)
    edges = [(np.zeros(0, np.intp), np.zeros(0, np.intp))]
    for step in np.unique(np.abs(window(canvas.stride, 1, GAP))).tolist():
        place = next_among(cells, step)
        near = np.flatnonzero(place >= 0)
        near = near[np.abs(here[:, near] - here[:, place[near]]).max(axis=0) <= LIKE]
        edges.append((near, place[near]))
    return components(cells.size, *(np.concatenate(ends) for ends in zip(*edges)))
