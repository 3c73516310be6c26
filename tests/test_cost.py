# SPDX-License-Identifier: GPL-2.0-or-later
"""The costs of mesh edges."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from meshes import grey, pictures, ribbon_of

from ddtcore.cost import EdgeCost, framed_levels, mesh_cost, premultiplied_levels
from ddtcore.ribbon import edges_of
from ddtcore.triangulation import ribbon_mesh

RANDOM = np.random.RandomState(1)
FLAT = np.zeros((6, 100))
GRADIENTS = RANDOM.randint(-255, 256, (2, 6, 100)).astype(np.float64)


def cost_between(name: str, one: np.ndarray, other: np.ndarray) -> np.ndarray:
    cost = EdgeCost(name, len(one) // 2)
    return cost.between(cost.planes(one), cost.planes(other))


def test_yu_is_equation_1():
    one, other = GRADIENTS
    norms = np.linalg.norm(one, axis=0) * np.linalg.norm(other, axis=0)
    assert np.allclose(cost_between("yu", one, other), norms - (one * other).sum(axis=0))


def test_paper_is_equation_2_with_absolute_values():
    (a1, a2, a3, b1, b2, b3), (c1, c2, c3, d1, d2, d3) = GRADIENTS
    expected = sum((abs(a) + abs(b)) * (abs(c) + abs(d)) - (a * c + b * d)
                   for a, b, c, d in ((a1, b1, c1, d1), (a2, b2, c2, d2), (a3, b3, c3, d3)))
    assert np.array_equal(cost_between("paper", *GRADIENTS), expected)


@pytest.mark.parametrize("name", ["yu", "paper"])
def test_a_cost_is_symmetric_and_never_negative(name):
    one, other = GRADIENTS
    cost = cost_between(name, one, other)
    assert np.allclose(cost, cost_between(name, other, one))
    assert np.all(cost >= 0)
    assert np.all(cost_between(name, one, FLAT) == 0)


@pytest.mark.parametrize("name", ["yu", "paper"])
def test_a_quarter_turn_of_the_picture_leaves_the_cost(name):
    one, other = (np.concatenate([-g[3:], g[:3]]) for g in GRADIENTS)
    assert np.allclose(cost_between(name, one, other), cost_between(name, *GRADIENTS))


def test_only_yu_forgives_coplanar_triangles():
    one = GRADIENTS[0]
    assert np.allclose(cost_between("yu", one, one), 0)
    expected = 2 * np.abs(one[:3] * one[3:]).sum(axis=0)
    assert np.array_equal(cost_between("paper", one, one), expected)


def test_premultiplied_levels_round_and_forget_what_is_transparent():
    pixels = np.array([[10, 20, 30, 255], [200, 255, 1, 128], [9, 8, 7, 0]], np.uint8)
    expected = [[10, 20, 30, 255], [100, 128, 1, 128], [0, 0, 0, 0]]
    assert premultiplied_levels(pixels).tolist() == expected


def test_the_frame_repeats_the_nearest_pixel():
    levels = framed_levels(grey([[1, 2], [3, 4]])).reshape(4, 4, 4)[..., 0]
    assert levels.tolist() == [[1, 1, 2, 2], [1, 1, 2, 2], [3, 3, 4, 4], [3, 3, 4, 4]]


@given(pictures())
def test_planes_of_the_start_give_the_cost_of_the_mesh(image):
    for name in ("yu", "paper"):
        ribbon, quads = ribbon_of(image, cost=name)
        inner = edges_of(ribbon, np.arange(ribbon.outside))
        total = ribbon.cost.between(ribbon.planes_of(inner), ribbon.planes_of(ribbon.twins[inner])).sum()
        assert total == pytest.approx(mesh_cost(ribbon_mesh(ribbon, quads), image, name), abs=1e-3)
