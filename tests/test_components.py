# SPDX-License-Identifier: GPL-2.0-or-later
"""Connected components against a plain search, node by node."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.components import (
    block_areas,
    cell_components,
    components,
    label_components,
    link_components,
    linked_areas,
    mask_areas,
    next_among,
    places_among,
)


def search(n, a, b):
    """Components by depth-first search, numbered in the order of their first nodes."""
    neighbours = [[] for _ in range(n)]
    for i, j in zip(a, b):
        neighbours[i].append(j)
        neighbours[j].append(i)
    number = [-1] * n
    count = 0
    for first in range(n):
        if number[first] >= 0:
            continue
        number[first], stack = count, [first]
        while stack:
            for other in neighbours[stack.pop()]:
                if number[other] < 0:
                    number[other] = count
                    stack.append(other)
        count += 1
    return np.array(number, np.int32)


def grid_edges(right, down, down_right, down_left):
    pixel = np.arange(right.shape[0] * down.shape[1]).reshape(right.shape[0], down.shape[1])
    sides = [(pixel[:, :-1], pixel[:, 1:], right), (pixel[:-1], pixel[1:], down),
             (pixel[:-1, :-1], pixel[1:, 1:], down_right), (pixel[:-1, 1:], pixel[1:, :-1], down_left)]
    return (np.concatenate([p[k][link] for *p, link in sides]) for k in (0, 1))


@pytest.mark.parametrize("seed", range(20))
def test_random_graphs_agree_with_search(seed):
    rng = np.random.RandomState(seed)
    n = rng.randint(1, 300)
    a, b = rng.randint(0, n, (2, rng.randint(0, 2 * n)))
    np.testing.assert_array_equal(components(n, a, b), search(n, a, b))


@pytest.mark.parametrize("order", ["rising", "falling", "mixed"])
@pytest.mark.parametrize("graph", ["star", "path", "comb"])
def test_long_graphs_are_one_component_in_few_rounds(graph, order, monkeypatch):
    n = 20001
    nodes = {"rising": np.arange(n), "falling": np.arange(n)[::-1],
             "mixed": np.random.RandomState(1).permutation(n)}[order]
    a, b = {"star": (np.full(n - 1, 0), np.arange(1, n)),
            "path": (np.arange(n - 1), np.arange(1, n)),
            "comb": (np.arange(1, n) // 2, np.arange(1, n))}[graph]
    rounds = []
    from ddtcore import components as module
    flatten = module._flatten
    monkeypatch.setattr(module, "_flatten", lambda parent: (rounds.append(1), flatten(parent)))
    assert not components(n, nodes[a], nodes[b]).any()
    assert len(rounds) < 40


def test_no_edges_and_no_nodes():
    none = np.empty(0, int)
    np.testing.assert_array_equal(components(3, none, none), [0, 1, 2])
    assert components(0, none, none).shape == (0,)


@pytest.mark.parametrize("seed", range(20))
def test_linked_grids_agree_with_search(seed):
    rng = np.random.RandomState(seed)
    h, w = rng.randint(1, 14, 2)
    share = rng.uniform(0.1, 0.7)
    links = [rng.rand(*shape) < share for shape in
             [(h, w - 1), (h - 1, w), (h - 1, w - 1), (h - 1, w - 1)]]
    expected = search(h * w, *grid_edges(*links)).reshape(h, w)
    np.testing.assert_array_equal(link_components(*links), expected)


@pytest.mark.parametrize("connectivity", [4, 8])
@pytest.mark.parametrize("seed", range(10))
def test_equal_labels_agree_with_search(seed, connectivity):
    rng = np.random.RandomState(seed)
    h, w = rng.randint(1, 20, 2)
    labels = rng.randint(0, 3, (h, w))
    diagonal = connectivity == 8
    links = [labels[:, 1:] == labels[:, :-1], labels[1:] == labels[:-1],
             (labels[1:, 1:] == labels[:-1, :-1]) & diagonal,
             (labels[1:, :-1] == labels[:-1, 1:]) & diagonal]
    expected = search(h * w, *grid_edges(*links)).reshape(h, w)
    np.testing.assert_array_equal(label_components(labels, connectivity), expected)


def test_chessboard():
    board = np.add.outer(np.arange(6), np.arange(7)) % 2
    assert label_components(board, 4).max() == 41
    np.testing.assert_array_equal(label_components(board, 8), board)


def test_connectivity_is_checked():
    with pytest.raises(ValueError, match="connectivity must be 4 or 8, not 6"):
        label_components(np.zeros((2, 2), int), 6)


@pytest.mark.parametrize("seed", range(8))
def test_linked_areas_are_the_components_with_links(seed):
    rng = np.random.RandomState(seed)
    shape = [(1, 1), (1, 9), (7, 1), (6, 8), (13, 11), (13, 11), (20, 20), (3, 2)][seed]
    right = rng.rand(shape[0], shape[1] - 1) < 0.3
    down = rng.rand(shape[0] - 1, shape[1]) < 0.3
    every = link_components(right, down)
    found = linked_areas(right, down)
    areas = found.at(np.arange(every.size)).reshape(every.shape)
    lone = np.bincount(every.ravel())[every] == 1
    assert (areas[lone] == -1).all() and areas.dtype == np.int32
    assert (found.size == np.bincount(areas[~lone])).all()
    # The others keep their order.
    assert (areas[~lone] == np.unique(every[~lone], return_inverse=True)[1].ravel()).all()
    # Every second area is written.
    given = np.where(np.arange(found.size.size) % 2, -1, np.arange(found.size.size) + 10)
    values = np.full(every.size, 7)
    found.put(values, given)
    assert (values == np.where((areas < 0) | (areas % 2 == 1), 7, areas + 10).ravel()).all()


def test_blocks_are_areas_where_they_share_pixels():
    block = np.zeros((5, 7), bool)
    block[0, 0], block[1, 1], block[3:, 5] = True, True, True
    found = block_areas(block)
    areas = found.at(np.arange(48)).reshape(6, 8)
    expected = np.full((6, 8), -1)
    expected[:2, :2] = expected[1:3, 1:3] = 0
    expected[3:, 5:7] = 1
    assert np.array_equal(areas, expected) and found.size.tolist() == [7, 6]


@pytest.mark.parametrize("share", [0.1, 0.4, 0.8])
def test_areas_among_some_pixels_are_those_of_the_whole_picture(share):
    random = np.random.RandomState(12)
    values = np.pad(random.randint(0, 2, (40, 50)), 1, mode="constant", constant_values=-1)
    values[random.rand(*values.shape) > share] = -1
    cells = np.flatnonzero(values >= 0)
    found = cell_components(cells, values.ravel()[cells], values.shape[1])
    number = label_components(values, 8).ravel()[cells]
    np.testing.assert_array_equal(found, np.unique(number, return_inverse=True)[1].ravel())


def test_areas_of_a_mask_are_those_of_its_pixels_but_lone_ones():
    mask = np.random.RandomState(13).rand(40, 50) < 0.5
    areas = mask_areas(mask)
    number = label_components(np.where(mask, 1, np.arange(mask.size).reshape(mask.shape) + 2)).ravel()
    cells = np.flatnonzero(mask)
    found, size = areas.at(cells), np.bincount(number)[number[cells]]
    assert ((found < 0) == (size == 1)).all()
    np.testing.assert_array_equal(areas.size[found[found >= 0]], size[size > 1])
    assert np.unique(found[found >= 0]).size == np.unique(number[cells][size > 1]).size


@pytest.mark.parametrize("seed", range(5))
def test_places_among_others(seed):
    rng = np.random.RandomState(seed)
    cells = np.unique(rng.randint(0, 200, 60)).astype(np.int32)
    aims = rng.randint(-5, 210, (3, 40))
    place = places_among(cells, aims)
    assert (cells[place[place >= 0]] == aims[place >= 0]).all()
    assert np.array_equal(place >= 0, np.isin(aims, cells))
    assert np.array_equal(next_among(cells, 3), places_among(cells, cells + 3))
