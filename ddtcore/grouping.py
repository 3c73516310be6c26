# SPDX-License-Identifier: GPL-2.0-or-later
"""Shapes of one colour one after the other, as far as the picture stays the same.

Painting by area mixes the colours.  Two shapes may change places where no shape lies
over the other, so each shape joins the last run of its colour unless something painted
after that run reaches it.  A raster of cells tells: it keeps the last run in each.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Dict, Hashable, List, Sequence, Tuple

import numpy as np

from .model import Drawing, Shape
from .options import TraceOptions

_CELLS = 256
"""Cells along the longer side, at most; they are whole pixels, which are painted by all in them."""


def group(drawing: Drawing, options: TraceOptions) -> Drawing:
    """Put the shapes of a drawing into runs of one colour, if that is wanted.

    Parameters
    ----------
    drawing : Drawing
    options : TraceOptions
        `group`.

    Returns
    -------
    Drawing
    """
    if options.group == "none":
        return drawing
    return replace(drawing, shapes=by_colour(drawing.shapes, drawing.width, drawing.height))


def by_colour(shapes: Sequence[Shape], width: int, height: int) -> Tuple[Shape, ...]:
    """Change the order of shapes so that those of one colour follow each other.

    Parameters
    ----------
    shapes : sequence of Shape
        Back to front.
    width, height : int
        Size of the picture, px.

    Returns
    -------
    tuple of Shape
        The same, back to front; they paint the same picture, in few runs of a colour.
    """
    size = -(-max(width, height) // _CELLS)
    latest = np.full((height // size + 1, width // size + 1), -1)
    runs: List[List[Shape]] = []
    last: Dict[Hashable, int] = {}
    for shape in shapes:
        if not shape.loops:
            continue
        below = latest[_cells(shape, size, latest.shape)]
        number = last.get(paint_of(shape), -1)
        if number < max(below.max(), 0):
            number = last[paint_of(shape)] = len(runs)
            runs.append([])
        runs[number].append(shape)
        np.maximum(below, number, out=below)
    return tuple(shape for run in runs for shape in run)


def paint_of(shape: Shape) -> Hashable:
    """What shapes of one colour have in common."""
    return shape.gradient or (shape.rgb, shape.opacity)


def _cells(shape: Shape, size: int, limits: Tuple[int, int]) -> Tuple[slice, slice]:
    """The cells that the control points of a shape enclose, at least one each way."""
    low = np.min([loop.control.min(axis=(0, 1)) for loop in shape.loops], axis=0)
    high = np.max([loop.control.max(axis=(0, 1)) for loop in shape.loops], axis=0)
    most = np.array(limits)[::-1] - 1
    left, top = np.clip(low // size, 0, most).astype(int)
    right, bottom = np.clip(high // size, 0, most).astype(int) + 1
    return slice(top, bottom), slice(left, right)
