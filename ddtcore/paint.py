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
from .sides import window
from .tint import beneath, cheaper, tinted

_FEW = 16
_NARROW = 0.35
"""Regions with fewer pixels off their border, or a smaller share of all, are narrow."""

_EVEN = 4.0
"""How far the colours in a block of 2 x 2 fully covered pixels differ at most, levels of a channel."""

_ENOUGH = 1 << 15
"""Pixels that are as good as all of a region."""

_ROWS = 256
"""Rows of the picture worked on at a time."""

_LEAST = 4
"""Regions with fewer pixels that stand out are judged by all their pixels."""

_STRONG = 0.93
"""Pixels of a narrow region stand out that differ from what is round it by this share of the most."""


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
    pixels = _Pixels.of(labels.index, unknown)
    colour = pixels.colours(image)
    opaque = bool((colour[:, 3] == 255).all())
    sure = _sure(image, labels.index, pixels)
    known = gradients.copy()
    for label, part in pixels.groups():
        chosen = part[sure[part]]
        chosen = chosen if len(chosen) >= _LEAST else part
        count = np.full(len(chosen), len(part) / len(chosen))
        samples = Samples(pixels.points[chosen], colour[chosen, :3 if opaque else 4], count)
        straight = int(np.count_nonzero(pixels.inside[part])) < _FEW
        own = fit_gradient(samples, pixels.points[part], straight)
        base = beneath(labels.index, pixels.cells[part], known)
        gradients[label] = own if own is None or base is None else cheaper(own, tinted(base, samples), base, samples)
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


class _Pixels(NamedTuple):
    """Pixels of some regions, in reading order."""

    cells: np.ndarray    # (n,) number of the pixel
    points: np.ndarray   # (n, 2) its centre
    region: np.ndarray   # (n,)
    inside: np.ndarray   # (n,) whether all its neighbours belong to the same region

    @classmethod
    def of(cls, regions: np.ndarray, some: np.ndarray) -> _Pixels:
        """The pixels in an array (H, W) of the regions that are set in a mask; of large ones, some."""
        cells = _chosen(regions, some)
        row, col = np.divmod(cells, regions.shape[1])
        points = np.stack([col + 0.5, row + 0.5], axis=1)
        return cls(cells, points, regions.ravel()[cells], surrounded(regions).ravel()[cells])

    def groups(self) -> Iterator[Tuple[int, np.ndarray]]:
        """Each region, and the places of its pixels."""
        order = np.argsort(self.region, kind="stable")
        values, first = np.unique(self.region[order], return_index=True)
        return zip(values.tolist(), np.split(order, first[1:]))

    @property
    def narrow(self) -> np.ndarray:
        """Which of the regions consist of their border, or nearly."""
        inner = np.bincount(self.region, self.inside)
        return np.asarray(inner < np.maximum(_FEW, _NARROW * np.bincount(self.region)))

    def colours(self, image: np.ndarray) -> np.ndarray:
        """Their premultiplied colours in a uint8 picture (H, W, 4)."""
        return premultiply(image.reshape(-1, 4)[self.cells].astype(np.float64))


def _chosen(regions: np.ndarray, some: np.ndarray) -> np.ndarray:
    """Numbers of the pixels of some regions; of the largest, those of every n-th row and column."""
    width = regions.shape[1]
    size = sum(np.bincount(row, minlength=len(some)) for row in _strips(regions.ravel(), width))
    step = np.maximum(np.sqrt(size / _ENOUGH).astype(np.int32), 1)
    chosen = []
    for number, strip in enumerate(_strips(regions.ravel(), width)):
        cells = np.flatnonzero(some[strip])
        row, col = np.divmod(cells, width)
        each = step[strip[cells]]
        kept = ((row + number * _ROWS) % each == 0) & (col % each == 0)
        chosen.append(cells[kept] + number * _ROWS * width)
    return np.concatenate(chosen)


def _strips(values: np.ndarray, width: int) -> Iterator[np.ndarray]:
    """The values of some rows after the other: what is computed of them needs little memory."""
    return (values[start:start + _ROWS * width] for start in range(0, len(values), _ROWS * width))


