# SPDX-License-Identifier: GPL-2.0-or-later
"""A limited number of areas."""

from __future__ import annotations

import gzip

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshes import clip_art, grey, pictures
from otherart import photograph
from painted import render

from ddtcore import TraceOptions, trace
from ddtcore.areas import ROOM, label_areas, limit_areas
from ddtcore.canvas import prepare
from ddtcore.components import label_components
from ddtcore.regions import label_pixels

PHOTO = photograph(128)


def squared_error(labels, image):
    return ((labels.palette[labels.index][..., :3] - image[..., :3]) ** 2).mean()


@pytest.mark.parametrize("most", [1, 2, 30, 400])
def test_there_are_as_many_areas_as_wanted_and_each_is_connected(most):
    labels = label_areas(prepare(PHOTO), most)
    assert len(labels.palette) == min(most, 128 * 128 // ROOM)
    assert int(label_components(labels.index).max()) + 1 == len(labels.palette)


def test_each_area_has_its_mean_colour():
    labels = label_areas(prepare(PHOTO), 20)
    for number in range(20):
        assert np.allclose(labels.palette[number], PHOTO[labels.index == number].mean(axis=0))


def test_more_areas_explain_more():
    errors = [squared_error(label_areas(prepare(PHOTO), most), PHOTO) for most in (1, 10, 100, 400)]
    assert errors == sorted(errors, reverse=True) and errors[-1] < 0.2 * errors[0]


@pytest.mark.parametrize("turn", [lambda a: a[::-1], lambda a: a[:, ::-1], lambda a: a.swapaxes(0, 1)])
def test_no_direction_is_preferred(turn):
    image = np.ascontiguousarray(turn(PHOTO))
    error = squared_error(label_areas(prepare(PHOTO), 60), PHOTO)
    assert squared_error(label_areas(prepare(image), 60), image) == pytest.approx(error, rel=0.04)


def test_what_stands_out_is_left():
    image = grey(np.random.RandomState(1).randint(95, 106, (80, 80)))
    image[10:14, 10:14, :3], image[40:70, 20:60, :3] = 250, 130
    labels = label_areas(prepare(image), 3)
    assert {tuple(colour) for colour in np.rint(labels.palette[:, :3] / 20).astype(int)} == {
        (5,) * 3, (12,) * 3, (6,) * 3}
    assert (labels.index[10:14, 10:14] == labels.index[11, 11]).all()
    assert np.count_nonzero(labels.index == labels.index[11, 11]) == 16


def test_a_large_area_takes_in_many_small_ones_before_anything_else_is_lost():
    # A thousand faint dots on one ground, and four strong squares.
    image = grey(np.full((128, 128), 120))
    image[2::4, 2::4, :3] = 128
    for k in range(4):
        image[20 + 24 * k:30 + 24 * k, 20:90, :3] = (250, 20, 200 * (k % 2))
    labels = label_areas(prepare(image), 6)
    for k in range(4):
        part = labels.index[20 + 24 * k:30 + 24 * k, 20:90]
        assert (part == part[0, 0]).all() and np.count_nonzero(labels.index == part[0, 0]) == part.size


@given(pictures(), st.integers(1, 6))
@settings(deadline=None)
def test_any_labels_are_limited(image, most):
    labels = label_pixels(image, TraceOptions(regions="pixels"))
    limited = limit_areas(labels, most)
    assert int(label_components(limited.index, 8).max()) + 1 <= most
    colours = {tuple(colour) for colour in labels.palette}
    assert {tuple(colour) for colour in limited.palette} <= colours
    if int(label_components(labels.index, 8).max()) + 1 <= most:
        assert limited is labels


def test_the_limit_holds_with_any_regions():
    image = clip_art("doctor")
    for regions in ("palette", "threshold"):
        many = len(trace(image, TraceOptions(regions=regions)).shapes)
        few = len(trace(image, TraceOptions(regions=regions, areas=10)).shapes)
        assert many > 30 and few <= 13


def test_photographs_look_alike_from_a_distance_and_stay_small():
    drawing = trace(PHOTO, TraceOptions.preset("photo"))
    assert drawing.choice == "" and len(drawing.shapes) < 1.1 * 128 * 128 // ROOM
    back = render(drawing)[..., :3].astype(float)
    assert np.sqrt(np.mean((back - PHOTO[..., :3]) ** 2)) < 13

    def from_afar(image):
        return image.reshape(16, 8, 16, 8, 3).mean(axis=(1, 3))

    assert np.abs(from_afar(back) - from_afar(PHOTO[..., :3].astype(float))).mean() < 3
    assert len(gzip.compress(drawing.to_svg().encode())) < 30_000


@pytest.mark.parametrize("image", [np.zeros((1, 1, 4), np.uint8), np.full((3, 50, 4), 200, np.uint8),
                                   np.zeros((20, 20, 4), np.uint8)])
def test_odd_pictures(image):
    assert len(label_areas(prepare(image), 5).palette) == 1
