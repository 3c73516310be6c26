# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that are too large or too busy are traced at a lower resolution, and it is said."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore import TraceOptions, trace
from ddtcore.bezier import evaluate
from ddtcore.budget import drawing_seconds, label_within_budget, labelling_seconds
from ddtcore.model import Labels


def art(height=120, width=160):
    """A few flat areas."""
    image = np.full((height, width, 4), 255, np.uint8)
    image[height // 4:height // 2, width // 8:width // 2, :3] = (200, 30, 40)
    image[height // 3:, width // 3:, :3] = (20, 30, 140)
    return image


def noise(height, width, seed=0):
    image = np.random.RandomState(seed).randint(0, 256, (height, width, 4)).astype(np.uint8)
    image[..., 3] = 255
    return image


def by_shade(picture, factor):
    """Labels by the first channel, without any cleverness."""
    index = (picture[..., 0] >> 5).astype(np.int32)
    return Labels(index, np.zeros((8, 4)), np.zeros(index.shape, bool))


def test_what_keeps_within_the_budget_is_left_alone():
    image = art()
    small, labels, factor, note = label_within_budget(image, TraceOptions(), by_shade)
    assert small is image and factor == 1 and note == "" and labels.index.shape == image.shape[:2]
    assert trace(image).notes == ()
    unlimited = TraceOptions(seconds=3600, megapixels=1000)
    assert trace(image, unlimited).to_svg() == trace(image).to_svg()


@pytest.mark.parametrize("megapixels, factor", [(0.0192, 1), (0.019, 2), (0.01, 2)])
def test_large_pictures_are_reduced_by_the_least_factor_that_will_do(megapixels, factor):
    options = TraceOptions(megapixels=megapixels)
    small, _, found, note = label_within_budget(art(), options, by_shade)
    assert found == factor and small.shape[0] * small.shape[1] <= megapixels * 1e6
    assert bool(note) == (factor > 1)


def test_drawings_keep_the_size_of_the_picture_and_say_what_has_happened():
    for changes, named in (({"megapixels": 0.01}, "'megapixels'"), ({"seconds": 0.1}, "'seconds'")):
        image = art(121, 163) if "megapixels" in changes else noise(121, 163)
        drawing = trace(image, TraceOptions(**changes))
        assert (drawing.width, drawing.height) == (163, 121)
        note, = drawing.notes
        assert named in note and "1/" in note and "\n" not in note
        # The curves as they are drawn: handles may lie outside.
        control = np.concatenate([loop.control for shape in drawing.shapes for loop in shape.loops])
        segment, t = (grid.ravel() for grid in np.meshgrid(np.arange(len(control)), np.linspace(0, 1, 17)))
        every = evaluate(control, segment, t)
        assert np.ptp(every[:, 0]) == pytest.approx(163, abs=1) and np.ptp(every[:, 1]) == pytest.approx(121, abs=1)


def test_the_resolution_falls_until_the_time_is_enough():
    image = noise(300, 300)
    previous, seen = 0, set()
    for seconds in (60, 1.0, 0.3, 0.1):
        options = TraceOptions(seconds=seconds)
        small, labels, factor, note = label_within_budget(image, options, by_shade)
        assert labelling_seconds(small, options) + drawing_seconds(labels, options) <= seconds or len(small) <= 64
        assert factor >= previous and bool(note) == (factor > 1)
        previous = factor
        seen.add(factor)
    assert len(seen) > 2


def test_a_large_smooth_picture_is_foretold_to_take_long():
    """Where everything slopes nothing is quick; noise is treated more roughly."""
    row, col = np.mgrid[:1000, :1000]
    smooth = np.stack([128 + 90 * np.sin(row / 40) * np.cos(col / 50), 128 + 60 * np.sin((row + col) / 60),
                       128 + 60 * np.cos(row / 35 - col / 70), np.full(row.shape, 255)], axis=-1).astype(np.uint8)
    options = TraceOptions()
    assert labelling_seconds(smooth, options) > 3 * labelling_seconds(noise(1000, 1000), options)
    assert labelling_seconds(smooth, options) > 20 * labelling_seconds(art(1000, 1000), options)


def test_it_is_not_reduced_further_than_needed():
    image = noise(300, 300)
    options = TraceOptions(seconds=1.0)
    _, _, factor, _ = label_within_budget(image, options, by_shade)
    assert factor > 1
    for less in range(1, factor):
        small = image.reshape(300 // less, less, 300 // less, less, 4).mean(axis=(1, 3)).astype(np.uint8) \
            if 300 % less == 0 else None
        if small is not None:
            assert labelling_seconds(small, options) + drawing_seconds(by_shade(small, less), options) > 1.0


def test_labels_are_not_looked_for_where_that_alone_would_take_too_long():
    tried = []

    def label(picture, factor):
        tried.append(picture.shape[0])
        return by_shade(picture, factor)

    label_within_budget(noise(900, 700), TraceOptions(seconds=0.1), label)
    assert tried and max(tried) < 900


def test_tiny_pictures_are_traced_whatever_it_takes():
    _, _, factor, note = label_within_budget(noise(64, 64), TraceOptions(seconds=0.1), lambda *given: by_shade(*given))
    assert factor == 1 and note == ""


def test_time_is_foretold_from_the_picture_alone():
    busy, calm = noise(200, 200), art(200, 200)
    options = TraceOptions()
    assert labelling_seconds(busy, options) > 2 * labelling_seconds(calm, options)
    assert labelling_seconds(busy, TraceOptions(regions="areas")) > labelling_seconds(busy, options)
    both = [drawing_seconds(by_shade(image, 1), TraceOptions()) for image in (busy, calm)]
    assert both[0] > 20 * both[1] > 0
    mesh = [drawing_seconds(by_shade(image, 1), TraceOptions(result="triangles")) for image in (busy, calm)]
    assert mesh[0] == mesh[1] > 0
    # Colours under transparent pixels are no steps.
    busy[..., 3] = 0
    assert labelling_seconds(busy, options) <= labelling_seconds(calm, options)


def test_speckle_keeps_to_pixels_of_the_whole_picture(monkeypatch):
    seen = []
    from ddtcore import regions

    def label(picture, options):
        seen.append(options.speckle)
        return by_shade(picture, 1)

    monkeypatch.setattr(regions, "label_pixels", label)
    trace(art(), TraceOptions(speckle=36, megapixels=0.01))
    assert seen == [9]


def test_a_megapixel_of_noise_ends_in_a_bounded_file():
    # Reduced as far as at the full size, where it would take as long as the budget allows.
    drawing = trace(noise(400, 400), TraceOptions(seconds=1))
    assert len(drawing.to_svg()) < 1_000_000 and drawing.notes
