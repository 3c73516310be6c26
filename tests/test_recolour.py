# SPDX-License-Identifier: GPL-2.0-or-later
"""A given palette, merged colours, no background: the colours change, the edges do not."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshes import clip_art, pictures
from painted import render
from pictures import BLACK, BLUE, RED, WHITE, disc, picture, rectangle

from ddtcore import TraceOptions, trace
from ddtcore.perception import oklab
from ddtcore.recolour import merge_similar, part_background
from ddtcore.regions import label_pixels

CENTRE = np.array((30.3, 31.2))
PINK = (205, 40, 55, 255)


def ring(outer, inner):
    return np.concatenate([outer, outer[:1], inner[:1], inner[::-1]])


def cartoon(colours, times=1):
    """A white face with an outline, a blue block and a disc like the block's neighbour, on white; 96 x 64."""
    parts = [ring(disc(CENTRE, 22), disc(CENTRE, 19.2)), disc(CENTRE, 6), rectangle((72.4, 20.7), 30, 17, -8),
             disc((74.5, 46.1), 9)]
    return picture(96 * times, 64 * times, [part * times for part in parts], colours).image


USUAL = (WHITE, BLACK, RED, BLUE, PINK)


def levels(image, truth):
    return np.sqrt(np.mean((image.astype(float) - truth) ** 2))


def fills(drawing):
    return {shape.rgb for shape in drawing.shapes}


# -- palette ----------------------------------------------------------------------

def test_fills_are_those_of_the_palette_and_edges_stay_where_they_are():
    drawing = trace(cartoon(USUAL), TraceOptions(palette="#fff #012 #e70 #08f"))
    assert fills(drawing) == {(255, 255, 255), (0, 17, 34), (238, 119, 0), (0, 136, 255)}
    new = ((255, 255, 255, 255), (0, 17, 34, 255), (238, 119, 0, 255), (0, 136, 255, 255), (238, 119, 0, 255))
    truth = cartoon(new, 4)
    assert levels(render(drawing, 4), truth) < 3.5
    usual = trace(cartoon(USUAL), TraceOptions())
    assert levels(render(usual, 4), cartoon(USUAL, 4)) < 3.5


@given(pictures(), st.lists(st.tuples(*3 * [st.integers(0, 255)]), min_size=1, max_size=4, unique=True))
@settings(max_examples=10, deadline=None)
def test_no_picture_gets_other_colours_than_the_palette_s(image, colours):
    for regions in ("palette", "threshold", "pixels", "areas", "black-white"):
        drawing = trace(image, TraceOptions(palette=colours, regions=regions))
        assert fills(drawing) <= set(colours)
        assert all(shape.gradient is None for shape in drawing.shapes)


def test_soft_ramps_become_bands_of_the_palette():
    row = np.arange(120)[:, None] * np.ones(80)
    image = np.dstack([row * 2, row * 2, row * 2, np.full(row.shape, 255)]).astype(np.uint8)
    drawing = trace(image, TraceOptions(palette="#000 #555 #aaa #fff"))
    assert len(drawing.shapes) == 4 and fills(drawing) == {(k, k, k) for k in (0, 85, 170, 255)}
    middle = render(drawing)[:, 40, 0].astype(int)
    assert (np.diff(middle) >= 0).all(), "from black to white"
    lightness = oklab(np.repeat(np.arange(0, 240, 2)[:, None], 3, axis=1))[:, 0]
    ends = oklab(np.array([[0] * 3, [85] * 3, [170] * 3, [255] * 3]))[:, 0]
    for level, (low, high) in zip((85, 170), zip(ends, ends[1:])):
        change = np.argmax(lightness > (low + high) / 2)
        assert abs(np.argmax(middle >= level) - change) <= 2


def test_transparency_stays():
    image = cartoon(tuple((*colour[:3], 128) for colour in USUAL))
    drawing = trace(image, TraceOptions(palette="#fff #000"))
    assert {round(shape.opacity * 255) for shape in drawing.shapes} == {128}
    image[:, 48:] = 0
    assert (render(trace(image, TraceOptions(palette="#fff #000")))[:, 50:, 3] == 0).all()


def test_the_fills_of_a_colour_are_one_string():
    svg = trace(cartoon(USUAL), TraceOptions(palette="#fff #000000 #E70")).to_svg()
    assert svg.count("#e70") >= 1 and "#ee7700" not in svg.lower()


# -- merge ------------------------------------------------------------------------

def test_colours_that_look_alike_become_the_more_frequent_one():
    apart = 100 * np.linalg.norm(oklab(np.array(RED[:3])) - oklab(np.array(PINK[:3])))
    both = {RED[:3], PINK[:3]}
    for merge, left in ((0.0, both), (0.9 * apart, both), (1.1 * apart, {PINK[:3]})):
        assert fills(trace(cartoon(USUAL), TraceOptions(merge=merge))) & both == left
    drawing = trace(cartoon(USUAL), TraceOptions(merge=1.1 * apart))
    assert levels(render(drawing, 4), cartoon((WHITE, BLACK, PINK, BLUE, PINK), 4)) < 3.5


