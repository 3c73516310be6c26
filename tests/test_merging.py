# SPDX-License-Identifier: GPL-2.0-or-later
"""Fewer colours and no specks."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.canvas import premultiply
from ddtcore.components import label_components
from ddtcore.merging import drop_unused, limit_colours, merge_like_pieces, merge_specks, merge_twins, ward_groups
from ddtcore.model import Labels

PALETTE = np.array(
    [[255, 255, 255, 255], [0, 0, 0, 255], [8, 8, 8, 255], [250, 0, 0, 255], [0, 0, 0, 0]], float)


def labels_of(index, ramp=None):
    index = np.asarray(index, np.int32)
    return Labels(index, PALETTE[:index.max() + 1], np.zeros(index.shape, bool), ramp)


def random_labels(seed, share=0.3):
    rng = np.random.RandomState(seed)
    coarse = rng.randint(0, 4, (6, 7)).repeat(6, axis=0).repeat(6, axis=1)
    return labels_of(np.where(rng.rand(*coarse.shape) < share, rng.randint(0, 4, coarse.shape), coarse))


@pytest.mark.parametrize("seed", range(8))
@pytest.mark.parametrize("area", [2.0, 5.0, 12.5, 60.0])
def test_no_region_below_the_area_is_left(seed, area):
    before = random_labels(seed)
    after = merge_specks(before, area)
    assert np.bincount(label_components(after.index, 8).ravel()).min() >= area
    np.testing.assert_array_equal(np.unique(after.index), np.arange(len(after.palette)))


@pytest.mark.parametrize("seed", range(4))
def test_large_regions_keep_their_pixels(seed):
    before = random_labels(seed, 0.05)
    region = label_components(before.index, 8)
    large = (np.bincount(region.ravel()) >= 20)[region]
    after = merge_specks(before, 20.0)
    np.testing.assert_array_equal(after.palette[after.index][large], before.palette[before.index][large])


def test_a_speck_joins_the_longest_border():
    index = np.zeros((10, 10), int)
    index[:, 6:] = 1
    index[4:6, 4:7] = 3  # seven edges with 0, three with 1
    after = merge_specks(labels_of(index), 8.0)
    assert (after.index[4:6, 4:7] == after.index[0, 0]).all()
    assert len(after.palette) == 2


def test_spared_specks_stay_inside_one_region():
    index = np.zeros((12, 12), int)
    index[:, 8:] = 1
    index[3:5, 3:5] = 3
    index[8:10, 7:9] = 3
    after = merge_specks(labels_of(index), 8.0, lambda mask, index: np.ones(np.count_nonzero(mask), bool))
    red = after.palette[after.index][..., 0] == 250
    assert red.sum() == 4 and red[3:5, 3:5].all()


def test_thin_pixels_of_merged_specks_are_forgotten():
    index = np.zeros((9, 9), int)
    index[4, 4] = 1
    labels = labels_of(index)
    labels.thin[4, 4] = labels.thin[2, 2] = True
    np.testing.assert_array_equal(np.argwhere(merge_specks(labels, 3.0).thin), [[2, 2]])


def test_limit_keeps_the_frequent_colour_of_each_group():
    index = np.zeros((10, 10), int)
    index[:, 4:7], index[:, 7:9], index[:, 9:] = 1, 2, 3
    after = limit_colours(labels_of(index), 3)
    np.testing.assert_array_equal(after.palette, PALETTE[[0, 1, 3]])
    assert (after.index[:, 4:9] == 1).all()


def test_limit_never_merges_nothing():
    index = np.arange(5).repeat(10).reshape(5, 10)
    after = limit_colours(labels_of(index), 1)
    np.testing.assert_array_equal(np.unique(after.palette[:, 3]), [0, 255])
    np.testing.assert_array_equal(after.palette[after.index][..., 3] == 0, index == 4)


def test_merged_ramps_are_ramps_no_more():
    index = np.arange(4).repeat(10).reshape(4, 10)
    after = limit_colours(labels_of(index, np.array([False, True, False, True])), 3)
    assert after.ramp.tolist() == [False, False, True]


def test_unused_colours_are_dropped():
    labels = drop_unused(labels_of([[0, 3], [3, 0]], np.array([False, True, True, True])))
    np.testing.assert_array_equal(labels.palette, PALETTE[[0, 3]])
    assert labels.index.tolist() == [[0, 1], [1, 0]] and labels.ramp.tolist() == [False, True]


def test_ward_groups_by_weight_and_distance():
    points = np.array([[0.0], [1.0], [10.0], [12.0]])
    assert ward_groups(points, np.ones(4), 2).tolist() == [0, 0, 1, 1]
    # A rare colour costs little, even if it is far from the next one.
    assert ward_groups(points, np.array([1000, 1000, 1000, 1]), 3).tolist() == [0, 1, 2, 2]
    assert ward_groups(points, np.ones(4), 4).tolist() == [0, 1, 2, 3]


def twins(palette, index, ramp=None):
    """Labels of RGBA colours with their twins merged."""
    palette, index = np.array(palette, float), np.asarray(index, np.int32)
    ramp = np.zeros(len(palette), bool) if ramp is None else np.array(ramp)
    labels = Labels(index, palette, np.zeros(index.shape, bool), ramp)
    return merge_twins(labels, premultiply(palette).T.astype(np.float32))


STRIPES = np.arange(4).repeat(10).reshape(4, 10).repeat(3, axis=0)


def test_twins_that_meet_take_the_more_frequent_colour():
    palette = [(12, 12, 12, 255), (13, 14, 13, 255), (255, 255, 255, 255), (255, 255, 251, 255)]
    merged = twins(palette, np.maximum(STRIPES, 1)), twins(palette, STRIPES)
    np.testing.assert_array_equal(merged[0].palette, palette[1:])
    assert len(merged[1].palette) == 3
    np.testing.assert_array_equal(merged[1].index[:6], 0)


def test_twins_that_do_not_meet_stay():
    palette = [(12, 12, 12, 255), (255, 255, 255, 255), (13, 14, 13, 255), (90, 90, 90, 255)]
    np.testing.assert_array_equal(twins(palette, STRIPES).palette, palette)


def test_no_chain_of_twins_changes_a_colour_visibly():
    palette = [(20 + 2 * k, 20, 20, 255) for k in range(4)]
    merged = twins(palette, STRIPES)
    assert np.abs(merged.palette[merged.index] - np.array(palette, float)[STRIPES]).max() <= 2
    assert len(merged.palette) == 2


def test_twins_of_other_opacity_and_ramps_stay():
    palette = [(80, 80, 80, 255), (81, 80, 80, 250), (0, 0, 0, 0), (255, 255, 255, 255)]
    np.testing.assert_array_equal(twins(palette, STRIPES).palette, palette)
    palette = [(80, 80, 80, 255), (81, 80, 80, 255), (0, 0, 0, 0), (255, 255, 255, 255)]
    np.testing.assert_array_equal(twins(palette, STRIPES, [False, True, False, False]).palette, palette)
    assert len(twins(palette, STRIPES).palette) == 3


def pieces(palette, ramp=None, side=4):
    """A picture in two halves with a piece of a third label in the right one, beside the left one, merged."""
    index = np.repeat([[0, 1]], 10, axis=0).repeat(10, axis=1)
    index[3:3 + side, 10:10 + side] = 2
    palette = np.array([(*rgb, 255) for rgb in palette], float)
    labels = Labels(index.astype(np.int16), palette, index == 2, None if ramp is None else np.array(ramp))
    merged = merge_like_pieces(labels, premultiply(palette).T, 20, 12)
    assert not merged.thin[index != 2].any()
    return merged.palette[merged.index[3:3 + side, 10:10 + side], 0].ravel()


def test_small_pieces_join_a_neighbour_nearly_like_them():
    assert (pieces([(0, 0, 0), (200, 200, 200), (210, 205, 195)]) == 200).all()
    assert (pieces([(200, 200, 200), (0, 0, 0), (210, 205, 195)]) == 200).all()


def test_of_two_such_neighbours_that_with_the_longer_border_counts():
    assert (pieces([(201, 200, 200), (205, 200, 200), (203, 200, 200)]) == 205).all()


def test_pieces_that_are_large_or_unlike_or_beside_ramps_stay():
    assert (pieces([(0, 0, 0), (200, 200, 200), (210, 205, 195)], side=5) == 210).all()
    assert (pieces([(0, 0, 0), (200, 200, 200), (213, 200, 200)]) == 213).all()
    assert (pieces([(0, 0, 0), (200, 200, 200), (210, 200, 200)], ramp=[False, True, False]) == 210).all()
    assert (pieces([(0, 0, 0), (200, 200, 200), (210, 200, 200)], ramp=[False, False, True]) == 210).all()
