# SPDX-License-Identifier: GPL-2.0-or-later
"""Labels of pictures whose true colours are known at every point."""

from __future__ import annotations

from time import process_time

import numpy as np
import pytest
from artwork import (
    CARTOON,
    box,
    colours_of,
    disc,
    draw,
    everywhere,
    half_plane,
    paint,
    palette_of,
    presence,
    rasterise,
    stroke,
)

from ddtcore.components import label_components
from ddtcore.options import TraceOptions
from ddtcore.regions import label_pixels

WHITE, BLACK, NOTHING = (255, 255, 255, 255), (0, 0, 0, 255), (0, 0, 0, 0)
DEFAULT = TraceOptions()


def shown(labels):
    """The picture as its labels paint it, uint8 (H, W, 4)."""
    return np.rint(labels.palette).astype(np.uint8)[labels.index]


def check_form(labels, shape):
    assert labels.index.shape == labels.thin.shape == shape
    assert labels.index.dtype in (np.int16, np.int32) and labels.thin.dtype == bool
    assert labels.palette.dtype == np.float64 and labels.palette.shape[1] == 4
    np.testing.assert_array_equal(np.unique(labels.index), np.arange(len(labels.palette)))
    assert labels.ramp is None or labels.ramp.shape == (len(labels.palette),)


def turned(layers, angle, cx, cy):
    """Layers rotated about a point."""
    def rotate(covers):
        return lambda x, y: covers(cx + (x - cx) * np.cos(angle) + (y - cy) * np.sin(angle),
                                   cy - (x - cx) * np.sin(angle) + (y - cy) * np.cos(angle))
    return [(colour, rotate(covers)) for colour, covers in layers]


@pytest.mark.parametrize("angle", [0, 0.1, 0.5, np.pi / 4, 2.0])
def test_flat_art_has_its_own_colours_and_no_fringe(angle):
    points = paint(96, 96, turned(CARTOON, angle, 48, 48))
    labels = label_pixels(rasterise(points), DEFAULT)
    check_form(labels, (96, 96))
    assert palette_of(labels) == colours_of(CARTOON)
    share = presence(points, shown(labels))
    assert (share > 0).all(), "a pixel has a colour that does not occur in it"
    assert (share[~labels.thin] > 0.35).mean() > 0.995


@pytest.mark.parametrize("place", [(30.0, 30.0), (30.4, 30.2), (30.5, 30.9)])
def test_a_dot_of_a_pixel_or_two_stays(place):
    yellow = (250, 205, 13, 255)
    layers = [((13, 14, 13, 255), everywhere), (yellow, disc(*place, 0.85)), (yellow, disc(10, 10, 5))]
    shines = (shown(label_pixels(draw(60, 60, layers), DEFAULT)) == yellow).all(axis=-1)
    assert 1 <= shines[25:36, 25:36].sum() <= 5


def test_few_regions():
    labels = label_pixels(draw(96, 96, CARTOON), DEFAULT)
    # page, outline, skin, two eyes of ring, white and iris, mouth, box, stroke
    assert label_components(labels.index, 8).max() + 1 == 12


@pytest.mark.parametrize("turn", ["left", "upside down", "mirrored", "transposed"])
def test_turning_the_picture_turns_the_labels(turn):
    change = {"left": np.rot90, "upside down": np.flipud, "mirrored": np.fliplr,
              "transposed": lambda a: a.swapaxes(0, 1)}[turn]
    image = draw(96, 96, CARTOON)
    one, other = label_pixels(image, DEFAULT), label_pixels(np.ascontiguousarray(change(image)), DEFAULT)
    assert (change(shown(one)) != shown(other)).any(axis=-1).mean() < 0.002


def test_inverted_colours_give_inverted_labels():
    image = draw(96, 96, CARTOON)
    inverted = image.copy()
    inverted[..., :3] = 255 - inverted[..., :3]
    one, other = shown(label_pixels(image, DEFAULT)), shown(label_pixels(inverted, DEFAULT))
    assert (other[..., :3] != 255 - one[..., :3]).any(axis=-1).mean() < 0.002


def test_grey_between_black_and_white_makes_no_islands():
    layers = [(WHITE, everywhere), ((128, 128, 128, 255), disc(80, 80, 12))]
    layers += [(BLACK, stroke(40, 40, angle, 1.7, 30)) for angle in np.linspace(0.1, 3.1, 5)]
    points = paint(100, 100, layers)
    labels = label_pixels(rasterise(points), DEFAULT)
    grey = (shown(labels) == (128, 128, 128, 255)).all(axis=-1)
    assert label_components(grey.astype(int)).max() == 1
    assert (presence(points, shown(labels))[grey] > 0).all()


