# SPDX-License-Identifier: GPL-2.0-or-later
"""The pixels between flat areas and ramps get their labels: thin strokes, edges, and what neither explains."""

from __future__ import annotations

from dataclasses import replace
from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from . import margins, residue, sides, strokes
from .canvas import Canvas, planes
from .growing import Surface
from .ridges import Ridges

ROUNDS = 2
"""How often areas that no label explains are looked for."""


class Filled(NamedTuple):
    """What is known once all pixels have a label.

    Attributes
    ----------
    thin : ndarray of shape (P,) and dtype bool
        Which pixels belong to strokes.
    specks : int
        How many are specks that nothing explains.
    colours : ndarray of shape (K, 4)
        RGBA of each label.
    surfaces : list of Surface or None
        Those of labels that are gradients.
    """

    thin: np.ndarray
    specks: int
    colours: np.ndarray
    surfaces: List[Optional[Surface]]


def label_unknown(canvas: Canvas, labels: np.ndarray, keys: np.ndarray, colours: np.ndarray,
                  surfaces: List[Optional[Surface]], ridges: Ridges, noise: float, soft: bool) -> Filled:
    """Label the thin strokes, then all other unknown pixels, in place.

    Parameters
    ----------
    canvas : Canvas
    labels : ndarray of shape (P,) and dtype int16
        Known labels with the rim, negative where unknown.
    keys : ndarray of shape (K,) and dtype uint32
        The flat colours, packed, whose labels come first.
    colours : ndarray of shape (L, 4)
        RGBA of these and of the ramps.
    surfaces : list of Surface or None
        Likewise, None for what is no gradient, or no known one.
    ridges : Ridges
        Unknown pixels that may be strokes.
    noise : float
        How far pixels may be from their mixes, levels.
    soft : bool
        Areas that no label explains get labels of their own, after all others: there are ramps, and no noise.
    """
    known = labels.copy() if soft else labels
    thin, specks = _fill(canvas, labels, ridges, keys, colours, noise)
    for _ in range(ROUNDS if soft else 0):
        cells, area = residue.unexplained_areas(canvas, known, labels, canvas.mixing(colours), surfaces)
        if not cells.size:
            break
        known[cells] = len(colours) + area
        more = residue.mean_of(canvas, cells, area)
        colours, surfaces = np.concatenate([colours, more]), [*surfaces, *[None] * len(more)]
        labels[:] = known
        thin, specks = _fill(canvas, labels, ridges, keys, colours, noise)
    return Filled(thin, specks, colours, surfaces)


def _fill(canvas: Canvas, labels: np.ndarray, ridges: Ridges, keys: np.ndarray,
          colours: np.ndarray, noise: float) -> Tuple[np.ndarray, int]:
    """Label the thin strokes, then all other unknown pixels, in place.

    Returns which pixels belong to strokes, and how many are specks that nothing explains.
    """
    unknown = canvas.cells(canvas.bare(labels) < 0)
    stroke, share = strokes.stroke_labels(canvas, ridges, planes(keys, canvas.opaque), labels, noise)
    taken = (stroke >= 0) & (labels[ridges.cells] < 0)
    labels[ridges.cells[taken]] = stroke[taken]
    sharp = canvas.keys.copy()
    sharp[ridges.cells[taken]] = keys[stroke[taken]]
    full, mixing = replace(canvas, keys=sharp), canvas.mixing(colours)
    sides.label_mixed(canvas, full, labels, canvas.cells(canvas.bare(labels) < 0), mixing)

    thin = np.zeros(labels.size, bool)
    thin[ridges.cells] = stroke == labels[ridges.cells]
    faint = ridges.cells[taken & (share < 0.5)]
    lone = faint[strokes.lone_corners(labels, thin, faint, canvas.stride)]
    labels[lone] = -1
    sides.label_mixed(canvas, full, labels, lone, mixing)
    flat = unknown[labels[unknown] < keys.size]
    sharp[flat] = keys[labels[flat]]
    specks = sides.join_islands(canvas, full, labels, unknown)
    thin[ridges.cells] &= stroke == labels[ridges.cells]
    thin[lone] = False
    margins.label_strips(canvas, labels, thin, mixing[:, :keys.size], noise)
    return thin, specks
