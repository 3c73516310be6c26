# SPDX-License-Identifier: GPL-2.0-or-later
"""The start: quads split by their cheaper diagonals."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from invariants import assert_valid_mesh
from meshes import exact_labels, grey, one_label, pictures

from ddtcore.cost import EdgeCost
from ddtcore.model import Labels, Mesh
from ddtcore.quads import choose_slash, colour_steps, half_edges, split_planes


def split(image: np.ndarray, labels: Labels, cost: str = "yu") -> np.ndarray:
    """Which quads of the framed grid are split by the slash, bool (H + 1, W + 1)."""
    shape = image.shape[0] + 1, image.shape[1] + 1
    quads = np.arange(shape[0] * shape[1])
    return choose_slash(image, labels, quads, colour_steps(image, quads), cost).reshape(shape)


@given(pictures())
def test_the_cheaper_diagonal_is_chosen(image):
    quads = np.arange((image.shape[0] + 1) * (image.shape[1] + 1))
    steps = colour_steps(image, quads)
    for name in ("yu", "paper"):
        cost = EdgeCost(name, len(steps.top))
        costs = []
        for slash in (np.zeros(len(quads), bool), np.ones(len(quads), bool)):
            planes = split_planes(steps, slash, cost)
            costs.append(cost.between(planes[:, ::2], planes[:, 1::2]))
        chosen = split(image, one_label(image), name).ravel()
        assert np.all(np.where(chosen, costs[1], costs[0]) <= np.minimum(*costs) + 1e-6)


@given(pictures())
def test_any_choice_of_quads_and_diagonals_is_a_valid_mesh(image):
    random = np.random.RandomState(image.size)
    chosen = random.rand(image.shape[0] + 1, image.shape[1] + 1) < 0.6
    quads = np.flatnonzero(chosen)
    triangles, twins = half_edges(quads, random.rand(len(quads)) < 0.5, chosen.shape)
    assert_valid_mesh(Mesh(shape=(image.shape[0] + 2, image.shape[1] + 2), quads=chosen,
                           triangles=triangles.astype(np.int32), twins=twins.astype(np.int32)))


@pytest.mark.parametrize("cost", ["yu", "paper"])
@pytest.mark.parametrize("levels, slash", [
    ([[255, 0], [0, 0]], True), ([[0, 0], [0, 255]], True),
    ([[0, 255], [0, 0]], False), ([[0, 0], [255, 0]], False),
])
def test_a_corner_is_cut_off(levels, slash, cost):
    image = grey(levels)
    assert split(image, one_label(image), cost)[1, 1] == slash


@pytest.mark.parametrize("ink, page", [(0, 255), (255, 0)])
def test_a_stroke_of_diagonal_pixels_stays_whole(ink, page):
    levels = np.full((8, 8), page)
    np.fill_diagonal(levels, ink)
    image = grey(levels)
    assert not split(image, one_label(image))[np.arange(1, 8), np.arange(1, 8)].any()
    assert split(image[:, ::-1], one_label(image))[np.arange(1, 8), np.arange(7, 0, -1)].all()


def test_a_thin_diagonal_is_kept_at_any_cost():
    image = grey([[0, 200], [0, 0]])
    labels = exact_labels(grey([[0, 9], [9, 0]]))
    assert not split(image, labels)[1, 1]
    labels.thin[0, 1] = True
    assert split(image, labels)[1, 1]
    labels.thin[1, 1] = True
    assert not split(image, labels)[1, 1], "both diagonals are thin: the cost decides"


@given(pictures())
def test_a_quarter_turn_of_the_picture_turns_the_diagonals(image):
    turned = np.ascontiguousarray(np.rot90(image))
    quads = np.arange((image.shape[0] + 1) * (image.shape[1] + 1))
    steps = colour_steps(image, quads)
    size = [(step.astype(np.int64) ** 2).sum(axis=0) for step in steps]
    decided = ((size[0] - size[1]) * (size[2] - size[3])).reshape(image.shape[0] + 1, -1) != 0
    agree = np.rot90(split(image, one_label(image))) != split(turned, one_label(turned))
    assert np.all(agree | ~np.rot90(decided))
