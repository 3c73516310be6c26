# SPDX-License-Identifier: GPL-2.0-or-later
"""Paint the pictures of README.md: bitmaps and traces enlarged, beside each other, with words above."""

from __future__ import annotations

import io
import re
from pathlib import Path

import resvg_py
from PIL import Image, ImageDraw, ImageFont

PICTURES = Path(__file__).resolve().parent / "images" / "readme"

_GAP = 16
_INK = "#d0006f"


def paint(body, box, zoom, folder=None):
    """Render a piece of SVG, in pixels of the picture, where `box` (x, y, width, height) lies.

    Links in it are looked for in `folder`.
    """
    x, y, width, height = box
    body = re.sub(r"^<\?xml.*?\?>", "", body)
    svg = (f'<svg xmlns="http://www.w3.org/2000/svg" width="{width * zoom}" height="{height * zoom}"'
           f' viewBox="{x} {y} {width} {height}">{body}</svg>')
    png = resvg_py.svg_to_bytes(svg_string=svg, background="white", skip_system_fonts=True,
                                resources_dir=str(folder) if folder else None)
    return Image.open(io.BytesIO(bytes(png))).convert("RGB")


def enlarge(picture, box, zoom):
    """The bitmap itself, every pixel a square."""
    x, y, width, height = box
    with Image.open(picture) as image:
        pixels = image.convert("RGBA").crop((x, y, x + width, y + height))
    page = Image.new("RGBA", pixels.size, "white")
    page.alpha_composite(pixels)
    return page.convert("RGB").resize((width * zoom, height * zoom), Image.NEAREST)


def nodes(drawing, zoom):
    """The nodes of a drawing as dots, the control points as handles."""
    dots, handles = set(), set()
    for shape in drawing.shapes:
        for loop in shape.loops:
            for (p0, p1, p2, p3), degree in zip(loop.control.round(2).tolist(), loop.degree):
                dots.add(tuple(p0))
                if degree > 1:
                    handles.update([(*p0, *p1), (*p3, *p2)])
    lines = "".join(f"M{x0} {y0}L{x1} {y1}" for x0, y0, x1, y1 in sorted(handles))
    circles = "".join(f'<circle cx="{x}" cy="{y}" r="{2.6 / zoom}"/>' for x, y in sorted(dots))
    return (f'<path d="{lines}" fill="none" stroke="{_INK}" stroke-width="{1 / zoom}"/>'
            f'<g fill="{_INK}" stroke="white" stroke-width="{.8 / zoom}">{circles}</g>')


def beside(*rows, gap=_GAP):
    """Pictures of one size in rows, with a gap between them."""
    width, height = rows[0][0].size
    columns = len(rows[0])
    page = Image.new("RGB", (columns * (width + gap) - gap, len(rows) * (height + gap) - gap), "white")
    for i, row in enumerate(rows):
        for j, picture in enumerate(row):
            page.paste(picture, (j * (width + gap), i * (height + gap)))
    return page


def labelled(page, labels, gap=_GAP):
    """Pictures beside each other with a word above each column."""
    font, room = ImageFont.load_default(15), 22
    higher = Image.new("RGB", (page.width, page.height + room), "white")
    higher.paste(page, (0, room))
    pen = ImageDraw.Draw(higher)
    for k, label in enumerate(labels):
        left = k * (page.width + gap) / len(labels)
        pen.text((left, 0), label, "#333", font)
    return higher


def save(picture, name, colours=64):
    """Write a PNG with few colours: small, and the same at every run."""
    PICTURES.mkdir(exist_ok=True)
    reduced = picture.quantize(colours, method=Image.MEDIANCUT, dither=Image.NONE)
    reduced.save(PICTURES / f"{name}.png", optimize=True)
