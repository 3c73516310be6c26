# SPDX-License-Identifier: GPL-2.0-or-later
"""Ramps that run into one another, parted where one gradient does not explain them.

A highlight that fades into the flat colour under it leaves no edge to cut along, and
two soft areas whose border fades out are connected.  What tells them apart is that no
single gradient explains both.
"""

from __future__ import annotations

from typing import Dict, List, Sequence, Tuple, Union

import numpy as np

from .canvas import Canvas
from .components import label_components, mask_areas
from .growing import FIT, MOST, Ramp, Surface, distance, fitted_surfaces, grown_surfaces
from .spans import Spans, renumber, spans_of

STRANGE = 0.03
"""Share of a ramp that may be unexplained by its gradient before it is parted."""

AREA = 24
"""Smallest surface, px²."""

REACH = 32
"""How far beyond its rows and columns a ramp may go on in narrow strips, px."""

_CELLS = 1 << 15
"""A ramp with more pixels than this is parted at a lower resolution."""

_FITS, _COMPARED = 250, 1 << 25
"""Gradients that are fitted to part ramps, and pixels that are compared with them at most: the largest
ramps come first, and those for which nothing is left stay in one piece."""

_WORK = 1 << 24
"""The windows in which ramps are extended have this area at most, px²."""

_STRIP = 1 << 20
"""Pixels times surfaces that are compared at a time."""

_NEAR = 3
"""How near ramps come that a stop may lie between, px."""

_CONTACT, _TRIES = 8, 64
"""Fewest pixels where they do so, and how many pairs are tried at most."""

_SMOOTH = 3


def separate(canvas: Canvas, ramps: np.ndarray, count: int, free: np.ndarray,
             fit: float = FIT, piece: int = AREA,
             joint: float = 0.5) -> Tuple[np.ndarray, List[Surface]]:
    """Part the ramps that no single gradient explains, and extend all to free pixels.

    Parameters
    ----------
    canvas : Canvas
    ramps : ndarray of shape (H, W) and dtype int16
        Number of the ramp of each pixel, -1 where there is none; changed in place.
    count : int
        How many there are.
    free : ndarray of shape (H, W) and dtype bool
        Pixels that may come to ramps they touch, if they have the colours of those there.
    fit : float
        How far pixels may be from the surface of their ramp, levels of a channel.
    piece : int
        Smallest connected piece of a surface, px².
    joint : float
        Share of `fit` within which one gradient has to explain two ramps that are to be one.

    Returns
    -------
    ramps : ndarray of shape (H, W) and dtype int16
        The same array, or where there are no ramps a copy; pixels that no surface explains, and
        surfaces of one flat colour, belong to no ramp.
    surfaces : list of Surface
        One for each ramp.
    """
    ramps = ramps if count else ramps.copy()
    members = spans_of(ramps, count)
    number = np.full(count + 1, -1, np.int32)
    surfaces: List[Surface] = []
    pieces = []
    fits, compared = _FITS, _COMPARED
    wholes = _wholes(canvas, members, fit)
    for k in sorted(range(count), key=lambda k: -members[k].size):
        whole, good = wholes[k]
        window = members[k].window(ramps.shape, 0)
        area = (window[0].stop - window[0].start) * (window[1].stop - window[1].start)
        if not good and fits > 0 and area * MOST <= compared:
            mask = ramps[window] == k
            parts, some, tried = _parted(canvas, mask, members[k].size, window, whole, fit, piece)
            fits, compared = fits - tried, compared - area * len(some)
            used = np.flatnonzero(np.bincount(parts[mask] + 1, minlength=len(some) + 1)[1:])
            into = np.full(len(some) + 1, -1, np.int32)
            into[used] = np.arange(len(surfaces), len(surfaces) + used.size)
            pieces.append((window, mask, into[parts[mask]]))
            surfaces += [some[part] for part in used.tolist()]
        else:
            number[k] = len(surfaces)
            surfaces.append(whole)
    renumber(ramps, number)
    for window, mask, parts in pieces:
        ramps[window][mask] = parts
    surfaces = _joined(canvas, ramps, surfaces, fit, joint * fit)
    extend(canvas, ramps, surfaces, free, fit)
    return ramps, surfaces


