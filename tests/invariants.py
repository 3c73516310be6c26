# SPDX-License-Identifier: GPL-2.0-or-later
"""What must be true of the data between the stages, whatever the picture."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree

import numpy as np
from pathparser import parse

from ddtcore.model import Drawing, Loop, Mesh


def assert_valid_mesh(mesh: Mesh) -> None:
    """Triangles of twice the area 1 that tile the meshed quads, with mutual twins."""
    assert mesh.triangles.dtype == mesh.twins.dtype == np.int32
    assert mesh.triangles.shape == (len(mesh.twins) // 3, 3)
    assert mesh.quads.shape == (mesh.shape[0] - 1, mesh.shape[1] - 1) and mesh.quads.dtype == bool
    a, b, c = np.moveaxis(mesh.points(mesh.triangles), 1, 0)
    assert np.all((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] == 1)
    assert len(mesh.triangles) == 2 * mesh.quads.sum()
    origin, end = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    inner = np.flatnonzero(mesh.twins >= 0)
    assert np.array_equal(mesh.twins[mesh.twins[inner]], inner)
    assert np.array_equal(origin[mesh.twins[inner]], end[inner])
    # Triangles that all run clockwise, and whose sum has the boundary of the meshed quads, cover
    # each point of these exactly once and no other point.
    rim = np.flatnonzero(mesh.twins < 0)
    ends = np.stack([origin[rim], end[rim]], axis=1)
    assert set(map(tuple, ends.tolist())) == _boundary(mesh)
    assert len(rim) == len(_boundary(mesh))


def _boundary(mesh: Mesh) -> set:
    """Sides of meshed quads that are not sides of two, as (origin, end), clockwise."""
    columns, quads = mesh.shape[1], np.pad(mesh.quads, 1, mode="constant")
    row, col = np.nonzero(mesh.quads)
    a = row * columns + col
    b, c, d = a + 1, a + columns + 1, a + columns
    sides = ((a, b, -1, 0), (b, c, 0, 1), (c, d, 1, 0), (d, a, 0, -1))
    boundary = set()
    for origin, end, down, right in sides:
        alone = ~quads[row + 1 + down, col + 1 + right]
        boundary.update(zip(origin[alone].tolist(), end[alone].tolist()))
    return boundary


def assert_sound(drawing: Drawing, by_area: bool = True) -> str:
    """Whatever the picture: closed finite shapes in it, larger ones at the back, and SVG that says the same.

    Parameters
    ----------
    drawing : Drawing
    by_area : bool
        Whether shapes must be sorted by area: not where they were grouped by colour.

    Returns
    -------
    str
        The document.
    """
    for shape in drawing.shapes:
        assert np.isfinite(shape.area) and 0 <= shape.opacity <= 1
        assert all(0 <= level <= 255 for level in shape.rgb)
        for loop in shape.loops:
            assert loop.control.shape == (len(loop.degree), 4, 2) and len(loop.degree)
            assert np.isin(loop.degree, (1, 2, 3)).all() and np.isfinite(loop.control).all()
            assert np.array_equal(loop.control[:, 3], np.roll(loop.control[:, 0], -1, axis=0)), "not closed"
            low, high = bounds(loop)
            assert (low > -SPILL).all() and (high < np.array([drawing.width, drawing.height]) + SPILL).all()
    # Translucent shapes come before opaque ones, each kind sorted by itself (see `order.area_order`).
    ranks = [(shape.opacity < 1, shape.area) for shape in drawing.shapes]
    assert not by_area or ranks == sorted(ranks, reverse=True)
    svg = drawing.to_svg()
    assert drawing.to_svg() == svg
    _assert_readable(svg, drawing)
    return svg


SPILL = 0.05
"""How far a curve may bulge over the border of the picture, px: one unit of a document."""


def bounds(loop: Loop):
    """Least and greatest x, y of a loop's segments, exact but for rounding."""
    a, b, c, d = np.moveaxis(loop.control, 1, 0)
    # The derivative of a cubic, in powers of t.
    square, linear, constant = d - 3 * c + 3 * b - a, 2 * (a - 2 * b + c), b - a
    with np.errstate(all="ignore"):
        root = np.sqrt(linear ** 2 - 4 * square * constant)
        turns = np.stack([(-linear + root) / (2 * square), (-linear - root) / (2 * square), -constant / linear])
    t = np.where((turns > 0) & (turns < 1), turns, 0)
    s = 1 - t
    points = np.concatenate([s ** 3 * a + 3 * s * s * t * b + 3 * s * t * t * c + t ** 3 * d, [d]])
    points[:, loop.degree == 1] = np.stack([a, d, a, d])[:, loop.degree == 1]
    return points.min(axis=(0, 1)), points.max(axis=(0, 1))


def _assert_readable(svg: str, drawing: Drawing) -> None:
    """The document is XML of the picture's size, and each path consists of closed loops of finite numbers."""
    root = ElementTree.fromstring(svg)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert (root.get("width"), root.get("height")) == (str(drawing.width), str(drawing.height))
    assert not re.search(r"(?i)\bnan|\binf", svg)
    paths = [element.get("d") for element in root.iter("{http://www.w3.org/2000/svg}path")]
    assert drawing.triangles is not None or len(paths) <= len(drawing.shapes)
    for data in paths:
        assert parse(data)
