# SPDX-License-Identifier: GPL-2.0-or-later
"""Black and white, with a threshold from the picture."""

from __future__ import annotations

import numpy as np
import pytest
from alignment import shift
from hypothesis import given
from hypothesis import strategies as st
from meshes import clip_art, grey
from painted import render
from pictures import disc, picture, rectangle, star

from ddtcore import TraceOptions, trace
from ddtcore.ink import MIDDLE, otsu, stretch

LINE_ART = TraceOptions.preset("line-art")
BLACK, WHITE = (0, 0, 0), (255, 255, 255)


def drawing_of(ink, paper, times=1):
    centre = np.array((30.3, 31.2))
    outer, inner = disc(centre, 22), disc(centre, 19.2)
    parts = [np.concatenate([outer, outer[:1], inner[:1], inner[::-1]]), star((69.2, 26.4), 18, 9, 5, 12),
             rectangle((60.4, 61.7), 38, 5, -8)]
    return picture(96 * times, 80 * times, [part * times for part in parts], (paper, *[ink] * len(parts))).image


def levels(image, truth):
    return np.sqrt(np.mean((image[..., :3].astype(float) - truth[..., :3]) ** 2))


def variance_between(count, threshold):
    """The variance between what is below and what is above a threshold, by its definition."""
    values = np.repeat(np.arange(256), count)
    below = values < threshold
    if below.all() or not below.any():
        return 0.0
    means = values[below].mean(), values[~below].mean()
    return below.mean() * (1 - below.mean()) * (means[0] - means[1]) ** 2


@given(st.lists(st.tuples(st.integers(0, 255), st.integers(1, 20)), min_size=2, max_size=12))
def test_no_threshold_parts_the_levels_better(peaks):
    count = np.zeros(256, int)
    for level, number in peaks:
        count[level] += number
    best = max(variance_between(count, threshold) for threshold in range(257))
    assert variance_between(count, otsu(count)) >= best * (1 - 1e-6)


def test_the_threshold_lies_amid_a_gap():
    count = np.zeros(256, int)
    count[[40, 200]] = 9, 5
    assert otsu(count) == pytest.approx(120, abs=1)


@pytest.mark.parametrize("ink, paper", [(0, 255), (60, 200), (90, 130), (0, 180)])
def test_ink_and_paper_of_any_grey_become_black_and_white(ink, paper):
    colours = [(level, level, level, 255) for level in (ink, paper)]
    drawing = trace(drawing_of(*colours), LINE_ART)
    assert [shape.rgb for shape in drawing.shapes] == [WHITE, BLACK]
    truth = drawing_of((*BLACK, 255), (*WHITE, 255), 4)
    back = render(drawing, 4)
    assert levels(back, truth) < 255 * 0.03
    assert np.abs(shift(truth[..., :3].astype(float), back[..., :3].astype(float))).max() / 4 < 0.02


def test_edges_keep_their_place_to_a_fraction_of_a_pixel_though_strokes_are_few():
    # Most dark pixels are those of the edges, and their mean is no black.
    image = picture(80, 60, [rectangle((40.2, 30.3), 60, 2.5, 12)], ((255,) * 4, (0, 0, 0, 255))).image
    drawn = 255 - render(trace(image, LINE_ART), 4)[..., 0].astype(float)
    assert drawn.sum() / 255 / 16 == pytest.approx(60 * 2.5, rel=0.02)


def test_ink_is_one_path_on_one_rectangle():
    drawing = trace(clip_art("doctor"), LINE_ART)
    assert [shape.rgb for shape in drawing.shapes] == [WHITE, BLACK]
    assert len(drawing.shapes[0].loops) == 1 and drawing.to_svg().count("<path") <= 2
    bare = trace(clip_art("doctor"), TraceOptions.preset("line-art", background="drop"))
    assert [shape.rgb for shape in bare.shapes] == [BLACK]
    for one, other in zip(bare.shapes[0].loops, drawing.shapes[1].loops):
        assert np.array_equal(one.control, other.control)


@pytest.mark.parametrize("level", [20.0, 50.0, 80.0])
def test_a_threshold_that_is_given(level):
    row = np.linspace(0, 255, 200)
    back = render(trace(grey(np.tile(row, (30, 1))), TraceOptions(regions="black-white", level=level)))
    assert abs((back[15, :, 0] < 128).mean() - level / 100) < 0.02
    assert set(np.unique(back[15, :, 0])) - {0, 255} == set() or (np.diff(back[15, :, 0].astype(int)) >= 0).all()


def test_stretched_levels_rise_and_meet_the_middle():
    image = grey(np.tile(np.arange(256), (3, 1)))
    tone = stretch(image, 30.0)[0, :, 0].astype(int)
    assert (np.diff(tone) >= 0).all() and tone[0] == 0 and tone[-1] == 255
    assert abs(np.argmax(tone > MIDDLE) - 0.3 * 255) <= 1


def test_colours_count_by_their_lightness():
    image = np.zeros((20, 40, 4), np.uint8)
    image[:, :20] = (255, 240, 0, 255)
    image[:, 20:] = (0, 0, 200, 255)
    back = render(trace(image, LINE_ART))
    assert (back[:, :19, 0] == 255).all() and (back[:, 21:, 0] == 0).all()


def test_nothing_stays_nothing():
    image = drawing_of((0, 0, 0, 255), (255, 255, 255, 255))
    image[:, :10] = 0
    drawing = trace(image, LINE_ART)
    assert {shape.rgb for shape in drawing.shapes} == {WHITE, BLACK}
    back = render(drawing)
    assert (back[:, :9, 3] == 0).all() and (back[:, 11:, 3] > 250).all()


@pytest.mark.parametrize("level", [0, 90, 255])
def test_a_picture_of_one_level(level):
    drawing = trace(grey(np.full((6, 8), level)), LINE_ART)
    assert drawing.shapes[0].rgb == WHITE and len(drawing.shapes) <= 2
    assert not trace(np.zeros((5, 5, 4), np.uint8), LINE_ART).shapes