BACKGROUNDS = {"white": (WHITE, WHITE), "black": (BLACK, BLACK),
               "yellow and blue": ((255, 208, 32, 255), (32, 80, 208, 255)),
               "white and grey": (WHITE, (144, 144, 144, 255)), "white and black": (WHITE, BLACK),
               "nothing": (NOTHING, NOTHING), "nothing and green": (NOTHING, (60, 150, 60, 255))}


@pytest.mark.parametrize("background", BACKGROUNDS)
@pytest.mark.parametrize("width", [0.7, 1.0, 1.5, 2.0])
def test_thin_strokes_stay_whole(width, background):
    one, other = BACKGROUNDS[background]
    ink = (200, 30, 40, 255)
    for angle in np.linspace(0, np.pi, 8, endpoint=False) + np.array([0, 0.1, 0.3, 0, 0, 0.1, 0.2, 0]):
        layers = [(one, everywhere), (other, half_plane(30.3, 30.1, angle)),
                  (ink, stroke(30.3, 30.1, angle, width, 22)), (ink, disc(5, 5, 4))]
        labels = label_pixels(draw(60, 60, layers), DEFAULT)
        assert palette_of(labels) == colours_of(layers)
        inked = (shown(labels) == ink).all(axis=-1)
        piece = label_components(np.where(inked, 1, 0), 8)
        y, x = np.mgrid[:60, :60] + 0.5
        along = (x - 30.3) * np.cos(angle) + (y - 30.1) * np.sin(angle)
        across = (y - 30.1) * np.cos(angle) - (x - 30.3) * np.sin(angle)
        own = inked & (abs(across) < 3) & (abs(along) < 23)
        assert len(np.unique(piece[own])) == 1
        assert np.ptp(along[own]) > 40
        assert labels.thin[own].any() or width > 1.4


def test_colour_that_occurs_in_a_thin_stroke_only():
    layers = [((255, 192, 128, 255), everywhere), (BLACK, disc(30, 30, 12)),
              ((184, 0, 0, 255), stroke(60, 50, 0.7, 1.5, 20))]
    assert palette_of(label_pixels(draw(90, 90, layers), DEFAULT)) == colours_of(layers)


@pytest.mark.parametrize("background", BACKGROUNDS)
@pytest.mark.parametrize("width", [1.0, 1.4, 2.2])
def test_colour_of_a_thin_stroke_is_found_wherever_it_runs(width, background):
    """From 1.4 px on some pixel is covered fully; a stroke of 1 px may come out a little pale."""
    one, other = BACKGROUNDS[background]
    ink = (60, 160, 70, 255) if other != (60, 150, 60, 255) else (200, 30, 90, 255)
    for angle in (0.1, 0.7, np.pi / 4, 2.0):
        layers = [(one, everywhere), (other, half_plane(30.3, 30.1, angle)),
                  (ink, stroke(30.3, 30.1, angle, width, 22)), (BLACK, disc(8, 8, 5))]
        found = np.array(sorted(palette_of(label_pixels(draw(60, 60, layers), DEFAULT))))
        off = np.abs(found[:, None] - np.array(sorted(colours_of(layers)))).max(axis=2)
        assert (off.min(axis=0) <= (4 if width > 1 else 32)).all(), "a colour is missing"
        assert (off.min(axis=1) <= 32).all(), "a colour is too many"


def test_tips_and_gaps_belong_to_what_shines_through():
    def wedge(x, y):
        return (abs(y - 30.2) < (x - 5) * 0.05) & (x > 5) & (x < 55)

    labels = label_pixels(draw(60, 60, [(WHITE, everywhere), (BLACK, wedge)]), DEFAULT)
    black = labels.index == np.argmin(labels.palette[:, 0])
    assert np.flatnonzero(black.any(axis=0)).min() <= 11
    assert label_components(np.where(black, 1, 0), 8).max() == 1


def test_dense_stripes_keep_their_colours():
    """Stripes of one and two pixels: where a dark one stands out more than the bright one beside it."""
    red, brown = (207, 52, 26, 255), (176, 114, 46, 255)
    layers = [(BLACK, everywhere), (red, box(3, 3, 9, 9)), (brown, box(40, 3, 50, 9)),
              (red, box(0, 14, 60, 18.27)), (brown, box(0, 20.1, 60, 21.25)), (red, box(0, 22.48, 60, 24.73))]
    labels = label_pixels(draw(60, 60, layers), DEFAULT)
    rows = shown(labels)[17:26, 30]
    expected = [red, BLACK, BLACK, brown, BLACK, red, red, red, BLACK]
    np.testing.assert_array_equal(rows, expected)


