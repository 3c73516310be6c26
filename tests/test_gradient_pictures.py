# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures painted with known gradients are traced back to these gradients."""

from __future__ import annotations

import io
import math

import numpy as np
import pytest
import resvg_py
from painted import render
from PIL import Image

from ddtcore.gradient import colours_at
from ddtcore.model import Gradient
from ddtcore.pipeline import trace

SIZE = 160
DISC = '<circle cx="80" cy="80" r="64" fill="url(#a)"/>'
BAR = '<rect x="20" y="40" width="120" height="70" fill="url(#a)"/>'
ALL = f'<rect width="{SIZE}" height="{SIZE}" fill="url(#a)"/>'
BLUE = f'<rect width="{SIZE}" height="{SIZE}" fill="#2288cc"/>'
TWO = ((0.0, (16, 32, 128), 1.0), (1.0, (200, 240, 255), 1.0))
THREE = ((0.0, (230, 0, 0), 1.0), (0.4, (255, 255, 255), 1.0), (1.0, (0, 70, 0), 1.0))
FOUR = ((0.0, (0, 0, 0), 1.0), (0.3, (255, 128, 0), 1.0), (0.6, (255, 255, 130), 1.0), (1.0, (250, 250, 250), 1.0))
FADE = ((0.0, (250, 20, 0), 0.9), (1.0, (0, 20, 250), 0.3))
OUT = ((0.0, (20, 20, 20), 0.8), (1.0, (20, 20, 20), 0.0))

CASES = {
    "linear": (Gradient("linear", (30, 50), (130, 110), TWO), BLUE + DISC),
    "on nothing": (Gradient("linear", (30, 50), (130, 110), TWO), DISC),
    "at the border": (Gradient("linear", (0, 0), (160, 160), TWO), ALL),
    "three stops": (Gradient("linear", (20, 75), (140, 75), THREE), BLUE + BAR),
    "four stops": (Gradient("linear", (80, 16), (80, 144), FOUR), BLUE + DISC),
    "ends inside": (Gradient("linear", (60, 60), (110, 100), TWO), BLUE + DISC),
    "radial": (Gradient("radial", (80, 80), (144, 80), TWO), BLUE + DISC),
    "radial off centre": (Gradient("radial", (60, 55), (140, 55), THREE), BLUE + BAR),
    "elliptic": (Gradient("radial", (80, 80), (150, 95), TWO, across=(72, 117)), BLUE + DISC),
    "translucent": (Gradient("linear", (30, 50), (130, 110), FADE), DISC),
    "radial to nothing": (Gradient("radial", (80, 80), (144, 80), OUT), DISC),
}


def definition(gradient):
    """SVG of a gradient."""
    stops = "".join(f'<stop offset="{offset}" stop-color="rgb{rgb}" stop-opacity="{opacity}"/>'
                    for offset, rgb, opacity in gradient.stops)
    (x, y), (u, v) = gradient.start, gradient.end
    if gradient.kind == "linear":
        return (f'<linearGradient id="a" gradientUnits="userSpaceOnUse" x1="{x}" y1="{y}" x2="{u}" y2="{v}">'
                f'{stops}</linearGradient>')
    p, q = gradient.across or (x - (v - y), y + (u - x))
    return (f'<radialGradient id="a" gradientUnits="userSpaceOnUse" cx="0" cy="0" r="1" gradientTransform='
            f'"matrix({u - x} {v - y} {p - x} {q - y} {x} {y})">{stops}</radialGradient>')


def rendered(gradient, body, zoom=1):
    svg = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{SIZE}" height="{SIZE}" viewBox="0 0 {SIZE} {SIZE}">'
           f'<defs>{definition(gradient)}</defs>{body}</svg>')
    png = resvg_py.svg_to_bytes(svg_string=svg, width=SIZE * zoom)
    return np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGBA"))


def psnr(off):
    """dB of differences in levels."""
    return 10 * math.log10(255 ** 2 / (off ** 2).mean())


def over(rgba, page):
    """RGBA over a page of one grey level."""
    alpha = rgba[..., 3:] / 255
    return rgba[..., :3] * alpha + page * (1 - alpha)


@pytest.mark.parametrize("name", list(CASES))
def test_one_shape_has_the_gradient(name):
    gradient, body = CASES[name]
    drawing = trace(rendered(gradient, body))
    found = [shape.gradient for shape in drawing.shapes if shape.gradient]
    assert len(found) == 1 and found[0].kind == gradient.kind
    assert len(drawing.shapes) == (2 if BLUE in body else 1)
    row, col = (grid.ravel() + 0.5 for grid in np.mgrid[:SIZE, :SIZE])
    points = np.stack([col, row], axis=1)
    inside = points[np.hypot(col - 80, row - 80) < 60] if DISC in body else points[
        (abs(col - 80) < 58) & (abs(row - 75) < 33)]
    off = colours_at(found[0], inside) - colours_at(gradient, inside)
    assert np.abs(off).max() < 3 and np.sqrt((off ** 2).mean()) < 1


