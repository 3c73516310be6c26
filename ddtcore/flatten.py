# SPDX-License-Identifier: GPL-2.0-or-later
"""The picture as it would be if its gradients were flat.

Where outlines run depends on how much of each pixel either side covers, and that on
the colours of both sides *there*.  The stages that measure it know one colour for each
label; so each pixel gets the same mix of the mean colours of its labels as it is of
their colours at its place.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import premultiply
from .model import Labels
from .paint import local_colours
from .raster import pixel_keys
from .sides import window

_REACH = 2
"""How far from an outline pixels may be mixed, px."""

_SAME = 8.0
"""Sides nearer to each other than this in colour can't be told apart, levels."""

_FOREIGN = 12.0
"""A pixel that is farther than this from all mixes keeps the difference, levels."""

_ROWS, _CHUNK = 256, 1 << 17
"""Rows of the picture painted at a time, and pixels mixed at a time."""


def flatten(image: np.ndarray, labels: Labels) -> np.ndarray:
    """Replace each gradient by its mean colour.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        With `gradients`.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
        `image` itself where there are no gradients.
    """
    soft = np.array([gradient is not None for gradient in labels.gradients or ()], bool)
    if not soft.any():
        return image
    return remix(image, labels, labels.index, np.arange(len(soft)), premultiply(labels.palette), soft)


def remix(image: np.ndarray, labels: Labels, index: np.ndarray, origin: np.ndarray, colours: np.ndarray,
          changed: np.ndarray) -> np.ndarray:
    """Paint regions in other colours, with every edge between them mixed as it was.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
        What the pixels of the picture are mixes of.
    index : ndarray of shape (H, W) and dtype int
        Number of the region of each pixel; no region has pixels of several labels.
    origin : ndarray of shape (R,) and dtype int
        Label of each region.
    colours : ndarray of shape (R, 4)
        Premultiplied RGBA of each region, 0 to 255.
    changed : ndarray of shape (R,) and dtype bool
        Which regions are to be painted; the others are left as they are, but for their edges.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
    """
    out = np.array(image, order="C")
    keys, painted = pixel_keys(out), pixel_keys(straightened(colours))
    for start in range(0, len(index), _ROWS):
        number = index[start:start + _ROWS]
        np.copyto(keys[start:start + _ROWS], painted[number], where=changed[number])
    cells, other = _pairs(index, changed)
    if not cells.size:
        return out
    cuts = np.unique(np.searchsorted(cells, cells[_CHUNK::_CHUNK]))
    for some, others in zip(np.split(cells, cuts), np.split(other, cuts)):
        at, mixed = _remixed(image, labels, index, origin, colours, changed, some, others)
        out.reshape(-1, 4)[at] = straightened(mixed)
    return out


def _remixed(image: np.ndarray, labels: Labels, index: np.ndarray, origin: np.ndarray, colours: np.ndarray,
             changed: np.ndarray, cells: np.ndarray, other: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels, of those given (n,), rising, with a region near each, and what they become."""
    own = index.ravel()[cells]
    row, col = np.divmod(cells, index.shape[1])
    points = np.stack([col + 0.5, row + 0.5], axis=1)
    colour = premultiply(image.reshape(-1, 4)[cells].astype(np.float64))
    here, there = (local_colours(labels, origin[number], points) for number in (own, other))
    share, off = _mix(colour, here, there)
    rest = np.sqrt((off ** 2).sum(axis=1))
    off[rest < _FOREIGN] = 0
    here, there = (np.where(changed[number, None], colours[number], was)
                   for number, was in ((own, here), (other, there)))
    mixed = there + share[:, None] * (here - there) + off
    # Of several regions nearby, the one whose mix leaves the least.
    group = np.cumsum(np.diff(cells, prepend=-1) > 0) - 1
    least = np.flatnonzero(rest == np.minimum.reduceat(rest, np.searchsorted(group, np.arange(group[-1] + 1)))[group])
    best = least[np.diff(group[least], prepend=-1) > 0]
    return cells[best], mixed[best]


def _pairs(index: np.ndarray, soft: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels, rising, and other labels near each; one of the two labels is soft."""
    framed = np.pad(index, _REACH, mode="edge")
    row, col = np.divmod(np.flatnonzero(_near_borders(framed, soft)), index.shape[1])
    cells = (row + _REACH) * framed.shape[1] + col + _REACH
    number = row * index.shape[1] + col
    framed = framed.ravel()
    own, other = framed[cells], np.full(cells.size, -1, framed.dtype)
    known = soft[own]
    more = [np.zeros(0, number.dtype)]
    for step in window(index.shape[1] + 2 * _REACH, 1, _REACH):
        near = framed[cells + step]
        hit = np.flatnonzero((near != own) & (near != other) & (known | soft[near]))
        # Few pixels are near several labels.
        again = other[hit] >= 0
        more.append(number[hit[again]] * len(soft) + near[hit[again]])
        other[hit[~again]] = near[hit[~again]]
    some = other >= 0
    pairs = np.concatenate([number[some] * len(soft) + other[some], np.unique(np.concatenate(more))])
    # Both parts are sorted, and no pair is in both.
    return np.divmod(np.sort(pairs, kind="stable"), len(soft))


def _near_borders(framed: np.ndarray, soft: np.ndarray) -> np.ndarray:
    """Which pixels have a border of a soft label in reach, and some of those nearby, of labels with such a frame."""
    near = np.zeros(framed.shape, bool)
    right, down, known = framed[:, 1:] != framed[:, :-1], framed[1:] != framed[:-1], soft[framed]
    right &= known[:, 1:] | known[:, :-1]
    down &= known[1:] | known[:-1]
    near[:, 1:] |= right
    near[1:] |= down
    wide = 2 * _REACH + 1
    rows, cols = (side - wide + 1 for side in framed.shape)
    across = np.zeros((len(near), cols), bool)
    for k in range(wide):
        across |= near[:, k:k + cols]
    out = np.zeros((rows, cols), bool)
    for k in range(wide):
        out |= across[k:k + rows]
    return out


def _mix(colour: np.ndarray, here: np.ndarray, there: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Share (n,) of `here` in the mix with `there` nearest to `colour`, and what is left over (n, 4)."""
    span = here - there
    size = (span ** 2).sum(axis=1)
    share = np.einsum("nc,nc->n", colour - there, span) / np.maximum(size, 1e-9)
    share = np.where(size < _SAME ** 2, 1.0, np.clip(share, 0, 1))
    return share, colour - there - share[:, None] * span


def straightened(colours: np.ndarray) -> np.ndarray:
    """RGBA bytes of premultiplied colours (n, 4)."""
    alpha = np.clip(colours[:, 3:], 0, 255)
    rgb = np.where(alpha > 0, colours[:, :3] * 255 / np.maximum(alpha, 1e-9), 0)
    return np.asarray(np.clip(np.rint(np.concatenate([rgb, alpha], axis=1)), 0, 255).astype(np.uint8))
