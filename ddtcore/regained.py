# SPDX-License-Identifier: GPL-2.0-or-later
"""Soft ramps that fell into bands of flat colours.

A strip between two outlines, the stem of a glass, is too narrow for its slopes to be told
from ripples, and what explains its pixels best are flat colours found elsewhere: bands whose
borders wind round every ripple.  What tells them from flat areas is that their pixels are off
their own mean, that there is no jump between neighbours, and that one gradient explains all.
"""

from __future__ import annotations

from dataclasses import replace
from typing import List, Optional, Sequence, Tuple

import numpy as np

from .canvas import Canvas, mean_colours, planes
from .components import components, label_components
from .gradient import BYTES, PRICE
from .growing import FIT, Surface, distance, fitted_surfaces
from .model import Labels

FLAT = 2048
"""An area of so many pixels, most of them near its mean colour, is no band, px²."""

EVEN = 0.8
"""Share of such pixels among those of a flat area."""

JUMP = 0.6
"""Largest step between two bands, as a share of what their colours differ by."""

FAR = 48.0
"""Largest difference between the colours of neighbouring bands, levels of a channel."""

AREA = 64
"""Smallest ramp, px²."""

STRANGE = 0.25
"""Share of a ramp's pixels that its gradient may leave unexplained."""

ALONE = 0.9
"""What has this share of one colour are no bands of several."""

GAIN = 0.8
"""What the gradient may leave of the squared error of the bands at most."""

MANY = 64
"""Most ramps that are looked for, the largest ones."""

CONTRAST = 0.75
"""Smallest contrast of a ramp, as a multiple of the noise."""

_ROUNDS = 3
_RIM = 1e-3
_ENDS = 2, 98


def regain_ramps(canvas: Canvas, labels: Labels, surfaces: Sequence[Optional[Surface]], doubt: np.ndarray,
                 noise: float) -> Labels:
    """Make ramps of neighbouring bands that one gradient explains, and join those that a ramp beside them explains.

    Parameters
    ----------
    canvas : Canvas
        The picture without most of its ripples.
    labels : Labels
    surfaces : sequence of Surface or None
        Those of the labels that are soft ramps.
    doubt : ndarray of shape (H, W)
        How much pixels of flat areas still vary, levels.
    noise : float
        How much they did; ramps have more contrast.
    """
    region = label_components(labels.index)
    values = planes(canvas.bare(canvas.keys), canvas.opaque)
    band, mean = _bands(region, values, labels, doubt)
    if not band.any():
        return labels
    within = np.where(band, _groups(region, values, band, mean, noise), -1)[region]
    found, members = _grouped(within)
    pixels = [_pixels(values, own) for own in members]
    fitted = fitted_surfaces(pixels)
    good = np.array([_are_bands(labels.index.ravel()[own])
                     and _pays(surface, *some, mean[:, region.ravel()[own]].T, noise)
                     for surface, some, own in zip(fitted, pixels, members)], bool)
    chosen = np.flatnonzero(good).tolist()
    labels = _with_ramps(canvas, labels, within, found[chosen], [fitted[k] for k in chosen])
    surfaces = [*surfaces, *(fitted[k] for k in chosen)]
    return _absorbed(labels, region, band, values, surfaces, noise)


def _grouped(within: np.ndarray) -> Tuple[np.ndarray, List[np.ndarray]]:
    """The largest groups of pixels (H, W), and the inner pixels of each."""
    cells = np.flatnonzero(_surrounded(within).ravel())
    number = within.ravel()[cells]
    size = np.bincount(number, minlength=1)
    large = np.flatnonzero(size >= AREA)
    large = large[np.argsort(-size[large], kind="stable")[:MANY]]
    order, ends = cells[np.argsort(number, kind="stable")], np.cumsum(size)
    return large, [order[ends[k] - size[k]:ends[k]] for k in large.tolist()]


