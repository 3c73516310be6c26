# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that aren't clean: JPEG, resized, dithered, photographs."""

from __future__ import annotations

import io

import numpy as np
import pytest
from artwork import CARTOON, box, colours_of, disc, draw, everywhere, palette_of

from ddtcore.calm import without_grain
from ddtcore.canvas import prepare, unpack
from ddtcore.components import label_components
from ddtcore.noise import ROUNDING, mixing_error, noise_level, noisy_colours
from ddtcore.options import TraceOptions
from ddtcore.palette import choose_colours, find_plateaus, known_labels
from ddtcore.posterise import is_noisy, posterise
from ddtcore.ramps import find_ramps
from ddtcore.regions import label_pixels

Image = pytest.importorskip("PIL.Image")
ImageFilter = pytest.importorskip("PIL.ImageFilter")

LARGE = [(colour, lambda x, y, covers=covers: covers(x / 3, y / 3)) for colour, covers in CARTOON]


def jpeg(image, quality):
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "JPEG", quality=quality)
    return np.array(Image.open(file).convert("RGBA"))


def resized(image, factor):
    size = round(image.shape[1] * factor), round(image.shape[0] * factor)
    return np.array(Image.fromarray(image).convert("RGB").resize(size, Image.BICUBIC).convert("RGBA"))


def dithered(image, colours):
    return np.array(Image.fromarray(image).convert("RGB").quantize(colours).convert("RGBA"))


def grainy(image, sigma, seed=0):
    """A little unsharp, with a grain over everything, as a scan."""
    blurred = np.array(Image.fromarray(image).convert("RGB").filter(ImageFilter.GaussianBlur(0.7)), float)
    blurred += np.random.RandomState(seed).randn(*blurred.shape) * sigma
    grained = np.full(image.shape, 255, np.uint8)
    grained[..., :3] = np.rint(blurred).clip(0, 255)
    return grained


def tinted(image):
    return np.rint(image * (0.98, 0.97, 0.955, 1)).astype(np.uint8)


def level(image):
    canvas = prepare(image)
    slopes, _ = find_ramps(canvas)
    return noise_level(canvas, find_plateaus(canvas, slopes >= 0).core, slopes)


@pytest.fixture(scope="module")
def clean():
    return draw(288, 288, LARGE)


def test_clean_art_has_no_noise(clean):
    assert level(clean) == (ROUNDING, False)
    assert level(draw(96, 96, CARTOON)) == (ROUNDING, False)
    assert level(np.full((9, 9, 4), 255, np.uint8)) == (ROUNDING, False)


def test_noise_grows_with_compression(clean):
    levels = [level(jpeg(clean, quality))[0] for quality in (95, 85, 50)]
    assert ROUNDING < levels[0] < levels[1] < levels[2] <= 24


@pytest.mark.parametrize("quality", [90, 75, 50])
def test_few_large_shapes_have_the_noise_that_is_beside_their_edges(quality):
    """Ripples that run out into flat areas make ramps of these, which tell nothing of the noise."""
    few = draw(400, 400, [((255, 255, 255, 255), everywhere), ((179, 206, 204, 255), box(120, 150, 280, 330)),
                          ((214, 229, 229, 255), box(140, 150, 180, 330)), ((255, 211, 102, 255), disc(200, 90, 45))])
    spoilt = jpeg(few, quality)
    assert level(spoilt)[0] > 2 * ROUNDING
    labels = label_pixels(spoilt, TraceOptions())
    assert len(labels.palette) == 4 and label_components(labels.index, 8).max() <= 4


@pytest.mark.parametrize("spoil", [lambda image: jpeg(image, 90), lambda image: jpeg(image, 75),
                                   lambda image: jpeg(image, 50), lambda image: resized(image, 0.7),
                                   lambda image: resized(image, 1.5), lambda image: dithered(image, 32),
                                   lambda image: grainy(image, 2), lambda image: grainy(image, 3),
                                   lambda image: grainy(tinted(image), 3)],
                         ids=["q90", "q75", "q50", "reduced", "enlarged", "dithered", "scanned", "scanned badly",
                              "on yellowish paper"])
