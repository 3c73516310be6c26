# SPDX-License-Identifier: GPL-2.0-or-later
"""Which colours of a picture are real, and which pixels surely have them."""

from __future__ import annotations

import numpy as np
import pytest
from artwork import CARTOON, box, colours_of, disc, draw, everywhere, half_plane, paint, palette_of, rasterise, stroke

from ddtcore import palette
from ddtcore.canvas import prepare, unpack
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

WHITE, BLACK, GREY, RED = (255, 255, 255, 255), (0, 0, 0, 255), (128, 128, 128, 255), (200, 30, 40, 255)


def look(image):
    """The canvas of a picture, its plateaus and the colours chosen."""
    canvas = prepare(image)
    plateaus = palette.find_plateaus(canvas, np.zeros(canvas.shape, bool))
    keys = palette.choose_colours(canvas, plateaus, False)
    return canvas, plateaus, np.append(keys, palette.unmixed_colours(canvas, plateaus, keys))


def chosen(image):
    return set(map(tuple, unpack(look(image)[2]).tolist()))


def test_core_is_every_pixel_in_an_equal_block():
    image = unpack(np.random.RandomState(3).randint(0, 2, (30, 40)).astype(np.uint32) | np.uint32(255 << 24))
    _, plateaus, _ = look(image)
    last = image[1:, 1:]
    same = (last == image[:-1, :-1]) & (last == image[1:, :-1]) & (last == image[:-1, 1:])
    expected = np.zeros((30, 40), bool)
    for row, col in np.argwhere(same.all(axis=-1)):
        expected[row:row + 2, col:col + 2] = True
    np.testing.assert_array_equal(plateaus.core, expected)
    assert plateaus.counts.sum() == expected.sum()


def test_a_plateau_of_four_pixels_counts():
    layers = [(WHITE, everywhere), (BLACK, disc(30, 30, 12)), ((20, 160, 60, 255), box(50, 50, 52, 52))]
    assert chosen(draw(60, 60, layers)) == colours_of(layers)


@pytest.mark.parametrize("top", [10, 10.25, 10.5])
def test_straight_strokes_make_no_colours_of_their_mixes(top):
    """A stroke one pixel wide that covers two rows by half leaves blocks of equal grey pixels."""
    layers = [(WHITE, everywhere), (BLACK, disc(40, 40, 12)), (BLACK, box(4, top, 56, top + 1)),
              (BLACK, box(top, 4, top + 1, 50)), (BLACK, box(30, top + 2, 31, 22))]
    layers += [(RED, box(20, 12, 26, 20)), (RED, disc(52, 52, 6))]
    assert chosen(draw(60, 60, layers)) == {WHITE, BLACK, RED}


def test_a_narrow_ring_of_a_mixed_colour_is_real():
    layers = [(WHITE, everywhere), (BLACK, disc(30, 30, 22)), (GREY, disc(30.2, 30.1, 12)),
              (BLACK, disc(30.2, 30.1, 8.8))]
    assert chosen(draw(60, 60, layers)) == {WHITE, BLACK, GREY}


def test_a_narrow_ring_without_plateaus_is_real_too():
    layers = [(WHITE, everywhere), (BLACK, disc(30, 30, 14)), (GREY, disc(30, 30, 6)),
              (BLACK, disc(30, 30, 3.6))]
    assert chosen(draw(60, 60, layers)) == {WHITE, BLACK, GREY}


@pytest.mark.parametrize("seed", range(3, 10))
def test_mixes_that_meet_by_chance_are_not_real(seed):
    """Few greys are left where colours were reduced: three pixels round a corner have the same one now and then."""
    random = np.random.RandomState(seed)
    places = random.uniform((10, 10, 0, 1, 6), (290, 290, np.pi, 2.6, 20), (80, 5))
    image = draw(300, 300, [(WHITE, everywhere), *((BLACK, stroke(*place)) for place in places)])
    image[..., :3] = np.array([0, 36, 100, 160, 220, 255])[np.digitize(image[..., :3], [18, 68, 130, 190, 238])]
    assert chosen(image) == {WHITE, BLACK}