def _pixels(values: np.ndarray, cells: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and colours (n, C) of pixels numbered without a rim."""
    row, col = np.divmod(cells, values.shape[2])
    return np.stack([col, row], axis=1) + 0.5, values.reshape(len(values), -1)[:, cells].T


def _absorbed(labels: Labels, region: np.ndarray, band: np.ndarray, values: np.ndarray,
              surfaces: Sequence[Optional[Surface]], noise: float) -> Labels:
    """Labels with the bands joined to ramps beside them whose surfaces explain them."""
    own = np.zeros(band.size, labels.index.dtype)
    own[region.ravel()] = labels.index.ravel()
    soft = np.array([surface is not None and surface.gradient is not None for surface in surfaces], bool)
    one, other = _meetings(region)
    a, b = (region.ravel()[np.append(*side)] for side in ((one, other), (other, one)))
    order = np.argsort(region.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(region.ravel()))
    for _ in range(_ROUNDS):
        left = band & ~soft[own]
        pair = np.unique(own[b].astype(np.int64)[left[a] & soft[own[b]]] * band.size + a[left[a] & soft[own[b]]])
        if not pair.size:
            break
        ramp, number = np.divmod(pair, band.size)
        least = np.full(band.size, np.inf)
        for k in np.unique(ramp).tolist():
            regions = number[ramp == k]
            cells = np.concatenate([order[(ends[r - 1] if r else 0):ends[r]] for r in regions.tolist()])
            place = np.searchsorted(regions, region.ravel()[cells])
            off = distance(surfaces[k], *_pixels(values, cells))
            size = np.bincount(place)
            mean = np.bincount(place, off) / size
            near = np.bincount(place, off <= max(FIT, noise / 2)) >= EVEN * size
            better = near & (mean < least[regions])
            own[regions[better]], least[regions[better]] = k, mean[better]
    return replace(labels, index=own[region], thin=labels.thin & ~soft[own][region])


def _bands(region: np.ndarray, values: np.ndarray, labels: Labels,
           doubt: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Which regions may be bands, bool (R,), and their mean colours (C, R)."""
    flat = region.ravel()
    size = np.bincount(flat)
    weight = np.where(_surrounded(region).ravel(), 1, _RIM)
    total = np.bincount(flat, weight)
    mean = np.stack([np.bincount(flat, weight * plane.ravel()) for plane in values]) / total
    off = np.zeros(flat.size, np.float32)
    for plane, own in zip(values, mean):
        np.maximum(off, np.abs(plane.ravel() - own[flat]), out=off)
    even = np.bincount(flat, weight * (off <= doubt.ravel())) / total
    thin = np.bincount(flat, labels.thin.ravel()) > 0.5 * size
    first = np.zeros(size.size, labels.index.dtype)
    first[flat] = labels.index.ravel()
    ramp = np.zeros(len(labels.palette), bool) if labels.ramp is None else labels.ramp
    return ~(ramp[first] | thin | (size >= FLAT) & (even >= EVEN)), mean


def _surrounded(areas: np.ndarray) -> np.ndarray:
    """Which pixels have the number of the four beside them, and none that is negative."""
    inner = areas >= 0
    for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        same = areas[one] == areas[other]
        inner[one] &= same
        inner[other] &= same
    return np.asarray(inner)


def _groups(region: np.ndarray, values: np.ndarray, band: np.ndarray, mean: np.ndarray, noise: float) -> np.ndarray:
    """Number of the group of each region: bands that meet without a jump."""
    one, other = _meetings(region)
    a, b = region.ravel()[one], region.ravel()[other]
    some = band[a] & band[b]
    one, other, a, b = one[some], other[some], a[some], b[some]
    flat = values.reshape(len(values), -1)
    code, place = np.unique(np.minimum(a, b).astype(np.int64) * band.size + np.maximum(a, b), return_inverse=True)
    step = np.bincount(place.ravel(), np.abs(flat[:, one] - flat[:, other]).max(axis=0)) / np.bincount(place.ravel())
    a, b = np.divmod(code, band.size)
    apart = np.abs(mean[:, a] - mean[:, b]).max(axis=0)
    joined = (apart <= FAR) & (step <= np.maximum(JUMP * apart, noise / 2))
    return components(band.size, a[joined], b[joined])


def _meetings(region: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Pixels on both sides of each border between two regions."""
    cells = np.arange(region.size).reshape(region.shape)
    pairs = []
    for one, other in ((np.s_[1:], np.s_[:-1]), (np.s_[:, 1:], np.s_[:, :-1])):
        differ = region[one] != region[other]
        pairs.append((cells[one][differ], cells[other][differ]))
    return np.concatenate([pair[0] for pair in pairs]), np.concatenate([pair[1] for pair in pairs])


def _are_bands(index: np.ndarray) -> bool:
    """Whether pixels have several colours (n,): hue that bled into a single one makes it no ramp."""
    return bool(np.bincount(index).max() < ALONE * index.size)


def _pays(surface: Surface, points: np.ndarray, colour: np.ndarray, bands: np.ndarray, noise: float) -> bool:
    """Whether a gradient explains the colours (n, C) at points (n, 2), and better than those of their bands."""
    if surface.gradient is None:
        return False
    own = surface.colours(points)
    low, high = np.percentile(own, _ENDS, axis=0)
    left, flat = (np.square(some - colour).sum() for some in (own, bands))
    strange = np.mean(np.abs(own - colour).max(axis=1) > max(FIT, noise / 2))
    return bool((high - low).max() >= CONTRAST * noise and strange < STRANGE and left < GAIN * flat
                and flat - left > PRICE * BYTES)


def _with_ramps(canvas: Canvas, labels: Labels, within: np.ndarray, groups: np.ndarray,
                surfaces: Sequence[Surface]) -> Labels:
    """Labels with some groups of pixels made ramps."""
    if not groups.size:
        return labels
    count = len(labels.palette)
    number = np.full(int(within.max()) + 2, -1, labels.index.dtype)
    number[groups] = np.arange(count, count + groups.size)
    ramps = number[within]
    ramps[within < 0] = -1
    index = np.where(ramps >= 0, ramps, labels.index)
    palette = np.concatenate([labels.palette, mean_colours(canvas, np.where(ramps >= 0, ramps - count, -1))])
    ramp = np.append(np.zeros(count, bool) if labels.ramp is None else labels.ramp, np.ones(groups.size, bool))
    gradients = (*(labels.gradients or [None] * count), *(surface.gradient for surface in surfaces))
    return replace(labels, index=index, palette=palette, ramp=ramp, gradients=gradients,
                   thin=labels.thin & (ramps < 0))
