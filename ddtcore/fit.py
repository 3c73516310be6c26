# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines become curves: few cubics within a tolerance, or the paper's quadratics.

Runs of points between corners and junctions are split where a curve misses its
points, and neighbours merged again where one curve serves both; all runs at
once.  Then all curves are adjusted together until they explain the pixels.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from . import bezier
from .corner import Arclength, find_corners
from .cubic import Ends, Fit, Track, fit_candidates
from .model import CUBIC, LINE, Curves, Labels, PlanarMap, Polylines
from .options import TraceOptions
from .polish import Target, Wire, polish
from .position import premultiplied
from .quadratic import fit_quadratics, polygons
from .runs import Runs, cut_at_knots, end_lines


MERGE_SHARE = 1.0
"""Share of the tolerance by which merged curves may differ from polished ones."""


SHRINKING = 0.2
"""Largest tolerance of a face's outline, as a share of the side of a square of its area."""


SPILL = 0.02
"""How far curves may bulge over the border of the picture, px."""


FAINT = 8.0
"""Difference of two colours, of 255, at which the tolerance doubles."""


def fit_arcs(image: np.ndarray, labels: Labels, planar: PlanarMap, lines: Polylines,
             options: TraceOptions) -> Curves:
    """Fit the curves of every arc.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels, planar, lines
    options : TraceOptions
        `curves` chooses the method; `result` may ask for the outlines as they are.

    Returns
    -------
    Curves
    """
    if options.result == "outlines":
        return polygons(planar, lines)
    if options.curves == "quadratic":
        return fit_quadratics(planar, lines, options.suppression)
    size = (float(image.shape[1]), float(image.shape[0]))
    along = Arclength(lines, planar.rings)
    corners = find_corners(planar, lines, along, options.corner)
    runs = cut_at_knots(planar, lines, along, corners, size)
    colours = premultiplied(labels.palette[planar.face_labels])
    colours[0] = 0
    step = colours[planar.left] - colours[planar.right]
    tolerance = np.minimum(_tolerances(step, options.tolerance + lines.slack), _room(planar))[runs.arc]
    segments = fit_runs(runs, tolerance)
    held = (runs.places == 0) | (runs.places == np.asarray(size))
    target = Target.of(image, step[planar.left != 0])
    wire = polish(wire_up(runs, segments, held, step), target, 2)
    # Polished curves are free of the points' noise: what they agree on can be merged closer.
    runs, segments = simplify(wire, runs, segments, MERGE_SHARE * tolerance)
    wire = polish(wire_up(runs, segments, held, step), target, 3)
    starts = np.searchsorted(runs.arc[segments.run], np.arange(len(planar.tail) + 1))
    control = _kept_inside(wire.control(), np.asarray(size))
    return Curves(starts, control, np.where(wire.line, LINE, CUBIC).astype(np.uint8))


def _tolerances(step: np.ndarray, tolerance: np.ndarray) -> np.ndarray:
    """Tolerance of each arc, px: wider where the two colours hardly differ.

    The colours of the picture are whole numbers, so the fainter an edge is, the less
    its pixels tell where it lies, and the less anybody sees of it.
    """
    return tolerance * (1 + FAINT / np.maximum(np.abs(step).max(axis=1), 1))


def _room(planar: PlanarMap) -> np.ndarray:
    """Largest tolerance of each arc, px, at which the smaller of its two faces cannot shrink to nothing."""
    area = np.bincount(planar.pixel_faces.ravel(), minlength=len(planar.face_labels)).astype(np.float64)
    area[0] = np.inf
    return SHRINKING * np.sqrt(np.minimum(area[planar.left], area[planar.right]))


