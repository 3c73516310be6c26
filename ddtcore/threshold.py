# SPDX-License-Identifier: GPL-2.0-or-later
"""Regions of the paper: what is connected by colour steps below a threshold.

"Adjacent colours having smooth luminance variations" are not border (section V), so
they belong to one region, and a border lies wherever neighbours differ by more.
"""

from __future__ import annotations

import numpy as np

from .canvas import Canvas, mean_colours
from .components import link_components
from .model import Labels

_BLACK_TO_WHITE = 255 * 3 ** 0.5


def label_steps(canvas: Canvas, percent: float) -> Labels:
    """Label the areas connected by small colour steps between a pixel and its eight neighbours.

    Parameters
    ----------
    percent : float
        Largest step, in percent of the distance from black to white.

    Returns
    -------
    Labels
        One label for each connected area, with its mean colour.
    """
    limit = (percent / 100 * _BLACK_TO_WHITE) ** 2
    key = canvas.bare(canvas.keys)
    step = canvas.stride
    index = link_components(
        _linked(canvas, key[:, :-1] == key[:, 1:], 0, 1, limit),
        _linked(canvas, key[:-1] == key[1:], 0, step, limit),
        _linked(canvas, key[:-1, :-1] == key[1:, 1:], 0, step + 1, limit),
        _linked(canvas, key[:-1, 1:] == key[1:, :-1], 1, step, limit))
    return Labels(index, mean_colours(canvas, index), np.zeros(index.shape, bool))


def _linked(canvas: Canvas, equal: np.ndarray, one: int, other: int, limit: float) -> np.ndarray:
    """Which pairs of pixels are near in colour; `one` and `other` lead from a pair's place to its pixels."""
    cells = canvas.cells(~equal)
    step = canvas.colours(cells + one) - canvas.colours(cells + other)
    linked = equal.ravel()
    linked[~linked] = np.einsum("in,in->n", step, step) <= limit
    return linked.reshape(equal.shape)
