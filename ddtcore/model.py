# SPDX-License-Identifier: GPL-2.0-or-later
"""The data that passes between the stages: arrays with names, and nothing else.

Coordinates are (x, y) in pixels of the picture, y down; the centre of pixel
(row, col) is (col + 1/2, row + 1/2) and the picture is the rectangle
[0, width] x [0, height].  "Left" and "right" are meant as seen on the screen
by someone who walks along an arc; a loop with its interior on the right runs
clockwise on the screen and has a positive area.

Lists of different lengths are stored one after the other with an array of
`starts`: item k is ``values[starts[k]:starts[k + 1]]``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Dict, Optional, Tuple

import numpy as np

OUTSIDE = -1
"""Label of the frame of vertices round the picture, and of its face (number 0)."""

LINE, QUADRATIC, CUBIC = 1, 2, 3
"""Degree of a segment: which of its four control points count (see `Curves`)."""


@dataclass(frozen=True)
class Labels:
    """Which flat colour each pixel belongs to.

    Attributes
    ----------
    index : ndarray of shape (H, W) and dtype int16 or int32
        Number of the colour in `palette`; never negative.
    palette : ndarray of shape (K, 4) and dtype float64
        Colours, RGBA, 0 to 255, not premultiplied; alpha 0 is "nothing" and never painted.
    thin : ndarray of shape (H, W) and dtype bool
        Pixels of strokes so thin that none of their pixels is fully covered; a
        diagonal between two of them must not be cut.
    ramp : ndarray of shape (K,) and dtype bool, optional
        Labels that stand for one connected soft ramp each; their palette colour is its
        mean.  None: there are no ramps.
    gradients : tuple of length K of Gradient or None, optional
        What explains the colours of each label better than one colour does.  None: not
        yet looked for.
    clear : ndarray of shape (H, W, 4) and dtype uint8, optional
        The picture as it was before its edges were blurred, as far as it was found out.
        None: as it is.
    speck : float
        Regions smaller than this are ripples, px²; 0 in a picture without.
    exact : ndarray of shape (K, 4) and dtype float64, optional
        The colours that areas are to be painted in, where `palette` tells those that the
        pixels of `clear` are mixes of.  None: the same.
    """

    index: np.ndarray
    palette: np.ndarray
    thin: np.ndarray
    ramp: Optional[np.ndarray] = None
    gradients: Optional[Tuple[Optional[Gradient], ...]] = None
    clear: Optional[np.ndarray] = None
    speck: float = 0.0
    exact: Optional[np.ndarray] = None


@dataclass(frozen=True)
class Mesh:
    """A triangulation of pixel centres, stored as half-edges.

    The picture is framed by one ring of vertices, so that every boundary closes:
    `shape` is (H + 2, W + 2) and vertex ``row * shape[1] + col`` lies at
    (col - 1/2, row - 1/2).  Half-edge ``3 * t + i`` runs from ``triangles[t, i]``
    to ``triangles[t, (i + 1) % 3]``, clockwise on the screen.

    Attributes
    ----------
    shape : (int, int)
        Rows and columns of the framed grid of vertices.
    triangles : ndarray of shape (T, 3) and dtype int32
        Vertex numbers; twice the signed area of every triangle is 1.
    twins : ndarray of shape (3 * T,) and dtype int32
        The opposite half-edge in the neighbouring triangle, -1 where there is none.
    quads : ndarray of shape (H + 1, W + 1) and dtype bool
        Which quads of the framed grid are covered by triangles; the others are flat.
    flips : int
        How many edge flips led here.
    finished : bool
        False where the work budget ended the flipping early.
    """

    shape: Tuple[int, int]
    triangles: np.ndarray
    twins: np.ndarray
    quads: np.ndarray
    flips: int = 0
    finished: bool = True

    def points(self, vertices: np.ndarray) -> np.ndarray:
        """Coordinates (x, y) of vertex numbers, float64, one more axis than `vertices`."""
        row, col = np.divmod(vertices, self.shape[1])
        return np.stack([col - 0.5, row - 0.5], axis=-1)


@dataclass(frozen=True)
class PlanarMap:
    """Topology of the regions: faces, the arcs between them, the junctions of arcs.

    An arc crosses mixed mesh edges one after the other, from one junction (a
    triangle with three labels) to the next, or round in a ring.  Each boundary is
    stored once and serves the faces on both of its sides.

    Attributes
    ----------
    starts : ndarray of shape (A + 1,) and dtype int64
        Where each arc begins in `crossings`.
    crossings : ndarray of shape (N,) and dtype int32
        Half-edges through which the walk enters one triangle after the other; the
        end of the half-edge lies in the face on the left, its origin on the right.
    tail, head : ndarray of shape (A,) and dtype int32
        Junctions where the arc begins and ends; -1 for a ring.
    left, right : ndarray of shape (A,) and dtype int32
        Faces on either side.
    junctions : ndarray of shape (J,) and dtype int32
        Triangle of each junction.
    face_labels : ndarray of shape (F,) and dtype int32
        Label of each face; face 0 is the outside of the picture.
    face_areas : ndarray of shape (F,) and dtype int64
        Pixels of each face; those of the outside are not counted.
    pixel_faces : ndarray of shape (H, W) and dtype int32
        Face of each pixel.
    """

    starts: np.ndarray
    crossings: np.ndarray
    tail: np.ndarray
    head: np.ndarray
    left: np.ndarray
    right: np.ndarray
    junctions: np.ndarray
    face_labels: np.ndarray
    face_areas: np.ndarray
    pixel_faces: np.ndarray

    @property
    def rings(self) -> np.ndarray:
        """Which arcs are rings, bool (A,)."""
        return self.tail < 0


@dataclass(frozen=True)
class Polylines:
    """Where the arcs of a `PlanarMap` lie, as points.

    Attributes
    ----------
    starts : ndarray of shape (A + 1,) and dtype int64
        Where each arc begins in `points`.
    points : ndarray of shape (N, 2) and dtype float64
        An open arc begins and ends with its junctions' positions; a ring does not
        repeat its first point.
    weight : ndarray of shape (N,) and dtype float64
        How far each position can be trusted, 0 to 1.
    slack : ndarray of shape (A,) and dtype float64
        How far the points of an arc may be off by their nature, px: 0 where they are
        measured, more where the picture has hard edges.
    angular : ndarray of shape (A,) and dtype bool, optional
        Arcs round so few pixels that every point is a corner.  None: there are none.
    """

    starts: np.ndarray
    points: np.ndarray
    weight: np.ndarray
    slack: np.ndarray
    angular: Optional[np.ndarray] = None

    def corners(self) -> np.ndarray:
        """Which arcs consist of corners and lines, bool (A,)."""
        return np.zeros(len(self.slack), bool) if self.angular is None else self.angular


@dataclass(frozen=True)
class Curves:
    """The Bézier segments of every arc.

    Attributes
    ----------
    starts : ndarray of shape (A + 1,) and dtype int64
        Where each arc begins in `control`.
    control : ndarray of shape (S, 4, 2) and dtype float64
        Control points.  Segments of one arc join exactly; those of a ring close.  A
        line uses points 0 and 3; a quadratic has its one control point at 1 and 2.
    degree : ndarray of shape (S,) and dtype uint8
        `LINE`, `QUADRATIC` or `CUBIC`.
    """

    starts: np.ndarray
    control: np.ndarray
    degree: np.ndarray


@dataclass(frozen=True)
class Loop:
    """One closed run of segments; the interior is on the right.

    Attributes
    ----------
    control : ndarray of shape (n, 4, 2) and dtype float64
    degree : ndarray of shape (n,) and dtype uint8
        As in `Curves`; ``control[k, 3] == control[k + 1, 0]``, and the last meets the first.
    """

    control: np.ndarray
    degree: np.ndarray


@dataclass(frozen=True)
class Gradient:
    """A linear or radial gradient in the coordinates of the picture.

    Attributes
    ----------
    kind : {'linear', 'radial'}
    start, end : (float, float)
        Linear: where the first and the last stop lie.  Radial: the centre and a point
        on the outer circle.
    stops : tuple of (offset, (r, g, b), opacity)
        Two to four, offsets 0 to 1 rising.
    across : (float, float), optional
        Radial: where the other half-axis ends, if the outer "circle" is an ellipse.
    """

    kind: str
    start: Tuple[float, float]
    end: Tuple[float, float]
    stops: Tuple[Tuple[float, Tuple[int, int, int], float], ...]
    across: Optional[Tuple[float, float]] = None


@dataclass(frozen=True)
class Shape:
    """One painted region of the result.

    Attributes
    ----------
    name : str
        For the person who edits the drawing, e.g. ``"#c0392b 3"``.
    rgb : (int, int, int)
        Flat colour; the mean one where `gradient` is set.
    opacity : float
        0 to 1.
    loops : tuple of Loop
        Filled by the non-zero rule: outer loops clockwise, holes anticlockwise.
    area : float
        What the shapes are sorted by, px².
    gradient : Gradient, optional
    """

    name: str
    rgb: Tuple[int, int, int]
    opacity: float
    loops: Tuple[Loop, ...]
    area: float
    gradient: Optional[Gradient] = None


@dataclass(frozen=True)
class Triangles:
    """A mesh to be drawn: the results `triangles` and `border`.

    Attributes
    ----------
    points : ndarray of shape (T, 3, 2) and dtype float64
    rgb : ndarray of shape (T, 3) and dtype uint8
        Mean colour of each triangle.
    opacity : ndarray of shape (T,) and dtype float64
    border : ndarray of shape (T,) and dtype bool
        Which are border triangles.
    filled : bool
        True: paint the mean colours; False: draw the mesh and mark the border triangles.
    """

    points: np.ndarray
    rgb: np.ndarray
    opacity: np.ndarray
    border: np.ndarray
    filled: bool


@dataclass(frozen=True)
class Drawing:
    """The result of a trace, independent of any file.

    Attributes
    ----------
    width, height : int
        Size of the traced picture, px.
    shapes : tuple of Shape
        Back to front; larger areas lie at the back.
    triangles : Triangles, optional
        The mesh, where that is the result; then there are no shapes.
    counts : dict
        What the stages counted: triangles, flips, border triangles, outlines, curves.
    notes : tuple of str
        What a person should know, e.g. that a budget was reached.
    decimals : int
        Digits after the point in path data.
    scale : int
        Units per pixel in a document of its own, where path data are whole numbers; 0 for
        as many as `decimals` gives.
    choice : str
        The preset that was chosen for the picture, and why; "" if none was to be chosen.
    """

    width: int
    height: int
    shapes: Tuple[Shape, ...] = ()
    triangles: Optional[Triangles] = None
    counts: Dict[str, int] = field(default_factory=dict)
    notes: Tuple[str, ...] = ()
    decimals: int = 2
    scale: int = 0
    choice: str = ""

    def to_svg(self) -> str:
        """The drawing as an SVG document."""
        from .svg import document

        return document(self)