def test_spoiled_pictures_have_the_colours_and_regions_of_the_clean_one(clean, spoil):
    labels = label_pixels(spoil(clean), TraceOptions())
    found = np.array(sorted(palette_of(labels)))[:, None]
    off = np.abs(found - np.array(sorted(colours_of(CARTOON)))).max(axis=-1)
    assert (off.min(axis=0) <= 12).all(), "a colour is missing"
    assert (off.min(axis=1) <= 12).all(), "a colour is too many"
    assert label_components(labels.index, 8).max() + 1 <= 1.5 * 12


def test_mixes_are_exact_unless_the_colours_were_reduced(clean):
    errors = []
    for image in (clean, dithered(clean, 64), dithered(clean, 20)):
        canvas = prepare(image)
        plateaus = find_plateaus(canvas, np.zeros(canvas.shape, bool))
        labels = known_labels(canvas, plateaus, choose_colours(canvas, plateaus, False), ROUNDING)
        errors.append(mixing_error(canvas, labels, canvas.cells(~plateaus.core)))
    assert errors[0] == ROUNDING and errors[2] > 3


def test_channels_near_their_ends_lie_there(clean):
    blue = (40, 90, 180, 255)
    changed = np.where((clean == blue).all(axis=-1)[..., None], np.array((0, 51, 217, 255), np.uint8), clean)
    found = palette_of(label_pixels(jpeg(changed, 50), TraceOptions()))
    assert any(colour[0] == 0 and colour[2] > 180 for colour in found)


@pytest.mark.parametrize("quality", [75, 50])
def test_colours_nearer_to_each_other_than_the_noise(quality):
    near = [(204, 81, 29, 255), (204, 109, 44, 255)]
    image = draw(240, 240, [((255, 255, 255, 255), everywhere), ((12, 12, 12, 255), disc(120, 120, 115)),
                            (near[1], disc(120, 120, 105)), ((12, 12, 12, 255), disc(120, 120, 90)),
                            (near[0], disc(120, 120, 80))])
    noise, _ = level(jpeg(image, quality))
    labels = label_pixels(jpeg(image, quality), TraceOptions())
    assert 2 * noise > 28 and len(labels.palette) == 4
    for y, colour in ((120, near[0]), (217, near[1])):
        assert np.abs(labels.palette[labels.index[y, 110:130]] - colour).max() <= 3


@pytest.mark.parametrize("sigma", [3, 4])
@pytest.mark.parametrize("seed", range(4))
def test_thin_strokes_of_a_scan_have_one_ink(sigma, seed):
    """Some cover their pixels more than others do; the grain makes the paler ones stand out as well."""
    random = np.random.RandomState(seed)
    white, black, blue = (255, 255, 255, 255), (0, 0, 0, 255), (0, 51, 217, 255)
    layers = [(white, everywhere), (blue, lambda x, y: x > 150)]
    for x, y in np.argwhere(np.ones((12, 12))) * 18 + 12:
        width, reach = random.uniform(1.6, 3.2) / 2, random.uniform(4, 7)
        layers.append((black, lambda u, v, x=x, y=y, width=width, reach=reach:
                       (abs(u - x) < width) & (abs(v - y) < reach) | (abs(v - y) < width) & (abs(u - x) < reach)))
    found = palette_of(label_pixels(grainy(draw(240, 240, layers), sigma, seed), TraceOptions()))
    assert {white, blue} <= found and sum(max(colour[:3]) - min(colour[:3]) < 12 for colour in found) == 2


def test_black_and_white_stay_exact(clean):
    for quality in (90, 75):
        labels = label_pixels(jpeg(clean, quality), TraceOptions())
        assert {(0, 0, 0, 255), (255, 255, 255, 255)} <= palette_of(labels)


def test_large_ramps_survive_a_little_compression():
    image = np.full((96, 128, 4), 255, np.uint8)
    image[8:88, 8:120, :3] = np.stack([np.arange(112) + 60, 200 - np.arange(112), np.full(112, 90)], axis=-1)
    assert label_pixels(jpeg(image, 97), TraceOptions()).ramp.any()


