# SPDX-License-Identifier: GPL-2.0-or-later
"""What must be true of the data between the stages, whatever the picture."""

from __future__ import annotations

import numpy as np

from ddtcore.model import Mesh


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
