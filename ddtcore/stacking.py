# SPDX-License-Identifier: GPL-2.0-or-later
"""Shapes back to front, without seams.

Whatever the order of painting, a shape may be drawn as its region and any part of the
regions painted after it.  So each boundary is drawn visibly by the later of its two
faces alone, exactly as it was fitted, over the full paint of the earlier one: nothing
shines through, and each boundary is stored once.  The earlier shape continues below:
through holes that are filled later anyway, and for a few pixels elsewhere.
"""

from __future__ import annotations

from typing import Dict, List, Sequence, Tuple

import numpy as np

from .doors import Hidden, pinched
from .loops import FaceLoops, begins, both_ways, face_loops, half_ranges, half_sides, ranges, rotate, select
from .model import LINE, Curves, Drawing, Labels, Loop, PlanarMap, Polylines, Shape
from .options import TraceOptions
from .order import Order, area_order, covers_all, filled_holes
from .paint import Paint, face_paints
from .rankmap import RankMap, sample_arcs
from .shortcut import take_shortcuts
from .underlap import hidden_lines

_STEP = 1.5
"""Distance between samples of the arcs, px."""

_UNITS = 20
"""Units per pixel of documents: rounding to them is lost in the tolerance, and they are
written shorter than digits after the point."""


def stack(image: np.ndarray, labels: Labels, planar: PlanarMap, lines: Polylines, curves: Curves,
          options: TraceOptions) -> Drawing:
    """Turn faces and fitted arcs into shapes, larger ones at the back.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels : Labels
    planar : PlanarMap
    lines : Polylines
        The arcs before they were simplified; faces are sorted by what these enclose.
    curves : Curves
    options : TraceOptions
        `stacking`: continue under later shapes, or cut out exactly.

    Returns
    -------
    Drawing
        One shape per painted face.
    """
    height, width = planar.pixel_faces.shape
    paints = face_paints(image, labels, planar, options)
    loops = face_loops(planar, lines)
    order = area_order(loops, paints, by_box=options.curves == "quadratic")
    outlines: List[List[Loop]] = [[] for _ in paints]
    if options.stacking == "cutout":
        _exact(select(loops, order.rank[loops.face] >= 0), curves, outlines)
    else:
        drawn = (order.rank[loops.face] >= 0) & ~filled_holes(loops, order)
        if covers_all(order):
            outlines[order.faces[0]].append(_rectangle(width, height))
            drawn &= order.rank[loops.face] > 0
        _continued(select(loops, drawn), planar, order, curves, outlines)
    shapes = _shapes(order, paints, outlines)
    counts = {"outlines": sum(len(shape.loops) for shape in shapes),
              "curves": sum(len(loop.degree) for shape in shapes for loop in shape.loops)}
    if options.decimals >= 0:
        return Drawing(width, height, shapes, counts=counts, decimals=options.decimals)
    return Drawing(width, height, shapes, counts=counts, scale=_UNITS)


def _rectangle(width: float, height: float) -> Loop:
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], float)
    return Loop(_lines(corners, np.roll(corners, -1, axis=0)), np.full(4, LINE, np.uint8))


