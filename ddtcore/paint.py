# SPDX-License-Identifier: GPL-2.0-or-later
"""What each region is filled with."""

from __future__ import annotations

from typing import Dict, List, NamedTuple, Optional, Tuple

import numpy as np

from .canvas import premultiply
from .field import Samples
from .gradient import colours_at, fit_gradient
from .model import Gradient, Labels, PlanarMap
from .options import TraceOptions

_FEW = 16
"""Regions with fewer pixels off their border are judged by all their pixels."""


class Paint(NamedTuple):
    """The fill of a region: a flat colour, or a gradient whose mean colour that is.

    Attributes
    ----------
    rgb : (int, int, int)
    opacity : float
        0 (nothing is painted) to 1 (everywhere opaque).
    gradient : Gradient, optional
        Its stops have opacities of their own.
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
        One per face; `NOTHING` for the outside and for transparent faces.  Faces of the
        same ramp share one `Gradient`.
    """
    rgba = np.clip(np.rint(labels.palette), 0, 255).astype(int).tolist()
    flat = [Paint((r, g, b), a / 255) if a else NOTHING for r, g, b, a in rgba]
    paints = [NOTHING] + [flat[label] for label in planar.face_labels[1:].tolist()]
    if labels.ramp is not None and labels.ramp.any():
        soft = labels.ramp[planar.face_labels]
        soft[0] = False
        for face, paint in _soft_paints(image, planar, soft).items():
            paints[face] = paint
    return paints


def gradient_offset(paints: List[Paint], planar: PlanarMap) -> Optional[np.ndarray]:
    """How far the gradients are from their mean colours, at each pixel.

    Parameters
    ----------
    paints : list of Paint
        One per face.
    planar : PlanarMap

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype float32, or None
        Premultiplied RGBA, 0 to 255; 0 outside of the faces with gradients.  None where
        there are no gradients.
    """
    soft = np.array([paint.gradient is not None for paint in paints])
    if not soft.any():
        return None
    pixels = _Pixels.of(planar, soft)
    mean = premultiply(np.array([(*paint.rgb, 255 * paint.opacity) for paint in paints]))
    offset = np.zeros(planar.pixel_faces.shape + (4,), np.float32)
    for face, part in pixels.by(pixels.face):
        colour = colours_at(paints[face].gradient, pixels.points[part])
        offset.reshape(-1, 4)[pixels.cells[part]] = colour - mean[face]
    return offset


class _Pixels(NamedTuple):
    cells: np.ndarray    # (n,) number of each pixel, in reading order
    points: np.ndarray   # (n, 2) its centre
    face: np.ndarray     # (n,)
    inside: np.ndarray   # (n,) whether all its neighbours belong to the same face

    @classmethod
    def of(cls, planar: PlanarMap, faces: np.ndarray) -> "_Pixels":
        """The pixels of the faces set in a mask (F,)."""
        cells = np.flatnonzero(faces[planar.pixel_faces])
        row, col = np.divmod(cells, planar.pixel_faces.shape[1])
        return cls(cells, np.stack([col + 0.5, row + 0.5], axis=1), planar.pixel_faces.ravel()[cells],
                   _surrounded(planar.pixel_faces).ravel()[cells])

    def by(self, number: np.ndarray):
        """Each different number (n,), and the places of the pixels that have it."""
        order = np.argsort(number, kind="stable")
        values, first = np.unique(number[order], return_index=True)
        return zip(values.tolist(), np.split(order, first[1:]))


def _surrounded(values: np.ndarray) -> np.ndarray:
    """Which pixels have eight equal neighbours, but for those beyond the border of the picture."""
    same = np.ones(values.shape, bool)
    equal = values[1:] == values[:-1]
    same[1:] &= equal
    same[:-1] &= equal
    rows = same.copy()
    equal = values[:, 1:] == values[:, :-1]
    same[:, 1:] &= equal & rows[:, :-1]
    same[:, :-1] &= equal & rows[:, 1:]
    return same


def _soft_paints(image: np.ndarray, planar: PlanarMap, soft: np.ndarray) -> Dict[int, Paint]:
    """Paints of the faces of ramps: a gradient for each ramp, or a colour for each face."""
    pixels = _Pixels.of(planar, soft)
    colour = premultiply(image.reshape(-1, 4)[pixels.cells].astype(np.float64))
    channels = 3 if (colour[:, 3] == 255).all() else 4
    sure = pixels.inside | (np.bincount(pixels.face, pixels.inside)[pixels.face] < _FEW)
    flat = _means(colour, pixels.face, sure)
    gradients: Dict[int, Gradient] = {}
    model = flat[pixels.face]
    for label, part in pixels.by(planar.face_labels[pixels.face]):
        chosen = part[pixels.inside[part]]
        chosen = chosen if len(chosen) >= _FEW else part
        gradient = fit_gradient(Samples(pixels.points[chosen], colour[chosen, :channels], np.ones(len(chosen))),
                                pixels.points[part])
        if gradient is not None:
            gradients[label] = gradient
            model[part] = colours_at(gradient, pixels.points[part])
    better = _errors(colour - model, pixels.face, sure) < _errors(colour - flat[pixels.face], pixels.face, sure)
    mean = np.where(better[:, None], _means(model, pixels.face, np.ones_like(sure)), flat)
    return {face: _paint(mean[face], gradients.get(label) if better[face] else None)
            for face, label in zip(np.flatnonzero(soft).tolist(), planar.face_labels[soft].tolist())}


def _means(values: np.ndarray, number: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted means of the values (n, C) with equal numbers."""
    total = np.maximum(np.bincount(number, weight), 1e-9)
    return np.stack([np.bincount(number, weight * channel) / total for channel in values.T], axis=1)


def _errors(off: np.ndarray, number: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """Weighted sums of the squares (n, C) with equal numbers."""
    return np.bincount(number, weight * (off ** 2).sum(axis=1))


def _paint(mean: np.ndarray, gradient: Optional[Gradient]) -> Paint:
    """The paint of a face with this premultiplied mean colour."""
    r, g, b = np.clip(np.rint(mean[:3] * 255 / max(mean[3], 1e-9)), 0, 255).astype(int).tolist()
    opacity = round(float(np.rint(mean[3]))) / 255
    if gradient is not None and any(stop[2] < 1 for stop in gradient.stops):
        opacity = min(max(opacity, 1 / 255), 254 / 255)
    return Paint((r, g, b), opacity, gradient) if opacity else NOTHING
