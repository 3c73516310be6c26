# SPDX-License-Identifier: GPL-2.0-or-later
"""The result in the document: a new layer above the picture, and in it one group per picture."""

from __future__ import annotations

import itertools
import re
from typing import Dict, FrozenSet

import inkex

from ..model import Drawing
from ..svg import group
from .pictures import Picture, is_cloned
from .placement import Box, Frame, Placement, own_style

LABEL = "DDT Trace"

PAINT = ("fill", "fill-opacity", "fill-rule", "opacity", "stroke", "stroke-width", "stroke-opacity",
         "stroke-linejoin", "stroke-linecap")
"""Presentation attributes that a drawing may carry."""

UNTOUCHED = {"stroke": "none", "stroke-dasharray": "none", "fill-opacity": "1", "fill-rule": "nonzero",
             "opacity": "1", "visibility": "visible", "shape-rendering": "auto"}
"""Properties that would spoil a drawing if the document's root or style sheets set them."""


def new_layer(svg: inkex.SvgDocumentElement, top: inkex.BaseElement) -> inkex.Layer:
    """Insert an empty layer right above a child of the root.

    Parameters
    ----------
    svg : SvgDocumentElement
    top : BaseElement
        What the layer is to lie above.

    Returns
    -------
    Layer
    """
    layer = inkex.Layer.new(LABEL)
    inherited = own_style(svg)
    _set_style(layer, {name: value for name, value in UNTOUCHED.items() if name in inherited}, svg)
    top.addnext(layer)
    return layer


def add_drawing(layer: inkex.Layer, name: str, description: str, drawing: Drawing,
                placement: Placement, by_colour: bool = False) -> None:
    """Add a drawing to a layer, where its picture lies.

    Parameters
    ----------
    layer : Layer
    name : str
        Label of the group.
    description : str
        Text for the description of the group.
    drawing : Drawing
    placement : Placement
    by_colour : bool
        Put shapes of one colour that follow each other into a group of their own.
    """
    gradients = any(shape.gradient for shape in drawing.shapes)
    ids = _free_name("ddt-trace-gradient", layer.root) if gradients else ""
    content = inkex.load_svg(group(drawing, names=True, ids=ids, runs=by_colour)).getroot()
    content.set("transform", str(placement.transform))
    if _has_style_sheets(layer.root):
        _paint_by_style(content)
    groups = [_frame_group(frame, layer.root) for frame in placement.frames] + [content]
    for outer, inner in zip(groups, groups[1:]):
        outer.append(inner)
    layer.append(groups[0])
    groups[0].set("inkscape:label", name)
    groups[0].desc = description


def finish_source(picture: Picture, fate: str, cloned: FrozenSet[str]) -> bool:
    """Keep, hide or remove a picture that was traced.

    Parameters
    ----------
    picture : Picture
    fate : {'keep', 'hide', 'remove'}
    cloned : frozenset of str
        From `pictures.cloned_ids`.

    Returns
    -------
    bool
        False if it had to be kept all the same, since hiding it would hide more.
    """
    shown = picture.shown
    if fate == "keep" or shown.getparent() is None:
        return True
    below = picture.chain[picture.chain.index(shown):-1]
    if not all(isinstance(element, inkex.Use) for element in below) or is_cloned(shown, cloned):
        return False
    if fate == "remove":
        shown.delete()
    else:
        kept = re.sub(r"(^|;)\s*display\s*:[^;]*", "", shown.attrib.get("style", "")).strip("; ")
        shown.attrib["style"] = ";".join(filter(None, [kept, "display:none"]))
    return True


def _frame_group(frame: Frame, svg: inkex.SvgDocumentElement) -> inkex.Group:
    result = inkex.Group()
    result.set("transform", str(frame.transform))
    style = dict(frame.style)
    if frame.clip:
        style["clip-path"] = f"url(#{_clip_path(frame.clip, svg)})"
    _set_style(result, style, svg)
    if frame.bounds and _measured_by_bounds(frame, svg):
        result.append(_rectangle(frame.bounds, style="fill:none;stroke:none"))
    return result


def _has_style_sheets(svg: inkex.SvgDocumentElement) -> bool:
    return bool(svg.xpath("//svg:style[normalize-space()]"))


def _set_style(element: inkex.BaseElement, style: Dict[str, str], svg: inkex.SvgDocumentElement) -> None:
    if _has_style_sheets(svg):
        style = {**UNTOUCHED, **style}
    if style:
        element.attrib["style"] = ";".join(f"{name}:{value}" for name, value in style.items())


def _measured_by_bounds(frame: Frame, svg: inkex.SvgDocumentElement) -> bool:
    # Then a rectangle gives the group the size of the picture, though its rim be transparent.
    if "filter" in frame.style:
        return True
    names = {name for value in frame.style.values() for name in re.findall(r"url\([\"']?#([^)\"']+)", value)}
    units = ("clipPathUnits", "maskUnits", "maskContentUnits")
    return any("objectBoundingBox" in map(element.get, units) or element.TAG == "mask"
               for element in svg.iter() if isinstance(element, inkex.BaseElement)
               and element.get("id") in names)


def _clip_path(box: Box, svg: inkex.SvgDocumentElement) -> str:
    name = _free_name("ddt-trace-clip", svg) + "box"
    clip = inkex.ClipPath(id=name)
    clip.append(_rectangle(box))
    svg.defs.append(clip)
    return name


def _rectangle(box: Box, **attributes: str) -> inkex.Rectangle:
    return inkex.Rectangle(**{name: f"{value:.9g}" for name, value in box._asdict().items()}, **attributes)


def _free_name(beginning: str, svg: inkex.SvgDocumentElement) -> str:
    """A beginning for ids that no id of the document shares."""
    taken = [name for name in svg.xpath("//@id") if name.startswith(beginning)]
    names = (f"{beginning}{number}-" for number in itertools.count(1))
    return next(name for name in names if not any(other.startswith(name) for other in taken))


def _paint_by_style(content: inkex.BaseElement) -> None:
    """Turn presentation attributes into styles, which the document's style sheets cannot overrule."""
    styles: Dict[inkex.BaseElement, Dict[str, str]] = {}
    for element in content.iter("{*}g", "{*}path"):
        style = {**styles.get(element.getparent(), UNTOUCHED), "opacity": "1"}
        style.update((name, element.attrib.pop(name)) for name in PAINT if name in element.attrib)
        styles[element] = style
        element.attrib["style"] = ";".join(f"{name}:{value}" for name, value in style.items())
