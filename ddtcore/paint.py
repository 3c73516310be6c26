# SPDX-License-Identifier: GPL-2.0-or-later
"""What each region is filled with."""

from __future__ import annotations

from dataclasses import replace
from typing import Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from .canvas import premultiply
from .gradient import Wanted, colours_at, fit_gradients
from .members import Pixels, sure_pixels
from .model import Gradient, Labels, PlanarMap
from .options import TraceOptions
from .samples import Samples
from .tint import beneath, cheaper, tinted

_FEW = 16
"""Regions with fewer pixels off their border may have straight gradients only."""

_KINDS, _KINDS_OF_PHOTOS = 3, 2
"""Kinds of gradients that larger ones may have; what slopes in a photograph is no ellipse."""

_LEAST = 4
"""Regions with fewer pixels that stand out are judged by all their pixels."""


_DOUBT = 2.0
"""A face takes its own mean colour where its ramp's gradient errs by this factor more: a mean always errs least,
and where pixels are covered in part, least is too pale."""


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
    """Find the gradient of each ramp that has none yet.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels

    Returns
    -------
    Labels
        With `gradients`; None of them for labels that are no ramps or better flat.
    """
    ramp = np.zeros(len(labels.palette), bool) if labels.ramp is None else labels.ramp
    gradients = [gradient if soft else None for gradient, soft in
                 zip(labels.gradients or [None] * len(ramp), ramp.tolist())]
    unknown = ramp & np.array([gradient is None for gradient in gradients], bool)
    if not unknown.any():
        return replace(labels, gradients=tuple(gradients))
    pixels = Pixels.of(labels.index, unknown)
    colour = pixels.colours(image)
    opaque = bool((colour[:, 3] == 255).all())
    sure = sure_pixels(image, labels.index, pixels)
    groups = list(pixels.groups())

    def samples_of(part: np.ndarray) -> Samples:
        chosen = part[sure[part]]
        chosen = chosen if len(chosen) >= _LEAST else part
        count = np.full(len(chosen), len(part) / len(chosen))
        return Samples(pixels.points[chosen], colour[chosen, :3 if opaque else 4], count)

    known = gradients.copy()
    most = _KINDS_OF_PHOTOS if labels.gradients is None else _KINDS
    found = fit_gradients(Wanted(samples_of(part), pixels.points[part],
                                 1 if np.count_nonzero(pixels.inside[part]) < _FEW else most) for _, part in groups)
    for (label, part), own in zip(groups, found):
        base = beneath(labels.index, pixels.cells[part], known)
        if own is not None and base is not None:
            samples = samples_of(part)
            own = cheaper(own, tinted(base, samples), base, samples)
        gradients[label] = own
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
    colours: np.ndarray = premultiply(np.concatenate([labels.palette, np.zeros((1, 4))]))[number]
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
        soft = labels.ramp[planar.face_labels]
        labels = labels if labels.gradients else find_gradients(image, labels)
        soft[0] = False
        for face, paint in _soft_paints(image, labels, planar, soft):
            paints[face] = paint
    return paints


def _soft_paints(image: np.ndarray, labels: Labels, planar: PlanarMap,
                 soft: np.ndarray) -> Iterator[Tuple[int, Paint]]:
    """Paints of the faces of ramps: the ramp's gradient, or the face's own colour if that is much nearer."""
    pixels = Pixels.of(planar.pixel_faces, soft)
    colour, face = pixels.colours(image), pixels.region
    sure = sure_pixels(image, planar.pixel_faces, pixels)
    flat = _means(colour, face, sure)
    model = local_colours(labels, planar.face_labels[face], pixels.points)
    known = labels.gradients or (None,) * len(labels.palette)
    gradients = [known[label] for label in planar.face_labels.tolist()]
    better = _errors(colour - model, face, sure) < _DOUBT * _errors(colour - flat[face], face, sure)
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
    """The paint of a face with this premultiplied mean colour: flat where all stops of its gradient are alike."""
    r, g, b = np.clip(np.rint(mean[:3] * 255 / max(mean[3], 1e-9)), 0, 255).astype(int).tolist()
    level = int(np.rint(mean[3]))
    if gradient is not None and len({stop[1:] for stop in gradient.stops}) == 1:
        gradient = None
    if gradient is not None and any(stop[2] < 1 for stop in gradient.stops):
        # Visible, but not opaque, whatever the mean is rounded to.
        level = min(max(level, 1), 254)
    return Paint((r, g, b), level / 255, gradient) if level else NOTHING
