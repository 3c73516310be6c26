# SPDX-License-Identifier: GPL-2.0-or-later
"""The data dependent triangulation of a picture (paper, section III).

Pixels are vertices.  Each quad of four neighbours is split by its cheaper diagonal (`quads`),
then edges are flipped while that lowers the cost of the mesh (`flips`, `cost`).

Nothing is to be gained where the picture is flat, so only a *ribbon* of quads is worked on:
those with several labels, and for flips everywhere also all that are not flat, and their
neighbours.  Edges at the rim of the ribbon are never flipped, nor are those of quads that
touch the frame.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import chain, islice
from typing import Tuple

import numpy as np

from .cost import EdgeCost
from .flips import flip_rounds
from .model import OUTSIDE, Labels, Mesh
from .options import TraceOptions
from .parts import in_parts
from .quads import choose_slash, colour_steps, half_edges, split_planes
from .raster import packed
from .ribbon import Ribbon

LABEL_ROUNDS = 4
"""Rounds of flips at boundaries; on clip art of a megapixel four do 94 % of all flips."""


def triangulate(image: np.ndarray, labels: Labels, options: TraceOptions) -> Mesh:
    """Triangulate a picture so that edges of the mesh run along those of the picture.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    labels : Labels
        A mesh edge that joins two pixels of one label, one of them thin, is never flipped,
        and such a diagonal is preferred to the other one.
    options : TraceOptions
        `cost`, `flips` and `work` apply.  For the results `triangles` and `border` the mesh
        covers the whole picture, else only the ribbon.

    Returns
    -------
    Mesh
        Vertices of the frame have the colour of the pixel nearest to them.
    """
    ribbon, quads = start_ribbon(image, labels, options)
    rounds = flip_rounds(ribbon, options.work)
    if options.flips == "boundaries":
        rounds = islice(rounds, LABEL_ROUNDS)
    else:
        rounds = chain(rounds, flip_rounds(ribbon, options.work, look_ahead=True))
    for _ in rounds:
        pass
    mesh = ribbon_mesh(ribbon, quads)
    return _fill(mesh, image, labels, options) if options.result in ("triangles", "border") else mesh


def start_ribbon(image: np.ndarray, labels: Labels, options: TraceOptions) -> Tuple[Ribbon, np.ndarray]:
    """The quads to work on, split by their cheaper diagonals.

    Parameters
    ----------
    image, labels, options
        As for `triangulate`.

    Returns
    -------
    ribbon : Ribbon
    quads : ndarray of shape (H + 1, W + 1) and dtype bool
        Which quads of the framed grid these are.
    """
    vertex_labels = np.pad(labels.index, 1, mode="constant", constant_values=OUTSIDE)
    everywhere = options.flips == "everywhere"
    quads = _uneven(vertex_labels)
    if everywhere:
        quads |= _dilated(_uneven(np.pad(packed(image), 1, mode="edge")))
    numbers = np.flatnonzero(quads)
    steps = colour_steps(image, numbers)
    slash = choose_slash(image, labels, numbers, steps, options.cost)
    triangles, twins = half_edges(numbers, slash, quads.shape)
    twins[twins < 0] = len(twins)
    cost = EdgeCost(options.cost, len(steps.top))
    planes = split_planes(steps, slash, cost)
    ribbon = Ribbon(
        columns=vertex_labels.shape[1], origins=np.append(triangles, [0, 0, 0]),
        twins=np.append(twins, [len(twins)] * 3), cost=cost,
        planes=np.concatenate([planes, np.zeros_like(planes[:, :1])], axis=1),
        labels=vertex_labels.ravel(), thin=np.pad(labels.thin, 1, constant_values=False).ravel(),
        everywhere=everywhere)
    return ribbon, quads


def ribbon_mesh(ribbon: Ribbon, quads: np.ndarray) -> Mesh:
    """The mesh that a ribbon has become.

    Parameters
    ----------
    ribbon : Ribbon
    quads : ndarray of shape (H + 1, W + 1) and dtype bool
        Which quads of the framed grid it covers.
    """
    rim = len(ribbon.twins) - 3
    twins = ribbon.twins[:rim].astype(np.int32)
    twins[twins == rim] = -1
    return Mesh(shape=(quads.shape[0] + 1, quads.shape[1] + 1),
                triangles=ribbon.origins[:rim].astype(np.int32).reshape(-1, 3), twins=twins,
                quads=quads, flips=ribbon.flips, finished=ribbon.finished)


def _fill(mesh: Mesh, image: np.ndarray, labels: Labels, options: TraceOptions) -> Mesh:
    """Add the quads that are not in the mesh, split by their cheaper diagonals."""
    numbers = np.flatnonzero(~mesh.quads)
    slash = choose_slash(image, labels, numbers, colour_steps(image, numbers), options.cost)
    triangles, twins = half_edges(numbers, slash, mesh.quads.shape)
    twins[twins >= 0] += len(mesh.twins)
    triangles = np.concatenate([mesh.triangles, triangles.astype(np.int32)])
    twins = np.concatenate([mesh.twins, twins.astype(np.int32)])
    # Edges at the rim still are sides of quads; two rims meet where their ends are the same.
    rim = np.flatnonzero(twins < 0)
    ends = np.stack([triangles.ravel()[rim], np.roll(triangles, -1, axis=1).ravel()[rim]]).astype(np.int64)
    key = 2 * ends.min(axis=0) + (np.abs(ends[0] - ends[1]) > 1)
    order = np.argsort(key, kind="stable")
    meet = np.flatnonzero(np.diff(key[order]) == 0)
    one, other = rim[order[meet]], rim[order[meet + 1]]
    twins[one], twins[other] = other, one
    return replace(mesh, triangles=triangles, twins=twins, quads=np.ones_like(mesh.quads))


def _uneven(plane: np.ndarray) -> np.ndarray:
    """Quads whose four values are not all equal: bool, one row and one column less."""
    def uneven(rows: slice) -> Tuple[np.ndarray]:
        some = plane[rows.start:rows.stop + 1]
        beside, below = some[:, 1:] != some[:, :-1], some[1:] != some[:-1]
        return (beside[1:] | beside[:-1] | below[:, 1:],)

    return in_parts(uneven, len(plane) - 1, size=plane.shape[1])[0]


def _dilated(quads: np.ndarray) -> np.ndarray:
    """Quads and their eight neighbours."""
    wide = quads.copy()
    wide[1:] |= quads[:-1]
    wide[:-1] |= quads[1:]
    wider = wide.copy()
    wider[:, 1:] |= wide[:, :-1]
    wider[:, :-1] |= wide[:, 1:]
    return wider