def _wholes(canvas: Canvas, ramps: Sequence[Spans], limit: float) -> List[Tuple[Surface, bool]]:
    """The gradient of each ramp, and whether nearly all pixels are nearer to it than a limit."""
    cells = [spans.every(-(-spans.size // _CELLS)) for spans in ramps]
    surfaces = fitted_surfaces(_pixels(canvas, own) for own in cells)
    return [(surface, bool(np.mean(distance(surface, *_pixels(canvas, own)) > limit) < STRANGE))
            for surface, own in zip(surfaces, cells)]


def _pixels(canvas: Canvas, cells: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and premultiplied colours (n, C) of pixels numbered without a rim."""
    row, col = np.divmod(cells, canvas.shape[1])
    return np.stack([col, row], axis=1) + 0.5, canvas.colours(canvas.numbers(row, col)).T


def _joined(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface], fit: float,
            joint: float) -> List[Surface]:
    """Join ramps that meet without a jump, in place, where one gradient explains both: a stop lies between them."""
    members = spans_of(ramps, len(surfaces))
    contacts = _contacts(ramps, len(surfaces))

    def meet(one: int, other: int, points: np.ndarray) -> bool:
        off = surfaces[one].colours(points) - surfaces[other].colours(points)
        return bool(np.median(np.abs(off).max(axis=1)) <= 2 * fit)

    def joined(pairs: List[Tuple[int, int]]) -> Dict[Tuple[int, int], Tuple[Surface, bool]]:
        both = [members[one].and_those_of(members[other]) for one, other in pairs]
        return dict(zip(pairs, _wholes(canvas, both, joint)))

    into = list(range(len(surfaces)))
    known = joined([(one, other) for one, other, points in contacts if meet(one, other, points)])
    for one, other, points in contacts:
        one, other = into[one], into[other]
        if one == other or not meet(one, other, points):
            continue
        if (one, other) not in known:
            known.update(joined([(one, other)]))
        surface, good = known[one, other]
        if good and surface.gradient is not None:
            members[one], surfaces[one] = members[one].and_those_of(members[other]), surface
            into = [one if k == other else k for k in into]
            known = {pair: found for pair, found in known.items() if one not in pair}
    kept = sorted(set(into))
    if len(kept) < len(into):
        renumber(ramps, np.append([kept.index(k) for k in into], -1).astype(np.int32))
    return [surfaces[k] for k in kept]


def _contacts(ramps: np.ndarray, count: int) -> List[Tuple[int, int, np.ndarray]]:
    """Pairs of ramps that come near each other, those that do so longest first, and points between them."""
    codes, points = [], []
    for axis in (0, 1):
        for step in range(1, _NEAR + 1):
            a, b = ((ramps[step:], ramps[:-step]), (ramps[:, step:], ramps[:, :-step]))[axis]
            meet = a != b
            meet &= a >= 0
            meet &= b >= 0
            row, col = np.divmod(np.flatnonzero(meet), meet.shape[1])
            low, high = np.sort([a[row, col], b[row, col]], axis=0).astype(np.int64)
            codes.append(low * count + high)
            points.append(np.stack([col, row], axis=1) + 0.5 + np.eye(2)[1 - axis] * step / 2)
    code, place = np.concatenate(codes), np.concatenate(points)
    order = np.argsort(code, kind="stable")
    values, first, size = np.unique(code[order], return_index=True, return_counts=True)
    longest = np.argsort(-size, kind="stable")[:_TRIES]
    return [(*divmod(int(values[k]), count), place[order[first[k]:first[k] + size[k]]])
            for k in longest.tolist() if size[k] >= _CONTACT]


def extend(canvas: Canvas, ramps: np.ndarray, surfaces: List[Surface], free: np.ndarray,
           fit: Union[float, np.ndarray]) -> None:
    """Extend ramps to the free pixels connected with them that have their colours, in place.

    `fit` is how far pixels may be from the surface of their ramp, levels, for all of them or for each, (H, W).
    """
    work, margin = _WORK, np.broadcast_to(fit, ramps.shape)
    for number, spans in enumerate(spans_of(ramps, len(surfaces))):
        window = spans.window(ramps.shape, REACH)
        here = ramps[window]
        work -= here.size
        row, col = np.nonzero(free[window] & (here < 0))
        if work < 0 or not row.size:
            continue
        points, colour = _pixels(canvas, (row + window[0].start) * ramps.shape[1] + col + window[1].start)
        fits = distance(surfaces[number], points, colour) < margin[window][row, col]
        if not fits.any():
            continue
        own = here == number
        more = own.copy()
        more[row[fits], col[fits]] = True
        areas = mask_areas(more)
        # The first pixels of the ramp in each row, and after each gap, tell of all.
        begins = own.copy()
        begins[:, 1:] &= ~own[:, :-1]
        inside = areas.at(np.flatnonzero(begins))
        held = np.full(areas.size.size, -1)
        held[inside[inside >= 0]] = 1
        reached = np.zeros(here.shape, bool)
        areas.put(reached.ravel(), held)
        here[reached] = number


def _parted(canvas: Canvas, mask: np.ndarray, size: int, window: Tuple[slice, slice],
            whole: Surface, fit: float, piece: int) -> Tuple[np.ndarray, List[Surface], int]:
    """Number of the surface of each pixel in a window, -1 for none, the surfaces, and the gradients fitted."""
    step = int(np.ceil(np.sqrt(max(size / _CELLS, mask.size / (8 * _CELLS)))))
    surfaces, fits = grown_surfaces(Ramp.of(canvas, mask, window, step), AREA / step**2, fit)
    if not surfaces:
        return np.where(mask, 0, -1).astype(np.int32), [whole], fits
    parts = _assigned(canvas, mask, window, surfaces, fit, piece)
    _drop_flat(parts, canvas.bare(canvas.keys)[window], surfaces)
    return parts, surfaces, fits


def _assigned(canvas: Canvas, mask: np.ndarray, window: Tuple[slice, slice], surfaces: List[Surface],
              fit: float, piece: int) -> np.ndarray:
    """The number of the surface that explains each pixel of a ramp best, -1 for none."""
    parts = np.full(mask.shape, -1, np.int32)
    rows = max(8 * _SMOOTH, _STRIP // (mask.shape[1] * len(surfaces)))
    for first in range(0, len(mask), rows):
        start, stop = max(first - _SMOOTH, 0), min(first + rows + _SMOOTH, len(mask))
        strip = slice(window[0].start + start, window[0].start + stop), window[1]
        nearest = _nearest(Ramp.of(canvas, mask[start:stop], strip), surfaces, fit)
        parts[first:first + rows] = nearest[first - start:first - start + rows]
    area = label_components(parts)
    parts[np.bincount(area.ravel())[area] < piece] = -1
    return parts


def _nearest(ramp: Ramp, surfaces: List[Surface], fit: float) -> np.ndarray:
    """The number of the surface that explains each pixel best, -1 for none.

    Where several explain it alike, its surroundings decide.
    """
    off = np.stack([ramp.off(surface) for surface in surfaces])
    cost = np.minimum(off, 3 * fit) ** 2
    cost[:, ~ramp.mask] = 0
    alike = cost < cost.min(axis=0) + fit**2
    smooth = np.stack([_blurred(plane) for plane in cost])
    parts: np.ndarray = np.where(alike, smooth, np.inf).argmin(axis=0)
    parts[~ramp.mask | (off.min(axis=0) > 2 * fit)] = -1
    return parts


def _drop_flat(parts: np.ndarray, keys: np.ndarray, surfaces: List[Surface]) -> None:
    """Take the surfaces out, in place, most of whose pixels have one and the same colour."""
    for k, surface in enumerate(surfaces):
        some = parts == k
        if surface.gradient is None and some.any():
            _, counts = np.unique(keys[some], return_counts=True)
            if 2 * counts.max() > counts.sum():
                parts[some] = -1


def _blurred(values: np.ndarray) -> np.ndarray:
    """Sums over squares round each pixel."""
    wide = 2 * _SMOOTH + 1
    total = np.pad(values, _SMOOTH + 1, mode="edge").cumsum(axis=0).cumsum(axis=1)
    sums: np.ndarray = total[wide:, wide:] - total[:-wide, wide:] - total[wide:, :-wide] + total[:-wide, :-wide]
    return sums[:-1, :-1]
