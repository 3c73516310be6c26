# SPDX-License-Identifier: GPL-2.0-or-later
"""What a drawing looks like: exactly, point by point, and as resvg renders it."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import resvg_py
from PIL import Image


def winding(loops, points):
    """Winding number round each of `points` (N, 2) of loops of lines."""
    turns = np.zeros(len(points), int)
    for loop in loops:
        (x0, y0), (x1, y1) = loop.control[:, 0].T[..., None], loop.control[:, 3].T[..., None]
        x, y = points.T
        right = (x1 - x0) * (y - y0) - (x - x0) * (y1 - y0)
        turns += ((y0 <= y) & (y1 > y) & (right > 0)).sum(axis=0)
        turns -= ((y0 > y) & (y1 <= y) & (right < 0)).sum(axis=0)
    return turns


def colours_at(drawing, points):
    """Premultiplied RGBA (N, 4), 0 to 255, at each of `points` of a drawing of lines."""
    out = np.zeros((len(points), 4))
    for shape in drawing.shapes:
        inside = winding(shape.loops, points) != 0
        colour = np.array([*shape.rgb, 255]) * shape.opacity
        out[inside] = colour + out[inside] * (1 - shape.opacity)
    return out


def render(drawing, zoom=1.0, page=None, antialias=True):
    """RGBA as int (h, w, 4), over a page of one colour if that is given."""
    width, height = round(drawing.width * zoom), round(drawing.height * zoom)
    svg = replace(drawing, decimals=4, scale=0).to_svg()
    png = resvg_py.svg_to_bytes(svg_string=svg, width=width, height=height, background=page,
                                skip_system_fonts=True,
                                shape_rendering="geometric_precision" if antialias else "crisp_edges")
    return np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGBA")).astype(int)
