# SPDX-License-Identifier: GPL-2.0-or-later
"""Drawings that are hatched or patterned nearly everywhere, saved as JPEG: the few inks they were drawn with.

Hardly a pixel of theirs is flat, so they look like photographs, and hue bleeds so far that no
pixel between strokes has its own.  But in a small square with two inks hue and brightness go
together along a line: how they do where brightness has bled as hue has, tells the hue of the
brightest and the darkest pixels.  In a drawing these are the same few inks in most squares, and
most pixels lie near the ends of their line; in a photograph anywhere between.
"""

from __future__ import annotations

from typing import List, NamedTuple, Tuple

import numpy as np

from . import bleeding
from .canvas import LUMA, Canvas, pack
from .noise import zigzags
from .palette import is_mixed, plain_colours

MANY = 16
"""Most inks."""

SQUARES = 128
"""How many squares of a large picture are looked at."""

SIDE = 16
"""Side of the parts of these that may have two inks, px."""

LOW = 24.0
"""Parts that differ less in brightness have one ink, levels."""

HATCHED = 0.5
"""Share of the parts that differ more."""

MIDDLE = 0.25
"""Share of the pixels of these that are in the middle of their line at most, where half of it is."""

OFF, SHARE = 8.0, 0.08
"""How far hue is from a line where there are two inks: levels, and a share more of how far they are apart."""

DOUBT = 16.0
"""How surely the line tells the hue of its ends, levels."""

SURE = 0.5
"""Share of the parts that have two inks."""

LIKE, LIKER = 6.0, 0.08
"""How far the inks of two parts may be from each other if they are the same: levels, and a share as above."""

APART = 1.5
"""How far other inks are from one at least, as a multiple of that."""

COVERED = 0.8
"""Share of the parts with two inks whose inks are among the few."""

GRAIN = 0.2
"""Share of zigzags from which there is a grain, as in a scan."""

CLIPPED = 0.25
"""Share of the pixels at one end that are 0 or 255 in a channel whose ink is, too."""

MIXED = 16.0
"""How far off the mixes of two inks a rarer one is that is such a mix in strokes too thin to be full, levels."""

RARER = 0.5
"""How often it is met at most, as a share of how often they are."""

_ENDS = 10, 90
_FEW = 4


class _Parts(NamedTuple):
    """The lines that hue and brightness lie on in small squares.

    Attributes
    ----------
    ends : ndarray of shape (n, 2, 3)
        The colours of the darkest and the brightest pixels.
    middle : ndarray of shape (n,)
        Share of the pixels between them.
    sure : ndarray of shape (n,) and dtype bool
        Whether there are no more than two inks.
    """

    ends: np.ndarray
    middle: np.ndarray
    sure: np.ndarray


