# SPDX-License-Identifier: GPL-2.0-or-later
"""Colours as mixes of two or three others: distances from segments and triangles.

Colours are premultiplied planes: arrays whose first axis is the channel.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Scalar products along the first axis."""
    product: np.ndarray = np.einsum("i...,i...->...", a, b)
    return product


def length(vectors: np.ndarray) -> np.ndarray:
    """Euclidean lengths along the first axis."""
    size: np.ndarray = np.sqrt(dot(vectors, vectors))
    return size


def segment_distance(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance of colours from the segments a-b, and how far from a to b the nearest mix is, 0 to 1."""
    off, share = _from_segment(points, a, b)
    return length(off), share


def excess(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vectors from the nearest mixes of a and b to the colours `points`."""
    return _from_segment(points, a, b)[0]


def _from_segment(points: np.ndarray, a: np.ndarray, b: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    along, off = b - a, points - a
    share = dot(off, along)
    share /= np.maximum(dot(along, along), 1e-6)
    np.clip(share, 0, 1, out=share)
    off -= share * along
    return off, share


def third_share(points: np.ndarray, a: np.ndarray, b: np.ndarray,
                thirds: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """How well colours are mixes of a, b and a third one: its share, and the distance left.

    Parameters
    ----------
    points, a, b : ndarray of shape (C, N)
    thirds : ndarray of shape (C, K)

    Returns
    -------
    distance, share : ndarray of shape (N, K)
        Distance from the nearest mix that holds any of the third colour, and its share
        there, 0 to 1.

    Notes
    -----
    All products come from three matrix products and a few scalars per point; the mix
    lies inside the triangle or on one of its two sides at the third colour.
    """
    off, across = points - a, b - a
    square = dot(thirds, thirds)
    a_third, b_third, point_third = (plane.T @ thirds for plane in (a, b, points))
    a_a, b_b, off_off, across_off = dot(a, a), dot(b, b), dot(off, off), dot(across, off)
    to_a = square - 2 * a_third + a_a[:, None]
    off_to = point_third - a_third - dot(points, a)[:, None] + a_a[:, None]
    distance, share = _side_mix(off_off[:, None], off_to, to_a)

    beyond = points - b
    to_b = square - 2 * b_third + b_b[:, None]
    beyond_to = point_third - b_third - dot(points, b)[:, None] + b_b[:, None]
    other, part = _side_mix(dot(beyond, beyond)[:, None], beyond_to, to_b)
    nearer = other < distance
    distance[nearer], share[nearer] = other[nearer], part[nearer]

    wide = dot(across, across)[:, None]
    cross = b_third - a_third - dot(a, b)[:, None] + a_a[:, None]
    det = wide * to_a - cross * cross
    inside = det > 0.02 * wide * to_a
    det[~inside] = 1
    along = (across_off[:, None] * to_a - off_to * cross) / det
    part = (off_to * wide - across_off[:, None] * cross) / det
    left = off_off[:, None] - along * across_off[:, None] - part * off_to
    inside &= (along >= 0) & (part >= 0) & (along + part <= 1)
    left = np.sqrt(np.maximum(left, 0))
    inside &= left < distance
    distance[inside], share[inside] = left[inside], part[inside]
    return distance, share


def _side_mix(off_off: np.ndarray, off_to: np.ndarray, to_to: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Distance from a segment and the share of its far end, from scalar products."""
    share = np.clip(off_to / np.maximum(to_to, 1e-6), 0, 1)
    return np.sqrt(np.maximum(off_off - 2 * share * off_to + share * share * to_to, 0)), share
