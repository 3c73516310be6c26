# SPDX-License-Identifier: GPL-2.0-or-later
"""Areas whose labels do not explain them get labels of their own, and nothing else does."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import disc, draw, everywhere

from ddtcore import residue
from ddtcore.canvas import prepare
from ddtcore.components import cell_components

WHITE, GREY, BLACK = (255, 255, 255, 255), (120, 120, 120, 255), (0, 0, 0, 255)


def ring(radius, width):
    return lambda x, y: disc(40, 40, radius + width / 2)(x, y) & ~disc(40, 40, radius - width / 2)(x, y)


def labelled(image, colours):
    """A picture, known labels where pixels have one of two colours, and the second one everywhere else."""
    canvas = prepare(image)
    off = np.abs(image[..., None, :].astype(int) - np.array(colours)).sum(axis=-1)
    exact = np.where(off.min(axis=-1) == 0, off.argmin(axis=-1), -1).astype(np.int16)
    known = canvas.rimmed(exact, np.int16(-1))
    return canvas, known, canvas.rimmed(np.where(exact < 0, 1, exact).astype(np.int16), np.int16(-1))


def found(image, colours=(WHITE, BLACK), surfaces=(None, None)):
    canvas, known, labels = labelled(image, colours)
    cells, area = residue.unexplained_areas(canvas, known, labels, canvas.mixing(np.array(colours, float)), surfaces)
    return canvas, cells, area


@pytest.mark.parametrize("width", [2.0, 2.6, 4.0])
def test_a_grey_ring_is_not_a_black_one_that_covers_half(width):
    canvas, cells, area = found(draw(80, 80, [(WHITE, everywhere), (GREY, ring(25, width))]))
    assert cells.size >= 60 and (np.diff(cells) > 0).all()
    assert set(area.tolist()) == set(range(area.max() + 1))
    mean = residue.mean_of(canvas, cells, area)
    assert mean.shape == (area.max() + 1, 4) and np.abs(mean - GREY).max() < 40
    assert np.abs(np.average(mean, axis=0, weights=np.bincount(area)) - GREY).max() < 20


@pytest.mark.parametrize("width", [0.4, 0.7, 1.0])
def test_a_thin_black_ring_stays_black(width):
    _, cells, _ = found(draw(80, 80, [(WHITE, everywhere), (BLACK, ring(25, width))]))
    assert not cells.size


@pytest.mark.parametrize("top", [20.0, 20.25, 20.5])
def test_a_line_along_the_rows_may_cover_two_of_them_alike(top):
    _, cells, _ = found(draw(80, 80, [(WHITE, everywhere),
                                      (BLACK, lambda x, y: (y > top) & (y < top + 1.5) & (np.abs(x - 40) < 30))]))
    assert not cells.size


def test_edges_are_mixes_of_what_is_beside_them():
    _, cells, _ = found(draw(80, 80, [(WHITE, everywhere), (BLACK, disc(40, 40, 25.3))]))
    assert not cells.size


def test_specks_do_not_pay():
    _, cells, _ = found(draw(80, 80, [(WHITE, everywhere), (GREY, disc(40, 40, 1.3))]))
    assert not cells.size


def test_pixels_that_are_no_mixes_at_all_are_told_by_their_colours():
    """Two flat areas with other colours than their labels', too wide for any stroke: two areas."""
    red, blue = (200, 0, 0, 255), (0, 0, 200, 255)
    image = draw(80, 80, [(WHITE, everywhere), (red, disc(25, 40, 12)), (blue, disc(50, 40, 14))])
    canvas, cells, area = found(image)
    assert area.max() == 1
    mean = residue.mean_of(canvas, cells, area)
    assert all(np.abs(mean - colour).max(axis=1).min() < 12 for colour in (red, blue))
    for number in range(2):
        own = cells[area == number]
        assert cell_components(own, np.zeros(own.size), canvas.stride).max() == 0
