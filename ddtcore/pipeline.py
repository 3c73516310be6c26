# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper from top to bottom: bitmap in, area-sorted Bézier shapes out."""

from __future__ import annotations

from dataclasses import replace
from typing import Optional

import numpy as np

from . import border, fit, flatten, outline, paint, position, regions, stacking, triangulation
from .model import Drawing
from .options import TraceOptions
from .raster import check_image


UNFINISHED = ("the triangulation was not finished: it reached the setting 'work';"
              " raise that, or trace a smaller picture")


def trace(image: np.ndarray, options: Optional[TraceOptions] = None) -> Drawing:
    """Trace a picture.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    options : TraceOptions, optional

    Returns
    -------
    Drawing
    """
    options = options or TraceOptions()
    image = check_image(image)
    labels = paint.find_gradients(image, regions.label_pixels(image, options))
    even = flatten.flatten(image, labels)
    mesh = triangulation.triangulate(even, labels, options)
    if options.result in ("triangles", "border"):
        drawing = border.draw_mesh(image, labels, mesh, options)
    else:
        planar = outline.link_outlines(mesh, labels)
        lines = position.place(even, labels, mesh, planar, options)
        curves = fit.fit_arcs(even, labels, planar, lines, options)
        drawing = stacking.stack(image, labels, planar, lines, curves, options)
    return drawing if mesh.finished else replace(drawing, notes=(*drawing.notes, UNFINISHED))
