# SPDX-License-Identifier: GPL-2.0-or-later
"""Gradients done without: bands of flat colours, or one flat colour, in place of each.

Cutters, embroiderers and old programs know no gradients.  The bands of a gradient differ
by equal steps of colour, and the edges between them are anti-aliased like any other, so
that the stages after this one find them where the gradient says.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple, Tuple

import numpy as np

from .canvas import premultiply
from .flatten import flatten, remix, straightened
from .gradient import offsets_at
from .members import surrounded
from .model import Gradient, Labels
from .options import TraceOptions

STEP = 12.0
"""Smallest difference of two bands that is aimed at, levels of a channel."""

MOST = 12
"""Most bands of a gradient."""

WIDE = 2.0
"""Least mean width of a band, px."""


def level(image: np.ndarray, labels: Labels, options: TraceOptions) -> Tuple[np.ndarray, Labels]:
    """Turn gradients into flat colours, as the options ask.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        With `gradients`.
    options : TraceOptions
        `gradients` is used.

    Returns
    -------
    image : ndarray of shape (H, W, 4) and dtype uint8
        Painted with the flat colours, with every edge mixed as it was.
    labels : Labels
        Without ramps, unless gradients are asked for.
    """
    if options.gradients == "gradients" or not any(labels.gradients or ()):
        return image, labels
    if options.gradients == "bands":
        return _banded(image, labels)
    return flatten(image, labels), _without_ramps(labels)


def _without_ramps(labels: Labels) -> Labels:
    return replace(labels, ramp=np.zeros(len(labels.palette), bool), gradients=(None,) * len(labels.palette))


def _banded(image: np.ndarray, labels: Labels) -> Tuple[np.ndarray, Labels]:
    """The picture and its labels with each gradient in bands."""
    index = labels.index.astype(np.int64) * MOST
    mixed = np.zeros((*labels.index.shape, 4))
    colours = np.repeat(premultiply(labels.palette), MOST, axis=0)
    soft = np.zeros(len(labels.palette), bool)
    for label, gradient in enumerate(labels.gradients or ()):
        if gradient is None:
            continue
        soft[label] = True
        row, col = np.nonzero(labels.index == label)
        bands = _bands(gradient)
        points = np.stack([col, row], axis=1) + 0.5
        number, mixed[row, col] = bands.at(points)
        index[row, col] += number
        colours[label * MOST:label * MOST + len(bands.colours)] = bands.colours
    used, index = np.unique(index, return_inverse=True)
    index, origin = index.reshape(labels.index.shape), used // MOST
    out = remix(image, labels, index, origin, colours[used], soft[origin])
    inner = soft[labels.index] & surrounded(labels.index)
    out[inner] = straightened(mixed[inner])
    palette = straightened(colours[used]).astype(np.float64)
    palette[~soft[origin]] = labels.palette[origin[~soft[origin]]]
    return out, _without_ramps(Labels(index.astype(np.int32), palette, labels.thin))


class _Bands(NamedTuple):
    """Bands of a gradient.

    Attributes
    ----------
    gradient : Gradient
    borders : ndarray of shape (n - 1,)
        Offsets where one band ends and the next begins.
    colours : ndarray of shape (n, 4)
        Premultiplied RGBA, 0 to 255.
    """

    gradient: Gradient
    borders: np.ndarray
    colours: np.ndarray

    def at(self, points: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
        """Number of the band at each point (n, 2), and the colour of a pixel there (n, 4), anti-aliased."""
        place = offsets_at(self.gradient, points)
        number = np.searchsorted(self.borders, place, side="right")
        if not self.borders.size:
            return number, self.colours[number]
        slope = np.hypot(*(offsets_at(self.gradient, points + step) - offsets_at(self.gradient, points - step)
                           for step in ((0.5, 0), (0, 0.5))))
        nearest = np.searchsorted((self.borders[1:] + self.borders[:-1]) / 2, place)
        share = np.clip(0.5 + (place - self.borders[nearest]) / np.maximum(slope, 1e-9), 0, 1)[:, None]
        return number, self.colours[nearest] + share * (self.colours[nearest + 1] - self.colours[nearest])


def _bands(gradient: Gradient) -> _Bands:
    """Bands of equal steps of colour along a gradient, as many as it is long and colourful enough for."""
    offsets = np.array([stop[0] for stop in gradient.stops])
    stops = np.array([(*stop[1], 255 * stop[2]) for stop in gradient.stops], float)
    passed = np.append(0, np.cumsum(np.abs(np.diff(stops, axis=0)).max(axis=1)))
    ends = np.array([gradient.start, gradient.end])
    length = np.hypot(*(ends[1] - ends[0])) * (offsets[-1] - offsets[0])
    count = int(np.clip(np.ceil(passed[-1] / STEP), 1, np.clip(length // WIDE, 1, MOST)))
    # Where no colour changes, there is nothing to part.
    passed += np.arange(len(passed)) * 1e-6
    share = np.arange(1, 2 * count) / (2 * count) * passed[-1]
    place = np.interp(share, passed, offsets)
    middle = np.stack([np.interp(place[::2], offsets, channel) for channel in stops.T], axis=1)
    return _Bands(gradient, place[1::2], premultiply(middle))
