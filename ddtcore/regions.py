# SPDX-License-Identifier: GPL-2.0-or-later
"""Which flat colour each pixel belongs to: the stage before the mesh.

Flat art is plateaus of few colours, and anti-aliasing between them.  First come
the pixels that are sure (plateaus, soft ramps), then strokes too thin to have
plateaus, then every pixel in between goes to the nearer of its two sides.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from . import merging, palette, ramps, sides, strokes, threshold
from .canvas import Canvas, planes, prepare, unpack
from .model import Labels
from .options import TraceOptions

MANY = 64
"""Most colours of an automatic palette."""


def label_pixels(image: np.ndarray, options: TraceOptions) -> Labels:
    """Decide which flat colour each pixel of a picture belongs to.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    options : TraceOptions
        `regions`, `threshold`, `colors` and `speckle` are used.

    Returns
    -------
    Labels
    """
    canvas = prepare(image)
    if options.regions == "threshold":
        labels = threshold.label_steps(canvas, options.threshold)
    elif palette.is_noisy(canvas):
        labels = palette.posterise(canvas, options.colors or MANY)
    else:
        labels = _label_flat_art(canvas)
    if options.colors:
        labels = merging.limit_colours(labels, options.colors)
    if options.speckle:
        labels = merging.merge_specks(labels, options.speckle)
    return labels


def _label_flat_art(canvas: Canvas) -> Labels:
    """Labels of a picture made of flat colours, soft ramps and anti-aliasing."""
    slopes, count = ramps.find_ramps(canvas)
    plateaus = palette.find_plateaus(canvas, slopes >= 0)
    keys = palette.choose_colours(canvas, plateaus, count > 0)
    if not keys.size and not count:
        return palette.posterise(canvas, MANY)
    known = palette.known_labels(canvas, plateaus, keys)
    labels = canvas.rimmed(known, -1)
    ridges = strokes.find_ridges(canvas, canvas.cells(~plateaus.core & (slopes < 0)))
    keys = np.append(keys, strokes.new_colours(canvas, ridges, planes(keys, canvas.opaque), labels))
    if count:
        labels = canvas.rimmed(np.where(slopes >= 0, slopes + np.int32(keys.size), known), -1)
    colours = unpack(keys).astype(np.float64)
    if count:
        colours = np.concatenate([colours, threshold.mean_colours(canvas, slopes)])
    thin, sharp = np.zeros(labels.size, bool), canvas
    if keys.size:
        thin, sharp = _label_strokes(canvas, labels, keys, ridges)
    _label_mixed(canvas, sharp, labels, canvas.mixing(colours))
    ramp = np.arange(len(colours)) >= keys.size
    index = np.ascontiguousarray(canvas.bare(labels)).astype(np.int32)
    return merging.drop_unused(Labels(index, colours, np.ascontiguousarray(canvas.bare(thin)), ramp))


def _label_strokes(canvas: Canvas, labels: np.ndarray, keys: np.ndarray, ridges: strokes.Ridges):
    """Label the thin strokes; where they are, and the picture with their pixels in full colour."""
    label = strokes.stroke_labels(canvas, ridges, planes(keys, canvas.opaque), labels)
    thin = np.zeros(labels.size, bool)
    sharp = canvas.keys.copy()
    taken = (label >= 0) & (labels[ridges.cells] < 0)
    cells, label = ridges.cells[taken], label[taken]
    labels[cells] = label
    sharp[cells] = keys[label]
    thin[cells] = True
    return thin, replace(canvas, keys=sharp)


def _label_mixed(canvas: Canvas, sharp: Canvas, labels: np.ndarray, colours: np.ndarray) -> None:
    """Give every pixel left the label of the nearer of its two sides, in place."""
    cells = canvas.cells(canvas.bare(labels) < 0)
    if not cells.size:
        return
    samples, close = sides.near_samples(labels, cells, canvas.stride)
    pair = sides.best_pairs(canvas, sharp, cells, samples, close)
    here = canvas.colours(cells)
    _, share = sides.segment_distance(here, sharp.colours(pair[0]), sharp.colours(pair[1]))
    nearest = labels[np.where(share < 0.5, pair[0], pair[1])]
    alone = np.flatnonzero(pair[0] < 0)
    nearest[alone] = _beside_one(here[:, alone], samples[0, alone], labels, sharp, colours)
    labels[cells] = nearest


def _beside_one(here: np.ndarray, sample: np.ndarray, labels: np.ndarray, sharp: Canvas,
                colours: np.ndarray) -> np.ndarray:
    """Labels of pixels with at most one known colour near: a mix of that with any, or the nearest colour."""
    best = np.zeros(sample.size, labels.dtype)
    least = np.full(sample.size, np.inf)
    one = np.where(sample >= 0, sharp.colours(sample), here)
    for k in range(colours.shape[1]):
        other = np.broadcast_to(colours[:, k, None], here.shape)
        mixed, share = sides.segment_distance(here, one, other)
        plain = np.sqrt(((here - other) ** 2).sum(axis=0))
        cost = np.where(sample >= 0, mixed + 0.05 * plain, plain)
        better = cost < least
        least[better] = cost[better]
        best[better] = np.where((sample >= 0) & (share < 0.5), labels[sample], k)[better]
    return best
