# SPDX-License-Identifier: GPL-2.0-or-later
"""Where Inkscape shows a picture: the way from its pixels to the coordinates of the document.

Rules: SVG 2, section 8 (coordinate systems, ``preserveAspectRatio``, ``viewBox``,
``use`` and ``symbol``), except where Inkscape differs: it draws what lies beyond a nested
viewport, and gives an image without a width or a height that of its pixels.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Dict, List, NamedTuple, Optional, Tuple

import inkex
from inkex.units import CONVERSIONS, parse_unit

from .pictures import Chain
from .source import PictureError
from .words import _

EFFECTS = {"clip-path": "none", "mask": "none", "filter": "none", "opacity": "1", "mix-blend-mode": "normal"}
"""Properties that change how an element and all it holds look, with their initial values."""

ASPECT_RATIO = re.compile(r"\s*(?:(none)|x(Min|Mid|Max)Y(Min|Mid|Max))(?:\s+(meet|slice))?\s*$")

FRACTIONS = {"Min": 0.0, "Mid": 0.5, "Max": 1.0}


class Box(NamedTuple):
    """A rectangle."""

    x: float
    y: float
    width: float
    height: float


@dataclass(frozen=True)
class Frame:
    """A group to be put round the drawing because something round the picture changes its look.

    Attributes
    ----------
    transform : Transform
        To the coordinates of the frame outside it, or of the document.
    style : dict
        Clip path, mask, ... as the document has them.
    clip : Box, optional
        Show only this part.
    bounds : Box, optional
        The rectangle of the picture, which clip paths and masks may be measured by.
    """

    transform: inkex.Transform
    style: Dict[str, str]
    clip: Optional[Box] = None
    bounds: Optional[Box] = None


@dataclass(frozen=True)
class Placement:
    """Where a picture lies.

    Attributes
    ----------
    frames : tuple of Frame
        From the outermost to the innermost.
    transform : Transform
        From pixels to the coordinates of the innermost frame, or of the document.
    """

    frames: Tuple[Frame, ...]
    transform: inkex.Transform


def place(chain: Chain, width: int, height: int) -> Placement:
    """Find where a picture lies.

    Parameters
    ----------
    chain : tuple of BaseElement
        See `pictures.Picture`.
    width, height : int
        Size of the picture, px.

    Returns
    -------
    Placement

    Raises
    ------
    PictureError
        The picture has no area.
    """
    image = chain[-1]
    viewport, matrix = _root_viewport(image.root), inkex.Transform()
    frames: List[Frame] = []
    for before, element in zip((image.root, *chain), chain):
        matrix = matrix @ _own_transform(element)
        box = _box(element, before, viewport, (width, height))
        style = effects(element)
        if style:
            frames.append(Frame(matrix, style, bounds=box if element is image else None))
            matrix = inkex.Transform()
        inner, viewport = _inner(element, box, viewport)
        matrix = matrix @ inner
    fitted, cut = fit(box, Box(0, 0, width, height), image.get("preserveAspectRatio"))
    if cut:
        frames.append(Frame(matrix, {}, clip=box))
        matrix = inkex.Transform()
    placement = Placement(tuple(frames), matrix @ fitted)
    _check_visible(placement)
    return placement


def _own_transform(element: inkex.BaseElement) -> inkex.Transform:
    if element.TAG == "svg":  # Inkscape ignores the transform of a nested svg element
        return inkex.Transform()
    try:
        return element.transform
    except Exception:  # inkex raises several kinds; Inkscape ignores one that cannot be read
        return inkex.Transform()


def _check_visible(placement: Placement) -> None:
    for transform in (placement.transform, *(frame.transform for frame in placement.frames)):
        determinant = transform.a * transform.d - transform.b * transform.c
        if not (determinant and all(map(math.isfinite, (*transform.to_hexad(), determinant)))):
            raise PictureError(_("its transform leaves nothing of it to be seen"))


def fit(box: Box, content: Box, aspect_ratio: Optional[str]) -> Tuple[inkex.Transform, bool]:
    """Fit `content` into `box` as ``preserveAspectRatio`` says.

    Parameters
    ----------
    box, content : Box
    aspect_ratio : str, optional
        Value of the attribute; anything invalid counts as the default, as in Inkscape.

    Returns
    -------
    transform : Transform
        From the coordinates of `content` to those of `box`.
    cut : bool
        Whether `content` reaches beyond `box` and is to be cut off there.

    Raises
    ------
    PictureError
        One of them has no area.
    """
    if min(box.width, box.height, content.width, content.height) <= 0:
        raise PictureError(_("it is shown without a width or a height"))
    across, down = box.width / content.width, box.height / content.height
    x = y = "Mid"
    cut = False
    found = ASPECT_RATIO.match(aspect_ratio or "")
    if not (found and found.group(1)):
        if found:
            x, y, cut = found.group(2), found.group(3), found.group(4) == "slice"
        across = down = max(across, down) if cut else min(across, down)
    left = box.x + FRACTIONS[x] * (box.width - across * content.width) - across * content.x
    top = box.y + FRACTIONS[y] * (box.height - down * content.height) - down * content.y
    return inkex.Transform((across, 0, 0, down, left, top)), cut


def effects(element: inkex.BaseElement) -> Dict[str, str]:
    """The properties in `EFFECTS` that are set for an element.

    Parameters
    ----------
    element : BaseElement

    Returns
    -------
    dict
        Without those that have their initial value.
    """
    style = own_style(element)
    return {name: value for name, initial in EFFECTS.items()
            for value in [str(style.get(name, initial)).strip()] if value not in (initial, "", "1.0")}


def own_style(element: inkex.BaseElement) -> inkex.Style:
    """The style of an element: its own and what style sheets give it, but nothing inherited.

    Parameters
    ----------
    element : BaseElement
    """
    attributes = dict(element.attrib)
    try:
        style = element.cascaded_style()
    except Exception:  # a style sheet that the CSS parser of inkex cannot read
        style = element.presentation_style() + element.style
    # To look it up in style sheets, inkex may have given it an id and rewritten its style.
    element.attrib.clear()
    element.attrib.update(attributes)
    return style


def length(text: Optional[str], whole: float, default: float) -> float:
    """A length in user units.

    Parameters
    ----------
    text : str, optional
        Number with or without a unit, or a percentage.
    whole : float
        What a percentage is part of.
    default : float
        The length if there is no valid `text`.
    """
    number, unit = parse_unit(text or "") or (default, "px")
    if unit == "%":
        return number / 100 * whole
    return number * CONVERSIONS[unit] if unit in CONVERSIONS else default


def _root_viewport(root: inkex.SvgDocumentElement) -> Tuple[float, float]:
    box = _view_box(root)
    if box:
        return box.width, box.height
    return length(root.get("width"), 100, 100), length(root.get("height"), 100, 100)


def _view_box(element: inkex.BaseElement) -> Optional[Box]:
    try:
        numbers = [float(number) for number in re.split(r"[\s,]+", (element.get("viewBox") or "").strip())]
    except ValueError:
        return None
    return Box(*numbers) if len(numbers) == 4 and min(numbers[2:]) > 0 else None


def _box(element: inkex.BaseElement, before: inkex.BaseElement, viewport: Tuple[float, float],
         size: Tuple[float, float]) -> Box:
    across, down = viewport
    if not isinstance(element, inkex.Image):
        size = viewport
    width, height = element.get("width"), element.get("height")
    if isinstance(before, inkex.Use) and element.TAG in ("svg", "symbol"):
        width, height = before.get("width") or width, before.get("height") or height
    return Box(length(element.get("x"), across, 0), length(element.get("y"), down, 0),
               length(width, across, size[0]), length(height, down, size[1]))


def _inner(element: inkex.BaseElement, box: Box,
           viewport: Tuple[float, float]) -> Tuple[inkex.Transform, Tuple[float, float]]:
    """From the coordinates inside an element to those outside, and the viewport inside."""
    if isinstance(element, inkex.Use):
        return _shift(box.x, box.y), viewport
    if element.TAG not in ("svg", "symbol"):
        return inkex.Transform(), viewport
    view = _view_box(element)
    if view is None:
        return _shift(box.x, box.y), (box.width, box.height)
    fitted, _ = fit(box, view, element.get("preserveAspectRatio"))
    return _at_reference_point(element, box, view, fitted), (view.width, view.height)


def _at_reference_point(element: inkex.BaseElement, box: Box, view: Box,
                        fitted: inkex.Transform) -> inkex.Transform:
    # refX and refY say what point of a symbol comes to lie where the clone is; Inkscape
    # has followed them since 1.3.
    (across, _, left), (_, down, top) = fitted.matrix
    if element.get("refX"):
        left = box.x - across * length(element.get("refX"), view.width, 0)
    if element.get("refY"):
        top = box.y - down * length(element.get("refY"), view.height, 0)
    return inkex.Transform((across, 0, 0, down, left, top))


def _shift(x: float, y: float) -> inkex.Transform:
    return inkex.Transform((1, 0, 0, 1, x, y))
