# SPDX-License-Identifier: GPL-2.0-or-later
"""What each region is filled with."""

from __future__ import annotations

from dataclasses import replace
from typing import Iterator, List, NamedTuple, Optional, Tuple

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


def find_gradients(image: np.ndarray, labels: Labels) -> Labels:
    """Find the gradient of each ramp.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels

    Returns
    -------
    Labels
        With `gradients`; None of them for labels that are no ramps or better flat.
    """
    gradients: List[Optional[Gradient]] = [None] * len(labels.palette)
    if labels.ramp is None or not labels.ramp.any():
        return replace(labels, gradients=tuple(gradients))
    pixels = _Pixels.of(labels.index, labels.ramp)
    colour = pixels.colours(image)
    opaque = bool((colour[:, 3] == 255).all())
    for label, part in pixels.groups():
        chosen = part[pixels.inside[part]]
        chosen = chosen if len(chosen) >= _FEW else part
        samples = Samples(pixels.points[chosen], colour[chosen, :3 if opaque else 4], np.ones(len(chosen)))
        gradients[label] = fit_gradient(samples, pixels.points[part])
    return replace(labels, gradients=tuple(gradients))


def local_colours(labels: Labels, number: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Colours that labels have, or would have, at points.

    Parameters
    ----------
    labels : Labels
        With `gradients`, or all labels count as flat.
    number : ndarray of shape (n,)
        A label for each point; the colour of `OUTSIDE` is nothing.
    points : ndarray of shape (n, 2)

    Returns
    -------
    ndarray of shape (n, 4) and dtype float64
        Premultiplied RGBA, 0 to 255.
    """
    colours = premultiply(np.concatenate([labels.palette, np.zeros((1, 4))]))[number]
    for label, gradient in enumerate(labels.gradients or ()):
        if gradient is not None:
            here = np.flatnonzero(number == label)
            colours[here] = colours_at(gradient, points[here])
    return colours


def face_paints(image: np.ndarray, labels: Labels, planar: PlanarMap, options: TraceOptions) -> List[Paint]:
    """Find the fill of every face.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        Gradients are looked for unless it has them.
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
        labels = labels if labels.gradients else find_gradients(image, labels)
        soft = labels.ramp[planar.face_labels]
        soft[0] = False
        for face, paint in _soft_paints(image, labels, planar, soft):
            paints[face] = paint
    return paints


class _Pixels(NamedTuple):
    """Pixels of some regions, in reading order."""

    cells: np.ndarray    # (n,) number of the pixel
    points: np.ndarray   # (n, 2) its centre
    region: np.ndarray   # (n,)
    inside: np.ndarray   # (n,) whether all its neighbours belong to the same region

    @classmethod
    def of(cls, regions: np.ndarray, some: np.ndarray) -> _Pixels:
        """The pixels in an array (H, W) of the regions that are set in a mask."""
        cells = np.flatnonzero(some[regions])
        row, col = np.divmod(cells, regions.shape[1])
        points = np.stack([col + 0.5, row + 0.5], axis=1)
        return cls(cells, points, regions.ravel()[cells], _surrounded(regions).ravel()[cells])

    def groups(self) -> Iterator[Tuple[int, np.ndarray]]:
        """Each region, and the places of its pixels."""
        order = np.argsort(self.region, kind="stable")
        values, first = np.unique(self.region[order], return_index=True)
        return zip(values.tolist(), np.split(order, first[1:]))

    def colours(self, image: np.ndarray) -> np.ndarray:
        """Their premultiplied colours in a uint8 picture (H, W, 4)."""
        return premultiply(image.reshape(-1, 4)[self.cells].astype(np.float64))


def _surrounded(values: np.ndarray) -> np.ndarray:
    """Which pixels have eight equal neighbours, but for those beyond the border of the picture."""
    same = np.ones(values.shape, bool)
    equal = values[1:] == values[:-1]
    same[1:] &= equal
    same[:-1] &= equal
    column = same.copy()
    equal = values[:, 1:] == values[:, :-1]
    same[:, 1:] &= equal & column[:, :-1]
    same[:, :-1] &= equal & column[:, 1:]
    return same


def _soft_paints(image: np.ndarray, labels: Labels, planar: PlanarMap,
                 soft: np.ndarray) -> Iterator[Tuple[int, Paint]]:
    """Paints of the faces of ramps: the ramp's gradient, or the face's own colour if that is nearer."""
    pixels = _Pixels.of(planar.pixel_faces, soft)
    colour, face = pixels.colours(image), pixels.region
    sure = pixels.inside | (np.bincount(face, pixels.inside)[face] < _FEW)
    flat = _means(colour, face, sure)
    model = local_colours(labels, planar.face_labels[face], pixels.points)
    gradients = [labels.gradients[label] for label in planar.face_labels.tolist()]
    better = _errors(colour - model, face, sure) < _errors(colour - flat[face], face, sure)
    better &= np.array([gradient is not None for gradient in gradients])[:len(better)]
    mean = np.where(better[:, None], _means(model, face, np.ones_like(sure)), flat)
    for k in np.flatnonzero(soft).tolist():
        yield k, _paint(mean[k], gradients[k] if better[k] else None)


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
    level = int(np.rint(mean[3]))
    if gradient is not None and any(stop[2] < 1 for stop in gradient.stops):
        # Visible, but not opaque, whatever the mean is rounded to.
        level = min(max(level, 1), 254)
    return Paint((r, g, b), level / 255, gradient) if level else NOTHING