def _kept_inside(control: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Control points of segments without those bulges that leave the picture."""
    control[:, [0, 3]] = np.clip(control[:, [0, 3]], 0, size)
    far = np.flatnonzero(((control < 0) | (control > size)).any(axis=(1, 2)))
    t = np.tile(np.linspace(0, 1, 17), len(far))
    points = bezier.evaluate(control, np.repeat(far, 17), t).reshape(-1, 17, 2)
    bulging = far[((points < -SPILL) | (points > size + SPILL)).any(axis=(1, 2))]
    control[bulging] = np.clip(control[bulging], 0, size)
    return control


class Segments(NamedTuple):
    """The segments of all runs, in order.

    Attributes
    ----------
    run : ndarray of shape (S,) and dtype int64
    first, last : ndarray of shape (S,) and dtype int64
        The points each segment replaces.
    ends : Ends
    fit : Fit
    """

    run: np.ndarray
    first: np.ndarray
    last: np.ndarray
    ends: Ends
    fit: Fit


def fit_runs(runs: Runs, tolerance: np.ndarray) -> Segments:
    """Fit each run with as few segments as the tolerance allows.

    Parameters
    ----------
    runs : Runs
    tolerance : ndarray of shape (R,)
        Of each run, px.

    Returns
    -------
    Segments
    """
    track = Track.of(runs.points, runs.weight)
    return _merge(track, _split(runs, track, _whole(runs), tolerance), tolerance)


def _whole(runs: Runs) -> Tuple[np.ndarray, np.ndarray, np.ndarray, Ends]:
    """One candidate for each whole run."""
    point, tangent, _ = end_lines(runs)
    point = runs.places[runs.knots]
    smooth = np.repeat(runs.smooth[:, None], 2, axis=1)
    ring = np.flatnonzero(runs.smooth)
    middle = (runs.low[ring] + runs.high[ring]) // 2
    place, direction = _node(runs, middle, runs.low[ring], runs.high[ring])
    point[ring] = place[:, None]
    tangent[ring] = np.stack([direction, -direction], axis=1)
    return np.arange(len(runs.arc)), runs.first, runs.last, Ends(point, tangent, smooth)


def _node(runs: Runs, at: np.ndarray, low: np.ndarray, high: np.ndarray,
          reach: int = 4) -> Tuple[np.ndarray, np.ndarray]:
    """Position and unit tangent at points `at`, from a parabola through their neighbours."""
    index = at[:, None] + np.arange(-reach, reach + 1)
    valid = (index >= low[:, None]) & (index < high[:, None])
    points = runs.points[np.clip(index, 0, len(runs.points) - 1)]
    weight = np.where(valid, runs.weight[np.clip(index, 0, len(runs.points) - 1)], 0)
    piece = np.hypot(*np.moveaxis(np.diff(points, axis=1), 2, 0))
    u = np.concatenate([np.zeros((len(at), 1)), np.cumsum(piece, axis=1)], axis=1)
    u -= u[:, reach:reach + 1]
    design = np.stack([np.ones_like(u), u, u * u], axis=-1)
    normal = np.einsum("rk,rki,rkj->rij", weight, design, design)
    normal[:, [0, 1, 2], [0, 1, 2]] += [1e-6, 1e-6, 0.05]
    side = np.linalg.solve(normal, np.einsum("rk,rki,rkd->rid", weight, design, points))
    tangent = side[:, 1]
    return side[:, 0], tangent / np.maximum(np.hypot(*tangent.T), 1e-9)[:, None]


def _split(runs: Runs, track: Track, whole: Tuple[np.ndarray, np.ndarray, np.ndarray, Ends],
           tolerance: np.ndarray) -> Segments:
    """Split runs where they miss their points, until all are met."""
    run, first, last, ends = whole
    done = []
    while len(run):
        fit = fit_candidates(track, first, last, ends, tolerance[run])
        bad = (fit.error > tolerance[run]) & (last - first >= 3)
        done.append(_take(Segments(run, first, last, ends, fit), ~bad))
        run, first, last, ends, fit = _take(Segments(run, first, last, ends, fit), bad)
        margin = np.minimum(3, (last - first - 1) // 2)
        at = np.clip(fit.worst, first + margin, last - 1 - margin)
        place, tangent = _node(runs, at, runs.low[run], runs.high[run])
        before, after = _cut(ends, place, tangent)
        run = np.concatenate([run, run])
        first, last = np.concatenate([first, at + 1]), np.concatenate([at, last])
        ends = Ends(*(np.concatenate(pair) for pair in zip(before, after)))
    segments = _join(done)
    return _take(segments, np.lexsort((segments.last, segments.first, segments.run)))


def _cut(ends: Ends, place: np.ndarray, tangent: np.ndarray) -> Tuple[Ends, Ends]:
    """Ends of the two parts of segments that are cut at a smooth node."""
    m = len(place)
    yes = np.ones(m, bool)
    before = Ends(np.stack([ends.point[:, 0], place], axis=1), np.stack([ends.tangent[:, 0], -tangent], axis=1),
                  np.stack([ends.smooth[:, 0], yes], axis=1))
    after = Ends(np.stack([place, ends.point[:, 1]], axis=1), np.stack([tangent, ends.tangent[:, 1]], axis=1),
                 np.stack([yes, ends.smooth[:, 1]], axis=1))
    return before, after


def _merge(track: Track, segments: Segments, tolerance: np.ndarray) -> Segments:
    """Merge neighbours of one run where a single curve serves both, best first."""
    refused = np.zeros(len(segments.run), bool)
    while True:
        left = np.flatnonzero((segments.run[1:] == segments.run[:-1]) & ~refused[:-1])
        if not len(left):
            return segments
        ends = _union(segments.ends, left)
        allowed = tolerance[segments.run[left]]
        fit = fit_candidates(track, segments.first[left], segments.last[left + 1], ends, allowed)
        good = fit.error <= allowed
        refused[left[~good]] = True
        price = np.full(len(segments.run) + 1, np.inf)
        price[left[good]] = fit.error[good]
        best = good & (price[left] < price[left - 1]) & (price[left] <= price[left + 1])
        if not best.any():
            return segments
        keep = np.ones(len(segments.run), bool)
        keep[left[best] + 1] = False
        for part, value in zip(segments.fit, fit):
            part[left[best]] = value[best]
        for part, value in zip(segments.ends, ends):
            part[left[best]] = value[best]
        segments.last[left[best]] = segments.last[left[best] + 1]
        # What was refused may fit now that one side has changed: ask again.
        refused[np.maximum(left[best] - 1, 0)] = False
        refused[left[best]] = False
        segments, refused = _take(segments, keep), refused[keep]


def _union(ends: Ends, left: np.ndarray) -> Ends:
    return Ends(*(np.stack([part[left, 0], part[left + 1, 1]], axis=1) for part in ends))


def _take(segments: Segments, which: np.ndarray) -> Segments:
    return Segments(segments.run[which], segments.first[which], segments.last[which],
                    Ends(*(part[which] for part in segments.ends)), Fit(*(part[which] for part in segments.fit)))


def _join(parts: list) -> Segments:
    def cat(which: list) -> np.ndarray:
        return np.concatenate(which)

    return Segments(cat([p.run for p in parts]), cat([p.first for p in parts]), cat([p.last for p in parts]),
                    Ends(*(cat(list(f)) for f in zip(*(p.ends for p in parts)))),
                    Fit(*(cat(list(f)) for f in zip(*(p.fit for p in parts)))))


def simplify(wire: Wire, runs: Runs, segments: Segments, tolerance: np.ndarray) -> Tuple[Runs, Segments]:
    """Merge neighbouring segments of polished curves.

    Parameters
    ----------
    wire : Wire
        Polished, of `runs` and `segments`.
    tolerance : ndarray of shape (R,)
        How far a merged segment may stray from the two it replaces, by run, px.

    Returns
    -------
    Runs, Segments
    """
    control = wire.control()
    length = np.hypot(*np.moveaxis(np.diff(control, axis=1), 2, 0)).sum(axis=1)
    count = np.clip(length, 5, 60).astype(np.int64)
    last = np.cumsum(count)
    first = last - count
    owner = np.repeat(np.arange(len(count)), count)
    points = bezier.evaluate(control, owner, (np.arange(last[-1]) - first[owner] + 0.5) / count[owner])
    tangent = np.where(wire.line[:, None, None], control[:, [3, 0]] - control[:, [0, 3]], wire.handles)
    tangent /= np.maximum(np.hypot(*np.moveaxis(tangent, 2, 0)), 1e-9)[..., None]
    ends = Ends(control[:, [0, 3]], tangent, wire.smooth[wire.ends])
    fit = Fit(control, wire.line, np.zeros(len(count)), np.full(len(count), -1))
    track = Track.of(points, np.ones(len(points)))
    runs = runs._replace(places=wire.nodes[:len(runs.places)])
    return runs, _merge(track, Segments(segments.run, first, last, ends, fit), tolerance)


def wire_up(runs: Runs, segments: Segments, fixed: np.ndarray, step: np.ndarray) -> Wire:
    """Segments with shared nodes, ready to be polished.

    Parameters
    ----------
    runs, segments
    fixed : ndarray of shape (K, 2) and dtype bool
        Coordinates of knots that must not change.
    step : ndarray of shape (A, C)
        Per arc, the colour on the left less that on the right.

    Returns
    -------
    Wire
    """
    inner = segments.run[1:] == segments.run[:-1]
    knots = len(runs.places)
    number = knots - 1 + np.cumsum(inner)
    ends = runs.knots[segments.run].astype(np.int64)
    ends[:-1, 1][inner] = number[inner]
    ends[1:, 0][inner] = number[inner]
    nodes = np.concatenate([runs.places, segments.ends.point[:-1, 1][inner]])
    nodes[ends[:, 0]] = segments.ends.point[:, 0]
    control, line = segments.fit.control, segments.fit.line
    handles = np.stack([control[:, 1] - control[:, 0], control[:, 2] - control[:, 3]], axis=1)
    smooth = np.zeros(len(nodes), bool)
    smooth[knots:] = True
    smooth[runs.knots[runs.smooth].ravel()] = True
    lines_at = np.bincount(ends[line].ravel(), minlength=len(nodes))
    smooth &= lines_at == 0
    held = np.zeros(nodes.shape, bool)
    held[:knots] = fixed
    return Wire(nodes, held, ends, handles, smooth, line, step[runs.arc[segments.run]])
