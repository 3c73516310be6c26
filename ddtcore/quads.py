# SPDX-License-Identifier: GPL-2.0-or-later
r"""The triangulation to start from: quads of four neighbouring pixels, each split in two.

A quad has the corners a, b, c, d, clockwise on the screen, and one of two diagonals::

        a --- b        a --- b
        |  \  |        |  /  |
        d --- c        d --- c

        backslash       slash

Step 1 of the paper takes the one that costs less between its own two triangles.  With the
steps b - a and c - d along the top and the bottom, d - a and c - b down the left and the
right, the two costs differ in the products of sizes only, and for both cost functions

    cost(slash) < cost(backslash)  <=>  (top - bottom) (left - right) > 0

where the letters stand for the squared lengths of the steps (`yu`) or for their absolute
values, the products summed over the channels (`paper`).  These are whole numbers, so ties
are exact.  Mostly both costs are 0 then, and either diagonal will do.  Else the quad is a
saddle, such as a checker of two colours, and its surroundings decide: the diagonal whose
colours are further from the mean of the twelve pixels around is joined, as a thin stroke
that crosses a background is the rarer of the two.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from .components import next_among
from .cost import EdgeCost, premultiplied_levels
from .model import Labels
from .raster import pixel_keys


class Steps(NamedTuple):
    """Differences of colour along the sides of quads, int32 (C, n) each."""

    top: np.ndarray
    bottom: np.ndarray
    left: np.ndarray
    right: np.ndarray


def colour_steps(image: np.ndarray, quads: np.ndarray) -> Steps:
    """Steps of premultiplied colour along the sides of quads.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    quads : ndarray of shape (n,) and dtype int64
        Numbers of quads of the framed grid, row by row.

    Returns
    -------
    Steps
        Channels that are the same in all these quads are left out: they cost nothing.
    """
    keys = _corner_values(pixel_keys(image), quads)
    a, b, c, d = np.moveaxis(premultiplied_levels(keys[..., np.newaxis].view(np.uint8)), 2, 1)
    steps = np.stack([b - a, c - d, d - a, c - b])
    return Steps(*steps[:, steps.any(axis=(0, 2))])


def choose_slash(image: np.ndarray, labels: Labels, quads: np.ndarray, steps: Steps, cost: str) -> np.ndarray:
    """Which quads to split by the slash.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        A diagonal that joins two pixels of one label, one of them thin, is chosen at any cost,
        unless the other one does so too.
    quads : ndarray of shape (n,) and dtype int64
    steps : Steps
        From `colour_steps`.
    cost : {'yu', 'paper'}

    Returns
    -------
    ndarray of shape (n,) and dtype bool
    """
    top, bottom, left, right = (_size(step, cost) for step in steps)
    better = ((top - bottom) * (left - right)).sum(axis=0)
    slash: np.ndarray = better > 0
    saddle = np.flatnonzero((better == 0) & (steps.top != steps.bottom).any(axis=0))
    slash[saddle] = _slash_is_rarer(image, quads[saddle])
    if labels.thin.any():
        index = _corner_values(labels.index, quads)
        a, b, c, d = np.where(_corner_values(labels.thin, quads), -1 - index, index)
        along_backslash, along_slash = _thin_link(a, c), _thin_link(b, d)
        slash = np.where(along_backslash != along_slash, along_slash, slash)
    return slash


def half_edges(quads: np.ndarray, slash: np.ndarray, shape: Tuple[int, int]) -> Tuple[np.ndarray, np.ndarray]:
    """Triangles of split quads: (a, b, c) and (c, d, a), or (a, b, d) and (c, d, b).

    Parameters
    ----------
    quads : ndarray of shape (n,) and dtype int64
        In rising order.
    slash : ndarray of shape (n,) and dtype bool
    shape : (int, int)
        Rows and columns of quads of the framed grid.

    Returns
    -------
    triangles : ndarray of shape (2 * n, 3) and dtype int64
    twins : ndarray of shape (6 * n,) and dtype int64
        As in `Mesh`.
    """
    row, col = np.divmod(quads, shape[1])
    a = row * (shape[1] + 1) + col
    b, d = a + 1, a + shape[1] + 1
    c = d + 1
    triangles = np.stack([a, b, np.where(slash, d, c), c, d, np.where(slash, b, a)], axis=1).reshape(-1, 3)
    # a-b is half-edge 0 of the six, c-d is number 3; where the others are depends on the diagonal.
    first = 6 * np.arange(len(quads))
    left, right = first + np.where(slash, 2, 4), first + np.where(slash, 5, 1)
    diagonal, opposite = first + np.where(slash, 1, 2), first + np.where(slash, 4, 5)
    above = next_among(quads, -shape[1])
    before = np.where((np.diff(quads, prepend=-2) == 1) & (col > 0), np.arange(len(quads)) - 1, -1)
    twins = np.full(6 * len(quads), -1)
    for edges, others in ((diagonal, opposite),
                          (first[above >= 0], first[above[above >= 0]] + 3),
                          (left[before >= 0], right[before[before >= 0]])):
        twins[edges], twins[others] = others, edges
    return triangles, twins


def split_planes(steps: Steps, slash: np.ndarray, cost: EdgeCost) -> np.ndarray:
    """Planes of the triangles that `half_edges` makes of quads, float64 (K, 2 * n)."""
    upper, lower = np.where(slash, steps.left, steps.right), np.where(slash, steps.right, steps.left)
    gradients = np.stack([np.concatenate([steps.top, upper]), np.concatenate([steps.bottom, lower])], axis=2)
    return cost.planes(gradients.reshape(2 * cost.channels, 2 * len(slash)).astype(np.float64))


def _corner_values(plane: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Values (4, n) at the corners a, b, c, d of quads; the frame repeats the nearest pixel."""
    height, width = plane.shape
    row, col = np.divmod(quads, width + 1)
    above, below = np.maximum(row - 1, 0), np.minimum(row, height - 1)
    before, after = np.maximum(col - 1, 0), np.minimum(col, width - 1)
    pixels = np.stack([above * width + before, above * width + after, below * width + after,
                       below * width + before])
    return np.asarray(plane.ravel()[pixels])


def _size(step: np.ndarray, cost: str) -> np.ndarray:
    step = step.astype(np.int64)
    return np.asarray(np.abs(step) if cost == "paper" else (step * step).sum(axis=0, keepdims=True))


def _thin_link(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Whether labels, with thin ones stored as -1 - label, are equal and one of them thin."""
    return np.asarray((np.minimum(one, other) < 0) & (np.maximum(one, -1 - one) == np.maximum(other, -1 - other)))


def _slash_is_rarer(image: np.ndarray, quads: np.ndarray) -> np.ndarray:
    """Whether b and d differ more from the twelve pixels round a quad than a and c do."""
    height, width = image.shape[:2]
    row, col = np.divmod(quads, width + 1)
    around = np.arange(-2, 2)
    rows = np.clip(row[:, np.newaxis] + around, 0, height - 1)
    cols = np.clip(col[:, np.newaxis] + around, 0, width - 1)
    block = premultiplied_levels(image[rows[:, :, np.newaxis], cols[:, np.newaxis, :]])
    backslash = block[:, 1, 1] + block[:, 2, 2]
    slash = block[:, 1, 2] + block[:, 2, 1]
    ring = block.sum(axis=(1, 2)) - backslash - slash
    return np.asarray(((6 * slash - ring) ** 2).sum(axis=1) > ((6 * backslash - ring) ** 2).sum(axis=1))
