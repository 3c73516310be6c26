# SPDX-License-Identifier: GPL-2.0-or-later
"""Scraps of labels on soft ramps that no one would miss.

Where shades run together, pixels fall to one or the other by chance, and pieces of a few
pixels are left that differ from what is round them by a few levels.  Each would be a path
of its own, and a notch in its neighbours.  What they explain beyond mixes of the labels
round them has to be worth a path.
"""

from __future__ import annotations

from typing import Optional, Sequence

import numpy as np

from .canvas import Canvas
from .components import label_components
from .gradient import PRICE
from .growing import Surface
from .mixes import length
from .overlays import side_colours, unexplained
from .sides import label_mixed, near_samples, window

AREA = 64
"""Largest scrap, px²."""

BYTES = 250
"""Size of what a scrap adds to the file: its path, and the notches in its neighbours."""

EVEN = 0.5
"""Pixels are no mixes where they differ from those in a block of 2 x 2 by less than this share of their contrast."""

_FAR = 1e3


def join_scraps(canvas: Canvas, labels: np.ndarray, colours: np.ndarray,
                surfaces: Sequence[Optional[Surface]], thin: np.ndarray) -> None:
    """Relabel small pieces beside ramps that what is round them explains nearly as well, in place.

    Parameters
    ----------
    canvas : Canvas
    labels : ndarray of shape (P,) and dtype int16
        Labels with the rim, none of them unknown.
    colours : ndarray of shape (C, K) and dtype float32
        Colours of the labels, premultiplied.
    surfaces : sequence of length K of Surface or None
        Those of the labels that are soft ramps.
    thin : ndarray of shape (P,) and dtype bool
        Pixels of thin strokes, which stay.
    """
    piece = label_components(canvas.bare(labels), 8)
    size = np.bincount(piece.ravel())
    small = size <= AREA
    small[piece[canvas.bare(thin)]] = False
    cells = canvas.cells(small[piece])
    if not cells.size:
        return
    row, col = canvas.places(cells)
    number = np.unique(piece[row, col], return_inverse=True)[1].ravel()
    known = labels.copy()
    known[cells] = -1
    samples, _ = near_samples(known, cells, canvas.stride)
    sides = side_colours(canvas, labels, cells, samples, surfaces)
    off = _unlike(canvas, labels, cells, sides, samples)
    soft = np.array([surface is not None for surface in surfaces], bool)
    on_ramp = np.bincount(number, (soft[labels[samples]] & (samples >= 0)).any(axis=0)) > 0
    joined = on_ramp & (np.bincount(number, np.minimum(off, _FAR) ** 2) < PRICE * BYTES)
    gone = cells[joined[number]]
    labels[gone] = -1
    label_mixed(canvas, canvas, labels, gone, colours)


def _unlike(canvas: Canvas, labels: np.ndarray, cells: np.ndarray, sides: np.ndarray,
            samples: np.ndarray) -> np.ndarray:
    """Distance of each pixel from what is round its piece: from the mixes of it, or where it is even, from each."""
    here = canvas.colours(cells)
    alone = np.where(samples >= 0, length(sides - here[:, None]), np.inf).min(axis=0)
    like = {}
    for step in window(canvas.stride, 1, 1).tolist():
        spread = length(canvas.colours(cells + step) - here)
        like[step] = (labels[cells + step] == labels[cells]) & (spread <= EVEN * alone)
    even = np.zeros(cells.size, bool)
    for down in (-canvas.stride, canvas.stride):
        for across in (-1, 1):
            even |= like[down] & like[across] & like[down + across]
    return np.where(even, alone, unexplained(here, sides, samples))
