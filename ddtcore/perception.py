# SPDX-License-Identifier: GPL-2.0-or-later
"""How far apart two colours look.

Distances are Euclidean in Oklab (Ottosson, "A perceptual color space for image
processing", 2020), where black and white are 1 apart.
"""

from __future__ import annotations

import numpy as np

_CONES = np.array([[0.4122214708, 0.5363325363, 0.0514459929],
                   [0.2119034982, 0.6806995451, 0.1073969566],
                   [0.0883024619, 0.2817188376, 0.6299787005]])

_OPPONENTS = np.array([[0.2104542553, 0.7936177850, -0.0040720468],
                       [1.9779984951, -2.4285922050, 0.4505937099],
                       [0.0259040371, 0.7827717662, -0.8086757660]])


def oklab(rgb: np.ndarray) -> np.ndarray:
    """Lightness and the two opponent colours of sRGB ones.

    Parameters
    ----------
    rgb : ndarray of shape (..., 3)
        0 to 255.

    Returns
    -------
    ndarray of shape (..., 3) and dtype float64
        Lightness is 0 for black and 1 for white.

    Examples
    --------
    >>> bool(np.abs(oklab(np.array([255, 255, 255])) - [1, 0, 0]).max() < 1e-6)
    True
    """
    value = np.asarray(rgb, np.float64) / 255
    linear = np.where(value > 0.04045, ((np.maximum(value, 0.04045) + 0.055) / 1.055) ** 2.4, value / 12.92)
    lab: np.ndarray = np.cbrt(linear @ _CONES.T) @ _OPPONENTS.T
    return lab


def nearest(rgb: np.ndarray, among: np.ndarray) -> np.ndarray:
    """Number of the colour (K, 3) that looks most like each of some others (N, 3)."""
    points, best = oklab(rgb), np.zeros(len(rgb), np.int32)
    least = np.full(len(rgb), np.inf)
    for k, centre in enumerate(oklab(among)):
        square = ((points - centre) ** 2).sum(axis=1)
        nearer = square < least
        best[nearer], least[nearer] = k, square[nearer]
    return best
