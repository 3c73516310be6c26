# SPDX-License-Identifier: GPL-2.0-or-later
"""Shades that lie astride of the border of two ramps, parted where it runs.

What is translucent has other colours over each of them, and no gradient has the jump between
these.  But a shade mixes one colour, in one share, with whatever lies below: so which ramp
lies below a pixel follows from its colour, and the one mix from all pixels.
"""

from __future__ import annotations

from typing import Sequence, Tuple

import numpy as np

from .canvas import Canvas
from .gradient import BYTES as GRADIENT
from .gradient import PRICE
from .growing import Surface
from .mixes import dot
from .shades import cores, neighbours, smooth

BYTES = 180 + GRADIENT
"""What a further shade adds to the file."""

AREA = 8
"""Fewest pixels over each ramp, px²."""

MANY = 256
"""Most areas that are looked at, the largest ones."""

_ROUNDS = 4

_MOST = 400.0
"""A pixel is not farther than this from what explains it, squared levels."""


def part_astride(canvas: Canvas, cells: np.ndarray, area: np.ndarray, ramp: np.ndarray,
                 surfaces: Sequence[Surface]) -> np.ndarray:
    """Part the areas that lie on two ramps each.

    Parameters
    ----------
    canvas : Canvas
    cells : ndarray of shape (N,)
        Numbers of the drawn pixels, rising.
    area : ndarray of shape (N,)
        Number of the area of each.
    ramp : ndarray of shape (N,)
        Number of the ramp next to each.
    surfaces : sequence of Surface
        The colours of the ramps.

    Returns
    -------
    ndarray of shape (N,)
        Numbers of areas, or of parts of them.
    """
    second = np.zeros(area.size, bool)
    full = cores(canvas, cells, canvas.colours(cells), area)[0] >= 0
    count = np.bincount(area)
    members = np.split(np.argsort(area, kind="stable"), np.cumsum(count)[:-1])
    count = np.bincount(area, full)
    largest = np.argsort(-count, kind="stable")[:MANY]
    for number in largest[count[largest] >= 2 * AREA].tolist():
        some = members[number]
        met = np.bincount(ramp[some])
        pair = np.argsort(-met, kind="stable")[:2]
        if len(pair) == 2 and met[pair[1]] >= AREA:
            row, col = canvas.places(cells[some])
            points = np.stack([col, row], axis=1) + 0.5
            below = np.stack([surfaces[k].colours(points).T for k in pair.tolist()])
            second[some] = _on_second(canvas, cells[some], points, below, ramp[some] == pair[1], full[some])
    return np.unique(2 * area + second, return_inverse=True)[1].ravel()


def _on_second(canvas: Canvas, cells: np.ndarray, points: np.ndarray, below: np.ndarray,
               second: np.ndarray, full: np.ndarray) -> np.ndarray:
    """Which pixels of an area lie over the second of two ramps with colours (2, C, n); none if that explains little.

    `second` is a first guess, and `full` which pixels the area surely covers.
    """
    here = canvas.colours(cells)
    near = neighbours(canvas, cells, np.zeros(cells.size, np.intp))
    for _ in range(_ROUNDS):
        share, ink = _mix(here[:, full], np.where(second, below[1], below[0])[:, full])
        off = np.minimum([dot(some, some) for some in here - share * below - ink], _MOST)
        second = smooth(near, off).argmin(axis=0) > 0
    fewest = min(np.count_nonzero(second & full), np.count_nonzero(~second & full))
    saved = _uneven(points[full], here[:, full]).sum() - np.where(second, off[1], off[0])[full].sum()
    return second if fewest >= AREA and saved >= PRICE * BYTES else np.zeros_like(second)


def _mix(here: np.ndarray, below: np.ndarray) -> Tuple[float, np.ndarray]:
    """The share of what is below in some colours (C, n), and what is added to it, (C, 1)."""
    middle, under = here.mean(axis=1, keepdims=True), below.mean(axis=1, keepdims=True)
    spread = ((below - under) ** 2).sum()
    share = min(max(float(((below - under) * (here - middle)).sum() / max(spread, 1e-9)), 0.0), 1.0)
    return share, middle - share * under


def _uneven(points: np.ndarray, here: np.ndarray) -> np.ndarray:
    """What one linear gradient leaves of some colours (C, n), squared levels."""
    terms = np.concatenate([points - points.mean(axis=0), np.ones((len(points), 1))], axis=1)
    values = np.linalg.lstsq(terms, here.T, rcond=None)[0]
    off = here - terms.dot(values).T
    return np.asarray(np.minimum(dot(off, off), _MOST))
