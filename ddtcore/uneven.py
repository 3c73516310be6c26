# SPDX-License-Identifier: GPL-2.0-or-later
"""Areas under uneven light, whose slope noise hides, and which fell into several flat colours.

A scan or a photograph of a drawing gets darker towards one side.  Without noise that is a
soft ramp; with it no step is even, and the colours found along it part the paper along borders
that wind round every grain.  What tells it from flat areas is what lies between their colours:
there, means over many pixels change slowly, and a border would part them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Iterator, NamedTuple, Tuple

import numpy as np

from .canvas import Canvas, mean_colours
from .components import components
from .members import surrounded
from .merging import drop_unused
from .mixes import dot, length
from .model import Labels

NEAR, FAR = 3.0, 24.0
"""How far apart neighbours along a slope may be, as a multiple of the noise, and at most, levels of a channel."""

LEAST = 32
"""Fewest places between two colours from which something is concluded."""

BETWEEN = 0.05
"""Least share of the places near two colours that lie between them on a slope: round a border few do."""

PARTED, WHOLE = 0.3, 0.7
"""Halves of a place on a slope differ by less than this share of what the two colours do, for most such places."""

MIXED = 0.25
"""Pixels of a place on a slope are closer to their mean than this share of what the two colours differ by."""

FINE = 0.6
"""What differs by less than this part of the noise differs by chance."""

REACHES = 4, 2
"""How far the squares reach round a pixel that are looked at: large ones, and what fits into lines, px."""

EVEN = 0.4
"""Largest part of the noise by which the colours of squares are off the light's slope."""

_SAMPLE = 1 << 13


def join_slopes(canvas: Canvas, labels: Labels, noise: float) -> Labels:
    """Make soft ramps of flat colours between which the picture changes slowly.

    Parameters
    ----------
    canvas : Canvas
    labels : Labels
        Of a noisy picture, none of them ramps yet.
    noise : float
        How much flat areas vary, levels.

    Returns
    -------
    Labels
    """
    colours = canvas.mixing(labels.palette)
    near = np.abs(colours[:, :, None] - colours[:, None]).max(axis=0) <= min(NEAR * noise, FAR)
    one, other = np.nonzero(np.triu(near, 1))
    if not one.size:
        return labels
    joined = np.zeros(one.size, bool)
    for pairs, inside in _groups(canvas, labels, one, other):
        for reach in REACHES:
            squares = _squares(canvas, inside, reach)
            joined[pairs] |= [_is_slope(squares, colours[:, one[k], None], colours[:, other[k], None], noise)
                              for k in pairs.tolist()]
    one, other = one[joined], other[joined]
    kept = np.zeros(one.size, bool)
    for pairs, inside in _groups(canvas, labels, one, other):
        kept[pairs] = _is_even(canvas, _squares(canvas, inside, REACHES[-1]), noise)
    return _joined(canvas, labels, one[kept], other[kept]) if kept.any() else labels


def _joined(canvas: Canvas, labels: Labels, one: np.ndarray, other: np.ndarray) -> Labels:
    """Labels with some pairs of them made one ramp."""
    slope = components(len(labels.palette), one, other)
    index = np.unique(slope, return_index=True)[1].astype(labels.index.dtype)[slope][labels.index]
    ramp = np.bincount(slope)[slope] > 1
    used = np.flatnonzero(ramp & (np.bincount(index.ravel(), minlength=len(ramp)) > 0))
    palette = labels.palette.copy()
    palette[used] = mean_colours(canvas, index)[used]
    return drop_unused(replace(labels, index=index, palette=palette, ramp=ramp))


def _groups(canvas: Canvas, labels: Labels, one: np.ndarray,
            other: np.ndarray) -> Iterator[Tuple[np.ndarray, np.ndarray]]:
    """Pairs of labels that are connected: their numbers, and the pixels (P,) well inside these labels."""
    member = components(len(labels.palette), one, other)
    for group in np.unique(member[one]).tolist():
        # Pixels on the border of an area may be mixes with what is beyond.
        inner = surrounded(member[labels.index]) & (member == group)[labels.index]
        yield np.flatnonzero(member[one] == group), canvas.rimmed(inner, False)


class _Squares(NamedTuple):
    """A sample of squares in a picture."""

    cells: np.ndarray   # (n,) their middles
    mean: np.ndarray    # (C, n) colours
    parted: np.ndarray  # (n,) how much those of two halves differ at most
    spread: np.ndarray  # (n,) how far pixels are from the mean, root mean square


def _squares(canvas: Canvas, inside: np.ndarray, reach: int) -> _Squares:
    """Squares that lie within a mask (P,) altogether."""
    row, col = np.nonzero(canvas.bare(inside)[reach:-reach, reach:-reach])
    few = slice(None, None, max(1, row.size // _SAMPLE))
    cells = canvas.numbers(row[few] + reach, col[few] + reach)
    down, across = np.mgrid[-reach:reach + 1, -reach:reach + 1].reshape(2, -1)
    square = cells[:, None] + down * canvas.stride + across
    whole = inside[square].all(axis=1)
    colour = canvas.colours(square[whole])
    sides = np.sign(np.stack([across, down, across + down, across - down], axis=1))
    halves = (sides * 2 / np.abs(sides).sum(axis=0)).astype(np.float32)
    mean = colour.mean(axis=2)
    spread = length(colour - mean[..., None])
    return _Squares(cells[whole], mean, length(colour @ halves).max(axis=1), np.sqrt(np.square(spread).mean(axis=1)))


def _is_even(canvas: Canvas, squares: _Squares, noise: float) -> bool:
    """Whether the colours of squares are, but for noise, a quadratic function of their places."""
    x, y = (place / max(canvas.shape) for place in canvas.places(squares.cells))
    design = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    off = squares.mean.T - design @ np.linalg.lstsq(design, squares.mean.T, rcond=None)[0]
    return bool(np.sqrt(np.square(off).mean(axis=0)).max() < EVEN * noise)


def _is_slope(squares: _Squares, one: np.ndarray, other: np.ndarray, noise: float) -> bool:
    """Whether two colours (C, 1) are places on one slope."""
    span = other - one
    apart = float(length(span)[0])
    share = dot(squares.mean - one, span) / apart ** 2
    near = (length(squares.mean - one - share * span) < PARTED * apart) & (share > -0.5) & (share < 1.5)
    between = near & (share > 0.2) & (share < 0.8)
    # Where stripes or dots of both colours mix to a mean, pixels are far from that.
    even = squares.parted[between] < max(PARTED * apart, FINE * noise)
    even &= squares.spread[between] < max(MIXED * apart, FINE * noise)
    return bool(even.size >= max(LEAST, BETWEEN * np.count_nonzero(near)) and np.mean(even) > WHOLE)
