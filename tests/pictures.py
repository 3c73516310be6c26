# SPDX-License-Identifier: GPL-2.0-or-later
"""Anti-aliased pictures of known geometry: each pixel mixes the colours by their exact areas in it."""

from __future__ import annotations

from typing import List, NamedTuple, Optional, Sequence

import numpy as np
from hypothesis import strategies as st
from meshes import pictures

from ddtcore.model import Labels, Mesh, PlanarMap, Polylines
from ddtcore.options import TraceOptions
from ddtcore.outline import link_outlines
from ddtcore.position import place
from ddtcore.triangulation import triangulate

WHITE, BLACK, RED, BLUE = (255, 255, 255, 255), (0, 0, 0, 255), (200, 30, 40, 255), (40, 60, 180, 255)


def coverage(points, width: int, height: int) -> np.ndarray:
    """Exact share (H, W) of each pixel inside a polygon that runs clockwise on the screen.

    Each side takes away what lies on its right in its rows, or adds it: the integral of
    clip(u, 0, 1) is known in closed form.
    """
    begin = np.asarray(points, float)
    end = np.roll(begin, -1, axis=0)
    rows = np.arange(height)
    top = np.clip(np.minimum(begin[:, 1], end[:, 1])[:, None], rows, rows + 1)
    bottom = np.clip(np.maximum(begin[:, 1], end[:, 1])[:, None], rows, rows + 1)
    side, row = np.nonzero(bottom > top)
    top, bottom = top[side, row], bottom[side, row]
    slope = ((end - begin)[side, 0] / (end - begin)[side, 1])
    x = begin[side, 0] + slope * (np.stack([top, bottom]) - begin[side, 1])
    u = np.arange(1, width + 1) - x[..., None]
    steep = np.abs(u[1] - u[0]) < 1e-6
    mean = np.where(steep, np.clip(u[0], 0, 1),
                    (_clip_integral(u[1]) - _clip_integral(u[0])) / np.where(steep, 1, u[1] - u[0]))
    sign = np.where(end[side, 1] < begin[side, 1], 1, -1)
    share = np.zeros((height, width))
    np.add.at(share, row, mean * (sign * (bottom - top))[:, None])
    return share


def _clip_integral(u: np.ndarray) -> np.ndarray:
    return np.where(u < 1, np.maximum(u, 0) ** 2 / 2, u - 0.5)


def turned(points, degrees: float, centre) -> np.ndarray:
    """Points turned about the origin (clockwise on the screen), then moved to `centre`."""
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.asarray(points, float) @ [[cos, sin], [-sin, cos]] + centre


def disc(centre, radius: float) -> np.ndarray:
    """A circle; 720 corners stray by less than a hundred-thousandth of the radius."""
    angle = np.arange(720) * np.pi / 360
    return np.asarray(centre) + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def star(centre, outer: float, inner: float, tips: int = 5, degrees: float = 0) -> np.ndarray:
    """A star; a regular polygon of twice as many corners if both radii are equal."""
    angle = np.arange(2 * tips) * np.pi / tips
    radius = np.where(np.arange(2 * tips) % 2, inner, outer)
    return turned(radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1), degrees, centre)


def rectangle(centre, width: float, height: float, degrees: float = 0) -> np.ndarray:
    x, y = width / 2, height / 2
    return turned([(-x, -y), (x, -y), (x, y), (-x, y)], degrees, centre)


def half_plane(point, degrees: float) -> np.ndarray:
    """All that lies on the right of a line through `point`, as far as pictures reach."""
    return turned([(-500, 0), (500, 0), (500, 500), (-500, 500)], degrees, point)


class Picture(NamedTuple):
    image: np.ndarray
    labels: Labels


def picture(width: int, height: int, parts: Sequence[np.ndarray],
            colours=(WHITE, BLACK, RED, BLUE)) -> Picture:
    """Polygons that don't overlap, on paper of the first colour.

    Pixels get the label of the largest part in them; alpha must be the same everywhere.
    """
    shares = np.stack([coverage(part, width, height) for part in parts])
    shares = np.concatenate([1 - shares.sum(axis=0)[None], shares])
    palette = np.array(colours[:len(shares)], float)
    image = np.rint(np.einsum("khw,kc->hwc", shares, palette)).astype(np.uint8)
    return Picture(image, Labels(np.argmax(shares, axis=0).astype(np.int32), palette,
                                 np.zeros((height, width), bool)))


@st.composite
def islands(draw) -> np.ndarray:
    """Small pictures of two or three colours with a margin: outlines are rings, some with junctions."""
    shape = draw(st.tuples(st.integers(3, 8), st.integers(3, 8)))
    random = np.random.RandomState(draw(st.integers(0, 2 ** 32 - 1)))
    index = np.pad(random.randint(0, draw(st.sampled_from([2, 2, 3])), shape), 1, mode="constant")
    return np.array([WHITE, BLACK, RED], np.uint8)[index]


def any_picture():
    """Noise, whose outlines mostly meet in junctions, and islands, whose outlines are mostly rings."""
    return st.one_of(pictures(), islands())


class Placed(NamedTuple):
    mesh: Mesh
    planar: PlanarMap
    lines: Polylines

    def arc(self, number: int) -> np.ndarray:
        return self.lines.points[self.lines.starts[number]:self.lines.starts[number + 1]]

    def inner(self) -> List[int]:
        """Arcs that don't run along the picture's border."""
        return np.flatnonzero(self.planar.left != 0).tolist()


def placed(drawn: Picture, options: Optional[TraceOptions] = None) -> Placed:
    """The outlines of a picture whose labels are known."""
    options = options or TraceOptions()
    mesh = triangulate(drawn.image, drawn.labels, options)
    planar = link_outlines(mesh, drawn.labels)
    return Placed(mesh, planar, place(drawn.image, drawn.labels, mesh, planar, options))


def apart(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Distances (N, M) between points and others."""
    return np.hypot(*(np.asarray(points)[:, None] - others).transpose(2, 0, 1))


def away(points: np.ndarray, polygon: np.ndarray) -> np.ndarray:
    """Signed distance of points from the nearest side of a clockwise polygon, positive outside; px."""
    begin = np.asarray(polygon, float)
    side = np.roll(begin, -1, axis=0) - begin
    offset = np.asarray(points)[:, None] - begin
    along = np.clip((offset * side).sum(axis=2) / np.maximum((side ** 2).sum(axis=1), 1e-12), 0, 1)
    foot = offset - along[..., None] * side
    nearest = np.argmin((foot ** 2).sum(axis=2), axis=1)
    index = np.arange(len(nearest))
    foot, side = foot[index, nearest], side[nearest]
    return np.hypot(*foot.T) * -np.sign(side[:, 0] * foot[:, 1] - side[:, 1] * foot[:, 0])
