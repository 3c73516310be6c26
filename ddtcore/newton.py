# SPDX-License-Identifier: GPL-2.0-or-later
"""One Gauss-Newton step for many segments and pixels.

Nearly all pixels are touched by one segment alone: what they say is summed into a
block of that segment once.  Conjugate gradients then run over the blocks, and over
the few pixels that segments share.
"""

from __future__ import annotations

from typing import Callable, NamedTuple

import numpy as np

STEPS = 24
"""Conjugate gradient steps."""

ENOUGH = 1e-3
"""Share of the first residual, squared, at which to stop."""


class Problem(NamedTuple):
    """Where parameters would change pixels; a group is what one segment does in one pixel.

    Attributes
    ----------
    pixel : ndarray of shape (G,) and dtype int64
        Of each group.
    segment : ndarray of shape (G,) and dtype int64
        Rising.
    step : ndarray of shape (G, C)
        Change of the colour per area moved, weighted.
    slope : ndarray of shape (8, G)
        Area moved per unit of each of the segment's parameters.
    index : ndarray of shape (8, S) and dtype int64
        Which those are; number 0 is none.
    residual : ndarray of shape (P, C)
        What is left to explain in each pixel, weighted.
    damping : ndarray of shape (X,)
        Of each parameter.
    """

    pixel: np.ndarray
    segment: np.ndarray
    step: np.ndarray
    slope: np.ndarray
    index: np.ndarray  # type: ignore[assignment]  # hides a method of tuples
    residual: np.ndarray
    damping: np.ndarray


def solve(problem: Problem) -> np.ndarray:
    """Parameters that lower the residual, damped.

    Parameters
    ----------
    problem : Problem

    Returns
    -------
    ndarray of shape (X,)
    """
    n = len(problem.damping)
    touched, begins = np.unique(problem.segment, return_index=True)
    index = problem.index[:, touched]
    pull = np.einsum("gc,gc->g", problem.residual.take(problem.pixel, axis=0), problem.step)
    rest = np.bincount(index.ravel(), np.add.reduceat(problem.slope * pull, begins, axis=1).ravel(), n)
    rest[0] = 0
    strength = np.einsum("gc,gc->g", problem.step, problem.step)
    diagonal = np.add.reduceat(problem.slope ** 2 * strength, begins, axis=1)
    diagonal = np.bincount(index.ravel(), diagonal.ravel(), n) + problem.damping
    alone = np.bincount(problem.pixel, minlength=len(problem.residual))[problem.pixel] == 1
    blocks = _blocks(problem.slope, np.where(alone, strength, 0), begins)
    shared = _shared(problem, ~alone)

    def normal(x: np.ndarray) -> np.ndarray:
        own = np.einsum("ijs,js->is", blocks, x[index])
        change: np.ndarray = np.bincount(index.ravel(), own.ravel(), n) + shared(x) + problem.damping * x
        change[0] = 0
        return change

    return _conjugate_gradients(normal, rest, diagonal)


def _blocks(slope: np.ndarray, strength: np.ndarray, begins: np.ndarray) -> np.ndarray:
    """Normal matrices (8, 8, S) of the pixels that each segment has alone."""
    blocks = np.empty((8, 8, len(begins)))
    for i in range(8):
        blocks[i, i:] = blocks[i:, i] = np.add.reduceat(slope[i:] * (strength * slope[i]), begins, axis=1)
    return blocks


def _shared(problem: Problem, which: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
    """The product of the normal matrix of the pixels that segments share with parameters."""
    n = len(problem.damping)
    pixels, pixel = np.unique(problem.pixel[which], return_inverse=True)
    step, slope, index = problem.step[which], problem.slope[:, which], problem.index[:, problem.segment[which]]

    def product(x: np.ndarray) -> np.ndarray:
        area = np.einsum("kg,kg->g", slope, x[index])
        change = np.stack([np.bincount(pixel, area * part, len(pixels)) for part in step.T], axis=1)
        pull = np.einsum("gc,gc->g", change.take(pixel, axis=0), step)
        return np.bincount(index.ravel(), (slope * pull).ravel(), n)

    return product


def _conjugate_gradients(product: Callable[[np.ndarray], np.ndarray], rest: np.ndarray,
                         diagonal: np.ndarray) -> np.ndarray:
    """Solution of ``product(x) = rest``, preconditioned by the diagonal."""
    x = np.zeros(len(rest))
    direction = ahead = rest / diagonal
    size = start = _dot(rest, ahead)
    for _ in range(STEPS):
        image = product(direction)
        pace = size / max(_dot(direction, image), 1e-300)
        x += pace * direction
        rest = rest - pace * image
        ahead = rest / diagonal
        grown = _dot(rest, ahead)
        if grown <= ENOUGH * start:
            break
        direction = ahead + grown / size * direction
        size = grown
    return x


def _dot(a: np.ndarray, b: np.ndarray) -> float:
    """Their product, summed in one order whatever the number of processors."""
    return float(np.einsum("x,x->", a, b))
