# SPDX-License-Identifier: GPL-2.0-or-later
"""Strokes too thin to have a fully covered pixel: which colour each has, told along it."""

from __future__ import annotations

from typing import Tuple

import numpy as np

from .canvas import Canvas
from .components import next_among, places_among
from .mixes import dot, length, third_share
from .noise import ROUNDING
from .ridges import LEAST, Ridges
from .sides import window

FAINT = 0.16
"""Smallest coverage of a stroke's pixel."""

FAINTER = 0.09
"""Smallest coverage of a pixel that continues a stroke."""

COLOURS = 32
"""How many colours are weighed for strokes."""

_ROUNDS = 8


def stroke_labels(canvas: Canvas, ridges: Ridges, colours: np.ndarray, labels: np.ndarray,
                  noise: float) -> Tuple[np.ndarray, np.ndarray]:
    """The colour of each ridge pixel's stroke.

    Neighbours along the stroke decide together: the colour has to explain them all.

    Parameters
    ----------
    colours : ndarray of shape (C, K) and dtype float32
        Premultiplied palette.
    labels : ndarray of shape (P,)
        Known labels with the rim, negative where unknown.
    noise : float
        How much flat areas vary, levels: the more, the less a faint stroke is believed.

    Returns
    -------
    label : ndarray of shape (R,) and dtype int32
        Label of the stroke, -1 where no colour explains the pixel.
    share : ndarray of shape (R,) and dtype float32
        Coverage of the stroke.
    """
    if not ridges.cells.size or not colours.shape[1]:
        return np.full(ridges.cells.size, -1, np.int32), np.zeros(ridges.cells.size, np.float32)
    chosen = _frequent(ridges, colours)
    colours = colours[:, chosen]
    beside, share = third_share(ridges.colour, ridges.one, ridges.other, colours)
    height = ridges.height
    cost = np.minimum(beside, 60) + 5 * ~_near(canvas, ridges.cells, labels, chosen)
    base = ridges.colour - ridges.off
    cost += 40 * (dot(base, base)[:, None] - 2 * base.T @ colours + dot(colours, colours) < 400)
    vote = _along_strokes(canvas, ridges, cost * np.minimum(height, 120)[:, None])
    choice = np.argmin(vote + 0.3 * beside, axis=1)
    rows = np.arange(choice.size)
    beside, share = beside[rows, choice], share[rows, choice]
    doubt = (noise - ROUNDING) / 100
    clear = (length(ridges.one - ridges.other) < LEAST) & (height > 2 * LEAST)
    good = (beside < 0.25 * height + 10) & (share > np.where(clear, FAINTER, FAINT) + doubt)
    label = np.where(good, chosen[choice], -1).astype(np.int32)
    strong = share > FAINT + doubt
    label[~strong & ~_continuing(canvas, ridges.cells, label, strong, labels)] = -1
    return label, share


def _continuing(canvas: Canvas, cells: np.ndarray, label: np.ndarray, strong: np.ndarray,
                labels: np.ndarray) -> np.ndarray:
    """Which ridge pixels lead to strong ones through others of the same label, away from areas of it, bool (R,)."""
    ring = window(canvas.stride, 1, 1)[:, None]
    weak = np.flatnonzero(~strong & (label >= 0))
    weak = weak[(labels[cells[weak] + ring] != label[weak]).all(axis=0)]
    beside = places_among(cells, cells[weak] + ring)
    # The last one stands for pixels that are no ridges.
    stroke = np.append(np.where(strong, label, -1), -1)
    for _ in range(_ROUNDS):
        led = (stroke[beside] == label[weak]).any(axis=0)
        stroke[weak[led]] = label[weak[led]]
        weak, beside = weak[~led], beside[:, ~led]
    return stroke[:-1] >= 0


def lone_corners(labels: np.ndarray, thin: np.ndarray, cells: np.ndarray, stride: int) -> np.ndarray:
    """Which stroke pixels neither connect nor continue anything: mere corners of an area.

    Round them their label appears in one run or not at all, and no neighbour is a pixel of
    the same stroke that connects something.
    """
    ring = np.array([-stride - 1, -stride, -stride + 1, 1, stride + 1, stride, stride - 1, -1])
    near = cells + ring[:, None]
    connecting = thin[near] & (labels[near] == labels[cells])
    # Two pixels that touch across a corner are connected without the one between them.
    connecting[connecting] = _runs(labels, near[connecting], ring, True) > 1
    return np.asarray((_runs(labels, cells, ring, False) <= 1) & ~connecting.any(axis=0))


def _runs(labels: np.ndarray, cells: np.ndarray, ring: np.ndarray, diagonal: bool) -> np.ndarray:
    """In how many runs the label of each pixel appears in the ring of its neighbours, which begins at a corner.

    With `diagonal` a run goes on across a corner of another label.
    """
    same = labels[cells + ring[:, None]] == labels[cells]
    if diagonal:
        same[::2] |= np.roll(same[1::2], 1, axis=0) & same[1::2]
    return np.asarray((same & ~np.roll(same, 1, axis=0)).sum(axis=0))


def _frequent(ridges: Ridges, colours: np.ndarray) -> np.ndarray:
    """Numbers of at most `COLOURS` colours, those that explain most of a sample of ridge pixels best."""
    count = colours.shape[1]
    if count <= COLOURS:
        return np.arange(count)
    sample = ridges.some(np.arange(0, ridges.cells.size, max(1, ridges.cells.size // 4096)))
    beside, _ = third_share(sample.colour, sample.one, sample.other, colours)
    wins = np.bincount(beside.argmin(axis=1), minlength=count)
    return np.sort(np.argsort(-wins, kind="stable")[:COLOURS])


def _near(canvas: Canvas, cells: np.ndarray, labels: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Which of the labels `chosen` occur within 5 x 5 of pixels, bool (N, K)."""
    place = np.full(max(int(labels.max()), int(chosen.max())) + 2, chosen.size)
    place[chosen] = np.arange(chosen.size)
    near = np.zeros((cells.size, chosen.size + 1), bool)
    rows = np.arange(cells.size)
    for step in window(canvas.stride, 1, 2):
        near[rows, place[labels[cells + step]]] = True
    return near[:, :-1]


def _along_strokes(canvas: Canvas, ridges: Ridges, vote: np.ndarray) -> np.ndarray:
    """Average votes (R, K) over neighbouring ridge pixels that stand out in the same direction."""
    unit = ridges.off / ridges.height
    total = np.ones((len(vote), 1), np.float32)
    links = []
    for step in window(canvas.stride, 1, 1):
        other = next_among(ridges.cells, step)
        agree = dot(unit, unit[:, other])
        rows = np.flatnonzero((other >= 0) & (agree > 0))
        weight = (agree[rows] ** 2)[:, None]
        total[rows] += weight
        links.append((rows, other[rows], weight))
    for _ in range(_ROUNDS):
        mean = vote.copy()
        for rows, other, weight in links:
            mean[rows] += weight * vote[other]
        vote = mean / total
    return vote
