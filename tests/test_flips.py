# SPDX-License-Identifier: GPL-2.0-or-later
"""Gains of flips and pairs of flips, and the rounds."""

from __future__ import annotations

import copy

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from invariants import assert_valid_mesh
from meshes import CLIP_ART, clip_art, one_label, pictures, ribbon_of

from ddtcore.cost import mesh_cost
from ddtcore.flips import LEAST_GAIN, flip_rounds, pair_gains, single_gains
from ddtcore.options import TraceOptions
from ddtcore.ribbon import Ribbon, corners, edges_of, flip_edges, flippable
from ddtcore.triangulation import ribbon_mesh, start_ribbon

ENOUGH = 10 ** 12


def all_edges(ribbon: Ribbon) -> np.ndarray:
    return edges_of(ribbon, np.arange(ribbon.outside))


def flip_by_hand(ribbon: Ribbon, ends) -> bool:
    """Flip the edge with these ends, if possible."""
    edges = all_edges(ribbon)
    p, q, _, _ = corners(ribbon, edges)
    edge = edges[((p == ends[0]) & (q == ends[1])) | ((p == ends[1]) & (q == ends[0]))]
    able, _ = flippable(ribbon, corners(ribbon, edge))
    flip_edges(ribbon, edge[able])
    return len(able) == 1


def cost_after(ribbon, quads, image, *edges) -> float:
    """Total cost once edges, given by their ends, are flipped in turn; inf if impossible."""
    trial = copy.deepcopy(ribbon)
    if not all(flip_by_hand(trial, ends) for ends in edges):
        return np.inf
    return mesh_cost(ribbon_mesh(trial, quads), image, ribbon.cost.name)


@settings(max_examples=25)
@given(pictures(longest=5), st.sampled_from(["yu", "paper"]), st.integers(0, 2))
def test_gains_are_what_the_total_cost_falls_by(image, name, rounds):
    ribbon, quads = ribbon_of(image, cost=name)
    for _ in zip(range(rounds), flip_rounds(ribbon, ENOUGH)):
        pass
    edges = all_edges(ribbon)
    p, q, r, s = corners(ribbon, edges)
    before = mesh_cost(ribbon_mesh(ribbon, quads), image, name)
    singles, pairs = single_gains(ribbon, edges), pair_gains(ribbon, edges)
    for i in np.random.RandomState(0).permutation(len(edges))[:12]:
        single = before - cost_after(ribbon, quads, image, (p[i], q[i]))
        assert singles[i] == pytest.approx(single, abs=1e-5)
        for side, ends in enumerate(((r, p), (p, s), (s, q), (q, r))):
            pair = before - cost_after(ribbon, quads, image, (p[i], q[i]), (ends[0][i], ends[1][i]))
            # Where the second flip would change nothing, the pair is not looked at.
            assert pairs[side, i] == pytest.approx(pair, abs=1e-5) or (
                pairs[side, i] == -np.inf and pair == pytest.approx(single, abs=1e-5))


@pytest.mark.parametrize("look_ahead", [False, True])
@pytest.mark.parametrize("name", ["yu", "paper"])
@pytest.mark.parametrize("art", CLIP_ART)
def test_the_total_cost_falls_with_every_round_to_a_local_optimum(art, name, look_ahead):
    image = clip_art(art, shrink=4)
    options = TraceOptions(cost=name, flips="everywhere")
    ribbon, quads = start_ribbon(image, one_label(image), options)
    cost, flips = mesh_cost(ribbon_mesh(ribbon, quads), image, name), 0
    for flipped in flip_rounds(ribbon, ENOUGH, look_ahead):
        mesh = ribbon_mesh(ribbon, quads)
        lower = mesh_cost(mesh, image, name)
        assert lower < cost
        cost, flips = lower, flips + flipped
    assert flips == mesh.flips > 500
    assert_valid_mesh(mesh)
    edges = all_edges(ribbon)
    assert single_gains(ribbon, edges).max() <= LEAST_GAIN
    assert ribbon.finished
    if look_ahead:
        assert pair_gains(ribbon, edges).max() <= LEAST_GAIN


@given(pictures())
def test_noise_comes_to_an_end_as_well(image):
    ribbon, quads = ribbon_of(image)
    cost = mesh_cost(ribbon_mesh(ribbon, quads), image, "yu")
    for _ in flip_rounds(ribbon, ENOUGH, look_ahead=True):
        lower = mesh_cost(ribbon_mesh(ribbon, quads), image, "yu")
        assert lower < cost
        cost = lower
    assert_valid_mesh(ribbon_mesh(ribbon, quads))
    assert single_gains(ribbon, all_edges(ribbon)).max(initial=0) <= LEAST_GAIN
    assert pair_gains(ribbon, all_edges(ribbon)).max(initial=0) <= LEAST_GAIN


def test_look_ahead_finds_what_single_flips_do_not():
    image = clip_art("stegosaurus", shrink=4)
    options = TraceOptions(flips="everywhere")
    ribbon, quads = start_ribbon(image, one_label(image), options)
    for _ in flip_rounds(ribbon, ENOUGH):
        pass
    single = mesh_cost(ribbon_mesh(ribbon, quads), image, "yu")
    for _ in flip_rounds(ribbon, ENOUGH, look_ahead=True):
        pass
    assert mesh_cost(ribbon_mesh(ribbon, quads), image, "yu") < 0.95 * single


@pytest.mark.parametrize("budget", [0, 1, 1000, 20000])
@pytest.mark.parametrize("look_ahead", [False, True])
def test_a_budget_that_bites_is_kept_and_told(budget, look_ahead):
    image = np.random.RandomState(0).randint(0, 256, (40, 40, 4)).astype(np.uint8)
    ribbon, quads = ribbon_of(image)
    rounds = list(flip_rounds(ribbon, budget, look_ahead))
    assert not ribbon.finished
    assert ribbon.work <= budget
    assert sum(rounds) == ribbon.flips
    assert ribbon.flips > 0 or budget < 20000
    assert_valid_mesh(ribbon_mesh(ribbon, quads))


def test_equal_gains_do_not_wait_for_each_other():
    # A stroke of slope 1/2: along it all gains are the same.
    rows, cols = np.mgrid[:200, :400]
    image = np.where((rows * 2 - cols)[..., np.newaxis] > 0, 255, 0) * np.ones(4)
    image[..., 3] = 255
    ribbon, _ = ribbon_of(image.astype(np.uint8))
    assert len(list(flip_rounds(ribbon, ENOUGH))) < 12
