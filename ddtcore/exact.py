# SPDX-License-Identifier: GPL-2.0-or-later
"""The exact colours of areas under noise, told by their own pixels once these are known.

Under ripples or a grain colours that are nearly alike are found as one, and the end of a channel
is the likeliest value near it.  But the pixels well inside of an area tell together which
colour it has, to a level or two.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Iterator, Tuple

import numpy as np

from .canvas import Canvas, unpack, within
from .components import label_components
from .members import surrounded
from .model import Labels

FAR, NEAR = (7, 5.0), (1, 10.0)
"""Pixels so far from an area's border, px, tell its colour if they are so far off that of its label, levels."""

AREA = 64
"""Fewest of such pixels."""

EVEN = 0.9
"""Least share of them that are as near to their colour as the noise lets them be."""

MANY = 256
"""Most areas that are asked, the largest ones."""

_ASKED = 1 << 12


def exact_colours(canvas: Canvas, labels: Labels, noise: float) -> Labels:
    """Give areas the colour of the pixels well inside them, where that is not the one of their label.

    Parameters
    ----------
    canvas : Canvas
        The picture as flat areas tell their colour.
    labels : Labels
        Of a noisy picture.
    noise : float
        How much pixels vary, levels.

    Returns
    -------
    Labels
        With more labels for flat areas whose colour is not the one found before; all colours
        are `exact` then.
    """
    region = label_components(labels.index)
    first = np.zeros(int(region.max()) + 1, np.int64)
    first[region.ravel()] = labels.index.ravel()
    rgba = unpack(canvas.bare(canvas.keys)).reshape(-1, 4)
    into, known = first.copy(), np.zeros((0, 5))
    asked = _flat(labels)[first]
    for reach, least in (FAR, NEAR):
        for area, cells in _inner(region, asked, reach):
            asked[area] = False
            some, label = rgba[cells[::-(-cells.size // _ASKED)]], first[area]
            colour = np.median(some, axis=0)
            even = np.mean(np.abs(some - colour).max(axis=1) <= noise) >= EVEN
            if np.abs(colour - labels.palette[label]).max() < least or not even:
                continue
            alike = np.flatnonzero((known[:, 0] == label) & (np.abs(known[:, 1:] - colour).max(axis=1) < FAR[1]))
            into[area] = len(labels.palette) + (alike[0] if alike.size else len(known))
            if not alike.size:
                known = np.concatenate([known, [[label, *colour]]])
    return _with(labels, into.astype(labels.index.dtype)[region], known) if len(known) else labels


def _flat(labels: Labels) -> np.ndarray:
    """Which labels (K,) are painted in a flat colour."""
    visible = labels.palette[:, 3] > 0
    return visible if labels.ramp is None else visible & ~labels.ramp


def _inner(region: np.ndarray, asked: np.ndarray, reach: int) -> Iterator[Tuple[int, np.ndarray]]:
    """The largest of some areas, and the pixels of each that are so far from its border."""
    inner = surrounded(region) & asked[region]
    cells = np.flatnonzero(within(inner[np.newaxis], reach, np.minimum)[0])
    number = region.ravel()[cells]
    size = np.bincount(number, minlength=1)
    large = np.flatnonzero(size >= AREA)
    large = large[np.argsort(-size[large], kind="stable")[:MANY]]
    order, ends = cells[np.argsort(number, kind="stable")], np.cumsum(size)
    return ((k, order[ends[k] - size[k]:ends[k]]) for k in large.tolist())


def _with(labels: Labels, index: np.ndarray, known: np.ndarray) -> Labels:
    """Labels with others for some areas: the label that these had, and their colour, (n, 5)."""
    origin = known[:, 0].astype(np.intp)
    ramp = None if labels.ramp is None else np.append(labels.ramp, labels.ramp[origin])
    gradients = labels.gradients and (*labels.gradients, *[None] * origin.size)
    return replace(labels, index=index, palette=np.concatenate([labels.palette, labels.palette[origin]]),
                   ramp=ramp, gradients=gradients, exact=np.concatenate([labels.palette, known[:, 1:]]))
