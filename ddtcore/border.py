# SPDX-License-Identifier: GPL-2.0-or-later
"""Border triangles and their barycentres (paper, section V), and the mesh as a drawing.

The paper calls a triangle a border triangle if it is "not an equilateral triangle", or if
it is "connected to a triangle with a different color", where a threshold excludes smooth
changes.  Made definite:

1. No triangle of a pixel grid is equilateral.  Those that no flip has touched have squared
   sides 1, 1 and 2; any other triangle is *irregular*.  As flips happen within soft shading
   too, an irregular triangle counts only if its vertices differ by more than the threshold.
2. A triangle whose vertices carry two labels or three lies on the border of regions.  The frame
   of the picture has a label of its own, so the picture's rim is a border.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .cost import framed_levels
from .model import OUTSIDE, Drawing, Labels, Mesh, Triangles
from .options import TraceOptions


def border_triangles(mesh: Mesh, vertex_labels: np.ndarray, vertex_colours: np.ndarray,
                     threshold: float) -> np.ndarray:
    """Mark the border triangles by either rule.

    Parameters
    ----------
    mesh : Mesh
    vertex_labels : ndarray of shape (V,) and an integer dtype
        Label of each vertex of the framed grid, `OUTSIDE` in the frame.
    vertex_colours : ndarray of shape (V, C)
        Colour of each, 0 to 255 per channel, premultiplied.
    threshold : float
        Distance in colour that makes an irregular triangle a border triangle, levels, see
        `TraceOptions.threshold_levels`.

    Returns
    -------
    ndarray of shape (T,) and dtype bool

    Raises
    ------
    ValueError
        If there is not one label and one colour for each vertex.
    """
    for name, values in (("vertex_labels", vertex_labels), ("vertex_colours", vertex_colours)):
        if len(values) != mesh.shape[0] * mesh.shape[1]:
            raise ValueError(f"{name} must have {mesh.shape[0] * mesh.shape[1]} rows, one for each"
                             f" vertex of the mesh, not {len(values)}")
    labels = vertex_labels[mesh.triangles]
    border: np.ndarray = (labels != labels[:, :1]).any(axis=1)
    irregular = np.flatnonzero(_longest_side(mesh) > 2)
    border[irregular] |= _colour_range(vertex_colours[mesh.triangles[irregular]]) > threshold
    return border


def barycentres(mesh: Mesh, triangles: np.ndarray) -> np.ndarray:
    """Barycentres, the means of the vertices.

    Parameters
    ----------
    mesh : Mesh
    triangles : ndarray
        Which triangles: their numbers, or bool (T,).

    Returns
    -------
    ndarray of shape (n, 2) and dtype float64
        Coordinates (x, y), px.
    """
    return np.asarray(mesh.points(mesh.triangles[triangles]).mean(axis=1))


def draw_mesh(image: np.ndarray, labels: Labels, mesh: Mesh, options: TraceOptions) -> Drawing:
    """The mesh as a drawing that covers the picture exactly.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    labels : Labels
    mesh : Mesh
        Covers all quads.
    options : TraceOptions
        With the result `triangles` these are painted in their mean colours; with `border`
        the mesh is drawn, and `threshold` says which triangles are marked in it.
    """
    height, width = image.shape[:2]
    levels = framed_levels(image)
    vertex_labels = np.pad(labels.index, 1, mode="constant", constant_values=OUTSIDE).ravel()
    border = border_triangles(mesh, vertex_labels, levels, options.threshold_levels)
    rgb, opacity = _mean_colours(np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge"), mesh)
    # The frame lies half a pixel outside; squeezed onto the picture's edge it fills the rim.
    points = np.clip(mesh.points(mesh.triangles), 0, [width, height])
    triangles = Triangles(points=points, rgb=rgb, opacity=opacity, border=border,
                          filled=options.result == "triangles")
    return Drawing(width=width, height=height, triangles=triangles, counts={
        "triangles": len(border), "flips": mesh.flips, "border triangles": int(border.sum())})


def _longest_side(mesh: Mesh) -> np.ndarray:
    """Square of the longest side of each triangle, (T,)."""
    corners = np.stack(np.divmod(mesh.triangles, mesh.shape[1]))
    return np.asarray(((corners - np.roll(corners, 1, axis=2)) ** 2).sum(axis=0).max(axis=1))


def _colour_range(colours: np.ndarray) -> np.ndarray:
    """Largest distance between two of three colours (n, 3, C), float64 (n,)."""
    steps = colours.astype(np.float64) - np.roll(colours, 1, axis=1)
    return np.asarray(np.sqrt((steps ** 2).sum(axis=2)).max(axis=1))


def _mean_colours(framed: np.ndarray, mesh: Mesh) -> Tuple[np.ndarray, np.ndarray]:
    """Mean colour, uint8 (T, 3), and opacity, float64 (T,), of the vertices of each triangle."""
    colours = framed.reshape(-1, 4)[mesh.triangles]
    alpha = colours[..., 3].astype(np.int64)
    total = alpha.sum(axis=1)
    weighted = np.einsum("tk,tkc->tc", alpha, colours[..., :3])
    divisor = np.maximum(total, 1)[:, np.newaxis]
    return ((2 * weighted + divisor) // (2 * divisor)).astype(np.uint8), total / 765.0
