# SPDX-License-Identifier: GPL-2.0-or-later
"""What each region is filled with."""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Tuple

import numpy as np

from .model import Gradient, Labels, PlanarMap
from .options import TraceOptions


class Paint(NamedTuple):
    """The fill of a region: a flat colour, or a gradient whose mean colour that is.

    Attributes
    ----------
    rgb : (int, int, int)
    opacity : float
        0 (nothing is painted) to 1.
    gradient : Gradient, optional
    """

    rgb: Tuple[int, int, int]
    opacity: float
    gradient: Optional[Gradient] = None


NOTHING = Paint((0, 0, 0), 0.0)


def face_paints(image: np.ndarray, labels: Labels, planar: PlanarMap, options: TraceOptions) -> List[Paint]:
    """Find the fill of every face.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
    planar : PlanarMap
    options : TraceOptions

    Returns
    -------
    list of Paint
        One per face; `NOTHING` for the outside and for transparent faces.
    """
    rgba = np.clip(np.rint(labels.palette), 0, 255).astype(int).tolist()
    paints = [Paint((r, g, b), a / 255) if a else NOTHING for r, g, b, a in rgba]
    return [NOTHING] + [paints[label] for label in planar.face_labels[1:].tolist()]
