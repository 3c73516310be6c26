# SPDX-License-Identifier: GPL-2.0-or-later
"""What is drawn on a ramp with an even, translucent colour gets the ramp's gradient seen through it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ddtcore.gradient import colours_at
from ddtcore.model import Gradient
from ddtcore.samples import Samples
from ddtcore.tint import beneath, cheaper, strengthened, tinted

STOPS = ((0.0, (255, 200, 40), 1.0), (0.4, (240, 150, 20), 1.0), (1.0, (200, 90, 0), 1.0))
BASES = [Gradient("linear", (0.0, 5.0), (60.0, 20.0), STOPS), Gradient("radial", (20.0, 50.0), (70.0, 50.0), STOPS),
         Gradient("radial", (20.0, 50.0), (70.0, 50.0), STOPS, (20.0, 20.0))]


def stroke(base, share, ink, cover=1.0):
    """Samples along a bent stroke of an ink on a ramp."""
    turn = np.linspace(0, 2, 150)
    points = np.stack([5 + 40 * np.sin(turn), 5 + 40 * np.cos(turn)], axis=1)
    below = colours_at(base, points)[:, :3]
    share = share * np.asarray(cover) * np.ones(len(points))
    colour = below + share[:, None] * (np.array(ink) - below)
    return Samples(points, np.rint(colour), np.ones(len(points)))


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("share, ink", [(0.15, (255, 255, 255)), (0.4, (90, 0, 0)), (0.08, (0, 0, 0))])
def test_colour_and_share_are_found(base, share, ink):
    samples = stroke(base, share, ink)
    found = tinted(base, samples)
    assert replace(found, stops=base.stops) == base
    assert np.abs(colours_at(found, samples.points)[:, :3] - samples.colour).max() <= 2


@pytest.mark.parametrize("base", BASES)
def test_pixels_covered_in_part_hardly_matter(base):
    cover = np.where(np.arange(150) % 8 == 0, 0.4, 1.0)
    full = stroke(base, 0.5, (90, 0, 0))
    found = tinted(base, stroke(base, 0.5, (90, 0, 0), cover))
    assert np.abs(colours_at(found, full.points)[:, :3] - full.colour).max() <= 8


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize("share, ink", [(0.5, (90, 0, 0)), (0.3, (255, 255, 255))])
def test_tips_that_are_covered_in_part_take_nothing_from_the_contrast(base, share, ink):
    full = stroke(base, share, ink)
    samples = stroke(base, share, ink, np.clip(np.linspace(1.6, 0.2, 150), 0, 1))
    tint = tinted(base, samples)
    off = [np.abs(colours_at(some, full.points)[:, :3] - full.colour).max()
           for some in (tint, strengthened(tint, base, samples))]
    assert off[1] <= 4 < off[0]


@pytest.mark.parametrize("base", BASES)
def test_a_tint_that_is_covered_in_full_stays(base):
    samples = stroke(base, 0.3, (90, 0, 0))
    tint = tinted(base, samples)
    before, after = (colours_at(some, samples.points) for some in (tint, strengthened(tint, base, samples)))
    assert np.abs(before - after).max() <= 2


def test_alpha_beside_an_opaque_thing_changes_nothing():
    """Other ramps of the picture may be translucent: all samples have a fourth channel then."""
    base = BASES[0]
    samples = stroke(base, 0.3, (90, 0, 0))
    alpha = np.full((len(samples.points), 1), 255.0)
    with_alpha = samples._replace(colour=np.concatenate([samples.colour, alpha], axis=1))
    tint = tinted(base, samples)
    assert strengthened(tint, base, with_alpha) == strengthened(tint, base, samples)
    other = replace(base, end=(40.0, 30.0))
    assert cheaper(other, tint, base, with_alpha) == cheaper(other, tint, base, samples)


def test_what_is_no_tint_at_all_is_not_strengthened():
    samples = stroke(BASES[0], 0.0, (0, 0, 0))
    assert np.abs(colours_at(strengthened(BASES[0], BASES[0], samples), samples.points)[:, :3]
                  - samples.colour).max() <= 2


def test_an_opaque_colour_is_a_tint_of_share_one():
    found = tinted(BASES[0], stroke(BASES[0], 1.0, (10, 20, 200)))
    assert {rgb for _, rgb, _ in found.stops} == {(10, 20, 200)}


def test_nothing_translucent_is_tinted():
    samples = stroke(BASES[0], 0.2, (0, 0, 0))
    faded = replace(BASES[0], stops=((0.0, (255, 0, 0), 0.5), (1.0, (0, 0, 0), 1.0)))
    assert tinted(faded, samples) is None
    alpha = np.full((len(samples.points), 1), 200.0)
    assert tinted(BASES[0], samples._replace(colour=np.concatenate([samples.colour, alpha], axis=1))) is None


def test_the_tint_is_preferred_to_luck_and_its_own_gradient_to_a_wrong_tint():
    base = BASES[1]
    samples = stroke(base, 0.2, (255, 255, 255))
    tint = tinted(base, samples)
    other = replace(base, start=(21.0, 50.0))
    assert cheaper(other, tint, base, samples) == strengthened(tint, base, samples)
    own = Gradient("linear", (0.0, 0.0), (45.0, 0.0), ((0.0, (0, 0, 255), 1.0), (1.0, (0, 255, 0), 1.0)))
    samples = samples._replace(colour=colours_at(own, samples.points)[:, :3])
    assert cheaper(own, tinted(base, samples), base, samples) is own


def test_the_ramp_that_is_met_most_lies_beneath():
    regions = np.zeros((20, 40), np.int32)
    regions[:, 30:] = 1
    regions[8:11, 2:34] = 2
    regions[9, 15] = 3
    cells = np.flatnonzero(regions == 2)
    assert beneath(regions, cells, [BASES[0], BASES[1], None, None]) is BASES[0]
    assert beneath(regions, cells, [None, BASES[1], None, None]) is BASES[1]
    assert beneath(regions, cells, [None] * 4) is None
