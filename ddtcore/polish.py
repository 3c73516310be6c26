# SPDX-License-Identifier: GPL-2.0-or-later
"""Curves adjusted until they explain the pixels.

Fitted curves follow points that were measured one by one.  Here nodes, tangents
and handles move together so that the picture which the curves would give agrees
with the one they were traced from: Gauss-Newton on the colours of all pixels
that outlines touch, after Yang et al., "Effective clipart image vectorization
through direct optimization of bezigons", IEEE TVCG 22, 2016.  Thin strokes,
junctions and corners need no case of their own: a pixel that several outlines
share is explained by all of them together.
"""

from __future__ import annotations

from typing import NamedTuple, Tuple

import numpy as np

from . import bezier
from .coverage import SAGITTA, Pieces, colours_along, cut_into_pixels, touched_pixels
from .newton import Problem, solve
from .position import premultiplied
from .raster import pixels_at

MUCH = 30000.0
"""Length of all outlines, px, up to which every pixel is explained; four times as much, blocks of 2 by 2."""

SPARSE = 0.04
"""Outlines with less length for each pixel of the picture, px, keep far from one another: half of `MUCH` will do."""

DAMPING = 0.01
"""Least weight of moves being small: what keeps nodes and handles in place that no pixel tells anything of.

Where pixels are off by more of their contrast than its root, they are believed that much less.
"""

SETTLED, GAIN = 0.01, 0.05
"""Rounds end when the last one brought the outlines closer to their pixels by less than this, px, and took
less than this share of what was left to explain."""

DOUBT = 0.5
"""A pixel that is off by more than this share of its contrast counts less and less."""

STRAY, FARTHEST = 3.0, 0.04
"""How far the chords stray into which the picture's curves were cut, by how far its pixels are off; at most, px.

Rasterisers draw chords, Cairo's up to 0.1 px off, and their shapes are that much too small.  Pixels that are
averages of many samples agree much better with what the curves would give.
"""


class Wire(NamedTuple):
    """Segments that share nodes: what moves in the polish.

    Attributes
    ----------
    nodes : ndarray of shape (N, 2)
    fixed : ndarray of shape (N, 2) and dtype bool
        Coordinates that must not change: nodes on the picture's border.
    ends : ndarray of shape (S, 2) and dtype int64
        Nodes at the beginning and end of each segment.
    handles : ndarray of shape (S, 2, 2)
        From each end to its control point.
    smooth : ndarray of shape (N,) and dtype bool
        Nodes that two segments pass with one tangent.
    line : ndarray of shape (S,) and dtype bool
    step : ndarray of shape (S, C)
        Colour on the left less that on the right.
    """

    nodes: np.ndarray
    fixed: np.ndarray
    ends: np.ndarray
    handles: np.ndarray
    smooth: np.ndarray
    line: np.ndarray
    step: np.ndarray

    def control(self) -> np.ndarray:
        """Control points (S, 4, 2)."""
        start, end = self.nodes[self.ends[:, 0]], self.nodes[self.ends[:, 1]]
        control = np.stack([start, start + self.handles[:, 0], end + self.handles[:, 1], end], axis=1)
        control[self.line] = bezier.from_line(start[self.line], end[self.line])
        return control


