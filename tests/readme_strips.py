# SPDX-License-Identifier: GPL-2.0-or-later
"""What settings do to a picture: for README.md one strip of small results for each of them."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import resvg_py
from PIL import Image
from readme_paint import beside, labelled, nodes, paint

from ddtcore import TraceOptions, load_image, trace
from ddtcore.svg import group

VECTOR = Path(__file__).resolve().parent / "images" / "vector"
WIDTH, GAP, SIZE = 256, 12, 256

STRIPS = {
    "colors": ("tiger", (4, 0, 150, 90), [{"colors": value} for value in (2, 3, 4, 0)]),
    "tolerance": ("stegosaurus.png", (158, 12, 64, 42),
                  [{"tolerance": value} for value in (.1, .2, 1.0, 3.0)]),
    "corner": ("sign", (74, 130, 60, 42), [{"corner": value, "tolerance": 1.0}
                                           for value in (10.0, 30.0, 90.0, 180.0)]),
    "speckle": ("tiger", (4, 0, 150, 90), [{"speckle": value} for value in (0.0, 6.0, 30.0, 150.0)]),
    "gradients": ("heart", (0, 0, 256, 160), [{"gradients": value} for value in
                                              ("flat", "bands", "gradients")]),
    "stacking": ("sign", (50, 110, 156, 116), [{"stacking": value} for value in ("cutout", "stacked")]),
}
"""By setting: drawing, box of the bitmap to show, and the settings of each cell."""

NODES = ("tolerance", "corner")
"""Strips that show the nodes."""


def bitmap(name, size=SIZE):
    """A drawing as a bitmap with the long side at a size, or a bitmap itself: RGBA uint8 (H, W, 4)."""
    if name.endswith(".png"):
        return load_image(VECTOR.parent / name)
    svg = (VECTOR / f"{name}.svg").read_text(encoding="utf-8")
    width, height = (float(re.search(rf'\b{side}="([\d.]+)"', svg)[1]) for side in ("width", "height"))
    scale = size / max(width, height)
    png = resvg_py.svg_to_bytes(svg_string=svg, width=round(width * scale), height=round(height * scale),
                                background="white", skip_system_fonts=True)
    return np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGBA"))


def moved(drawing, offset, share=.1):
    """The drawing with its small shapes moved, so that what lies behind is seen."""
    small = share * drawing.width * drawing.height
    shapes = [shape if shape.area > small else replace(shape, loops=tuple(
        replace(loop, control=loop.control + offset) for loop in shape.loops)) for shape in drawing.shapes]
    return replace(drawing, shapes=tuple(shapes))


def caption(name, changes, drawing):
    """What stands above a cell."""
    value = changes[name]
    count = sum(len(loop.degree) for shape in drawing.shapes for loop in shape.loops)
    text = f"{value:g}" if isinstance(value, (int, float)) else str(value)
    if changes == {"colors": 0}:
        text = "0 (all)"
    return f"{text}: {count} nodes" if name in NODES or name == "speckle" else text


def strip(name):
    """The strip of a setting."""
    source, box, cells = STRIPS[name]
    image, zoom = bitmap(source), WIDTH / box[2]
    pictures, captions = [], []
    for changes in cells:
        drawing = replace(trace(image, TraceOptions(**changes)), decimals=3)
        captions.append(caption(name, changes, drawing))
        if name == "stacking":
            drawing = moved(drawing, (14, 22))
        marks = nodes(drawing, zoom) if name in NODES else ""
        pictures.append(paint(group(drawing) + marks, box, zoom))
    return labelled(beside(pictures, gap=GAP), captions, GAP)
