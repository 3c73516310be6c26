# SPDX-License-Identifier: GPL-2.0-or-later
"""Who is seen where: the order of painting as a raster of the curves that are drawn.

A shape may be continued under what is painted after it, and nowhere else.  Whether a
place is free is asked very often, so the curves are rasterised once: each row of cells
is cut where arcs cross its middle, and the runs between are filled (the scan-line
method of polygon filling).
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .bezier import evaluate
from .loops import begins, ranges
from .model import LINE, QUADRATIC, Curves, PlanarMap

FINE = 2
"""Cells per pixel and axis on the finest level of a `RankMap`."""

REACH = (0.0, 1.0, 2.0)
"""How far round a place each level of a `RankMap` looks at least, px."""

_STRIP = 64
"""Rows of pixels worked on at a time, so that what is computed stays in the processor's cache."""


def as_cubics(curves: Curves) -> np.ndarray:
    """Control points (S, 4, 2) with lines and quadratics raised to cubics."""
    control = curves.control.copy()
    ends = control[:, ::3]
    line = curves.degree == LINE
    control[line, 1:3] = (2 * ends[line] + ends[line, ::-1]) / 3
    bend = curves.degree == QUADRATIC
    control[bend, 1:3] = (ends[bend] + 2 * control[bend, 1:3]) / 3
    return control


def sample_arcs(curves: Curves, step: float) -> Tuple[np.ndarray, np.ndarray]:
    """Points along the arcs, both ends of each segment among them.

    Parameters
    ----------
    curves : Curves
    step : float
        Distance between neighbours, px, about.

    Returns
    -------
    starts : ndarray of shape (A + 1,) and dtype int64
        Where each arc begins in `points`.
    points : ndarray of shape (N, 2) and dtype float64
        Rings repeat their first point at the end.
    """
    control = as_cubics(curves)
    length = np.hypot(*np.diff(control, axis=1).T).sum(axis=0)
    count = np.maximum(np.ceil(length / step), 1).astype(np.int64)
    last = np.zeros(len(control), bool)
    last[curves.starts[1:] - 1] = True
    # A segment's end is the next one's beginning; only the last of an arc keeps it.
    kept = count + last
    t = ranges(np.zeros(len(kept), np.int64), kept) / np.repeat(count, kept)
    points = evaluate(control, np.repeat(np.arange(len(kept)), kept), t)
    return begins(kept)[curves.starts], points


class RankMap:
    """The lowest rank seen round any place of the picture.

    Level 0 says what is seen in a cell of half a pixel; the coarser levels give the
    minimum over `REACH` pixels and a bit in all directions.

    Parameters
    ----------
    starts, points : ndarray
        Samples of the arcs, see `sample_arcs`.
    planar : PlanarMap
    cover : ndarray of shape (F,) and dtype int32
        Rank of each face, -1 where nothing may be continued under it.
    """

    def __init__(self, starts: np.ndarray, points: np.ndarray, planar: PlanarMap, cover: np.ndarray) -> None:
        height, width = planar.pixel_faces.shape
        # Ranks are looked up millions of times: in few bytes more of them are at hand.
        small = cover.astype(np.min_scalar_type(-len(cover) - 1))
        cells = _fill(starts, points * FINE, small[planar.left], small[planar.right],
                      height * FINE, width * FINE)
        near = _spread(_by_pixel(cells))
        self._levels = [_rimmed(level) for level in (cells, near, _spread(near))]
        self._cells = (FINE, 1, 1)

    def lowest(self, points: np.ndarray, level: int) -> np.ndarray:
        """The lowest rank round each of `points` (N, 2); -1 outside the picture."""
        grid = self._levels[level]
        cell = np.floor(points * self._cells[level]).astype(np.int64) + 1
        col = np.clip(cell[:, 0], 0, grid.shape[1] - 1)
        row = np.clip(cell[:, 1], 0, grid.shape[0] - 1)
        return np.asarray(grid[row, col])


def _fill(starts: np.ndarray, points: np.ndarray, left: np.ndarray, right: np.ndarray,
          rows: int, cols: int) -> np.ndarray:
    """Raster of what lies on either side of the arcs, with a rim of one cell; points in cells."""
    arc = np.repeat(np.arange(len(left)), np.diff(starts))
    piece = np.flatnonzero(arc[1:] == arc[:-1])
    # Cell (r, c) is sampled at (c + 1/2, r + 1/2).
    (x0, y0), (x1, y1) = points[piece].T - 0.5, points[piece + 1].T - 0.5
    first = np.clip(np.ceil(np.minimum(y0, y1)), 0, rows).astype(np.int64)
    count = np.maximum(np.clip(np.ceil(np.maximum(y0, y1)), 0, rows).astype(np.int64) - first, 0)
    row = ranges(first, count)
    k = np.repeat(np.arange(len(piece)), count)
    x = x0[k] + (row - y0[k]) / (y1 - y0)[k] * (x1 - x0)[k]
    # Walking down the screen, the right hand points to smaller x.
    down, owner = (y1 > y0)[k], arc[piece[k]]
    before = np.where(down, right[owner], left[owner])
    after = np.where(down, left[owner], right[owner])
    order = np.argsort(row * (2.0 * cols) + np.clip(x, 0, cols), kind="stable")
    at = ((row + 1) * (cols + 2) + 1 + np.clip(np.ceil(x), 0, cols).astype(np.int64))[order]
    # Far from the origin two that all but touch may be sorted the wrong way round.
    at = np.maximum.accumulate(at)
    # Both ends of a run agree unless arcs cross, and then the lower one is the safe one.
    nothing = left.dtype.type(-1)
    run = np.minimum(np.append(nothing, after[order]), np.append(before[order], nothing))
    return np.repeat(run, np.diff(np.concatenate([[0], at, [(rows + 2) * (cols + 2)]]))).reshape(rows + 2, -1)


def _rimmed(grid: np.ndarray) -> np.ndarray:
    """The grid with -1 all round it, in place."""
    grid[0], grid[-1], grid[:, 0], grid[:, -1] = -1, -1, -1, -1
    return grid


def _by_pixel(cells: np.ndarray) -> np.ndarray:
    """The lowest of the cells of each pixel, with a rim that is higher than any."""
    height, width = ((size - 2) // FINE for size in cells.shape)
    out = np.full((height + 2, width + 2), np.iinfo(cells.dtype).max, cells.dtype)
    for first in range(0, height, _STRIP):
        last = min(first + _STRIP, height)
        rows = np.minimum(cells[1 + FINE * first:1 + FINE * last:FINE, 1:-1],
                          cells[2 + FINE * first:2 + FINE * last:FINE, 1:-1])
        np.minimum(rows[:, ::FINE], rows[:, 1::FINE], out=out[1 + first:1 + last, 1:-1])
    return out


def _spread(grid: np.ndarray) -> np.ndarray:
    """Minimum over each cell and its eight neighbours; the rim stays as it is."""
    out = grid.copy()
    for first in range(1, len(grid) - 1, _STRIP):
        last = min(first + _STRIP, len(grid) - 1)
        rows = np.minimum(grid[first - 1:last - 1], grid[first:last])
        np.minimum(rows, grid[first + 1:last + 1], out=rows)
        inner = out[first:last, 1:-1]
        np.minimum(rows[:, :-2], rows[:, 1:-1], out=inner)
        np.minimum(inner, rows[:, 2:], out=inner)
    return out
