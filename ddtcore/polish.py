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
from .coverage import Pieces, colours_along, cut_into_pixels, touched_pixels
from .position import premultiplied

STEPS = 12
"""Conjugate gradient steps in each round."""

DOUBT = 0.5
"""A pixel that is off by more than this share of its contrast counts less and less."""


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
    """

    image: np.ndarray
    basis: np.ndarray

    @classmethod
    def of(cls, image: np.ndarray, steps: np.ndarray) -> "Target":
        """The target for edges with these colour steps (A, 4)."""
        # A step of nothing changes no direction, and serves where there are no edges.
        steps = np.unique(np.concatenate([steps, np.zeros((1, 4))]), axis=0)
        _, size, directions = np.linalg.svd(steps, full_matrices=False)
        return cls(image, directions[:max(int((size > 1e-3 * size[:1]).sum()), 1)].T.astype(np.float64))

    def colours(self, pixels: np.ndarray) -> np.ndarray:
        """Colours (P, C) of pixels by their number ``row * width + col``."""
        return premultiplied(self.image.reshape(-1, 4)[pixels]) @ self.basis


def polish(wire: Wire, target: Target, rounds: int) -> Wire:
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
    """
    step = wire.step @ target.basis
    best, least = wire, np.inf
    for _ in range(rounds):
        problem = _linearise(wire, step, target)
        if problem.cost < least:
            best, least = wire, problem.cost
        wire = _moved(wire, _solve(problem))
    return wire if _misfit(wire, step, target).cost < least else best


class _Misfit(NamedTuple):
    pieces: Pieces
    number: np.ndarray       # (M,) touched pixel of each piece
    residual: np.ndarray     # (P, C) weighted
    weight: np.ndarray       # (P,)
    cost: float


def _misfit(wire: Wire, step: np.ndarray, target: Target) -> _Misfit:
    """How the picture differs from what the curves would give."""
    h, w = target.image.shape[:2]
    pieces = cut_into_pixels(wire.control(), wire.line, (h, w))
    pixels, number = touched_pixels(pieces, h * w)
    residual = target.colours(pixels) - colours_along(pieces, pixels, number, step[pieces.segment], w)
    strength = np.einsum("sc,sc->s", step, step)[pieces.segment]
    contrast = np.zeros(len(pixels))
    # Later entries win, so the strongest edge of each pixel comes last.
    rising = np.argsort(strength, kind="stable")
    contrast[number[rising]] = strength[rising]
    scale = 1 / np.sqrt(contrast + 16)
    off = np.sqrt(np.einsum("pc,pc->p", residual, residual)) * scale
    weight = scale / np.sqrt(np.maximum(off / DOUBT, 1))
    cost = float(np.square(np.minimum(off, DOUBT)).sum())
    return _Misfit(pieces, number, residual * weight[:, None], weight, cost)


class _Problem(NamedTuple):
    pixel: np.ndarray        # (G,) touched pixel of each group of pieces
    step: np.ndarray         # (G, C) colour step, weighted
    slope: np.ndarray        # (G, 8) area moved per unit of each parameter
    index: np.ndarray        # (G, 8) parameters
    residual: np.ndarray     # (P, C) weighted
    damping: np.ndarray      # (X,)
    cost: float


def _linearise(wire: Wire, step: np.ndarray, target: Target) -> _Problem:
    """How each parameter would change the pixels."""
    pieces, number, residual, weight, cost = _misfit(wire, step, target)
    index, damping = _parameters(wire)
    begins = np.flatnonzero(np.r_[True, (np.diff(pieces.segment) != 0) | (np.diff(pieces.pixel) != 0)])
    segment, pixel = pieces.segment[begins], number[begins]
    slope = np.add.reduceat(_slopes(wire, pieces, _frames(wire)), begins, axis=0)
    return _Problem(pixel, step[segment] * weight[pixel, None], slope, index[segment], residual, damping, cost)


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


def _parameters(wire: Wire) -> Tuple[np.ndarray, np.ndarray]:
    """Numbers (S, 8) of the parameters of each segment, and the damping of all; number 0 is none.

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
                      place[wire.ends[:, 1], 0], place[wire.ends[:, 1], 1], own[:, 1, 0], second[:, 1]], axis=1)
    damping = np.full(1 + 3 * n + 4 * s, 0.05)
    damping[0] = 1e12
    length = np.einsum("sed,sed->se", wire.handles, wire.handles)
    damping[1 + 2 * n:1 + 3 * n] = 1e-3
    np.add.at(damping, angle[wire.ends], 0.05 * length)
    return index, damping


def _slopes(wire: Wire, pieces: Pieces, frame: np.ndarray) -> np.ndarray:
    """Area (M, 8) that each piece moves to the left colour per unit of its segment's parameters."""
    b = bezier.basis(pieces.t)
    line = wire.line[pieces.segment]
    begin = np.where(line, 1 - pieces.t, b[:, 0] + b[:, 1])
    normal = np.stack([-pieces.move[:, 1], pieces.move[:, 0]], axis=1)
    turned = np.einsum("mepd,md->mep", frame[pieces.segment], normal)
    slope = np.empty((len(b), 8))
    slope[:, 0:2] = begin[:, None] * normal
    slope[:, 2:4] = b[:, 1, None] * turned[:, 0]
    slope[:, 4:6] = (1 - begin)[:, None] * normal
    slope[:, 6:8] = b[:, 2, None] * turned[:, 1]
    return slope


def _solve(problem: _Problem) -> np.ndarray:
    """Parameters (X,) that lower the residual, by conjugate gradients on the normal equations."""
    n, p = len(problem.damping), len(problem.residual)
    flat = problem.index.ravel()

    def back(residual: np.ndarray) -> np.ndarray:
        pull = np.einsum("gc,gc->g", residual[problem.pixel], problem.step)
        return np.bincount(flat, (problem.slope * pull[:, None]).ravel(), n)

    def normal(x: np.ndarray) -> np.ndarray:
        area = np.einsum("gk,gk->g", problem.slope, x[problem.index])
        change = np.stack([np.bincount(problem.pixel, area * problem.step[:, c], p)
                           for c in range(problem.step.shape[1])], axis=1)
        return back(change) + problem.damping * x

    square = np.einsum("gc,gc->g", problem.step, problem.step)
    diagonal = np.bincount(flat, (problem.slope ** 2 * square[:, None]).ravel(), n) + problem.damping
    x = np.zeros(n)
    rest = back(problem.residual)
    rest[0] = 0
    direction = ahead = rest / diagonal
    size = rest.dot(ahead)
    for _ in range(STEPS):
        image = normal(direction)
        pace = size / max(direction.dot(image), 1e-300)
        x += pace * direction
        rest = rest - pace * image
        rest[0] = 0
        ahead = rest / diagonal
        grown = rest.dot(ahead)
        if grown <= 1e-6 * size:
            break
        direction = ahead + grown / size * direction
        size = grown
    return x


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
