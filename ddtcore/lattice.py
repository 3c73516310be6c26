# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines along the edges of pixels: what pixel art is made of.

While no edge of the mesh is flipped, each triangle lies in one quad of four neighbouring
pixels, and the corner that these share is its centre.  So an arc, which walks from
triangle to triangle, passes from one such corner to the next.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Tuple

import numpy as np

from .model import LINE, Curves, Labels, Mesh, PlanarMap, Polylines
from .options import TraceOptions
from .reduction import scaled
from .triangulation import ribbon_mesh, start_ribbon

FINE = 4
"""Parts of a pixel that shapes overlap by."""

MOST = 1 << 22
"""Most parts of pixels in a picture."""


def parts(shape: Tuple[int, ...]) -> int:
    """How many parts to cut the sides of the pixels of a picture of this shape into."""
    return max(1, min(FINE, int((MOST / max(1, shape[0] * shape[1])) ** 0.5)))


def square_mesh(image: np.ndarray, labels: Labels, options: TraceOptions) -> Mesh:
    """A triangulation whose triangles are halves of squares of four pixels; see `triangulate`."""
    return ribbon_mesh(*start_ribbon(image, labels, options))


def along_pixels(mesh: Mesh, planar: PlanarMap) -> Tuple[Polylines, Curves]:
    """The arcs as lines along the edges of pixels.

    Parameters
    ----------
    mesh : Mesh
        Of `square_mesh`.
    planar : PlanarMap

    Returns
    -------
    lines : Polylines
        The corners of the arcs and their ends.  Both ends of an arc may be the same.
    curves : Curves
        The same, as lines.
    """
    arc, points, last = _walks(mesh, planar)
    keep = _turns(planar, arc, points)
    # A ring ends where it begins; an open arc keeps its end.
    keep |= last & ~planar.rings[arc]
    arc, points = arc[keep], points[keep]
    starts = np.searchsorted(arc, np.arange(len(planar.tail) + 1))
    lines = Polylines(starts, points, np.ones(len(points)), np.zeros(len(planar.tail)))
    return lines, _joined(planar, arc, points)


def magnified(planar: PlanarMap, lines: Polylines, curves: Curves,
              times: int) -> Tuple[PlanarMap, Polylines, Curves]:
    """Faces and arcs at a multiple of their size, so that shapes as narrow as a pixel can overlap neatly."""
    faces = _repeated(planar.pixel_faces, times)
    return (replace(planar, face_areas=planar.face_areas * times ** 2, pixel_faces=faces),
            replace(lines, points=lines.points * times), replace(curves, control=curves.control * times))


def magnified_paint(image: np.ndarray, labels: Labels, times: int) -> Tuple[np.ndarray, Labels]:
    """The picture and its gradients at a multiple of their size."""
    gradients = tuple(scaled(gradient, (times, times)) for gradient in labels.gradients or ())
    return _repeated(image, times), replace(labels, gradients=gradients or None)


def _repeated(plane: np.ndarray, times: int) -> np.ndarray:
    return np.repeat(np.repeat(plane, times, axis=0), times, axis=1)


def _walks(mesh: Mesh, planar: PlanarMap) -> Tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The corners of pixels that each arc passes: its number, the corners (n, 2), which are its last."""
    inner = np.repeat(np.arange(len(planar.tail)), np.diff(planar.starts))
    open_ = np.flatnonzero(~planar.rings)
    arc = np.concatenate([open_, inner])
    triangle = np.concatenate([planar.junctions[planar.tail[open_]], planar.crossings // 3])
    order = np.argsort(arc, kind="stable")
    arc = arc[order]
    corners = mesh.points(mesh.triangles[triangle[order]])
    points = (corners.min(axis=1) + corners.max(axis=1)) / 2
    fresh = np.ones(len(arc), bool)
    fresh[1:] = (arc[1:] != arc[:-1]) | (points[1:] != points[:-1]).any(axis=1)
    # The walk round a ring enters the triangle it began in last.
    begin, end = np.searchsorted(arc, arc, side="left"), np.searchsorted(arc, arc, side="right") - 1
    first = np.arange(len(arc)) == begin
    fresh &= ~(first & planar.rings[arc] & (points == points[end]).all(axis=1) & (begin < end))
    arc, points = arc[fresh], points[fresh]
    return arc, points, np.append(arc[1:] != arc[:-1], True)[:len(arc)]


def _turns(planar: PlanarMap, arc: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Which points begin an open arc or are no middle of a straight stretch."""
    first = np.searchsorted(arc, np.arange(len(planar.tail) + 1))
    index = np.arange(len(arc))
    ring = planar.rings[arc]
    begin, end = first[arc], first[arc + 1] - 1
    before = np.where(index > begin, index - 1, np.where(ring, end, index))
    after = np.where(index < end, index + 1, np.where(ring, begin, index))
    into, out = points - points[before], points[after] - points
    return np.asarray((np.sign(into) != np.sign(out)).any(axis=1))


def _joined(planar: PlanarMap, arc: np.ndarray, points: np.ndarray) -> Curves:
    """Lines from each point to the next, round rings to the first."""
    first = np.searchsorted(arc, np.arange(len(planar.tail) + 1))
    index = np.arange(len(arc))
    end = first[arc + 1] - 1
    after = np.where(index < end, index + 1, first[arc])
    # An arc within one corner of pixels is a line of no length.
    some = planar.rings[arc] | (index < end) | (first[arc] == end)
    begin, stop = points[some], points[after[some]]
    starts = np.searchsorted(arc[some], np.arange(len(planar.tail) + 1))
    return Curves(starts, np.stack([begin, begin, stop, stop], axis=1), np.full(len(begin), LINE, np.uint8))