def test_box_has_no_ears():
    """A pixel covered by three eighths at a corner belongs to the page."""
    layers = [(WHITE, everywhere), (BLACK, box(10.5, 10.25, 30.5, 30.25))]
    labels = label_pixels(draw(40, 40, layers), DEFAULT)
    black = labels.index == np.argmin(labels.palette[:, 0])
    rows, cols = black.any(axis=1), black.any(axis=0)
    np.testing.assert_array_equal(black, rows[:, None] & cols)


def test_edges_that_run_along_the_border_make_no_islands():
    for offset in (0, 0.3, 0.6):
        layers = [(WHITE, everywhere), (BLACK, half_plane(30, offset, 0.02)),
                  (WHITE, half_plane(30, offset + 6.3, 0.04)), (BLACK, half_plane(30, offset + 20, 0.02))]
        labels = label_pixels(draw(50, 60, layers), DEFAULT)
        assert label_components(labels.index, 8).max() + 1 == 4


def test_border_half_covered_takes_no_colour_from_further_inside():
    blue = (33, 97, 161, 255)
    layers = [(WHITE, everywhere), (BLACK, box(5, 30, 55, 59.5)), (blue, box(10, 35, 50, 57))]
    last = shown(label_pixels(draw(60, 60, layers), DEFAULT))[59]
    assert not (last == blue).all(axis=-1).any()


def test_four_pixels_of_a_colour_count():
    layers = [(WHITE, everywhere), (BLACK, disc(30, 30, 12)), ((20, 160, 60, 255), box(50, 50, 52, 52))]
    assert palette_of(label_pixels(draw(60, 60, layers), DEFAULT)) == colours_of(layers)


# transparency

@pytest.mark.parametrize("hidden", [(10, 200, 30), None])
def test_nothing_is_one_label_whatever_colour_it_hides(hidden):
    image = draw(60, 60, [((200, 30, 40, 255), disc(30, 30, 20))])
    hidden = np.random.RandomState(1).randint(0, 256, (60, 60, 3)) if hidden is None else hidden
    image[..., :3] = np.where(image[..., 3:] == 0, hidden, image[..., :3])
    labels = label_pixels(image, DEFAULT)
    assert palette_of(labels) == {NOTHING, (200, 30, 40, 255)}


def test_edge_against_nothing_is_coverage():
    image = draw(60, 60, [((200, 30, 40, 255), disc(30, 30, 20))])
    labels = label_pixels(image, DEFAULT)
    filled = shown(labels)[..., 3] == 255
    np.testing.assert_array_equal(filled[~labels.thin], (image[..., 3] >= 128)[~labels.thin])


def test_partial_opacity_is_a_colour_of_its_own():
    layers = [((0, 120, 0, 255), disc(20, 30, 14)), ((200, 30, 40, 128), disc(45, 30, 12)),
              (BLACK, disc(45, 30, 5))]
    assert palette_of(label_pixels(draw(60, 64, layers), DEFAULT)) == colours_of(layers) | {NOTHING}


# pictures of other kinds

def test_hard_edged_pictures_keep_every_pixel():
    points = paint(96, 96, CARTOON, samples=1)
    labels = label_pixels(points, DEFAULT)
    assert palette_of(labels) == colours_of(CARTOON)
    np.testing.assert_array_equal(shown(labels), points)


def test_lone_pixels_of_a_hard_edged_picture_stay():
    layers = [(WHITE, everywhere), (BLACK, half_plane(30, 30, 0.3)), ((128, 128, 128, 255), disc(10, 50, 6))]
    points = paint(60, 60, layers, samples=1)
    points[[10, 30, 41], [20, 33, 44]] = 128, 128, 128, 255
    np.testing.assert_array_equal(shown(label_pixels(points, DEFAULT)), points)


@pytest.mark.parametrize("steepness", [0.7, 2.0, 6.0])
def test_a_soft_ramp_is_one_region(steepness):
    y, x = np.mgrid[:64, :80]
    image = np.zeros((64, 80, 4), np.uint8)
    image[..., 0] = np.clip(20 + (x - 8) * steepness * 0.6, 0, 255)
    image[..., 1] = np.clip(60 + (x - 8) * steepness * 0.4, 0, 255)
    image[..., 3] = 255
    inside = (x >= 8) & (x < 40) & (y >= 8) & (y < 56)
    image[~inside] = WHITE
    labels = label_pixels(image, DEFAULT)
    assert labels.ramp.sum() == 1 and len(labels.palette) == 2
    np.testing.assert_array_equal(labels.ramp[labels.index], inside)
    np.testing.assert_allclose(labels.palette[labels.ramp][0], image[inside].mean(axis=0), atol=0.3)