@pytest.mark.parametrize("name", list(CASES))
def test_traces_look_like_the_drawing_on_any_page(name):
    gradient, body = CASES[name]
    drawing = trace(rendered(gradient, body))
    truth, ours = rendered(gradient, body, 4), render(drawing, 4)
    for page in (0, 255):
        off = over(ours.astype(float), page) - over(truth.astype(float), page)
        assert psnr(off) > 42
    row, col = (np.mgrid[:4 * SIZE, :4 * SIZE] + 0.5) / 4
    if DISC in body and BLUE not in body:
        assert not ours[np.hypot(col - 80, row - 80) > 64.7].any()


def test_ends_within_the_area_are_found_where_they_are():
    gradient, body = CASES["ends inside"]
    found, = (shape.gradient for shape in trace(rendered(gradient, body)).shapes if shape.gradient)
    if math.dist(found.start, gradient.start) > math.dist(found.start, gradient.end):
        found = Gradient("linear", found.end, found.start, tuple((1 - t, *stop) for t, *stop in found.stops[::-1]))
    for mine, given in zip((found.start, found.end), (gradient.start, gradient.end)):
        # Only the place along the gradient is determined.
        along = np.subtract(gradient.end, gradient.start) / math.dist(gradient.start, gradient.end)
        assert abs(np.subtract(mine, given).dot(along)) < 1
    for mine, given in zip(found.stops, gradient.stops):
        assert np.abs(np.subtract(mine[1], given[1])).max() <= 2 and mine[2] == given[2]


def test_centres_and_radii_are_found():
    for name in ("radial", "radial off centre", "elliptic"):
        gradient, body = CASES[name]
        found, = (shape.gradient for shape in trace(rendered(gradient, body)).shapes if shape.gradient)
        assert math.dist(found.start, gradient.start) < 1


def test_a_gloss_that_fades_into_a_plateau_is_a_shape_of_its_own():
    gloss = Gradient("linear", (80, 30), (80, 84), ((0.0, (255, 255, 255), 0.8), (1.0, (255, 255, 255), 0.0)))
    body = '<circle cx="80" cy="80" r="64" fill="#0066cc"/><ellipse cx="80" cy="57" rx="44" ry="27" fill="url(#a)"/>'
    drawing = trace(rendered(gloss, body))
    soft = [shape for shape in drawing.shapes if shape.gradient]
    assert len(soft) == 1 and len(drawing.shapes) <= 3
    assert any(shape.rgb == (0, 102, 204) and shape.gradient is None for shape in drawing.shapes)
    off = over(render(drawing, 4).astype(float), 255) - over(rendered(gloss, body, 4).astype(float), 255)
    assert psnr(off) > 40


def test_strokes_on_a_gradient_are_shapes_of_their_own():
    gradient, body = CASES["linear"]
    strokes = ('<path d="M40 110 C60 60 100 60 120 100" fill="none" stroke="#fff" stroke-opacity=".4"'
               ' stroke-width="2.5"/><path d="M60 50 L110 60" stroke="#102040" stroke-width="2"/>')
    drawing = trace(rendered(gradient, body + strokes))
    assert len(drawing.shapes) == 4
    off = over(render(drawing, 4).astype(float), 255) - over(rendered(gradient, body + strokes, 4).astype(float), 255)
    assert psnr(off) > 36


@pytest.mark.parametrize("width", [0.6, 0.7, 1.0])
@pytest.mark.parametrize("name", ["linear", "radial"])
def test_a_thin_rim_has_the_colour_of_its_ink(name, width):
    gradient = CASES[name][0]
    body = BLUE + DISC.replace("/>", f' stroke="#000" stroke-width="{width}"/>')
    drawing = trace(rendered(gradient, body))
    rims = [shape for shape in drawing.shapes if max(shape.rgb) < 40 and shape.gradient is None]
    assert rims and sum(shape.gradient is not None for shape in drawing.shapes) == 1
    off = over(render(drawing, 4).astype(float), 255) - over(rendered(gradient, body, 4).astype(float), 255)
    assert psnr(off) > 30


def test_faces_share_the_gradient_that_a_bar_cuts_in_two():
    gradient, body = CASES["linear"]
    drawing = trace(rendered(gradient, body + '<rect x="70" width="12" height="160" fill="#2288cc"/>'))
    assert len({shape.gradient for shape in drawing.shapes if shape.gradient}) <= 2
    assert sum(shape.gradient is not None for shape in drawing.shapes) == 2


def test_shades_on_an_opaque_ramp_and_on_one_that_fades():
    """One is translucent to the page, the other only to what it is drawn on."""
    fading = ('<defs><linearGradient id="g"><stop offset="0" stop-color="#f40" stop-opacity=".9"/><stop offset="1"'
              ' stop-color="#f40" stop-opacity=".1"/></linearGradient></defs>'
              '<rect x="20" y="115" width="120" height="40" fill="url(#g)"/>'
              '<path d="M30 125 C60 155 100 145 120 122" fill="none" stroke="#000" stroke-opacity=".4"'
              ' stroke-width="3"/>')
    shade = ('<path d="M40 100 C60 50 100 50 120 95" fill="none" stroke="#102040" stroke-opacity=".4"'
             ' stroke-width="3"/>')
    gradient = CASES["linear"][0]
    drawing = trace(rendered(gradient, BAR + shade + fading))
    for page in (0, 255):
        off = over(render(drawing, 4).astype(float), page) - over(rendered(gradient, BAR + shade + fading, 4), page)
        assert psnr(off) > 34
