# SPDX-License-Identifier: GPL-2.0-or-later
"""Other colours than those of the picture: a given palette, similar ones merged, no background.

Labels tell which pixels belong together and of which two colours each pixel on an edge is
a mix.  So colours are changed label by label, and the picture is painted anew with every
edge mixed as before: the stages after this one measure edges as exactly as ever.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Callable, Tuple, Union

import numpy as np

from .canvas import premultiply
from .components import label_components
from .flatten import remix
from .model import Labels
from .options import TraceOptions
from .perception import nearest, oklab

Snap = Callable[[np.ndarray], np.ndarray]
"""The number of the swatch for each of some colours (n, 3)."""


def recolour(image: np.ndarray, labels: Labels, options: TraceOptions) -> Tuple[np.ndarray, Labels]:
    """Merge similar colours and snap all to a palette, as the options ask.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        With `gradients`.
    options : TraceOptions
        `merge` and `palette` are used.

    Returns
    -------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        The same if nothing is asked for.
    """
    if options.merge:
        image, labels = merge_similar(image, labels, options.merge / 100)
    if options.palette:
        swatches = np.array(options.swatches)
        opaque = np.column_stack([swatches, np.full(len(swatches), 255)])
        image, labels = snap(image, labels, opaque, lambda rgb: nearest(rgb, swatches))
    return image, labels


def settle(image: np.ndarray, labels: Labels) -> Tuple[np.ndarray, Labels]:
    """Paint areas in their exact colours, where these are not those that the picture mixes."""
    if labels.exact is None:
        return image, labels
    if labels.clear is None:
        return image, replace(labels, palette=labels.exact, exact=None)
    return _repaint(image, labels, labels.index, np.arange(len(labels.palette)), labels.exact)


def merge_similar(image: np.ndarray, labels: Labels, apart: float) -> Tuple[np.ndarray, Labels]:
    """Give colours that look alike the most frequent one of them; soft ramps stay.

    From the most frequent colour to the rarest, each joins the nearest of those kept so
    far, or is kept if none is nearer than `apart`, as a share of the distance between
    black and white.  So all that are kept are farther apart than that.
    """
    count = np.bincount(labels.index.ravel(), minlength=len(labels.palette))
    flat = np.flatnonzero(~_ramps(labels) & (labels.palette[:, 3] > 0))
    flat = flat[np.argsort(-count[flat], kind="stable")]
    look = np.column_stack([oklab(labels.palette[flat, :3]), labels.palette[flat, 3] / 255])
    into = np.arange(len(labels.palette))
    kept = np.zeros(len(flat), bool)
    for k, number in enumerate(flat.tolist()):
        distance = np.sqrt(((look[kept] - look[k]) ** 2).sum(axis=1))
        kept[k] = not (distance < apart).any()
        if not kept[k]:
            into[number] = flat[kept][np.argmin(distance)]
    return _repaint(image, labels, labels.index, np.arange(len(into)), labels.palette[into])


def snap(image: np.ndarray, labels: Labels, swatches: np.ndarray, choose: Snap) -> Tuple[np.ndarray, Labels]:
    """Give each label one of the colours `swatches` (S, 4); soft ramps become bands of them.

    What is transparent in part stays so, unless the swatch is "nothing".
    """
    ramps = _ramps(labels)
    soft = ramps[labels.index]
    band = np.zeros(labels.index.shape, np.int64)
    band[soft] = choose(image[soft][:, :3])
    used, index = np.unique(labels.index.astype(np.int64) * len(swatches) + band, return_inverse=True)
    origin, swatch = np.divmod(used, len(swatches))
    swatch = np.where(ramps[origin], swatch, choose(labels.palette[origin, :3]))
    colours = swatches[swatch].astype(np.float64)
    colours[:, 3] *= labels.palette[origin, 3] / 255
    bare = replace(labels, ramp=np.zeros(len(ramps), bool))
    return _repaint(image, bare, index.reshape(soft.shape), origin, colours, ramps[origin])


def part_background(labels: Labels) -> Tuple[Labels, Labels]:
    """Tell the background apart: the colour that most of the border has, where it is connected with it.

    Areas of that colour that something else encloses are no background, nor is "nothing".

    Parameters
    ----------
    labels : Labels

    Returns
    -------
    labels : Labels
        With a label of its own for the background, of the same colour, so that the edges
        of the picture are measured as they are.
    painted : Labels
        The same with "nothing" as the background.
    """
    index, frame = labels.index, _frame_label(labels)
    if labels.palette[frame, 3] == 0:
        return labels, labels
    area = label_components(index)
    dropped = np.zeros(int(area.max()) + 1, bool)
    for side in _SIDES:
        dropped[area[side][index[side] == frame]] = True
    origin = np.append(np.arange(len(labels.palette)), frame)
    gradients = None if labels.gradients is None else tuple(labels.gradients[k] for k in origin.tolist())
    parted = Labels(np.where(dropped[area], np.int32(len(labels.palette)), index), labels.palette[origin],
                    labels.thin, _ramps(labels)[origin], gradients, speck=labels.speck)
    return parted, _without_last(parted)


_SIDES = ((0, slice(None)), (-1, slice(None)), (slice(1, -1), 0), (slice(1, -1), -1))


def _frame_label(labels: Labels) -> int:
    """The label that most pixels of the border of a picture have."""
    return int(np.argmax(np.bincount(np.concatenate([labels.index[side] for side in _SIDES]))))


def _without_last(labels: Labels) -> Labels:
    """The same labels, the last of them "nothing"."""
    palette, ramp = labels.palette.copy(), _ramps(labels).copy()
    palette[-1], ramp[-1] = 0, False
    gradients = None if labels.gradients is None else (*labels.gradients[:-1], None)
    return replace(labels, palette=palette, ramp=ramp, gradients=gradients)


def _ramps(labels: Labels) -> np.ndarray:
    """Which labels are soft ramps, bool (K,)."""
    return np.zeros(len(labels.palette), bool) if labels.ramp is None else labels.ramp


def _repaint(image: np.ndarray, labels: Labels, index: np.ndarray, origin: np.ndarray, colours: np.ndarray,
             banded: Union[np.ndarray, bool] = False) -> Tuple[np.ndarray, Labels]:
    """Paint regions, each within one label, in new colours (R, 4); those of one colour become one label."""
    changed = (colours != labels.palette[origin]).any(axis=1) | banded
    image = remix(image, labels, index, origin, premultiply(colours), changed)
    colours = np.where(colours[:, 3:] > 0, colours, 0)
    ramp = _ramps(labels)[origin] & ~changed
    used = np.bincount(index.ravel(), minlength=len(origin)) > 0
    # Soft ramps are told apart by their number.
    key = np.column_stack([colours, np.where(ramp, np.arange(1, len(origin) + 1), 0)])
    _, first, number = np.unique(key[used], axis=0, return_index=True, return_inverse=True)
    number_of = np.zeros(len(origin), np.int32)
    number_of[used] = np.ravel(number)
    first = np.flatnonzero(used)[first]
    gradients = None
    if labels.gradients is not None:
        gradients = tuple(labels.gradients[origin[k]] if ramp[k] else None for k in first.tolist())
    return image, Labels(number_of[index], colours[first], labels.thin, ramp[first], gradients,
                         speck=labels.speck)
