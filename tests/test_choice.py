# SPDX-License-Identifier: GPL-2.0-or-later
"""What suits a picture: clip art unless it surely is something else."""

from __future__ import annotations

import io

import numpy as np
import pytest
from meshes import clip_art
from otherart import enlarged, photograph, sprite
from pictures import disc, picture
from PIL import Image, ImageFilter

from ddtcore import trace
from ddtcore.choice import FEW, choose_preset, settle
from ddtcore.options import Automatic, TraceOptions

NAMES = ["doctor", "stegosaurus", "sunglasses"]
RANDOM = np.random.RandomState(4)

def jpeg(image, quality):
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "JPEG", quality=quality)
    return np.asarray(Image.open(file).convert("RGBA"))


def scanned(image):
    """Blurred, on paper that is not quite white, lit from one side, with noise."""
    soft = np.asarray(Image.fromarray(image).convert("RGB").filter(ImageFilter.GaussianBlur(0.8)), float)
    light = np.linspace(5, -10, image.shape[1])[None, :, None]
    noisy = 0.92 * soft + 8 + light + RANDOM.normal(0, 4, image.shape[:2])[..., None]
    return np.dstack([np.clip(noisy, 0, 255), np.full(image.shape[:2], 255)]).astype(np.uint8)


SPOILT = {"as it is": lambda image: image, "JPEG 75": lambda image: jpeg(image, 75),
          "JPEG 40": lambda image: jpeg(image, 40), "scanned": scanned,
          "dithered": lambda image: np.asarray(Image.fromarray(image).convert("RGB").quantize(16).convert("RGBA")),
          "half": lambda image: np.asarray(Image.fromarray(image).resize(
              (image.shape[1] // 2, image.shape[0] // 2), Image.BICUBIC))}


@pytest.mark.parametrize("spoil", SPOILT)
@pytest.mark.parametrize("name", NAMES)
def test_clip_art_is_clip_art_however_it_was_saved(name, spoil):
    assert choose_preset(SPOILT[spoil](clip_art(name))).preset == "clip-art"


def test_shaded_clip_art_is_clip_art():
    row, col = np.mgrid[0:200, 0:300]
    shades = np.dstack([row, col * 200 // 300, 255 - row, np.full(row.shape, 255)]).astype(np.uint8)
    shades[60:140, 80:200, :3] = (200, 30, 30)
    for image in (shades, jpeg(shades, 60)):
        assert choose_preset(image).preset == "clip-art"


@pytest.mark.parametrize("times", [3, 5])
def test_what_is_enlarged_is_looked_at_from_farther_away(times):
    """A camera's twelve megapixels are smooth from pixel to pixel."""
    for image, kind in ((photograph(512), "photo"), (clip_art("doctor"), "clip-art")):
        size = image.shape[1] * times, image.shape[0] * times
        assert choose_preset(np.asarray(Image.fromarray(image).resize(size, Image.BICUBIC))).preset == kind


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("spoil", ["as it is", "JPEG 75", "JPEG 40", "half"])
def test_photographs(channels, spoil):
    assert choose_preset(SPOILT[spoil](photograph(channels=channels))).preset == "photo"


@pytest.mark.parametrize("times", [1, 2, 3, 16])
@pytest.mark.parametrize("colours", [((0, 0, 0, 0), (60, 220, 80, 255)), ((255, 255, 255, 255), (0, 0, 0, 255))])
def test_sprites_are_pixel_art_enlarged_or_not(times, colours):
    choice = choose_preset(enlarged(sprite(colours), times))
    assert choice.preset == "pixel-art"
    assert ("without" if times == 1 else f"{times} x {times} px") in choice.reason and "2 colours" in choice.reason


def test_what_is_enlarged_unevenly_or_smoothly_is_no_sprite():
    large = Image.fromarray(enlarged(sprite(((255, 255, 255, 255), (0, 0, 0, 255))), 8))
    for image in (large.resize((167, 121), Image.NEAREST), large.resize((167, 121), Image.BICUBIC)):
        assert choose_preset(np.asarray(image)).preset == "clip-art"


@pytest.mark.parametrize("name", NAMES)
def test_small_and_anti_aliased_is_no_sprite(name):
    image = Image.fromarray(clip_art(name))
    image.thumbnail((48, 48), Image.BOX)
    assert choose_preset(np.asarray(image)).preset == "clip-art"


def test_a_small_symmetric_icon_has_few_colours_and_is_no_sprite():
    icon = picture(20, 20, [disc((10, 10), 7)]).image
    assert np.unique(icon.reshape(-1, 4), axis=0).shape[0] < FEW
    assert choose_preset(icon).preset == "clip-art"


def test_areas_filled_with_texture_are_no_photograph():
    row, col = np.mgrid[0:200, 0:200]
    grain = RANDOM.randint(-16, 17, (200, 200, 1))
    for colours in (np.array([[90, 90, 90], [170, 170, 170]]), RANDOM.randint(30, 220, (4, 3))):
        image = np.clip(colours[(col // 40 + row // 50) % len(colours)] + grain, 0, 255)
        image = np.dstack([image, np.full((200, 200), 255)]).astype(np.uint8)
        choice = choose_preset(image)
        assert choice.preset == "clip-art" and int(choice.reason.split("%")[0].split()[-1]) > 50


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (2, 2), (5, 5), (40, 60)])
def test_what_holds_next_to_nothing_is_clip_art(shape):
    for level in (0, 255):
        assert choose_preset(np.full((*shape, 4), level, np.uint8)).preset == "clip-art"


def test_what_lies_under_transparent_pixels_has_no_say():
    image = enlarged(sprite(), 4)
    noisy = image.copy()
    hidden = image[..., 3] == 0
    noisy[hidden, :3] = RANDOM.randint(0, 256, (hidden.sum(), 3))
    assert choose_preset(noisy) == choose_preset(image)


def test_large_pictures_are_sampled():
    photo = photograph(512)
    assert choose_preset(np.tile(photo, (4, 4, 1))).preset == choose_preset(photo).preset == "photo"


def test_choices_can_be_given_and_are_told():
    image = enlarged(sprite(), 4)
    assert settle(image, TraceOptions()) == (TraceOptions(), "")
    options, choice = settle(image, None)
    assert options == TraceOptions.preset("pixel-art") and choice == str(choose_preset(image))
    assert settle(image, Automatic(stacking="cutout"))[0] == TraceOptions.preset("pixel-art", stacking="cutout")
    assert trace(image).choice == choice and trace(image, TraceOptions()).choice == ""
    assert trace(image).to_svg() == trace(image, TraceOptions.preset("pixel-art")).to_svg()


@pytest.mark.parametrize("name", NAMES)
def test_chosen_clip_art_is_traced_as_by_default(name):
    image = clip_art(name)
    assert trace(image).to_svg() == trace(image, TraceOptions()).to_svg()