def _lines(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Control points (n, 4, 2) of lines with exactly these ends."""
    return np.stack([begin, begin, end, end], axis=1)


def _shapes(order: Order, paints: Sequence[Paint], outlines: Sequence[Sequence[Loop]]) -> Tuple[Shape, ...]:
    """Shapes in painting order, named by their colour and a number within that colour."""
    used: Dict[Tuple[int, int, int], int] = {}
    shapes = []
    for face, area in zip(order.faces.tolist(), order.key.tolist()):
        paint = paints[face]
        used[paint.rgb] = used.get(paint.rgb, 0) + 1
        name = "#{:02x}{:02x}{:02x} {}".format(*paint.rgb, used[paint.rgb])
        shapes.append(Shape(name, paint.rgb, paint.opacity, tuple(outlines[face]), area, paint.gradient))
    return tuple(shapes)


def _exact(loops: FaceLoops, curves: Curves, outlines: List[List[Loop]]) -> None:
    """Give each face its loops, as they were fitted."""
    first, count = (side[loops.halves] for side in half_ranges(curves.starts))
    _cut(loops, _reversible(curves.control), both_ways(curves.degree), first, count, outlines)


def _continued(loops: FaceLoops, planar: PlanarMap, order: Order, curves: Curves,
               outlines: List[List[Loop]]) -> None:
    """Give each face its loops, with lines below later shapes in place of hidden borders."""
    samples = sample_arcs(curves, _STEP)
    ranks = RankMap(*samples, planar, order.cover)
    covered = _covered(loops, planar, order, samples, ranks)
    loops = rotate(loops, covered)
    places, hidden = _hidden_stretches(loops, covered, planar, order, samples)
    starts, points = take_shortcuts(*hidden_lines(hidden, ranks), hidden.rank, ranks)
    points = np.clip(points, 0, planar.pixel_faces.shape[::-1])
    control, degree = _reversible(curves.control), both_ways(curves.degree)
    first, count = (side[loops.halves] for side in half_ranges(curves.starts))
    count[covered[loops.halves]] = 0
    first[places], count[places] = len(degree) + starts[:-1], np.diff(starts) - 1
    # The line from one polyline's end to the next one's beginning is there, but not used.
    control = np.concatenate([control, _lines(points[:-1], points[1:])])
    degree = np.concatenate([degree, np.full(len(control) - len(degree), LINE, np.uint8)])
    _cut(loops, control, degree, first, count, outlines)


def _reversible(control: np.ndarray) -> np.ndarray:
    """Control points in order, then all segments backwards: see `both_ways`."""
    return np.concatenate([control, control[::-1, ::-1]])


def _cut(loops: FaceLoops, control: np.ndarray, degree: np.ndarray, first: np.ndarray, count: np.ndarray,
         outlines: List[List[Loop]]) -> None:
    """Put each loop together from a range of segments per half-arc, outer loops first."""
    index = ranges(first, count)
    control, degree = control[index], degree[index]
    starts = begins(count)[loops.starts].tolist()
    face = loops.face.tolist()
    for k in np.argsort(~loops.outer, kind="stable").tolist():
        part = slice(starts[k], starts[k + 1])
        outlines[face[k]].append(Loop(control[part], degree[part]))


def _covered(loops: FaceLoops, planar: PlanarMap, order: Order, samples: Tuple[np.ndarray, np.ndarray],
             ranks: RankMap) -> np.ndarray:
    """Which half-arcs (2 * A,) are drawn, hidden by a later face, and have room below it."""
    face, other = half_sides(planar)
    halves = loops.halves[order.cover[other[loops.halves]] > order.rank[face[loops.halves]]]
    each = _stretches(halves, np.arange(len(halves)), planar.rings[halves // 2], order.rank[face], samples)
    covered = np.zeros(len(face), bool)
    covered[halves] = ~pinched(each, ranks)
    return covered


def _hidden_stretches(loops: FaceLoops, covered: np.ndarray, planar: PlanarMap, order: Order,
                      samples: Tuple[np.ndarray, np.ndarray]) -> Tuple[np.ndarray, Hidden]:
    """Join covered half-arcs that follow one another.

    Returns
    -------
    places : ndarray of shape (R,)
        Where each stretch begins in ``loops.halves``.
    hidden : Hidden
    """
    flags = covered[loops.halves]
    fresh = flags.copy()
    fresh[1:] &= ~flags[:-1]
    fresh[loops.starts[:-1]] = flags[loops.starts[:-1]]
    places = np.flatnonzero(fresh)
    inside = np.flatnonzero(flags)
    first = np.searchsorted(inside, places)
    size = np.diff(np.append(first, len(inside)))
    loop = np.searchsorted(loops.starts, places, side="right") - 1
    closed = size == np.diff(loops.starts)[loop]
    return places, _stretches(loops.halves[inside], first, closed, order.rank[half_sides(planar)[0]], samples)


def _stretches(halves: np.ndarray, first: np.ndarray, closed: np.ndarray, rank: np.ndarray,
               samples: Tuple[np.ndarray, np.ndarray]) -> Hidden:
    """Join the samples of half-arcs; stretch k begins at ``halves[first[k]]``."""
    starts, points = samples
    begin, count = (side[halves] for side in half_ranges(starts))
    # Half-arcs that follow one another share a point.
    shared = np.ones(len(halves), np.int64)
    shared[first] = 0
    begin, count = begin + shared, count - shared
    ends = begins(count)[np.append(first, len(halves))]
    return Hidden(ends, both_ways(points)[ranges(begin, count)], rank[halves[first]], closed)
