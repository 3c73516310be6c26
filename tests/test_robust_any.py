# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures by chance through the whole pipeline: parsed, and rendered back."""

from __future__ import annotations

import fuzzing
import meshes  # noqa: F401  (chooses the profile of hypothesis: the same examples in every run)
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from invariants import assert_sound
from painted import render
from pictures import coverage, disc, rectangle, star

from ddtcore import TraceOptions, trace

LEVELS = st.sampled_from([0, 51, 128, 204, 255])
OPACITY = st.sampled_from([255, 255, 255, 128, 0])
PLACES = st.floats(-4, 28, allow_nan=False, width=32)
SIZES = st.floats(0.25, 14, width=32)


@st.composite
def shapes(draw):
    """A polygon that runs clockwise: round, starry or square, anywhere near the picture."""
    centre, size = (draw(PLACES), draw(PLACES)), draw(SIZES)
    kind = draw(st.integers(0, 2))
    if kind == 0:
        return disc(centre, size)
    if kind == 1:
        return star(centre, size, size * draw(st.sampled_from([0.3, 0.6, 1.0])), draw(st.integers(3, 7)))
    return rectangle(centre, size, draw(SIZES), draw(st.integers(0, 90)))


@st.composite
def images(draw):
    """Shapes of random colours on paper of one, with or without anti-aliasing; uint8 (H, W, 4)."""
    width, height = draw(st.integers(1, 26)), draw(st.integers(1, 26))
    colour = st.tuples(LEVELS, LEVELS, LEVELS, OPACITY)
    image = np.zeros((height, width, 4)) + np.array(draw(colour), float)
    image[..., :3] *= image[..., 3:] / 255
    hard = draw(st.booleans())
    for polygon in draw(st.lists(shapes(), max_size=5)):
        share = coverage(polygon, width, height)[..., None]
        over = np.array(draw(colour), float)
        over[:3] *= over[3] / 255
        image += (np.rint(share) if hard else share) * (over - image)
    alpha = np.maximum(image[..., 3:] / 255, 1e-9)
    return np.rint(np.concatenate([np.where(alpha > 1e-6, image[..., :3] / alpha, 0), image[..., 3:]],
                                  axis=2)).clip(0, 255).astype(np.uint8)


def premultiplied(rgba):
    return np.concatenate([rgba[..., :3] * (rgba[..., 3:] / 255), rgba[..., 3:]], axis=2)


@given(images(), st.sampled_from([TraceOptions(), None, TraceOptions(stacking="cutout")]))
@settings(max_examples=120)
def test_the_drawing_looks_like_the_picture(image, options):
    drawing = trace(image, options)
    assert_sound(drawing)
    off = premultiplied(render(drawing, 1).astype(float)) - premultiplied(image.astype(float))
    # Shapes as small as these are not all to be had; but nothing large is lost or made up.
    assert np.sqrt(np.mean(off ** 2)) < 32


@given(images(), st.integers(0, 2 ** 63), st.data())
@settings(max_examples=60)
def test_any_settings_give_a_sound_drawing(image, seed, data):
    choices = {name: field.metadata["choices"] for name, field in TraceOptions.__dataclass_fields__.items()
               if field.metadata["choices"]}
    changes = {name: data.draw(st.sampled_from(values)) for name, values in choices.items()}
    drawing = trace(image, TraceOptions(**changes))
    assert_sound(drawing, by_area=changes["group"] == "none")
    assert trace(image.copy(), TraceOptions(**changes)).to_svg() == drawing.to_svg()


def test_changed_files_and_pixels_give_a_sound_drawing_or_one_sentence():
    """A short run of the fuzz target; ``make fuzz`` goes on for longer."""
    faults = []
    tried, failed = fuzzing.try_random(400, seed=1, fault=faults.append)
    assert (tried, failed) == (400, 0), faults