class Target(NamedTuple):
    """The picture that the curves should explain, in as few channels as its edges need.

    Attributes
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
    basis : ndarray of shape (4, C)
        Directions in premultiplied colour that tell the two sides of all edges apart;
        black and white art needs one.
    block : int
        Pixels of the picture along the side of one that is explained: large pictures tell
        enough at a lower resolution.
    known : ndarray of shape (P, C) and dtype float32
        Colours of all blocks that were asked for, NaN for the others.
    sagitta : float
        How far the chords stray that its curves were drawn as, px.
    """

    image: np.ndarray
    basis: np.ndarray
    block: int
    known: np.ndarray
    sagitta: float

    @classmethod
    def of(cls, image: np.ndarray, steps: np.ndarray, length: float) -> "Target":
        """The target for edges with these colour steps (A, 4) and of this length, px."""
        # A step of nothing changes no direction, and serves where there are no edges.
        steps = np.unique(np.concatenate([steps, np.zeros((1, 4))]), axis=0)
        _, size, directions = np.linalg.svd(steps, full_matrices=False)
        basis = directions[:max(int((size > 1e-3 * size[:1]).sum()), 1)].T.astype(np.float64)
        much = MUCH / 2 if length < SPARSE * image[..., 0].size else MUCH
        block = max(int(np.ceil(np.sqrt(length / much))), 1)
        blocks = (image.shape[0] // block) * (image.shape[1] // block)
        return cls(image, basis, block, np.full((blocks, basis.shape[1]), np.nan, np.float32), SAGITTA)

    @property
    def shape(self) -> Tuple[int, int]:
        """Rows and columns of whole blocks."""
        return self.image.shape[0] // self.block, self.image.shape[1] // self.block

    def drawn_in_chords(self, off: float) -> "Target":
        """The same, for curves whose pixels are off by this share of their contrast."""
        return self._replace(sagitta=min(max(STRAY * off, SAGITTA), FARTHEST))

    def colours(self, pixels: np.ndarray) -> np.ndarray:
        """Colours (P, C) of blocks by their number ``row * width + col``."""
        new = pixels[np.isnan(self.known[pixels, 0])]
        row, col = np.divmod(new, max(self.shape[1], 1))
        width, across = self.image.shape[1], range(self.block)
        corner = self.block * (row * width + col)
        each = (pixels_at(self.image, corner + y * width + x) for y in across for x in across)
        mean = sum(map(premultiplied, each)) / self.block ** 2
        self.known[new] = np.einsum("pk,kc->pc", mean, self.basis)
        return np.asarray(self.known.take(pixels, axis=0))


def polish(wire: Wire, target: Target, rounds: int) -> Tuple[Wire, float]:
    """Move nodes and handles until the curves explain the pixels best.

    Parameters
    ----------
    wire : Wire
    target : Target
    rounds : int
        Gauss-Newton steps.

    Returns
    -------
    Wire
    float
        By which share of its contrast one pixel in two is off at least.
    """
    if not rounds:
        return wire, 0.0
    step = np.einsum("sk,kc->sc", wire.step, target.basis)
    wire = _scaled(wire, 1 / target.block)
    best, least, off = wire, np.inf, 0.0
    for left in range(rounds, -1, -1):
        misfit = _misfit(wire, step, target)
        gained = least - misfit.cost > min(SETTLED ** 2 * len(misfit.weight), GAIN * misfit.cost)
        if misfit.cost < least:
            best, least, off = wire, misfit.cost, misfit.off
        if not (left and gained):
            break
        wire = _moved(wire, solve(_linearise(wire, step, misfit)))
    return _scaled(best, target.block), off


def _scaled(wire: Wire, scale: float) -> Wire:
    return wire._replace(nodes=scale * wire.nodes, handles=scale * wire.handles)


class _Misfit(NamedTuple):
    pieces: Pieces
    number: np.ndarray       # (M,) touched pixel of each piece
    residual: np.ndarray     # (P, C) weighted
    weight: np.ndarray       # (P,)
    cost: float
    off: float               # share of the contrast, the middle one


def _misfit(wire: Wire, step: np.ndarray, target: Target) -> _Misfit:
    """How the picture differs from what the curves would give."""
    h, w = target.shape
    pieces = cut_into_pixels(wire.control(), wire.line, (h, w), target.sagitta)
    pixels, number = touched_pixels(pieces, h * w)
    residual = target.colours(pixels) - colours_along(pieces, pixels, number, step[pieces.segment], w)
    strength, rank = np.unique(np.einsum("sc,sc->s", step, step), return_inverse=True)
    contrast = np.zeros(len(pixels))
    # Later entries win, so the strongest edge of each pixel comes last; small ranks are sorted faster.
    rank = rank.astype(np.min_scalar_type(len(strength)))[pieces.segment]
    rising = np.argsort(rank, kind="stable")
    contrast[number[rising]] = strength[rank[rising]]
    scale = 1 / np.sqrt(contrast + 16)
    off = np.sqrt(np.einsum("pc,pc->p", residual, residual)) * scale
    weight = scale / np.sqrt(np.maximum(off / DOUBT, 1))
    cost = float(np.square(np.minimum(off, DOUBT)).sum())
    middle = float(np.median(off)) if len(off) else 0.0
    return _Misfit(pieces, number, residual * weight[:, None], weight, cost, middle)


def _linearise(wire: Wire, step: np.ndarray, misfit: _Misfit) -> Problem:
    """How each parameter would change the pixels, and how far off they are."""
    pieces, number, residual, weight, *_, off = misfit
    # The middle one: a few pixels that are far off say nothing of the others.
    index, damping = _parameters(wire, max(DAMPING, off ** 2))
    fresh = np.r_[True, (np.diff(pieces.segment) != 0) | (np.diff(pieces.pixel) != 0)]
    begins = np.flatnonzero(fresh)
    segment, pixel = pieces.segment[begins], number[begins]
    slope = _slopes(wire, pieces, np.cumsum(fresh) - 1, segment)
    return Problem(pixel, segment, step[segment] * weight[pixel, None], slope, index, residual, damping)


def _frames(wire: Wire) -> np.ndarray:
    """How each handle's two parameters move its control point, (S, 2 ends, 2 parameters, 2)."""
    frame = np.zeros(wire.handles.shape[:2] + (2, 2))
    smooth = wire.smooth[wire.ends]
    length = np.maximum(np.hypot(*np.moveaxis(wire.handles, 2, 0)), 1e-9)
    along = wire.handles / length[..., None]
    across = np.stack([-wire.handles[..., 1], wire.handles[..., 0]], axis=-1)
    frame[..., 0, :] = np.where(smooth[..., None], along, [1.0, 0.0])
    frame[..., 1, :] = np.where(smooth[..., None], across, [0.0, 1.0])
    frame[wire.line] = 0
    return frame


def _parameters(wire: Wire, firmness: float) -> Tuple[np.ndarray, np.ndarray]:
    """Numbers (8, S) of the parameters of each segment, and the damping of all; number 0 is none.

    In the order x, y of the beginning, its handle's two, x, y of the end, its handle's two.
    A smooth handle has its length and the angle of its node, a free one has x and y.
    """
    n, s = len(wire.nodes), len(wire.ends)
    place = np.where(wire.fixed, 0, 1 + np.arange(2 * n).reshape(n, 2))
    angle = 1 + 2 * n + np.arange(n)
    # Beside a line the tangent is the line's.
    beside = np.zeros(n, bool)
    beside[wire.ends[wire.line].ravel()] = True
    angle = np.where(beside, 0, angle)
    own = 1 + 3 * n + np.arange(4 * s).reshape(s, 2, 2)
    own[wire.line] = 0
    smooth = wire.smooth[wire.ends] & ~wire.line[:, None]
    second = np.where(smooth, angle[wire.ends], own[..., 1])
    index = np.stack([place[wire.ends[:, 0], 0], place[wire.ends[:, 0], 1], own[:, 0, 0], second[:, 0],
                      place[wire.ends[:, 1], 0], place[wire.ends[:, 1], 1], own[:, 1, 0], second[:, 1]])
    damping = np.full(1 + 3 * n + 4 * s, firmness)
    damping[0] = 1e12
    length = np.einsum("sed,sed->se", wire.handles, wire.handles)
    damping[1 + 2 * n:1 + 3 * n] = firmness / 50
    np.add.at(damping, angle[wire.ends], firmness * length)
    return index, damping


def _slopes(wire: Wire, pieces: Pieces, group: np.ndarray, segment: np.ndarray) -> np.ndarray:
    """Area (8, G) that groups of pieces, each of a segment, move to the left colour per unit of its parameters."""
    t, (dx, dy) = pieces.t, pieces.move
    s = 1 - t
    share = np.where(wire.line[pieces.segment], s, s * s * (1 + 2 * t))
    weights = (share, 3 * s * s * t, 1 - share, 3 * s * t * t)
    moved = np.stack([np.bincount(group, w * d, len(segment)) for w in weights for d in (-dy, dx)]).reshape(2, 4, -1)
    frames = np.ascontiguousarray(_frames(wire).transpose(1, 2, 3, 0)).take(segment, axis=3)
    moved[:, 2:] = np.einsum("epdg,edg->epg", frames, moved[:, 2:])
    return moved.reshape(8, -1)


def _moved(wire: Wire, x: np.ndarray) -> Wire:
    """The wire after a step, with moves and handles kept within reason."""
    n, s = len(wire.nodes), len(wire.ends)
    x = x.copy()
    x[0] = 0
    move = x[1:1 + 2 * n].reshape(n, 2)
    move = move / np.maximum(np.hypot(*move.T), 1)[:, None]
    nodes = wire.nodes + np.where(wire.fixed, 0, move)
    turn = np.clip(x[1 + 2 * n:1 + 3 * n], -0.3, 0.3)[wire.ends]
    own = x[1 + 3 * n:].reshape(s, 2, 2)
    smooth = wire.smooth[wire.ends]
    length = np.hypot(*np.moveaxis(wire.handles, 2, 0))
    longer = np.maximum(length + np.clip(own[..., 0], -0.5 * length - 0.5, 0.5 * length + 0.5), 0.02)
    along = wire.handles / np.maximum(length, 1e-9)[..., None]
    cos, sin = np.cos(turn), np.sin(turn)
    turned = np.stack([cos * along[..., 0] - sin * along[..., 1], sin * along[..., 0] + cos * along[..., 1]], axis=-1)
    shift = own / np.maximum(np.hypot(*np.moveaxis(own, 2, 0)), 1)[..., None]
    handles = np.where(smooth[..., None], turned * longer[..., None], wire.handles + shift)
    chord = np.hypot(*(nodes[wire.ends[:, 1]] - nodes[wire.ends[:, 0]]).T)[:, None]
    length = np.hypot(*np.moveaxis(handles, 2, 0))
    handles *= np.minimum(1, 1.6 * chord / np.maximum(length, 1e-9))[..., None]
    return _aligned(wire._replace(nodes=nodes, handles=handles))


def _aligned(wire: Wire) -> Wire:
    """Handles beside a line turned into its direction, at smooth nodes."""
    lines = np.flatnonzero(wire.line)
    toward = np.zeros_like(wire.nodes)
    chord = wire.nodes[wire.ends[lines, 1]] - wire.nodes[wire.ends[lines, 0]]
    chord /= np.maximum(np.hypot(*chord.T), 1e-9)[:, None]
    toward[wire.ends[lines, 0]], toward[wire.ends[lines, 1]] = -chord, chord
    known = (toward != 0).any(axis=1) & wire.smooth
    turn = known[wire.ends] & ~wire.line[:, None]
    length = np.hypot(*np.moveaxis(wire.handles, 2, 0))
    handles = np.where(turn[..., None], toward[wire.ends] * length[..., None], wire.handles)
    return wire._replace(handles=handles)
