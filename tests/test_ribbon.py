# SPDX-License-Identifier: GPL-2.0-or-later
"""Half-edges, and what a flip does to them."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from invariants import assert_valid_mesh
from meshes import exact_labels, pictures, ribbon_of

from ddtcore.cost import EdgeCost, mesh_cost
from ddtcore.model import Labels
from ddtcore.options import TraceOptions
from ddtcore.ribbon import Ribbon, corners, edges_of, flip_edges, flippable
from ddtcore.triangulation import ribbon_mesh, start_ribbon


def all_edges(ribbon: Ribbon) -> np.ndarray:
    return edges_of(ribbon, np.arange(ribbon.outside))


def flip_at_random(ribbon: Ribbon, times: int, seed: int) -> None:
    random = np.random.RandomState(seed)
    for _ in range(times):
        edges = all_edges(ribbon)
        able, _ = flippable(ribbon, corners(ribbon, edges))
        if len(able):
            flip_edges(ribbon, edges[random.choice(able, 1)])


def strictly_convex(ribbon: Ribbon, edges: np.ndarray) -> np.ndarray:
    """Whether p s q r turns the same way at all four corners."""
    p, q, r, s = (np.stack(np.divmod(v, ribbon.columns)) for v in corners(ribbon, edges))
    around = (p, s, q, r)
    turns = []
    for i in range(4):
        one, other = around[i] - around[i - 1], around[(i + 1) % 4] - around[i]
        turns.append(one[1] * other[0] - one[0] * other[1])
    return (np.stack(turns) > 0).all(axis=0)


@given(pictures(), st.integers(0, 30), st.sampled_from(["yu", "paper"]))
def test_flips_keep_the_mesh_valid_and_its_planes_exact(image, times, name):
    ribbon, quads = ribbon_of(image, cost=name)
    flip_at_random(ribbon, times, seed=times)
    mesh = ribbon_mesh(ribbon, quads)
    assert_valid_mesh(mesh)
    inner = all_edges(ribbon)
    total = ribbon.cost.between(ribbon.planes_of(inner), ribbon.planes_of(ribbon.twins[inner])).sum()
    assert total == pytest.approx(mesh_cost(mesh, image, name), rel=1e-12, abs=1e-6)
    gradients = ribbon.cost.gradients(ribbon.planes)
    assert np.array_equal(gradients, np.round(gradients))


@given(pictures(), st.integers(0, 30))
def test_exactly_convex_quadrilaterals_of_pixels_are_flippable(image, times):
    ribbon, _ = ribbon_of(image)
    flip_at_random(ribbon, times, seed=times)
    edges = all_edges(ribbon)
    able, _ = flippable(ribbon, corners(ribbon, edges))
    in_picture = ribbon.labels[np.stack(corners(ribbon, edges))].min(axis=0) >= 0
    assert np.array_equal(able, np.flatnonzero(strictly_convex(ribbon, edges) & in_picture))


@given(pictures())
def test_at_boundaries_only_edges_among_several_labels_are_flippable(image):
    ribbon, _ = ribbon_of(image, everywhere=False)
    edges = all_edges(ribbon)
    around = corners(ribbon, edges)
    labels = ribbon.labels[np.stack(around)]
    several = (labels != labels[0]).any(axis=0) & (labels.min(axis=0) >= 0)
    able, _ = flippable(ribbon, around)
    assert np.array_equal(able, np.flatnonzero(several & strictly_convex(ribbon, edges)))


@given(pictures())
def test_edges_along_thin_strokes_are_not_flippable(image):
    exact = exact_labels(image)
    labels = Labels(exact.index, exact.palette, np.random.RandomState(0).rand(*image.shape[:2]) < 0.3)
    ribbon, _ = start_ribbon(image, labels, TraceOptions(flips="everywhere"))
    edges = all_edges(ribbon)
    able, (p, q, _, _) = flippable(ribbon, corners(ribbon, edges))
    thin, index = np.pad(labels.thin, 1).ravel(), np.pad(labels.index, 1).ravel()
    assert not np.any((index[p] == index[q]) & (thin[p] | thin[q]))
    ribbon.thin[:] = False
    without, _ = flippable(ribbon, corners(ribbon, edges))
    assert set(able) <= set(without)
    p, q, _, _ = corners(ribbon, edges[np.setdiff1d(without, able)])
    assert np.all((index[p] == index[q]) & (thin[p] | thin[q]))


def test_two_flips_of_an_edge_bring_it_back():
    image = np.random.RandomState(0).randint(0, 256, (6, 7, 4)).astype(np.uint8)
    ribbon, quads = ribbon_of(image)
    edges = all_edges(ribbon)
    able, _ = flippable(ribbon, corners(ribbon, edges))
    before = ribbon_mesh(ribbon, quads)
    planes = ribbon.planes.copy()
    edge = edges[able[:1]]
    flip_edges(ribbon, edge)
    twin = ribbon.twins[edge // 3 * 3 + (edge % 3 + 1) % 3]
    assert not np.array_equal(ribbon_mesh(ribbon, quads).triangles, before.triangles)
    flip_edges(ribbon, twin)
    assert set(map(tuple, np.sort(ribbon_mesh(ribbon, quads).triangles, axis=1).tolist())) == set(
        map(tuple, np.sort(before.triangles, axis=1).tolist()))
    assert np.array_equal(np.sort(ribbon.planes, axis=1), np.sort(planes, axis=1))


def test_a_cost_without_channels_is_zero():
    cost = EdgeCost("yu", 0)
    planes = cost.planes(np.zeros((0, 3)))
    assert planes.tolist() == [[0, 0, 0]] and cost.between(planes, planes).tolist() == [0, 0, 0]
