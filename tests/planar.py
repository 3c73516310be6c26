# SPDX-License-Identifier: GPL-2.0-or-later
"""A planar map of a small label array, built step by step in plain loops.

It shares no code with `ddtcore.outline`: quads get a diagonal by a fixed rule,
mixed edges are walked one by one, arcs run through their mid-points as lines.
"""

from __future__ import annotations

from typing import Tuple

import numpy as np

from ddtcore.model import LINE, OUTSIDE, Curves, Labels, PlanarMap, Polylines


def palette_labels(index, palette=None) -> Labels:
    """Labels with a palette of clearly different colours, or with the given one."""
    index = np.asarray(index, np.int32)
    if palette is None:
        k = np.arange(index.max() + 1)
        palette = np.stack([k * 97 % 256, k * 57 % 256, 255 - k * 71 % 256, np.full(len(k), 255)], axis=1)
    return Labels(index, np.asarray(palette, float), np.zeros(index.shape, bool))


def planar_map(index) -> Tuple[PlanarMap, Polylines, Curves]:
    """Faces and arcs of a label array, and the arcs' points as polylines and as lines."""
    index = np.asarray(index, np.int32)
    height, width = index.shape
    label = np.pad(index, 1, constant_values=OUTSIDE)
    triangles = _triangles(label)
    face, face_labels = _flood(label, triangles)
    arcs = _walk(label, triangles)
    junctions = sorted({end for arc in arcs for end in (arc[0], arc[-1]) if len(end) == 3})
    number = {triangle: k for k, triangle in enumerate(junctions)}
    points, starts, tail, head, left, right = [], [0], [], [], [], []
    for arc in arcs:
        points += [_place(item, width, height) for item in arc]
        starts.append(len(points))
        tail.append(number.get(arc[0], -1))
        head.append(number.get(arc[-1], -1))
        a, b = _sides(arc)
        left.append(face[a])
        right.append(face[b])
    lines = Polylines(np.array(starts), np.array(points), np.ones(len(points)), np.zeros(len(arcs)))
    pixel_faces = np.array([[face[r + 1, c + 1] for c in range(width)] for r in range(height)], np.int32)
    planar = PlanarMap(
        starts=np.zeros(len(arcs) + 1, np.int64), crossings=np.zeros(0, np.int32),
        tail=np.array(tail, np.int32), head=np.array(head, np.int32),
        left=np.array(left, np.int32), right=np.array(right, np.int32),
        junctions=np.zeros(len(junctions), np.int32), face_labels=np.array(face_labels, np.int32),
        face_areas=np.bincount(pixel_faces.ravel(), minlength=len(face_labels)), pixel_faces=pixel_faces)
    return planar, lines, straight(planar, lines)


def straight(planar: PlanarMap, lines: Polylines) -> Curves:
    """The polylines as curves of degree 1."""
    control, starts = [], [0]
    for k, ring in enumerate(planar.rings):
        p = lines.points[lines.starts[k]:lines.starts[k + 1]]
        p = np.concatenate([p, p[:1]]) if ring else p
        control.append(np.stack([p[:-1], p[:-1], p[1:], p[1:]], axis=1))
        starts.append(starts[-1] + len(p) - 1)
    return Curves(np.array(starts), np.concatenate(control), np.full(starts[-1], LINE, np.uint8))


def _triangles(label):
    """Triangles as triples of (row, col), clockwise on the screen."""
    out = []
    for r in range(label.shape[0] - 1):
        for c in range(label.shape[1] - 1):
            a, b, d, e = (r, c), (r, c + 1), (r + 1, c), (r + 1, c + 1)
            outside = label[b] == label[d] == OUTSIDE
            if outside or label[a] == label[e] != OUTSIDE:
                out += [(a, b, e), (a, e, d)]
            else:
                out += [(a, b, d), (b, e, d)]
    return out


def _flood(label, triangles):
    """Face of each framed vertex (a dict) and label of each face, the outside first."""
    near = {}
    for t in triangles:
        for u, v in zip(t, t[1:] + t[:1]):
            if label[u] == label[v]:
                near.setdefault(u, set()).add(v)
                near.setdefault(v, set()).add(u)
    face, face_labels = {}, []
    for seed in np.ndindex(label.shape):
        if seed in face:
            continue
        face[seed], stack = len(face_labels), [seed]
        face_labels.append(label[seed])
        while stack:
            for other in sorted(near.get(stack.pop(), ())):
                if other not in face:
                    face[other] = face[seed]
                    stack.append(other)
    return face, face_labels


def _walk(label, triangles):
    """Arcs as lists of mixed edges (pairs of vertices); open ones with junctions (triples) at both ends."""
    around, begins = {}, []
    for t in triangles:
        mixed = [tuple(sorted(e)) for e in zip(t, t[1:] + t[:1]) if label[e[0]] != label[e[1]]]
        if len(mixed) == 3:
            begins += [(t, edge) for edge in mixed]
        for edge in mixed:
            around.setdefault(edge, []).append((t, mixed))
    arcs, used = [], set()
    for came, edge in begins + [(None, edge) for edge in sorted(around)]:
        if edge in used:
            continue
        arc = [] if came is None else [came]
        came = around[edge][0][0] if came is None else came
        while edge not in used:
            used.add(edge)
            arc.append(edge)
            came, mixed = next(x for x in around[edge] if x[0] != came)
            if len(mixed) == 3:
                arc.append(came)
                break
            edge = next(e for e in mixed if e != edge)
        arcs.append(arc)
    return arcs


def _sides(arc):
    """A vertex on the left and one on the right of an arc."""
    k = 0 if len(arc[0]) == 2 else 1
    u, v = arc[k]
    here = np.mean(arc[k], axis=0)
    # A ring has at least three edges round a vertex, so its neighbour lies to one side.
    ahead = np.mean(arc[k + 1] if k + 1 < len(arc) else arc[k - 1], axis=0) - here
    across = np.array(v, float) - u
    cross = ahead[1] * across[0] - ahead[0] * across[1]
    return (u, v) if cross > 0 else (v, u)


def _place(item, width, height):
    """Where a mixed edge or a junction lies, (x, y)."""
    corners = np.array([(c - 0.5, r - 0.5) for r, c in item])
    point = corners.mean(axis=0)
    for axis, size in ((0, width), (1, height)):
        if (corners[:, axis] < 0).any():
            point[axis] = 0
        if (corners[:, axis] > size).any():
            point[axis] = size
    return point
