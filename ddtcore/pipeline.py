# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper from top to bottom: bitmap in, area-sorted Bézier shapes out."""

from __future__ import annotations

from typing import Optional

import numpy as np

from . import border, fit, outline, position, regions, stacking, triangulation
from .model import Drawing
from .options import TraceOptions
from .raster import check_image


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
    labels = regions.label_pixels(image, options)
    mesh = triangulation.triangulate(image, labels, options)
    if options.result in ("triangles", "border"):
        return border.draw_mesh(image, labels, mesh, options)
    planar = outline.link_outlines(mesh, labels)
    lines = position.place(image, labels, mesh, planar, options)
    curves = fit.fit_arcs(image, labels, planar, lines, options)
    return stacking.stack(image, labels, planar, lines, curves, options)
