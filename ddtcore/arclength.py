# SPDX-License-Identifier: GPL-2.0-or-later
"""Polylines by the distance walked along them."""

from __future__ import annotations

import numpy as np

from .model import Polylines


class Arclength:
    """Arcs as functions of the distance walked along them.

    Attributes
    ----------
    at_point : ndarray of shape (N,)
        Distance of each point of the polylines from the beginning of its arc, px.
    total : ndarray of shape (A,)
        Length of each arc, px.
    """

    def __init__(self, lines: Polylines, ring: np.ndarray) -> None:
        count = np.diff(lines.starts)
        arc = np.repeat(np.arange(len(count)), count + ring)
        starts = np.concatenate([[0], np.cumsum(count + ring)])
        index = np.arange(starts[-1]) - np.repeat(starts[:-1] - lines.starts[:-1], count + ring)
        closing = starts[1:][ring] - 1
        index[closing] = lines.starts[:-1][ring]
        points = lines.points.take(index, axis=0)
        piece = np.zeros(len(points))
        piece[1:] = np.hypot(*np.diff(points, axis=0).T)
        # A gap between arcs keeps the whole table rising.
        piece[starts[:-1]] = 1.0
        self._table = np.cumsum(piece)
        # As complex numbers, both coordinates are looked up at once.
        self._places = np.ascontiguousarray(points).view(np.complex128)[:, 0]
        self._base = self._table[starts[:-1]]
        self._ring = ring
        self.total = self._table[starts[1:] - 1] - self._base
        own = np.ones(len(points), bool)
        own[closing] = False
        self.at_point = (self._table - self._base[arc])[own]

    def at(self, arc: np.ndarray, length: np.ndarray) -> np.ndarray:
        """Points at a distance from the beginning of arcs; rings wrap, open arcs end."""
        return self.places(arc, length).view(np.float64).reshape(-1, 2)

    def places(self, arc: np.ndarray, length: np.ndarray) -> np.ndarray:
        """The same points as complex numbers."""
        total = self.total[arc]
        query = np.minimum(np.maximum(length, 0), total)
        beyond = np.flatnonzero(((length < 0) | (length >= total)) & self._ring[arc])
        query[beyond] = np.mod(length[beyond], np.maximum(total[beyond], 1e-9))
        query += self._base[arc]
        return np.asarray(np.interp(query, self._table, self._places))
