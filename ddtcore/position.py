# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the outlines lie: barycentres, or the coverage that anti-aliasing wrote down.

The paper draws outlines through the barycentres of the border triangles, which
are at best a third of a pixel off.  An anti-aliased pixel tells more: its colour
mixes those of its two sides in the proportion of the areas they cover.  The sum
of the coverage along a pixel column that an edge crosses from one flat side to
the other is where the edge crosses the middle of the column, exactly so for
straight edges (Trujillo-Pino et al., "Accurate subpixel edge location based on
partial area effect", Image and Vision Computing 31, 2013).
"""

from __future__ import annotations

from typing import List, Optional, Tuple

import numpy as np

from .border import barycentres
from .loops import kept_on
from .model import Labels, Mesh, PlanarMap, Polylines
from .options import TraceOptions
from .parts import in_parts
from .raster import pixels_at
from .staircase import SLACK, find_staircases

REACH = 4
"""How far from a crossing a flat side is looked for, px."""

FLAT = 0.03
"""Coverage closer than this to 0 or 1 counts as flat."""

GAP = 8
"""Most doubtful crossings in a row beside a soft ramp that are left out: what is drawn there hides other colours."""

PURE = 14.0
"""How far a pixel between two sides may be from their mixes, levels."""


def place(image: np.ndarray, labels: Labels, mesh: Mesh, planar: PlanarMap,
          options: TraceOptions) -> Polylines:
    """Give every arc its points.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
    mesh : Mesh
    planar : PlanarMap
    options : TraceOptions
        `positions` chooses the method.

    Returns
    -------
    Polylines
    """
    if options.positions == "barycentres":
        located = _through_barycentres(mesh, planar)
    else:
        located = _by_coverage(image, labels, mesh, planar)
    return _assemble(mesh, planar, *located)


def premultiplied(rgba: np.ndarray) -> np.ndarray:
    """Colours (..., 4) with RGB multiplied by alpha, float32, 0 to 255."""
    colours = np.array(rgba, np.float32)
    if (colours[..., 3] < 255).any():
        colours[..., :3] *= colours[..., 3:] / np.float32(255)
    return colours


def _through_barycentres(mesh: Mesh, planar: PlanarMap) -> Tuple[np.ndarray, ...]:
    arc = np.repeat(np.arange(len(planar.tail)), np.diff(planar.starts))
    # The last triangle of an open arc is its head junction, which is added later.
    inside = np.ones(len(arc), bool)
    inside[planar.starts[1:][~planar.rings] - 1] = False
    points = _framed(mesh, planar.crossings[inside] // 3)
    slack = np.full(len(planar.tail), SLACK)
    return arc[inside], points, np.full(len(points), 0.5), _framed(mesh, planar.junctions), slack


def _framed(mesh: Mesh, triangles: np.ndarray) -> np.ndarray:
    """Barycentres; those of triangles that reach into the frame lie on the picture's border."""
    points = barycentres(mesh, triangles)
    corners = mesh.points(mesh.triangles[triangles])
    for axis, size in ((0, mesh.shape[1] - 2), (1, mesh.shape[0] - 2)):
        points[(corners[:, :, axis] < 0).any(axis=1), axis] = 0
        points[(corners[:, :, axis] > size).any(axis=1), axis] = size
    return points


def _by_coverage(image: np.ndarray, labels: Labels, mesh: Mesh,
                 planar: PlanarMap) -> Tuple[np.ndarray, ...]:
    arc = np.repeat(np.arange(len(planar.tail)), np.diff(planar.starts))
    colours = premultiplied(labels.palette[planar.face_labels])
    left, right = (colours.take(side[arc], axis=0) for side in (planar.left, planar.right))
    edge = _crossed_edges(mesh, planar)
    shares = [_share(_pixels(image, edge[:, k]), left, right) for k in (0, 1)]
    raw = _half_way(edge, shares, planar.left[arc] == 0)
    ends = _junction_means(mesh, planar, raw)
    contrast = np.maximum(np.sqrt(np.square(left - right).sum(axis=1)), 1)
    stairs = find_staircases(planar, arc, edge, shares, contrast, ends)
    hard, dot, hard_points, hard_arc = stairs.hard, stairs.dot, stairs.points, stairs.arc
    inner = np.flatnonzero((planar.left[arc] != 0) & ~hard[arc])
    tangent = _tangents(planar, arc, raw).take(inner, axis=0)
    first = np.flatnonzero(_first_in_column(planar.rings, arc[inner], raw.take(inner, axis=0), tangent))
    inner, tangent = inner[first], tangent.take(first, axis=0)
    crossed, one, other = (part.take(inner, axis=0) for part in (raw, left, right))
    position, sure = in_parts(
        lambda part: _column_sums(image, crossed[part], tangent[part], one[part], other[part]), len(inner))
    soft = _beside_ramps(labels, planar)[arc[inner]]
    keep = _needed(arc[inner], sure, np.where(soft, GAP, 1))
    # A ring round a pixel or two needs all of its crossings, or nothing would be left of it.
    small = planar.rings & ~hard & (np.bincount(arc[inner][keep], minlength=len(hard)) < 3)
    keep &= ~small[arc[inner]]
    whole = np.flatnonzero(small[arc] & (planar.left[arc] != 0))
    weight = np.where(sure, 1.0, 0.5)[keep]
    return (np.concatenate([arc[inner][keep], arc[whole], hard_arc]),
            np.concatenate([position[keep], raw[whole], hard_points]),
            np.concatenate([weight, np.full(len(whole), 0.5), np.ones(len(hard_arc))]),
            ends, np.where(hard & ~dot, SLACK, 0.0), dot)


def _beside_ramps(labels: Labels, planar: PlanarMap) -> np.ndarray:
    """Which arcs have a soft ramp on one side, bool (A,)."""
    ramp = np.zeros(len(labels.palette) + 1, bool)
    if labels.ramp is not None:
        # The last one stands for the outside.
        ramp[:-1] = labels.ramp
    return np.asarray(ramp[planar.face_labels[planar.left]] | ramp[planar.face_labels[planar.right]])


def _needed(arc: np.ndarray, sure: np.ndarray, gap: np.ndarray) -> np.ndarray:
    """Which crossings (N,) are sure, or not between two of their arc that are, with up to `gap` (N,) between them.

    Between positions that are sure, doubtful ones only add noise.
    """
    number = np.arange(len(sure))
    before = np.maximum.accumulate(np.where(sure, number, -1))
    after = np.minimum.accumulate(np.where(sure, number, len(sure))[::-1])[::-1]
    between = (before >= 0) & (after < len(sure)) & (after - before - 1 <= gap)
    between[between] = arc[before[between]] == arc[after[between]]
    return sure | ~between


def _crossed_edges(mesh: Mesh, planar: PlanarMap) -> np.ndarray:
    """Origin and end of each crossed mesh edge, (N, 2, 2)."""
    triangle, side = np.divmod(planar.crossings, 3)
    ends = np.stack([mesh.triangles[triangle, side], mesh.triangles[triangle, (side + 1) % 3]], axis=1)
    return mesh.points(ends)


def _half_way(edge: np.ndarray, shares: List[np.ndarray], framed: np.ndarray) -> np.ndarray:
    """Where each crossed mesh edge is half one colour, half the other; (N, 2)."""
    a, b = shares
    rise = b - a
    half = np.where(rise > 0.2, (0.5 - a) / np.maximum(rise, 0.2), 0.5)
    half = np.where(framed, 0.5, np.clip(half, 0.05, 0.95))
    return np.asarray(edge[:, 0] + half[:, None] * (edge[:, 1] - edge[:, 0]))


def _first_in_column(ring: np.ndarray, arc: np.ndarray, raw: np.ndarray, tangent: np.ndarray) -> np.ndarray:
    """Crossings that begin a new pixel column (or row): steps and diagonals repeat the one before."""
    cell = np.floor(raw)
    upright = np.abs(tangent[:, 1]) > np.abs(tangent[:, 0])
    column = np.where(upright, -1 - cell[:, 1], cell[:, 0])
    first = np.append(True, arc[1:] != arc[:-1])[:len(arc)]
    fresh = first.copy()
    fresh[1:] |= column[1:] != column[:-1]
    # A ring can end in the column it began in.
    head = np.flatnonzero(first)
    last = np.append(head[1:], len(arc)) - 1
    closed = ring[arc[head]] & (last > head)
    fresh[head[closed]] = column[last[closed]] != column[head[closed]]
    return fresh


def _pixels(image: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Premultiplied colours of the pixels that contain `points`; outside, of the nearest."""
    h, w = image.shape[:2]
    col = np.clip(np.floor(points[..., 0]), 0, w - 1).astype(np.int64)
    row = np.clip(np.floor(points[..., 1]), 0, h - 1).astype(np.int64)
    return premultiplied(pixels_at(image, row * w + col))


def _share(colour: np.ndarray, left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """How much of the left colour is in a mix of left and right, (N,); not limited to 0..1."""
    span = left - right
    size = np.einsum("ij,ij->i", span, span)
    return np.asarray(np.einsum("ij,ij->i", colour - right, span) / np.maximum(size, 1))


def _junction_means(mesh: Mesh, planar: PlanarMap, raw: np.ndarray) -> np.ndarray:
    """Junctions amid the nearest crossings of their three arcs; at the frame, on it."""
    ends = _framed(mesh, planar.junctions)
    open_ = np.flatnonzero(~planar.rings)
    number = np.concatenate([planar.tail[open_], planar.head[open_]])
    nearest = np.concatenate([raw[planar.starts[open_]], raw[planar.starts[open_ + 1] - 1]])
    count = np.bincount(number, minlength=len(ends))
    mean = np.stack([np.bincount(number, nearest[:, k], len(ends)) / np.maximum(count, 1)
                     for k in (0, 1)], axis=-1)
    free = ((ends > 0) & (ends < [mesh.shape[1] - 2, mesh.shape[0] - 2]))
    return np.where(free, mean, ends)


def _tangents(planar: PlanarMap, arc: np.ndarray, raw: np.ndarray) -> np.ndarray:
    """Direction of each arc at its crossings, from two crossings before to two after."""
    first, length, closed = planar.starts[arc], np.diff(planar.starts)[arc], planar.rings[arc]

    def beside(step: int) -> np.ndarray:
        place = np.arange(step, len(raw) + step) - first
        return np.asarray(raw.take(first + kept_on(place, length, closed), axis=0))

    return np.asarray(beside(2) - beside(-2))


def _column_sums(image: np.ndarray, raw: np.ndarray, tangent: np.ndarray, left: np.ndarray,
                 right: np.ndarray) -> Tuple[np.ndarray, np.ndarray]:
    """Sum the coverage across the edge, in its pixel column or row.

    Returns
    -------
    position : ndarray of shape (N, 2)
        `raw` where it is not sure.
    sure : ndarray of shape (N,) and dtype bool
        Both sides are flat within reach and nothing but their mixes lies between.
    """
    h, w = image.shape[:2]
    upright = np.abs(tangent[:, 1]) > np.abs(tangent[:, 0])
    cell = np.floor(raw).astype(np.int64)
    cell[:, 0] = np.clip(cell[:, 0], 0, w - 1)
    cell[:, 1] = np.clip(cell[:, 1], 0, h - 1)
    # Walking right (down), the left side is up (right): step from the left to the right side.
    step = np.where(upright, -np.sign(tangent[:, 1]), np.sign(tangent[:, 0])).astype(np.int64)
    stride = np.where(upright, step, step * w)
    across = np.where(upright, cell[:, 0], cell[:, 1])
    room = np.where(upright, w - 1, h - 1)
    reach = np.arange(-REACH, REACH + 1)
    inside = np.clip(across[:, None] + reach * step[:, None], 0, room[:, None]) - across[:, None]
    flat = (cell[:, 1] * w + cell[:, 0])[:, None] + inside * np.abs(stride)[:, None]
    colour = premultiplied(pixels_at(image, flat))
    colour -= right[:, None]
    span = left - right
    share = np.einsum("nkc,nc->nk", colour, span)
    share /= np.maximum(np.einsum("nc,nc->n", span, span), 1)[:, None]
    total, sure, between = _sum_between_flats(share)
    mixed = np.flatnonzero(between)
    item = mixed // len(reach)
    pure = np.clip(share.take(mixed), 0, 1)[:, None] * span.take(item, axis=0)
    off = np.abs(colour.reshape(-1, 4).take(mixed, axis=0) - pure).max(axis=1)
    sure[item[off >= PURE]] = False
    along = np.where(step > 0, across + total, across + 1 - total)
    position = cell + 0.5
    position[upright, 0], position[~upright, 1] = along[upright], along[~upright]
    away = np.abs(position - raw)
    sure &= (away[:, 0] < 0.8) & (away[:, 1] < 0.8) & (step != 0)
    return np.where(sure[:, None], position, raw), sure


def _sum_between_flats(share: np.ndarray) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Sums of each row of `share` (N, 2 * REACH + 1) between the nearest 1 before and the nearest 0 after.

    Returns also whether both are there and it falls from one to the other, and what lies between them.
    """
    index = np.arange(2 * REACH + 1)
    high = (share > 1 - FLAT) & (index <= REACH)
    low = (share < FLAT) & (index >= REACH)
    begin = 2 * REACH - np.argmax(high[:, ::-1], axis=1)
    end = np.argmax(low, axis=1)
    between = (index > begin[:, None]) & (index < end[:, None])
    total = np.where(between, share, 0).sum(axis=1) + begin - REACH + 1
    sure = (begin <= REACH) & (end >= REACH)
    rising = share[:, 1:] - share[:, :-1] >= 0.02
    rising &= between[:, 1:]
    rising &= between[:, :-1]
    sure[np.nonzero(rising)[0]] = False
    return total, sure, between


def _assemble(mesh: Mesh, planar: PlanarMap, arc: np.ndarray, points: np.ndarray,
              weight: np.ndarray, ends: np.ndarray, slack: np.ndarray,
              angular: Optional[np.ndarray] = None) -> Polylines:
    """Put junctions at the ends of open arcs, and the picture's own border in place."""
    inner = planar.left[arc] != 0
    pieces = [(arc[inner], np.ones(inner.sum(), np.int64), points[inner], weight[inner])]
    for rank, junction in ((0, planar.tail), (2, planar.head)):
        open_ = np.flatnonzero(junction >= 0)
        pieces.append((open_, np.full(len(open_), rank), ends[junction[open_]], np.full(len(open_), 0.5)))
    for number in np.flatnonzero(planar.left == 0).tolist():
        corners = _frame_corners(mesh, planar, number, ends)
        pieces.append((np.full(len(corners), number), np.ones(len(corners), np.int64), corners,
                       np.ones(len(corners))))
    arc, place, points, weight = (np.concatenate(part) for part in zip(*pieces))
    order = np.lexsort((place, arc))
    starts = np.searchsorted(arc[order], np.arange(len(planar.tail) + 1))
    return Polylines(starts, points.take(order, axis=0), weight[order], slack, angular)


def _frame_corners(mesh: Mesh, planar: PlanarMap, arc: int, ends: np.ndarray) -> np.ndarray:
    """Corners of the picture that a walk along its border meets, clockwise; (n, 2)."""
    h, w = mesh.shape[0] - 2.0, mesh.shape[1] - 2.0
    corners = np.array([[0, 0], [w, 0], [w, h], [0, h]])
    if planar.tail[arc] < 0:
        return corners
    begin = _along_frame(ends[planar.tail[arc]], w, h)
    length = (_along_frame(ends[planar.head[arc]], w, h) - begin) % (2 * (w + h)) or 2 * (w + h)
    ahead = (np.array([0, w, w + h, w + h + w]) - begin) % (2 * (w + h))
    met = np.flatnonzero((ahead > 0) & (ahead < length))
    return corners[met[np.argsort(ahead[met])]]


def _along_frame(point: np.ndarray, w: float, h: float) -> float:
    """Distance along the picture's border from its top left corner, clockwise."""
    x, y = map(float, point)
    if y == 0:
        return x
    if x == w:
        return w + y
    return w + h + (w - x) if y == h else 2 * w + 2 * h - y