def surrounded(values: np.ndarray) -> np.ndarray:
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


def _sure(image: np.ndarray, regions: np.ndarray, pixels: _Pixels) -> np.ndarray:
    """Which pixels (n,) tell the colours of their region: they are covered by it in full, as far as any are."""
    sure = pixels.inside.copy()
    some = np.flatnonzero(pixels.narrow[pixels.region])
    if not some.size:
        return sure
    cells = pixels.cells[some]
    even = _even(image, regions, cells)
    height = _height(image, regions, cells)
    strong = height >= _STRONG * _most_near(height, regions, cells)
    # Where a region is so narrow that nothing is even, what stands out most there is the best there is.
    sure[some] = even | strong & (_most_near(even.astype(np.float64), regions, cells) == 0)
    return sure


def _even(image: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Which pixels lie in a block of 2 x 2 of the same region and nearly the same colour."""
    framed = np.pad(regions, 1, mode="constant", constant_values=-1).ravel()
    colours = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge").reshape(-1, 4)
    cells, stride = _framed(cells, regions.shape, 1)
    here = premultiply(colours[cells].astype(np.float32))
    like = {}
    for step in window(stride, 1, 1).tolist():
        off = np.abs(premultiply(colours[cells + step].astype(np.float32)) - here).max(axis=1)
        like[step] = (framed[cells + step] == framed[cells]) & (off <= _EVEN)
    even = np.zeros(cells.size, bool)
    for down in (-stride, stride):
        for across in (-1, 1):
            even |= like[down] & like[across] & like[down + across]
    return even


def _height(image: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """How far the colours of pixels are from the mean of those of other regions within 7 x 7."""
    framed = np.pad(regions, 3, mode="edge").ravel()
    colours = np.pad(image, ((3, 3), (3, 3), (0, 0)), mode="edge").reshape(-1, 4)
    cells, stride = _framed(cells, regions.shape, 3)
    total, count = np.zeros((cells.size, 4)), np.zeros((cells.size, 1))
    for step in window(stride, 1, 3):
        other = (framed[cells + step] != framed[cells])[:, None]
        total += other * premultiply(colours[cells + step].astype(np.float64))
        count += other
    off = premultiply(colours[cells].astype(np.float64)) - total / np.maximum(count, 1)
    return np.asarray(np.sqrt((off ** 2).sum(axis=1)))


def _most_near(height: np.ndarray, regions: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """The largest of the values (n,) of some pixels of the same region within 5 x 5 of each."""
    framed = np.pad(regions, 2, mode="edge").ravel()
    cells, stride = _framed(cells, regions.shape, 2)
    values = np.zeros(framed.size)
    values[cells] = height
    most = height.copy()
    for step in window(stride, 1, 2):
        np.maximum(most, np.where(framed[cells + step] == framed[cells], values[cells + step], 0), out=most)
    return most


def _framed(cells: np.ndarray, shape: Tuple[int, int], rim: int) -> Tuple[np.ndarray, int]:
    """Numbers of pixels in a picture with a rim, and the step from one of its rows to the next."""
    row, col = np.divmod(cells, shape[1])
    stride = shape[1] + 2 * rim
    return (row + rim) * stride + col + rim, stride


def _soft_paints(image: np.ndarray, labels: Labels, planar: PlanarMap,
                 soft: np.ndarray) -> Iterator[Tuple[int, Paint]]:
    """Paints of the faces of ramps: the ramp's gradient, or the face's own colour if that is nearer."""
    pixels = _Pixels.of(planar.pixel_faces, soft)
    colour, face = pixels.colours(image), pixels.region
    sure = _sure(image, planar.pixel_faces, pixels)
    flat = _means(colour, face, sure)
    model = local_colours(labels, planar.face_labels[face], pixels.points)
    known = labels.gradients or (None,) * len(labels.palette)
    gradients = [known[label] for label in planar.face_labels.tolist()]
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