def test_photographs_are_posterised():
    rng = np.random.RandomState(0)
    image = np.full((160, 200, 4), 255, np.uint8)
    smooth = np.cumsum(np.cumsum(rng.randn(160, 200, 3), axis=0), axis=1)
    smooth = 255 * (smooth - smooth.min()) / np.ptp(smooth)
    image[..., :3] = np.clip(smooth + 12 * rng.randn(160, 200, 3), 0, 255)
    assert is_noisy(prepare(image)) and without_grain(prepare(image)) is None
    labels = label_pixels(image, TraceOptions())
    assert 8 <= len(labels.palette) <= 64
    assert np.bincount(label_components(labels.index, 8).ravel()).min() >= 8
    error = labels.palette[labels.index][..., :3] - smooth
    assert np.sqrt((error ** 2).mean()) < 16
    assert len(label_pixels(image, TraceOptions(colors=5)).palette) <= 5


def test_soft_shades_under_a_grain_are_no_flat_colours():
    y, x = np.mgrid[:160, :200]
    for shade in (x + 20, 200 - y, np.hypot(x - 90, y - 80)):
        image = np.repeat(shade[..., None], 4, axis=2) + np.random.RandomState(3).randn(160, 200, 1) * 3
        image = np.rint(image).clip(0, 255).astype(np.uint8)
        image[..., 3] = 255
        assert is_noisy(prepare(image)) and without_grain(prepare(image)) is None


def test_few_colours_stay_exact():
    image = np.random.RandomState(2).randint(0, 2, (40, 40, 1)).astype(np.uint8) * np.uint8(255)
    image = np.concatenate([image, image, image, np.full_like(image, 255)], axis=-1)
    labels = posterise(prepare(image), 8)
    np.testing.assert_array_equal(labels.palette[labels.index], image)


def test_faint_edges_are_no_noise():
    """Shades of one colour beside each other: their edges are small steps, but clean ones."""
    shades = [(237, 212, 168, 255), (222, 197, 153, 255), (251, 223, 153, 255)]
    image = draw(60, 60, [((255, 255, 255, 255), everywhere), (shades[0], disc(30, 30, 24)),
                          (shades[1], disc(22.3, 30.2, 9)), (shades[2], disc(37.6, 29.7, 9))])
    assert level(image) == (ROUNDING, False)


@pytest.mark.parametrize("original, told", [(12.0, True), (18.0, False)])
def test_mixes_within_the_noise_that_was_averaged_away_are_no_colours(original, told):
    """Averages of 3 x 3 of two dark colours 32 levels apart, where the noise had made them alike."""
    image = np.full((160, 160, 4), 255, np.uint8)
    image[..., :3] = 0
    image[:, 80:, :3] = 32
    for top in range(4, 150, 12):
        for left in range(4, 70, 12):
            image[top:top + 6, left:left + 6, :3] = np.random.RandomState(top + left).randint(12, 20, (6, 6, 1))
    canvas = prepare(image)
    found = noisy_colours(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)), 4.8, original)
    assert sorted(int(rgba[0]) for rgba in unpack(found))[::len(found) - 1] == [0, 32]
    assert len(found) == 2 + told


@pytest.mark.parametrize("quality", [75, 50])
def test_brightness_tells_colours_apart_in_narrow_areas(quality):
    """As in a tiger: two browns on orange, none of them with pixels that are flat in all channels."""
    browns = [(189, 92, 0, 255), (184, 125, 0, 255)]
    layers = [((237, 148, 10, 255), everywhere)]
    for k, brown in enumerate(browns):
        layers += [((0, 0, 0, 255), lambda x, y, k=k: ((y + x / 9) % 40 < 12) & (x // 150 == k)),
                   (brown, lambda x, y, k=k: (np.abs((y + x / 9) % 40 - 6) < 4) & (x // 150 == k))]
    image = jpeg(draw(200, 300, layers), quality)
    canvas, (noise, _) = prepare(image), level(image)
    found = unpack(noisy_colours(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)), noise, noise))
    for brown in browns:
        assert np.abs(found.astype(int) - brown).max(axis=1).min() <= 14
    assert len(found) <= 4


@pytest.mark.parametrize("quality", [90, 75, 50])
def test_ripples_add_no_colours(clean, quality):
    canvas, (noise, _) = prepare(jpeg(clean, quality)), level(jpeg(clean, quality))
    found = unpack(noisy_colours(canvas, find_plateaus(canvas, np.zeros(canvas.shape, bool)), noise, noise))
    off = np.abs(found[:, None].astype(int) - np.array(sorted(colours_of(CARTOON)))).max(axis=-1)
    assert (off.min(axis=1) <= 12).all() and len(found) == len(colours_of(CARTOON))
