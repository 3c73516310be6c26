# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure how far one picture is shifted against another, to a small fraction of a pixel."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image


def over_white(png):
    """Pixels of a PNG (path or bytes) over white paper, float (H, W, 3)."""
    rgba = np.asarray(Image.open(io.BytesIO(png) if isinstance(png, bytes) else png).convert("RGBA"), float)
    alpha = rgba[..., 3:] / 255
    return rgba[..., :3] * alpha + 255 * (1 - alpha)


def shift(before, after):
    """The shift (x, y) in px that best explains `after`; (0, 0) for blank pictures.

    One step of the gradient method of Lucas and Kanade (1981), on blurred pictures; good for
    shifts below a pixel, and away from zero for larger ones.
    """
    before, after = _blur(before), _blur(after)
    down, across = np.gradient((before + after) / 2, axis=(0, 1))
    gradient = np.stack([across.ravel(), down.ravel()], axis=1)
    return -np.linalg.lstsq(gradient, (after - before).ravel(), rcond=None)[0]


def _blur(picture):
    for axis in (0, 1):
        picture = sum(weight * np.roll(picture, step, axis)
                      for step, weight in zip((-2, -1, 0, 1, 2), (1 / 16, 4 / 16, 6 / 16, 4 / 16, 1 / 16)))
    return picture
