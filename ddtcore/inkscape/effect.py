# SPDX-License-Identifier: GPL-2.0-or-later
"""The effect from top to bottom: selection in, layers over the pictures out."""

from __future__ import annotations

from argparse import Namespace
from typing import Dict, List, Tuple

import inkex

from .. import __version__, trace
from ..model import Drawing
from ..options import TraceOptions
from .decode import decode
from .layer import add_drawing, finish_source, new_layer
from .log import note
from .pictures import Picture, cloned_ids, find_pictures
from .placement import Placement, place
from .settings import changes, trace_options
from .source import Folders, PictureError, read_picture
from .words import _, brief

Trace = Tuple[Picture, Drawing, Placement]


def trace_pictures(svg: inkex.SvgDocumentElement, chosen: Namespace, folders: Folders) -> None:
    """Trace the selected pictures of a document and put the drawings over them.

    Parameters
    ----------
    svg : SvgDocumentElement
        The document; it is changed only if every picture could be traced.
    chosen : Namespace
        Parsed arguments: the settings, and `ids` of what is selected.
    folders : tuple of str
        Where relative links are looked up.

    Raises
    ------
    AbortExtension
        Something cannot be traced; the message says what and why.
    """
    options = trace_options(chosen)
    traces = _trace_all(find_pictures(svg, chosen.ids), options, folders)
    cloned = cloned_ids(svg)
    layers: Dict[inkex.BaseElement, inkex.Layer] = {}
    for picture, drawing, placement in traces:
        top = picture.chain[0]
        if top not in layers:
            layers[top] = new_layer(svg, top)
        notes = list(drawing.notes)
        if not finish_source(picture, chosen.source, cloned):
            notes.append(_("the picture was kept, since hiding it would hide more than it"))
        add_drawing(layers[top], picture.name, _description(chosen, drawing, notes), drawing, placement,
                    by_colour=options.group == "color")
        note(f'"{brief(picture.name)}": {"; ".join(notes) or _("traced")}')


def _trace_all(pictures: List[Picture], options: TraceOptions, folders: Folders) -> List[Trace]:
    drawings: Dict[bytes, Drawing] = {}  # clones of one picture are traced once
    result = []
    for picture in pictures:
        try:
            data = read_picture(picture.image, folders)
            if data not in drawings:
                drawings[data] = trace(decode(data), options)
            drawing = drawings[data]
            result.append((picture, drawing, place(picture.chain, drawing.width, drawing.height)))
        except PictureError as error:
            text = _('The picture "{name}" cannot be traced: {reason}.')
            raise inkex.AbortExtension(text.format(name=brief(picture.name), reason=error)) from error
    return result


def _description(chosen: Namespace, drawing: Drawing, notes: List[str]) -> str:
    settings = ", ".join(f"{name}={value}" for name, value in
                         [("preset", chosen.preset), *changes(vars(chosen)).items()])
    settings += f"; {drawing.choice}" if drawing.choice else ""
    size = f"{drawing.width} x {drawing.height} px"
    return "\n".join([f"DDT Trace {__version__}", _("Picture: {size}").format(size=size),
                      _("Settings: {settings}").format(settings=settings),
                      *(_("Note: {text}").format(text=text) for text in notes)])
