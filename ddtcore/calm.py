# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art under a grain, as in a scan: the grain is averaged away, edges are kept."""

from __future__ import annotations

from dataclasses import replace
from typing import Optional, Tuple, Union

import numpy as np

from .canvas import Canvas, planes, unpack
from .noise import noise_level, noisy_colours
from .palette import find_plateaus
from .ramps import no_ramps
from .sides import window

LEFT = 3.0
"""How much less flat areas vary without their grain."""

EXPLAINED = 0.5
"""Share of the pixels that have one of few colours in flat art, but for the grain."""

GATHERED = 0.82
"""Share of those that are as near to it without the grain as they should be then."""

_SAMPLE = 1 << 14


def without_grain(canvas: Canvas) -> Optional[Tuple[Canvas, float]]:
    """The picture without its grain, and how strong that is, if it is flat art with a grain all over.

    Round the colours of flat art pixels gather; in a photograph they lie anywhere between.

    Returns
    -------
    Canvas
    float
        How far pixels of flat areas were from their colour, levels.
    """
    nowhere = np.zeros(canvas.shape, bool)
    grain, rippled = noise_level(canvas, find_plateaus(canvas, nowhere).core, no_ramps(canvas.shape))
    if not rippled:
        return None
    even = calm(canvas, grain)
    colours = planes(noisy_colours(even, find_plateaus(even, nowhere), grain / LEFT, grain), canvas.opaque)
    cells = canvas.cells(~nowhere)
    here = even.colours(cells[::max(1, cells.size // _SAMPLE)])
    off = np.abs(here[:, :, None] - colours[:, None]).max(axis=0).min(axis=1, initial=np.inf)
    explained = np.mean(off <= grain)
    flat = explained > EXPLAINED and np.mean(off <= grain / LEFT) > GATHERED * explained
    return (even, grain) if flat else None


def calm(canvas: Canvas, noise: Union[float, np.ndarray]) -> Canvas:
    """Average away what pixels vary by, up to `noise` levels, for all of them or for each, (P,).

    A sigma filter (Lee, "Digital image smoothing and the sigma filter", 1983), twice: means
    of 3 x 3 pixels tell better than the pixels themselves which of 5 x 5 are alike.
    """
    rgba = unpack(canvas.keys).copy()
    values = np.ascontiguousarray(rgba.T).astype(np.int16)
    guide = _means(values, values, canvas.stride, 1, np.asarray(noise))
    rgba[...] = _means(values, guide, canvas.stride, 2, np.asarray(noise) / 2).T
    return replace(canvas, keys=rgba.view(np.uint32)[:, 0])


def _means(values: np.ndarray, guide: np.ndarray, stride: int, reach: int, margin: np.ndarray) -> np.ndarray:
    """Mean values (C, P) of the pixels within `reach` whose guides differ by no more than a margin."""
    margin = np.broadcast_to(np.floor(margin).astype(np.int16), values.shape[1:])
    total, count = values.copy(), np.ones(values.shape[1], np.int16)
    for step in window(stride, 1, reach):
        if step > 0:
            like = np.abs(guide[:, step:] - guide[:, :-step]).max(axis=0) <= margin[step:]
            count[step:] += like
            count[:-step] += like
            total[:, step:] += values[:, :-step] * like
            total[:, :-step] += values[:, step:] * like
    return (total + count // 2) // count