def find_inks(canvas: Canvas) -> np.ndarray:
    """The packed inks of a hatched drawing, those met most often first; none if the picture is no such drawing."""
    none = np.zeros(0, np.uint32)
    if not canvas.opaque or plain_colours(canvas).size:
        return none
    squares = bleeding.in_squares(canvas)
    # Squares that leave the picture at its end are filled up.
    places = np.argwhere(np.ones([max(1, size // bleeding.TILE) for size in canvas.shape], bool))
    places = places[np.linspace(0, len(places) - 1, min(len(places), SQUARES)).astype(int)]
    ends, middle, sure = _lines(squares[places[:, 0], places[:, 1]])
    hatched = (ends[:, 1] - ends[:, 0]) @ LUMA > LOW
    if hatched.mean() < HATCHED or sure.mean() < SURE or middle[hatched].mean() > MIDDLE:
        return none
    return _gathered(ends[sure]) if zigzags(canvas, 4) < GRAIN else none


def _lines(squares: np.ndarray) -> _Parts:
    """The lines in the parts of squares (m, 3, S, S) with their surroundings."""
    luma = np.tensordot(squares, LUMA, (1, 0))
    here, bled, luma = (_parts(bleeding.without_rim(planes)) for planes in (
        squares, bleeding.bleed(luma)[:, np.newaxis], luma[:, np.newaxis]))
    low, high = np.percentile(luma[:, 0], _ENDS, axis=1)
    apart = high - low
    # Not all JPEGs keep less of hue.
    fits = [_fit(here - luma, seen, apart, low, high) for seen in (bled, luma)]
    ends, off, doubt = min(fits, key=lambda fit: float(fit[1].sum()))
    ends = _clipped(np.clip(ends, 0, 255), here, luma[:, 0], low, high)
    sure = (off <= OFF + SHARE * np.abs(ends[:, 1] - ends[:, 0]).max(axis=1)) & ((doubt <= DOUBT) | (apart <= LOW))
    place = (luma[:, 0] - low[:, np.newaxis]) / np.maximum(apart, 1)[:, np.newaxis]
    return _Parts(ends, np.mean(np.abs(place - 0.5) < 0.25, axis=1), sure)


def _fit(hue: np.ndarray, seen: np.ndarray, apart: np.ndarray, low: np.ndarray,
         high: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Colours at the ends (n, 2, 3) of lines between the hue (n, 3, N) and brightness (n, 1, N) of pixels.

    And how far hue is from them, and how surely they tell it there, levels (n,).
    """
    mean, middle = hue.mean(axis=2), seen.mean(axis=2)
    hue, seen = hue - mean[..., np.newaxis], seen - middle[..., np.newaxis]
    var = np.maximum(np.square(seen).mean(axis=2), 1e-3)
    slope = np.where(apart[:, np.newaxis] > LOW, (hue * seen).mean(axis=2) / var, 0)
    off = np.sqrt(np.square(hue - slope[..., np.newaxis] * seen).mean(axis=2)).max(axis=1)
    ends = np.stack([value[:, np.newaxis] + mean + (value[:, np.newaxis] - middle) * slope for value in (low, high)],
                    axis=1)
    # Hue that bleeds over 2 x 2 pixels makes these no four witnesses.
    return ends, off, 2 * off * apart / (SIDE * np.sqrt(var[:, 0]))


def _parts(planes: np.ndarray) -> np.ndarray:
    """Planes (m, C, S, S) of squares as those of their parts, (n, C, pixels)."""
    count, channels, side, _ = planes.shape
    parts = planes.reshape(count, channels, side // SIDE, SIDE, side // SIDE, SIDE)
    return parts.transpose(0, 2, 4, 1, 3, 5).reshape(-1, channels, SIDE * SIDE)


def _clipped(ends: np.ndarray, here: np.ndarray, luma: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """The colours at the ends with channels at 0 or 255 where many pixels have such: there they may have gone on."""
    for end, some in enumerate((luma <= low[:, np.newaxis], luma >= high[:, np.newaxis])):
        least = CLIPPED * some.sum(axis=1)[:, np.newaxis]
        for value in (0, 255):
            ends[:, end][((here == value) & some[:, np.newaxis]).sum(axis=2) > least] = value
    return ends


def _gathered(ends: np.ndarray) -> np.ndarray:
    """The few packed colours that the ends (n, 2, 3) of most lines are like; none if many are like none of few."""
    points = ends.reshape(-1, 3)
    margin = np.repeat(LIKE + LIKER * np.abs(ends[:, 1] - ends[:, 0]).max(axis=1), 2)
    left, covered = np.ones(len(points), bool), np.zeros(len(points), bool)
    alike = np.ones((len(points), len(points)), bool)
    for plane in points.T:
        alike &= np.abs(plane[:, np.newaxis] - plane) <= margin
    inks: List[np.ndarray] = []
    counts: List[int] = []
    while left.any() and len(inks) < MANY:
        count = (alike & left).sum(axis=1) * left
        best = int(count.argmax())
        if count[best] < max(_FEW, 0.01 * len(points)):
            break
        ink = np.median(points[alike[best] & left], axis=0)
        near = np.abs(points - ink).max(axis=1) <= margin
        if all(np.abs(other - ink).max() > APART * margin[best] for other in inks):
            inks, counts = [*inks, ink], [*counts, int(count[best])]
            covered |= near
        left &= ~near
        left[best] = False
    if len(inks) < 2 or covered.reshape(-1, 2).all(axis=1).mean() < COVERED:
        return np.zeros(0, np.uint32)
    return pack(_without_mixes(np.array(inks), np.array(counts)).T)


def _without_mixes(inks: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Colours (K, 3), of which there are falling counts, without mixes of others that are far more frequent."""
    kept = np.ones(len(inks), bool)
    for k in range(2, len(inks)):
        more = inks[:k][kept[:k] & (counts[k] <= RARER * counts[:k])].T
        kept[k] = not is_mixed(inks[k:k + 1].T, more, MIXED)[0]
    return np.asarray(inks[kept])