def test_pieces_of_a_ramp_join_it():
    """A faint crease across a ramp, with small plateaus of its own."""
    x = np.arange(90)
    image = np.full((60, 90, 4), 255, np.uint8)
    image[10:50, 10:80, :3] = (60 + 2 * x[10:80] // 1)[:, None]
    image[28:31, 20:70, :3] = (60 + 2 * (x[20:70] // 5 * 5) + 7)[:, None]
    labels = label_pixels(image, DEFAULT)
    assert len(labels.palette) == 2 and labels.ramp.sum() == 1


def test_two_ramps_are_two_labels():
    x = np.arange(90)
    image = np.full((40, 90, 4), 255, np.uint8)
    image[..., 0] = np.where(x < 40, 100 + 2 * x, np.where(x > 50, 280 - 2 * x, 255))
    labels = label_pixels(image, DEFAULT)
    assert labels.ramp.sum() == 2


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("regions", ["palette", "threshold"])
def test_noise_is_bounded(seed, regions):
    image = np.random.RandomState(seed).randint(0, 256, (200, 300, 4)).astype(np.uint8)
    labels = label_pixels(image, TraceOptions(regions=regions))
    check_form(labels, image.shape[:2])
    if regions == "palette":
        assert len(labels.palette) <= 64


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 2), (3, 40)])
@pytest.mark.parametrize("settings", [{}, {"regions": "threshold"}, {"colors": 2, "speckle": 3.0}])
def test_tiny_pictures(shape, settings):
    rng = np.random.RandomState(5)
    for image in (rng.randint(0, 256, (*shape, 4)), np.zeros((*shape, 4)), np.full((*shape, 4), 77)):
        check_form(label_pixels(image.astype(np.uint8), TraceOptions(**settings)), shape)


# settings

def test_number_of_colours_is_limited():
    image = draw(96, 96, CARTOON)
    for most in (1, 2, 3, 5):
        labels = label_pixels(image, TraceOptions(colors=most))
        assert len(labels.palette) == most
        assert palette_of(labels) <= colours_of(CARTOON)


def test_nothing_does_not_count_as_a_colour():
    image = draw(60, 60, [(BLACK, disc(20, 30, 14)), ((200, 30, 40, 255), disc(45, 30, 12))])
    assert palette_of(label_pixels(image, TraceOptions(colors=1))) == {NOTHING, BLACK}


def test_specks_join_the_neighbour_with_the_longest_border():
    image = np.full((20, 30, 4), 255, np.uint8)
    image[:, 15:] = BLACK
    image[8:11, 13:17] = (255, 0, 0, 255)
    image[2:4, 2:4] = (0, 0, 255, 255)
    image[15:19, 2:7] = (0, 255, 0, 255)
    labels = label_pixels(image, TraceOptions(speckle=16.0))
    assert palette_of(labels) == {WHITE, BLACK, (0, 255, 0, 255)}
    assert label_components(labels.index).max() == 2


def test_threshold_links_small_steps_in_all_eight_directions():
    image = np.full((5, 9, 4), 255, np.uint8)
    image[..., :3] = np.arange(9)[:, None] * 8
    image[:, 5:, :3] += 100
    index = label_pixels(image, TraceOptions(regions="threshold", threshold=3.5)).index
    np.testing.assert_array_equal(index, np.where(np.arange(9) < 5, 0, 1)[None].repeat(5, axis=0))
    assert label_pixels(image, TraceOptions(regions="threshold", threshold=3.0)).index.max() == 8
    diagonal = np.where(np.eye(6, dtype=bool)[..., None], BLACK, WHITE).astype(np.uint8)
    labels = label_pixels(diagonal, TraceOptions(regions="threshold"))
    assert len(labels.palette) == 2 and palette_of(labels) == {BLACK, WHITE}


def test_time_grows_with_the_picture_not_faster():
    """16 times the pixels, with the same share of edges, take little more than 16 times as long."""
    small = np.tile(draw(96, 96, CARTOON), (2, 2, 1))
    large = np.tile(small, (4, 4, 1))
    times = []
    for image in (small, large):
        runs = []
        for _ in range(3):
            start = process_time()
            label_pixels(image, DEFAULT)
            runs.append(process_time() - start)
        times.append(min(runs))
    assert times[1] < 25 * times[0]


def test_few_colours_are_all_tried_however_many_pixels(monkeypatch):
    image = draw(96, 96, CARTOON)
    before = label_pixels(image, TraceOptions())
    monkeypatch.setattr("ddtcore.sides._TRIED", 0)
    np.testing.assert_array_equal(label_pixels(image, TraceOptions()).index, before.index)


def test_one_plateau_explains_no_other_colours():
    """No mixes with a single colour lie between it and others, however few pixels these have."""
    blue = np.array([[128, 128, 117], [117, 117, 40]] + [[0, 0, 0]] * 3)
    image = np.stack([0 * blue, 0 * blue, blue, 0 * blue + 255], axis=2).astype(np.uint8)
    labels = label_pixels(image, DEFAULT)
    assert np.abs(labels.palette[labels.index] - image).max() <= 12