def test_beside_ramps_a_strip_between_unlike_colours_is_real():
    layers = [(WHITE, everywhere), (BLACK, disc(20, 30, 12)), (RED, box(44, 4, 48, 56)), (GREY, box(48, 4, 50, 56))]
    canvas = prepare(draw(60, 60, layers))
    skip = np.zeros(canvas.shape, bool)
    skip[:, :4] = True
    keys = palette.choose_colours(canvas, palette.find_plateaus(canvas, skip), True)
    assert GREY in map(tuple, unpack(keys).tolist())


def test_colours_that_differ_by_one_level_both_count():
    layers = [((12, 12, 12, 255), everywhere), ((13, 14, 13, 255), half_plane(30, 30, 0.3)),
              (WHITE, disc(30, 30, 9))]
    assert chosen(draw(60, 60, layers)) == colours_of(layers)


def test_mixes_of_others():
    line = np.array([[0, 255, 128, 60, 255], [0, 255, 128, 200, 0], [0, 255, 128, 90, 0]], np.float32)
    np.testing.assert_array_equal(palette.is_mixed(line, line), [False, False, True, False, False])


def test_known_pixels_have_that_colour():
    points = paint(96, 96, CARTOON)
    canvas, plateaus, keys = look(rasterise(points))
    labels = canvas.bare(palette.known_labels(canvas, plateaus, keys, 2.0))
    known = labels >= 0
    assert known[plateaus.core].all()
    off = unpack(keys)[labels[known]].astype(int) - rasterise(points)[known]
    assert np.abs(off).max() <= 2
    rim = palette.known_labels(canvas, plateaus, keys, 2.0).reshape(-1, canvas.stride)
    assert (rim[:3] == -1).all() and (rim[:, -3:] == -1).all()


def test_mixes_on_edges_are_not_taken_for_the_grey_they_equal():
    """A half covered pixel between black and white is no pixel of the grey box elsewhere."""
    layers = [(WHITE, everywhere), (GREY, box(40, 40, 56, 56)), (BLACK, box(10.5, 10, 25, 30)),
              (BLACK, stroke(30, 8, 0.4, 6, 9))]
    canvas, plateaus, keys = look(draw(60, 60, layers))
    labels = canvas.bare(palette.known_labels(canvas, plateaus, keys, 2.0))
    grey = labels == list(keys).index(pack_one(GREY))
    assert grey[40:56, 40:56].all() and grey.sum() == 256


def test_strokes_that_cover_two_rows_in_part_have_no_colour_of_their_own():
    """Black is nowhere full: what two equal rows show is a grey, as often as one likes."""
    layers = [(WHITE, everywhere)] + [(BLACK, box(4, y + 0.25, 50, y + 1.75)) for y in range(6, 50, 10)]
    layers += [(BLACK, box(x + 0.25, 4, x + 1.75, 58)) for x in (10, 40)]
    image = draw(60, 90, layers + [(BLACK, stroke(70, 30, 1.1, 1.5, 20))])
    assert np.count_nonzero((image == (64, 64, 64, 255)).all(axis=-1)) > 300
    assert palette_of(label_pixels(image, TraceOptions())) == {WHITE, BLACK}


def test_a_mix_that_is_wide_once_is_known_only_there():
    """Between stripes as narrow as pixels the mix is all there is; strokes of two such rows are strokes."""
    brown, half = (176, 114, 46, 255), (88, 57, 23, 255)
    layers = [(brown, everywhere), (BLACK, box(30, 4, 58, 20)), (half, box(4, 4, 9, 9))]
    layers += [(BLACK, box(4, y + 0.5, 58, y + 1.5)) for y in range(26, 60, 5)]
    canvas, plateaus, keys = look(draw(64, 64, layers))
    keys = np.append(keys[keys != pack_one(half)], np.uint32(pack_one(half)))
    labels = canvas.bare(palette.known_labels(canvas, plateaus, keys, 2.0))
    known = labels == keys.size - 1
    assert known[4:9, 4:9].all() and known.sum() == 25


def pack_one(colour):
    return int(prepare(np.array([[colour]], np.uint8)).keys[0])


def test_many_colours_are_bounded():
    y, x = np.mgrid[:60, :60] // 3
    image = np.stack([x * 12, y * 12, x * y % 256, np.full_like(x, 255)], axis=-1).astype(np.uint8)
    _, _, keys = look(image)
    assert palette.MANY >= keys.size > 200
