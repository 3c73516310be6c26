# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper's Table 1."""

from __future__ import annotations

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import ddtcore.pipeline
from ddtcore import TraceOptions, trace
from ddtcore.report import report
from ddtcore.svg import document, encoded


def picture(height=9, width=12):
    image = np.full((height, width, 4), 255, dtype=np.uint8)
    image[1:height - 1, 1:width // 2] = (200, 30, 30, 255)
    return image


@pytest.mark.parametrize("width", range(3, 9))
def test_bitmap_has_the_size_that_it_has_on_disk(width):
    image = picture(5, width)
    file = io.BytesIO()
    Image.fromarray(image).convert("RGB").save(file, "BMP")
    assert report(image).bmp == len(file.getvalue())


@pytest.mark.parametrize("preset", ("clip-art", "paper"))
def test_sizes_are_those_of_the_results(preset):
    options = TraceOptions.preset(preset)
    figures = report(picture(), options)
    curves = trace(picture(), options)
    assert figures.svg == len(document(curves))
    assert figures.svgz == len(b"".join(encoded(curves, compressed=True)))
    assert figures.ddt_svg == len(document(trace(picture(), replace(options, result="triangles"))))


def test_result_of_the_options_does_not_matter():
    assert report(picture(), TraceOptions(result="border")) == report(picture(), TraceOptions())


def test_what_was_chosen_is_said_and_why():
    figures = report(picture())
    assert figures.choice == trace(picture()).choice and figures.choice.startswith("clip-art (")
    assert figures.to_dict()["choice"] == figures.choice
    assert figures.to_text().splitlines()[1] == f"  preset: {figures.choice}"
    plain = report(picture(), TraceOptions())
    assert plain.choice == "" and "preset" not in plain.to_text()


def test_a_drawing_that_is_there_is_not_made_again(monkeypatch):
    results = []

    def spy(image, options):
        results.append(options.result)
        return trace(image, options)

    drawing = trace(picture())
    monkeypatch.setattr(ddtcore.pipeline, "trace", spy)
    report(picture(), drawing=drawing)
    assert results == ["triangles"]


def test_counts_are_those_of_the_stages():
    counts = report(picture()).counts
    assert {"triangles", "flips", "border triangles", "outlines", "curves"} <= set(counts)
    assert counts["triangles"] > counts["border triangles"] > counts["outlines"] > 0


def test_text_and_json_say_the_same():
    figures = report(picture(), name="a picture.png")
    read = json.loads(figures.to_json())
    assert read == figures.to_dict() and "\n" not in figures.to_json()
    assert (read["picture"], read["width"], read["height"]) == ("a picture.png", 12, 9)
    assert read["ratios"]["bmp/svg"] == figures.bmp / figures.svg
    assert read["ratios"]["ddt_svg/svgz"] == figures.ddt_svg / figures.svgz
    text = figures.to_text()
    assert text.splitlines()[0] == "a picture.png, 12 x 9 px"
    for number in list(read["bytes"].values()) + list(read["counts"].values()):
        assert f" {number:,}" in text
    assert max(map(len, text.splitlines())) < 80