@given(st.lists(st.tuples(*3 * [st.integers(0, 255)]), min_size=1, max_size=12, unique=True),
       st.floats(0.01, 0.9))
@settings(deadline=None)
def test_what_is_left_is_farther_apart_and_nothing_has_moved_farther(colours, apart):
    # Blocks of the colours, the first ones larger.
    blocks = [np.full((2, 40 - 2 * k, 4), (*colour, 255), np.uint8) for k, colour in enumerate(colours)]
    image = np.concatenate([np.pad(block, ((0, 0), (0, 40 - block.shape[1]), (0, 0)), mode="edge")
                            for block in blocks])
    labels = label_pixels(image, TraceOptions(regions="pixels"))
    _, merged = merge_similar(image, labels, apart)
    before = oklab(labels.palette[labels.index][..., :3])
    after = oklab(merged.palette[merged.index][..., :3])
    assert np.linalg.norm(before - after, axis=-1).max() < apart
    look = oklab(merged.palette[:, :3])
    distance = np.linalg.norm(look[:, None] - look, axis=-1)[~np.eye(len(look), dtype=bool)]
    assert (distance >= apart).all() and len(np.unique(merged.palette, axis=0)) == len(merged.palette)


def test_merging_everything_leaves_one_shape():
    drawing = trace(cartoon(USUAL), TraceOptions(merge=100.0))
    assert [shape.rgb for shape in drawing.shapes] == [WHITE[:3]]


# -- background -------------------------------------------------------------------

@pytest.mark.parametrize("stacking", ["stacked", "cutout"])
def test_the_colour_of_the_border_is_dropped_and_what_others_enclose_stays(stacking):
    image = cartoon(USUAL)
    kept = trace(image, TraceOptions(stacking=stacking))
    drawing = trace(image, TraceOptions(stacking=stacking, background="drop"))
    back, truth = render(drawing, 4), cartoon(((255, 255, 255, 0), *USUAL[1:]), 4)
    outside = np.hypot(*(np.mgrid[0:256, 0:384] / 4 - CENTRE[::-1, None, None])) > 23
    blank = outside & (truth[..., 3] == 0)
    assert (back[..., 3][blank & (render(kept, 4)[..., :3] == 255).all(axis=2)] < 30).all()
    inside = np.hypot(*(np.mgrid[0:256, 0:384] / 4 - CENTRE[::-1, None, None])) < 18
    # Shapes that are cut out leave a hairline of the page between them.
    assert (back[inside][:, 3] >= (254 if stacking == "stacked" else 180)).all(), "the face is still white"
    assert len(drawing.shapes) == len(kept.shapes) - 1
    # Over white it looks as before.
    assert levels(render(drawing, 4, page="white"), render(kept, 4, page="white")) < 1


@pytest.mark.parametrize("name", ["doctor", "stegosaurus", "sunglasses"])
def test_without_its_background_a_picture_looks_the_same_on_a_page_of_that_colour(name):
    image = clip_art(name)
    kept, dropped = (trace(image, TraceOptions(background=choice)) for choice in ("keep", "drop"))
    assert (render(dropped)[[0, 0, -1, -1], [0, -1, 0, -1], 3] == 0).all()
    assert levels(render(dropped, 2, page="white"), render(kept, 2, page="white")) < 4.5


def test_a_transparent_border_has_no_background():
    image = cartoon(((255, 255, 255, 255), *USUAL[1:]))
    image[:4] = image[-4:] = 0
    image[:, :4] = image[:, -4:] = 0
    drop, keep = (trace(image, TraceOptions(background=choice)).to_svg() for choice in ("drop", "keep"))
    assert drop == keep


def test_a_shaded_background_is_dropped_too():
    row = np.arange(96)[:, None] * np.ones(120)
    image = np.dstack([row * 2, 60 + row, 255 - row, np.full(row.shape, 255)]).astype(np.uint8)
    image[30:60, 40:80] = (200, 30, 40, 255)
    drawing = trace(image, TraceOptions(background="drop"))
    assert [shape.rgb for shape in drawing.shapes] == [(200, 30, 40)]


def test_areas_of_the_background_s_colour_are_told_apart_by_their_connection_with_the_border():
    image = np.full((9, 9, 4), 255, np.uint8)
    image[2:7, 2:7] = (0, 0, 0, 255)
    image[4, 4] = 255
    labels, painted = part_background(label_pixels(image, TraceOptions(regions="pixels")))
    assert np.array_equal(labels.palette[labels.index], image)
    expected = image.copy()
    expected[(image[..., 0] == 255) & (np.arange(81).reshape(9, 9) != 40)] = 0
    assert np.array_equal(painted.palette[painted.index], expected)


def test_a_picture_of_one_colour_is_all_background():
    assert not trace(np.full((6, 7, 4), 255, np.uint8), TraceOptions(background="drop")).shapes
