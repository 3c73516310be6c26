# SPDX-License-Identifier: GPL-2.0-or-later
"""Strips along the border: whose mixes they are, and where edges leave the picture."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import box, disc, draw, everywhere, half_plane, palette_of

from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

WHITE, BLACK, GREY = (255, 255, 255, 255), (0, 0, 0, 255), (128, 128, 128, 255)
RED, BLUE = (200, 30, 40, 255), (40, 60, 180, 255)
TURNS = [lambda a: a, np.flipud, np.rot90, lambda a: np.rot90(a, 3)]


def labelled(layers, turn=lambda a: a, height=40, width=60):
    """The colours that a picture's labels paint, uint8 (H, W, 4), and where they are thin; turned back."""
    labels = label_pixels(np.ascontiguousarray(turn(draw(height, width, layers))), TraceOptions())
    # Turning by a quarter and by three quarters undo each other, as flipping undoes itself.
    back = {TURNS[2]: TURNS[3], TURNS[3]: TURNS[2]}.get(turn, turn)
    return back(np.rint(labels.palette).astype(np.uint8)[labels.index]), back(labels.thin)


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("share", [0.125, 0.25, 0.45])
def test_a_frame_of_less_than_half_a_pixel_has_its_colour(turn, share):
    layers = [(BLACK, everywhere), (WHITE, box(0, share, 60, 40)), (RED, box(20, 10, 30, 20)),
              (BLACK, disc(45, 25, 8))]
    shown, thin = labelled(layers, turn)
    np.testing.assert_array_equal((shown[0] == BLACK).all(axis=-1), True)
    assert thin[0].all() and (shown[1] == WHITE).all()


@pytest.mark.parametrize("turn", TURNS)
@pytest.mark.parametrize("slope", [0.01, 0.03, 0.08])
def test_a_flat_edge_leaves_where_it_meets_the_border(turn, slope):
    """The wedge beyond the edge is thinner than half a pixel for half a pixel's worth of slope."""
    layers = [(BLACK, everywhere), (WHITE, half_plane(24, 0, slope)), (RED, box(20, 25, 30, 35)),
              (BLACK, disc(45, 28, 6))]
    shown, _ = labelled(layers, turn)
    black = (shown[0] == BLACK).all(axis=-1)
    # Right of x = 24 the coverage of black rises by the slope from column to column.
    assert black[24 + int(0.12 / slope) + 2:].all() and not black[:24].any()


@pytest.mark.parametrize("angle", [0.3, 0.8, 1.3, np.pi / 2, 2.0])
def test_steep_edges_are_left_alone(angle):
    image = draw(40, 60, [(WHITE, everywhere), (BLACK, half_plane(30.2, 0, angle))])
    labels = label_pixels(image, TraceOptions())
    black = np.rint(labels.palette).astype(int)[labels.index][..., 0] == 0
    rows, cols = np.nonzero((image[..., 0] < 120) != black)
    assert not np.isin(rows, [0, 39]).any() or np.abs(image[rows, cols, 0].astype(int) - 127).max() < 70


def test_the_colour_that_goes_on_beside_the_strip_wins():
    """A strip of grey before black could as well be half as much white, which is more frequent."""
    layers = [(WHITE, everywhere), (BLACK, box(0, 0, 60, 30)), (GREY, box(0, 0, 20, 12)),
              (GREY, box(0, 0, 50, 0.45)), (GREY, box(10, 33, 20, 38))]
    shown, _ = labelled(layers)
    assert (shown[0, :50] == GREY).all(axis=-1).sum() >= 49
    layers[3] = (WHITE, box(0, 0, 60, 0.125))
    layers[2] = (BLACK, box(0, 0, 1, 1))
    assert (labelled(layers)[0][0] == WHITE).all()


def test_what_no_mix_explains_stays():
    image = draw(40, 60, [(WHITE, everywhere), (BLACK, box(0, 0, 60, 30.3)), (RED, disc(20, 15, 6))])
    image[0, :, :3] = 60, 20, 20
    shown = label_pixels(image, TraceOptions())
    assert palette_of(shown) == {WHITE, BLACK, RED}
    assert not shown.thin[0].any()


def test_a_strip_of_nothing_is_nothing():
    shown, thin = labelled([(BLUE, box(5, 5, 55, 39.7))])
    assert (shown[39, 8:52, 3] == 0).all() and thin[39, 8:52].all()
    assert (shown[38, 8:52] == BLUE).all()
