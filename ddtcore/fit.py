# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines become curves: few cubics within a tolerance, or the paper's quadratics.

Runs of points between corners and junctions are split where a curve misses its
points, and neighbours merged again where one curve serves both; all runs at
once.  Then all curves are adjusted together until they explain the pixels.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from . import bezier
from .arclength import Arclength
from .corner import find_corners
from .cubic import Ends, Fit, Track
from .loops import ranges
from .model import CUBIC, LINE, Curves, Labels, PlanarMap, Polylines
from .options import TraceOptions
from .paint import local_colours
from .polish import Target, Wire, polish
from .position import premultiplied
from .quadratic import fit_quadratics, polygons
from .runs import Runs, cut_at_knots
from .segments import Segments, fit_runs, merge

MERGE_SHARE = 1.0
"""Share of the tolerance by which merged curves may differ from polished ones."""

ROUNDS, FEWER = (1, 4), (1, 2)
"""Most rounds of the polish before and after curves are merged; and where blocks of pixels are explained."""

SHRINKING = 0.2
"""Largest tolerance of a face's outline, as a share of the side of a square of its area."""

SPILL = 0.02
"""How far curves may bulge over the border of the picture, px."""

FAINT, SOFT = 16.0, 48.0
"""Difference of two colours, of 255, at which the tolerance doubles; and beside a gradient."""


def fit_arcs(image: np.ndarray, labels: Labels, planar: PlanarMap, lines: Polylines,
             options: TraceOptions) -> Curves:
    """Fit the curves of every arc.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    labels, planar, lines
    options : TraceOptions
        `curves` chooses the method; `result` may ask for the outlines as they are.  With the
        regions `areas` curves aren't polished: pixels of photographs are no mixes of two colours.

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
    tolerance = _tolerances(labels, planar, lines, step, options.tolerance + lines.slack)[runs.arc]
    segments = fit_runs(runs, tolerance)
    held = (runs.places == 0) | (runs.places == np.asarray(size))
    inner = planar.left != 0
    target = Target.of(image, step[inner], along.total[inner].sum())
    first, second = (0, 0) if options.regions == "areas" else ROUNDS if target.block == 1 else FEWER
    wire, off = polish(wire_up(runs, segments, held, step), target, first)
    # Polished curves are free of the points' noise: what they agree on can be merged closer.
    runs, segments = simplify(wire, runs, segments, MERGE_SHARE * tolerance)
    wire, _ = polish(wire_up(runs, segments, held, step), target.drawn_in_chords(off), second)
    starts = np.searchsorted(runs.arc[segments.run], np.arange(len(planar.tail) + 1))
    control = _kept_inside(wire.control(), np.asarray(size))
    return Curves(starts, control, np.where(wire.line, LINE, CUBIC).astype(np.uint8))


def _tolerances(labels: Labels, planar: PlanarMap, lines: Polylines, step: np.ndarray,
                tolerance: np.ndarray) -> np.ndarray:
    """Tolerance of each arc, px: wider where the two colours hardly differ, if both faces have room for it.

    The colours of the picture are whole numbers, so the fainter an edge is, the less
    its pixels tell where it lies, and the less anybody sees of it.  What is drawn on a ramp
    hides among colours that change anyway, and is seen as lines, not as areas.
    """
    wider = FAINT / np.maximum(np.abs(step).max(axis=1), 1)
    soft = np.flatnonzero(_beside_gradients(labels, planar))
    wider[soft] = SOFT / np.maximum(_local_steps(labels, planar, lines, soft), 1)
    return np.asarray(np.minimum(tolerance * (1 + wider), _room(planar)))


def _beside_gradients(labels: Labels, planar: PlanarMap) -> np.ndarray:
    """Which arcs have a gradient on one side at least and no border of the picture on the other, bool (A,)."""
    soft = np.array([gradient is not None for gradient in labels.gradients or ()], bool)
    if not soft.any():
        return np.zeros(len(planar.left), bool)
    inner = (planar.left != 0) & (planar.right != 0)
    return np.asarray(inner & (soft[planar.face_labels[planar.left]] | soft[planar.face_labels[planar.right]]))


def _local_steps(labels: Labels, planar: PlanarMap, lines: Polylines, arcs: np.ndarray) -> np.ndarray:
    """How much the colours on both sides of some arcs differ where these lie, levels."""
    count = np.diff(lines.starts)[arcs]
    points, arc = ranges(lines.starts[arcs], count), np.repeat(np.arange(len(arcs)), count)
    left, right = (local_colours(labels, planar.face_labels[side[arcs]][arc], lines.points[points])
                   for side in (planar.left, planar.right))
    square = np.square(left - right).max(axis=1)
    return np.asarray(np.sqrt(np.bincount(arc, square, len(arcs)) / np.maximum(count, 1)))


def _room(planar: PlanarMap) -> np.ndarray:
    """Largest tolerance of each arc, px, at which the smaller of its two faces cannot shrink to nothing."""
    area = planar.face_areas.astype(np.float64)
    area[0] = np.inf
    return np.asarray(SHRINKING * np.sqrt(np.minimum(area[planar.left], area[planar.right])))


def _kept_inside(control: np.ndarray, size: np.ndarray) -> np.ndarray:
    """Control points of segments without those bulges that leave the picture."""
    control[:, [0, 3]] = np.clip(control[:, [0, 3]], 0, size)
    far = np.flatnonzero(((control < 0) | (control > size)).any(axis=(1, 2)))
    t = np.tile(np.linspace(0, 1, 17), len(far))
    points = bezier.evaluate(control, np.repeat(far, 17), t).reshape(-1, 17, 2)
    bulging = far[((points < -SPILL) | (points > size + SPILL)).any(axis=(1, 2))]
    control[bulging] = np.clip(control[bulging], 0, size)
    return control


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
    return runs, merge(track, Segments(segments.run, first, last, ends, fit), tolerance)


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
