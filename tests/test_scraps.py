# SPDX-License-Identifier: GPL-2.0-or-later
"""Small pieces on ramps that nobody would miss join what is round them; all others stay."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import prepare
from ddtcore.gradient import colours_at
from ddtcore.model import Gradient
from ddtcore.scraps import AREA, join_scraps
from ddtcore.surfaces import Surface

SIZE = 40
GRADIENT = Gradient("linear", (0.0, 0.0), (40.0, 10.0), ((0.0, (240, 120, 0), 1.0), (1.0, (250, 210, 60), 1.0)))
SURFACE = Surface(lambda points: colours_at(GRADIENT, points)[:, :3], GRADIENT)
ROW, COL = np.mgrid[:SIZE, :SIZE]
RAMP = colours_at(GRADIENT, np.stack([COL.ravel(), ROW.ravel()], axis=1) + 0.5).reshape(SIZE, SIZE, 4)
WHITE = COL >= 30


def joined(mask, change, thin=False, surface=SURFACE):
    """Labels of a ramp (1) and white (0) with a piece (2) that is darker, after scraps are joined."""
    rgba = np.where(WHITE[..., None], 255.0, RAMP)
    rgba[mask, :3] -= change
    canvas = prepare(np.clip(np.rint(rgba), 0, 255).astype(np.uint8))
    index = np.where(WHITE, 0, 1)
    index[mask] = 2
    labels = canvas.rimmed(index.astype(np.int32), 0)
    colours = np.array([[255, 245, 200], [255, 160, 100], [255, 30, 50]], np.float32)
    join_scraps(canvas, labels, colours, [None, surface, None], canvas.rimmed(np.full(mask.shape, thin) & mask, False))
    assert (labels >= 0).all()
    out = canvas.bare(labels)
    assert np.array_equal(out[~mask], index[~mask])
    return out[mask]


def block(height, width, row=15, col=12):
    return (abs(2 * (ROW - row) + 1 - height) < height) & (abs(2 * (COL - col) + 1 - width) < width)


@pytest.mark.parametrize("height, width", [(1, 1), (2, 3), (5, 2), (4, 4)])
def test_faint_pieces_join_the_ramp(height, width):
    assert (joined(block(height, width), 6) == 1).all()


@pytest.mark.parametrize("height, width", [(2, 2), (3, 4), (7, 7)])
@pytest.mark.parametrize("surface", [SURFACE, None])
def test_dots_that_stand_out_stay(height, width, surface):
    assert (joined(block(height, width), 100, surface=surface) == 2).all()


def test_mixes_on_an_edge_join_either_side():
    mask = block(6, 1, col=29)
    assert set(joined(mask, (RAMP[mask][:, :3] - 255) * 0.4)) <= {0, 1}


def test_an_even_piece_is_no_mix_even_of_colours_round_it():
    mask = block(6, 4, col=26)
    assert (joined(mask, (RAMP[mask][:, :3] - 255) * 0.5) == 2).all()


def test_large_pieces_and_thin_strokes_and_flat_art_stay():
    assert (joined(block(AREA // 5, 6), 5) == 2).all()
    assert (joined(block(1, 6), 5, thin=True) == 2).all()
    assert (joined(block(2, 3), 6, surface=None) == 2).all()
