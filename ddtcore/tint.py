# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradients of what is drawn on a ramp: the ramp's own, seen through something even.

A translucent shade or gloss mixes one colour, in one share, with whatever lies below.  So its
colours follow the gradient of the ramp wherever it goes, round every bend, and two numbers
tell it apart.  Narrow things show their colour in few pixels: to find a gradient of their
own in these is mostly luck.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Optional, Sequence, Tuple

import numpy as np

from .gradient import colours_at, price
from .mixes import excess
from .model import Gradient
from .samples import Samples, total_error, weighted_quantile

LUCK = 0.5
"""A gradient of its own has to explain a narrow thing better than a tint by this factor: less is luck."""

_STRAY = 9.0
"""Samples count less that are off by more than so many times the middle squared error."""

_ROUNDS = 4

_FULL, _FULLEST = 0.93, 0.9
"""Covered in full is what is covered by this share of what the fullest samples are, those at this quantile."""

_STEP = 2
"""How far from its pixels a region's neighbours are looked for, px."""


def tinted(base: Gradient, samples: Samples) -> Optional[Gradient]:
    """The gradient `base` seen through a colour that is the same everywhere.

    Parameters
    ----------
    base : Gradient
    samples : Samples
        Colours of what is drawn on it.

    Returns
    -------
    Gradient or None
        None where either is translucent to the page.
    """
    colour, below = samples.colour, colours_at(base, samples.points)
    if any(stop[2] < 1 for stop in base.stops) or (colour[:, 3:] < 255).any():
        return None
    colour, below = colour[:, :3], below[:, :3]
    weight = samples.count
    for _ in range(_ROUNDS):
        middle, under = (weight.dot(values) / weight.sum() for values in (colour, below))
        spread = weight.dot(((below - under) ** 2).sum(axis=1))
        share = weight.dot(((below - under) * (colour - middle)).sum(axis=1)) / max(spread, 1e-9)
        share = min(max(share, 0.0), 1.0)
        square = ((colour - middle - share * (below - under)) ** 2).sum(axis=1)
        weight = samples.count / (1 + square / (_STRAY * np.median(square) + 1))
    ink = middle - share * under
    stops = tuple((offset, _levels(share * np.array(rgb) + ink), opacity) for offset, rgb, opacity in base.stops)
    return replace(base, stops=stops)


def _levels(rgb: np.ndarray) -> Tuple[int, int, int]:
    r, g, b = np.clip(np.rint(rgb), 0, 255).astype(int).tolist()
    return r, g, b


def strengthened(tint: Gradient, base: Gradient, samples: Samples) -> Gradient:
    """A tint of `base` as the samples that are covered in full tell it: narrow things, and tips, are not everywhere."""
    below, before = colours_at(base, samples.points)[:, :3], np.ones(len(samples.points), bool)
    colour = samples.colour[:, :3]
    for _ in range(_ROUNDS):
        change = colours_at(tint, samples.points)[:, :3] - below
        cover = ((colour - below) * change).sum(axis=1) / np.maximum((change ** 2).sum(axis=1), 1)
        fullest = weighted_quantile(cover, samples.count, _FULLEST)
        full = cover >= min(fullest, _FULL * fullest)
        if (full == before).all():
            break
        tint, before = tinted(base, Samples(*(values[full] for values in samples))) or tint, full
    return tint


def cheaper(one: Gradient, other: Optional[Gradient], base: Gradient, samples: Samples) -> Gradient:
    """The one of two gradients, if there are two, that explains more of something narrow for its price.

    Pixels between the colours of a gradient and of `base`, on which it is drawn, are covered in part.  The other
    one, a tint, is strengthened if it is taken.
    """
    if other is None:
        return one
    costs = [_unexplained(gradient, base, samples) + price(gradient) for gradient in (one, other)]
    return one if costs[0] <= LUCK * costs[1] else strengthened(other, base, samples)


def _unexplained(gradient: Gradient, base: Gradient, samples: Samples) -> float:
    """What the mixes of two gradients leave unexplained."""
    above, below = (colours_at(some, samples.points)[:, :samples.colour.shape[1]].T for some in (gradient, base))
    return total_error(excess(samples.colour.T, above, below).T, samples.count)


def beneath(regions: np.ndarray, cells: np.ndarray, gradients: Sequence[Optional[Gradient]]) -> Optional[Gradient]:
    """The gradient of the region that some pixels of another one meet most, if it is a ramp.

    Parameters
    ----------
    regions : ndarray of shape (H, W)
    cells : ndarray of shape (n,)
        Numbers of the pixels.
    gradients : sequence of Gradient or None
        Those that are known.
    """
    row, col = np.divmod(cells, regions.shape[1])
    met = np.zeros(len(gradients), np.int64)
    for down, across in ((-_STEP, 0), (_STEP, 0), (0, -_STEP), (0, _STEP)):
        there = regions[np.clip(row + down, 0, len(regions) - 1), np.clip(col + across, 0, regions.shape[1] - 1)]
        met += np.bincount(there, minlength=len(gradients))
    met *= np.array([gradient is not None for gradient in gradients])
    return gradients[int(met.argmax())]
