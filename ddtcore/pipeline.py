# SPDX-License-Identifier: GPL-2.0-or-later
"""The paper from top to bottom: bitmap in, area-sorted Bézier shapes out.

Stages are called for what they find; somebody who waits may be told of them, and may end
the trace between them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Callable, Optional, Tuple

import numpy as np

from . import (
    bands,
    border,
    choice,
    enlarged,
    fit,
    flatten,
    grouping,
    ink,
    lattice,
    outline,
    paint,
    position,
    recolour,
    regions,
    splinters,
    sprites,
    stacking,
    triangulation,
    unblur,
)
from .budget import label_within_budget
from .model import Drawing, Labels
from .options import TraceOptions
from .raster import check_image, is_opaque
from .reduction import enlarge

Progress = Callable[[str, float], object]
"""Told the name of each stage when it begins, and the share of the work that is done by then."""

STAGES = {"colours": 0.0, "gradients": 0.15, "triangles": 0.2, "outlines": 0.3, "positions": 0.35,
          "curves": 0.4, "shapes": 0.9}
"""The stages in their order, each with the share of the time that is over when it begins."""

UNFINISHED = ("the triangulation was not finished: it reached the setting 'work';"
              " raise that, or trace a smaller picture")


def trace(image: np.ndarray, options: Optional[TraceOptions] = None,
          progress: Optional[Progress] = None) -> Drawing:
    """Trace a picture.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    options : TraceOptions, optional
        Without them, the preset is chosen by the look of the picture, see `choose_preset`.
    progress : callable, optional
        Called with the name of each of the `STAGES` that is run, when it begins, and with the
        share of the work that is done by then, 0 to 1.  What it raises ends the trace.

    Returns
    -------
    Drawing
        If a budget was reached, its notes say so.

    Examples
    --------
    >>> picture = np.full((20, 30, 4), 255, np.uint8)
    >>> picture[5:15, 8:20, :3] = 200, 30, 40
    >>> [shape.rgb for shape in trace(picture).shapes]
    [(255, 255, 255), (200, 30, 40)]
    """
    image = check_image(image)
    options, chosen = choice.settle(image, options)
    tell = progress or (lambda stage, share: None)

    def begin(stage: str) -> None:
        tell(stage, STAGES[stage])

    begin("colours")
    original, (across, down) = _original(image, options)
    small, labels, factor, note = label_within_budget(
        original, options, lambda picture, factor: regions.label_pixels(
            picture, replace(options, speckle=options.speckle / (factor ** 2 * across * down))))
    if across > 1 and options.regions == "palette":
        # What an enlargement lost is not found again everywhere.
        labels = replace(labels, speck=max(labels.speck, enlarged.SPECK))
    drawing = _draw(small, labels, options, begin)
    if factor * across > 1:
        drawing = enlarge(drawing, (factor * across, factor * down), image.shape[1], image.shape[0])
        drawing = replace(drawing, scale=math.ceil(drawing.scale / across))
    if note:
        drawing = replace(drawing, notes=(note, *drawing.notes))
    return replace(drawing, choice=chosen)


def _original(image: np.ndarray, options: TraceOptions) -> Tuple[np.ndarray, Tuple[float, float]]:
    """What is to be traced in place of a picture, and how many pixels a pixel of it is wide and high."""
    if options.regions == "black-white":
        return ink.stretch(image, options.level), (1, 1)
    if options.regions == "palette":
        return enlarged.original(image)
    size = sprites.block_size(image) if options.regions == "pixels" else 1
    return sprites.reduced(image, size), (size, size)


def _draw(image: np.ndarray, labels: Labels, options: TraceOptions, begin: Callable[[str], None]) -> Drawing:
    """All that comes after the labels; what no later stage needs is let go."""
    begin("gradients")
    opaque = is_opaque(image)
    image, labels, painted = _paint(image if labels.clear is None else labels.clear, labels, options)
    even = unblur.unblur(flatten.flatten(image, labels), labels)
    begin("triangles")
    crisp = options.curves == "crisp" and options.result in ("outlines", "curves")
    triangulate = lattice.square_mesh if crisp else triangulation.triangulate
    mesh = triangulate(even, labels, options)
    notes = () if mesh.finished else (UNFINISHED,)
    if options.result in ("triangles", "border"):
        return replace(border.draw_mesh(image, labels, mesh, options), notes=notes)
    begin("outlines")
    planar, times = outline.link_outlines(mesh, labels), 1
    whole = labels if crisp else splinters.join_splinters(labels, planar)
    if whole is not labels:
        labels, painted = whole, replace(painted, index=whole.index, thin=whole.thin)
        mesh = triangulate(even, labels, options)
        planar = outline.link_outlines(mesh, labels)
    begin("positions")
    if crisp:
        times = lattice.parts(planar.pixel_faces.shape)
        planar, lines, curves = lattice.magnified(planar, *lattice.along_pixels(mesh, planar), times)
        image, painted = lattice.magnified_paint(image, painted, times)
    else:
        lines = position.place(even, labels, mesh, planar, options)
        del mesh
        begin("curves")
        curves = fit.fit_arcs(even, labels, planar, lines, options)
    del even
    begin("shapes")
    drawing = stacking.stack(image, painted, planar, lines, curves, options)
    if times > 1:
        drawing = enlarge(drawing, (1 / times, 1 / times), *labels.index.shape[::-1])
    if options.regions == "black-white" and opaque:
        drawing = ink.on_paper(drawing, options)
    drawing = grouping.group(drawing, options)
    return replace(drawing, notes=(*drawing.notes, *notes))


def _paint(image: np.ndarray, labels: Labels, options: TraceOptions) -> Tuple[np.ndarray, Labels, Labels]:
    """The picture and its labels in the colours that are wanted, and the labels with what isn't painted."""
    image, labels = recolour.settle(image, labels)
    labels = paint.find_gradients(image, labels)
    if options.regions == "black-white":
        image, labels = ink.separate(image, labels)
    image, labels = bands.level(image, labels, options)
    image, labels = recolour.recolour(image, labels, options)
    if options.background == "drop":
        return (image, *recolour.part_background(labels))
    return image, labels, labels
