# SPDX-License-Identifier: GPL-2.0-or-later
"""Flat art drawn with exact anti-aliasing, so that the true colour of every point is known.

A picture is a list of layers, back to front: a colour (RGBA, 0 to 255) and a
predicate of the coordinates x, y in px that tells which points it covers.
"""

from __future__ import annotations

import numpy as np

SAMPLES = 8
"""Samples per pixel in each direction."""


def everywhere(x, y):
    return np.ones_like(x, bool)


def disc(cx, cy, radius):
    return lambda x, y: (x - cx) ** 2 + (y - cy) ** 2 < radius * radius


def box(left, top, right, bottom):
    return lambda x, y: (x >= left) & (x < right) & (y >= top) & (y < bottom)


def half_plane(cx, cy, angle):
    """The points on the right of a line as seen along its direction (y down)."""
    return lambda x, y: (y - cy) * np.cos(angle) - (x - cx) * np.sin(angle) > 0


def stroke(cx, cy, angle, width, reach):
    """A straight stroke of a width round a centre."""
    def covers(x, y):
        along = (x - cx) * np.cos(angle) + (y - cy) * np.sin(angle)
        across = (y - cy) * np.cos(angle) - (x - cx) * np.sin(angle)
        return (np.abs(across) < width / 2) & (np.abs(along) < reach)
    return covers


def paint(height, width, layers, samples=SAMPLES):
    """The layers on top of each other, point by point: uint8 (H * samples, W * samples, 4)."""
    y, x = (np.mgrid[:height * samples, :width * samples] + 0.5) / samples
    points = np.zeros((height * samples, width * samples, 4), np.uint8)
    for colour, covers in layers:
        points[covers(x, y)] = colour
    return points


def rasterise(points, samples=SAMPLES):
    """A picture with coverage anti-aliasing, premultiplied while it averages: uint8 (H, W, 4)."""
    height, width = points.shape[0] // samples, points.shape[1] // samples
    values = points.astype(np.float64)
    values[..., :3] *= values[..., 3:] / 255
    mean = values.reshape(height, samples, width, samples, 4).mean(axis=(1, 3))
    alpha = np.maximum(mean[..., 3:] / 255, 1e-9)
    mean[..., :3] = np.where(mean[..., 3:] > 0, mean[..., :3] / alpha, 0)
    return np.rint(mean).clip(0, 255).astype(np.uint8)


def draw(height, width, layers):
    """A picture of the layers, uint8 (H, W, 4)."""
    return rasterise(paint(height, width, layers))


def presence(points, colours, samples=SAMPLES):
    """Which share of each pixel shows the colour (H, W, 4) given for it, float (H, W)."""
    height, width = colours.shape[:2]
    cells = points.reshape(height, samples, width, samples, 4).transpose(0, 2, 1, 3, 4)
    return (cells == colours[:, :, None, None]).all(axis=-1).mean(axis=(2, 3))


CARTOON = [
    ((255, 255, 255, 255), everywhere),
    ((0, 0, 0, 255), disc(40, 40, 32)), ((247, 203, 77, 255), disc(40, 40, 30.3)),
    ((0, 0, 0, 255), disc(30, 32, 7.2)), ((255, 255, 255, 255), disc(30, 32, 5.8)),
    ((40, 90, 180, 255), disc(31, 33, 2.6)),
    ((0, 0, 0, 255), disc(52, 32, 7.2)), ((255, 255, 255, 255), disc(52, 32, 5.8)),
    ((40, 90, 180, 255), disc(51, 33, 2.6)),
    ((180, 30, 40, 255), box(27.4, 50.3, 54.7, 57.6)), ((128, 128, 128, 255), box(70.5, 70.25, 90.2, 91.9)),
    ((0, 0, 0, 255), stroke(80, 20, 0.4, 1.1, 14))]
"""A face with outlines, a mouth, a grey box (a mix of black and white) and a thin stroke; 96 x 96."""


def colours_of(layers):
    """The different colours of layers, as a set of tuples."""
    return {tuple(colour) for colour, _ in layers}


def palette_of(labels):
    """The colours of labels rounded to 8 bits, as a set of tuples."""
    return set(map(tuple, np.rint(labels.palette).astype(int).tolist()))
