# SPDX-License-Identifier: GPL-2.0-or-later
"""The order in which faces are painted: by area, larger ones to the back.

"Areas with larger bounding rectangle are written first" (the paper, section V).  The
area within a face's outer loop serves as well: a face inside a hole of another one has
the smaller key either way, while the area of the face itself, holes left out, would
paint a thin net over its cells.  Neither key is relied upon: a hole is filled only
where all that lies inside comes later.
"""

from __future__ import annotations

from typing import NamedTuple, Sequence

import numpy as np

from .loops import FaceLoops
from .paint import Paint


class Order(NamedTuple):
    """Who is painted when, and under whom others may continue.

    Attributes
    ----------
    faces : ndarray of shape (n,) and dtype int64
        The painted faces, back to front.
    key : ndarray of shape (n,) and dtype float64
        What they are sorted by, px².
    rank : ndarray of shape (F,) and dtype int32
        Place of each face in `faces`, -1 if it is not painted.
    cover : ndarray of shape (F,) and dtype int32
        The same, but -1 for translucent faces too: they hide nothing.
    """

    faces: np.ndarray
    key: np.ndarray
    rank: np.ndarray
    cover: np.ndarray


def area_order(loops: FaceLoops, paints: Sequence[Paint], by_box: bool) -> Order:
    """Sort the painted faces.

    Parameters
    ----------
    loops : FaceLoops
    paints : sequence of Paint
        One per face.
    by_box : bool
        Sort by the area of the bounding rectangle, as the paper does, rather than by
        the area within the outer loop.

    Returns
    -------
    Order

    Notes
    -----
    Translucent faces come before all opaque ones, each kind sorted by itself.  Nothing
    may continue under a translucent face, but it may itself continue under the opaque
    ones, and that closes the seam between the two.
    """
    area, key = np.zeros(len(paints)), np.zeros(len(paints))
    area[loops.face[loops.outer]] = loops.area[loops.outer]
    key[loops.face[loops.outer]] = (loops.box if by_box else loops.area)[loops.outer]
    opacity = np.array([paint.opacity for paint in paints])
    faces = np.lexsort((-area, -key, opacity == 1))
    faces = faces[opacity[faces] > 0]
    rank = np.full(len(paints), -1, np.int32)
    rank[faces] = np.arange(len(faces))
    cover = np.where(opacity == 1, rank, np.int32(-1))
    return Order(faces, np.maximum(key[faces], 0), rank, cover)


def covers_all(order: Order) -> bool:
    """Whether every face but the first painted one is painted later, and all are opaque."""
    return len(order.faces) > 0 and bool((order.cover[1:] >= 0).all())


def filled_holes(loops: FaceLoops, order: Order) -> np.ndarray:
    """Which loops are holes that later, opaque faces cover completely.

    Parameters
    ----------
    loops : FaceLoops
        Of all faces.
    order : Order

    Returns
    -------
    ndarray of shape (L,) and dtype bool
    """
    outer, hole = loops.outer, ~loops.outer
    lowest = np.full(int(loops.web.max()) + 1, np.iinfo(np.int32).max, np.int32)
    np.minimum.at(lowest, loops.web[outer], order.cover[loops.face[outer]])
    outer_web = np.full(len(order.cover), -1)
    outer_web[loops.face[outer]] = loops.web[outer]
    inner, around = loops.web[hole], outer_web[loops.face[hole]]
    inner, around = inner[around >= 0], around[around >= 0]
    while True:  # once per level of nesting
        before = lowest.copy()
        np.minimum.at(lowest, around, lowest[inner])
        if np.array_equal(before, lowest):
            return np.asarray(hole & (lowest[loops.web] > order.rank[loops.face]))
