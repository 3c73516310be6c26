# SPDX-License-Identifier: GPL-2.0-or-later
"""How large a picture may be, and how long its trace may take, before it is made smaller.

Time is foretold by counting: pixels, steps from colour to colour, and the length of the
boundaries between labels, which is what most of the work goes into.  The clock isn't asked.
So the same picture gives the same drawing on a slow machine and a fast one, and with any
number of jobs at a time; what a person sets in seconds is right to a factor of two on a
machine of today.

Where a budget bites, the picture is reduced by a whole factor.  That suits those for which
it does: dither becomes the shade that it stands for, noise is averaged out.
"""

from __future__ import annotations

import math
from typing import Callable, Tuple

import numpy as np

from .canvas import unpack
from .model import Labels
from .options import TraceOptions
from .parts import in_parts
from .posterise import ROUGH, rough_share
from .raster import is_opaque, packed, pixel_keys
from .reduction import reduce

PIXEL = 0.2e-6
"""Seconds for a pixel, wherever it lies."""

STEP = 5e-6
"""Seconds of labelling for a step between pixels of different colours."""

NOISY, AREAS = 0.5e-6, 1.5e-6
"""Most seconds of labelling for a pixel of a noisy picture, for such are treated more roughly; and
most where regions are areas."""

BOUNDARY = 30e-6
"""Seconds for a pixel of boundary, from its crossings to the curve."""

TRIANGLES = 6e-6
"""Seconds for the triangles of a pixel, where these are the result."""

TOO_LARGE = "traced at 1/{} of its resolution: it has {:.3g} million pixels, more than 'megapixels' allows"
TOO_LONG = "traced at 1/{} of its resolution: at a higher one it would take longer than 'seconds' allows"

_SMALLEST = 64
"""Pictures whose sides are no longer than this are traced whatever it takes, px."""

_LINES = 256


def label_within_budget(image: np.ndarray, options: TraceOptions, label: Callable[[np.ndarray, int], Labels]
                        ) -> Tuple[np.ndarray, Labels, int, str]:
    """Label a picture at the highest resolution at which its trace keeps within the budget.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    options : TraceOptions
        `seconds` and `megapixels` are used.
    label : callable
        Labels a picture, given how many of the whole picture's pixels are a side of one of its own.

    Returns
    -------
    image : ndarray
        The picture as it was labelled.
    labels : Labels
    factor : int
        By which it was reduced.
    note : str
        Why, "" if it wasn't.
    """
    pixels = image.shape[0] * image.shape[1]
    factor, note = 1, ""
    if pixels > options.megapixels * 1e6:
        factor = math.ceil(math.sqrt(pixels / (options.megapixels * 1e6)))
        note = TOO_LARGE.format(factor, pixels / 1e6)
    while True:
        small = reduce(image, factor)
        whatever = max(small.shape[:2]) <= _SMALLEST
        seconds = labelling_seconds(small, options)
        if whatever or seconds <= options.seconds:
            labels = label(small, factor)
            seconds += drawing_seconds(labels, options)
            if whatever or seconds <= options.seconds:
                return small, labels, factor, note
        # Work falls with the square of the factor at most.
        factor = max(factor + 1, int(factor * math.sqrt(seconds / options.seconds)))
        note = TOO_LONG.format(factor)


def labelling_seconds(image: np.ndarray, options: TraceOptions) -> float:
    """How long it will take to label a picture (H, W, 4), by a sample of its rows and columns."""
    opaque, key = is_opaque(image), pixel_keys(image)
    steps, rough = 0.0, 1.0
    for lines in (key, key.T):
        keys = packed(unpack(lines[::max(1, len(lines) // _LINES)]))
        steps += np.count_nonzero(keys[:, 1:] != keys[:, :-1]) / keys.size
        rough = min(rough, rough_share(keys, opaque))
    most = AREAS if options.regions == "areas" else NOISY if rough > ROUGH else np.inf
    return float(image.shape[0] * image.shape[1] * (PIXEL + min(STEP * steps, most)))


def drawing_seconds(labels: Labels, options: TraceOptions) -> float:
    """How long it will take to draw what has been labelled."""
    index = labels.index
    if options.result in ("triangles", "border"):
        return TRIANGLES * index.size

    def steps(rows: slice) -> Tuple[np.ndarray]:
        some = index[rows.start:rows.stop + 1]
        own = some[:rows.stop - rows.start]
        return (np.array([np.count_nonzero(some[1:] != some[:-1]) + np.count_nonzero(own[:, 1:] != own[:, :-1])]),)

    return BOUNDARY * float(in_parts(steps, len(index), size=index.shape[1])[0].sum())
