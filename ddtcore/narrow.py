# SPDX-License-Identifier: GPL-2.0-or-later
"""Strips of two pixels whose colour is a mix: a stroke that covers both in part.

A horizontal or upright stroke of one to two pixels covers two rows or columns in part, and where both
get the same share they are a plateau of two pixels' width.
"""

from __future__ import annotations

import numpy as np

from .canvas import Canvas
from .sides import window

STRIPS = 0.5
"""Share of a colour's pixels in strips from which it is the mix of strokes there."""


def clear_strips(canvas: Canvas, labels: np.ndarray, doubtful: np.ndarray) -> None:
    """Make unknown, in place, what is narrower than three pixels of those `doubtful` labels that mostly are.

    Parameters
    ----------
    canvas : Canvas
    labels : ndarray of shape (P,)
        Labels with the rim, negative where unknown.
    doubtful : ndarray of shape (K,) and dtype bool
    """
    if not doubtful.any():
        return
    cells = canvas.cells(np.append(doubtful, False)[canvas.bare(labels)])
    ring, here = window(canvas.stride, 1, 1), labels[cells]
    full = np.ones(cells.size, bool)
    for step in ring:
        full &= labels[cells + step] == here
    wide = np.zeros(labels.size, bool)
    wide[cells[full]] = True
    for step in ring:
        wide[cells[full] + step] = True
    strip = ~wide[cells]
    most = np.bincount(here[strip], minlength=doubtful.size) > STRIPS * np.bincount(here, minlength=doubtful.size)
    labels[cells[strip & most[here]]] = -1
