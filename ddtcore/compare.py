# SPDX-License-Identifier: GPL-2.0-or-later
"""A picture and its trace side by side, as one HTML page that needs nothing else.

The page holds the bitmap, the trace, what the stages of the method made on the way to it
(paper, figures 5 and 6), the report, and the trace at two other settings.  It asks no
network and runs no script but its own; ``compare.html`` is its frame.
"""

from __future__ import annotations

import base64
import io
import pkgutil
import re
from dataclasses import fields, replace
from html import escape
from typing import Any, Dict, Iterable, Iterator, List, NamedTuple, Optional, Tuple

import numpy as np

from . import __version__
from .choice import settle
from .model import LINE, Drawing, Loop, Triangles
from .options import TraceOptions
from .pathdata import number_text
from .pipeline import trace
from .raster import check_image
from .report import Report, report
from .svg import encoded, group

MOST_TRIANGLES = 40_000
"""Triangles in a page; of a larger mesh a window is shown."""

WORDS: Dict[str, str] = {
    "bmp": "24-bit bitmap", "ddt_svg": "triangles as SVG", "svg": "curves as SVG", "svgz": "curves, compressed",
    "bmp/svg": "bitmap / curves", "ddt_svg/svgz": "triangles / compressed curves"}
"""What the page calls the figures of a report."""

_DIGITS = 2
"""Digits after the point of points and handles."""

Box = Tuple[float, float, float, float]


class _Setting(NamedTuple):
    """A trace among the three that are shown side by side."""

    title: str
    options: TraceOptions


def compare(image: np.ndarray, options: Optional[TraceOptions] = None, name: str = "picture") -> str:
    """Trace a picture and write the page that compares the two.

    Parameters
    ----------
    image : ndarray of shape (H, W, 4) and dtype uint8
        RGBA, not premultiplied.
    options : TraceOptions, optional
        Their `result` doesn't matter: the page shows all of them.  Without them, the preset is
        chosen by the look of the picture.
    name : str
        What the page calls the picture.

    Returns
    -------
    str
        HTML.  The mesh is limited to `MOST_TRIANGLES`; what remains grows with the sizes of
        the bitmap as PNG and of the trace as SVG.

    Examples
    --------
    >>> page = compare(np.zeros((4, 6), dtype=np.uint8), name="a < b")
    >>> page.count("<title>a &lt; b"), "http://" in page.replace("http://www.w3.org/", "")
    (1, False)
    """
    image = check_image(image)
    options, chosen = settle(image, options)
    options = replace(options, result="curves")
    meshes = trace(image, replace(options, result="triangles"))
    curves = replace(trace(image, options), choice=chosen)
    # Cut out, for stacked shapes go on where nobody sees them.
    outlines = trace(image, replace(options, result="outlines", stacking="cutout"))
    assert meshes.triangles is not None
    mesh, box = _window(image, meshes.triangles)
    height, width = image.shape[:2]
    close = _busiest(mesh, (width, height))
    settings = enumerate(_settings(options))
    return _fill({
        "name": escape(name), "size": f"{width} × {height} px", "version": __version__,
        "settings": _said(options),
        "notes": "\n".join(f"  <p>{escape(note)}</p>" for note in (*_chosen(chosen), *curves.notes)),
        "width": str(width), "height": str(height), "bitmap": _bitmap(image),
        "close_x": f"{close[0]:.0f}", "close_y": f"{close[1]:.0f}",
        "curves": group(curves, ids="trace"), "triangles": _painted(mesh), "border": _lined(mesh),
        "outlines": _outlines(outlines), "nodes": _nodes(curves),
        "window": _window_note(box, (width, height)),
        "variants": "\n".join(_figure(k, setting, image, curves) for k, setting in settings),
        "figures": "\n".join(_tables(report(image, options, curves, name, meshes)))})


def flags(options: TraceOptions) -> str:
    """The flags of the command line that differ from the defaults.

    Examples
    --------
    >>> flags(TraceOptions(tolerance=0.5, colors=8))
    '--colors 8 --tolerance 0.5'
    """
    changed = [(field.name, getattr(options, field.name)) for field in fields(TraceOptions)
               if getattr(options, field.name) != field.default]
    return " ".join(f"--{name.replace('_', '-')} {value}" for name, value in changed)


def _chosen(choice: str) -> List[str]:
    return [f"Preset chosen by the look of the picture: {choice}"] if choice else []


def _said(options: TraceOptions) -> str:
    """The flags as HTML."""
    text = escape(flags(options))
    return f"<code>{text}</code>" if text else "the default settings"


def _fill(values: Dict[str, str]) -> str:
    """The frame of the page with its places filled."""
    frame = pkgutil.get_data(__package__, "compare.html")
    assert frame is not None
    return re.sub(r"\{\{(\w+)\}\}", lambda place: values[place[1]], frame.decode("utf-8"))


def _bitmap(image: np.ndarray) -> str:
    """The picture as a PNG in a data URI."""
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(image).save(file, "PNG", optimize=True)
    return "data:image/png;base64," + base64.b64encode(file.getvalue()).decode("ascii")


# -- the mesh ---------------------------------------------------------------------

def _window(image: np.ndarray, mesh: Triangles) -> Tuple[Triangles, Box]:
    """The triangles to be shown, and the box (left, top, right, bottom) that they come from.

    Left out are those within flat areas: all their corners have one colour.
    """
    height, width = image.shape[:2]
    column, row = np.moveaxis(np.minimum(mesh.points, [width - 1, height - 1]).astype(np.intp), -1, 0)
    colours = image[row, column]
    shown = np.flatnonzero((colours != colours[:, :1]).any(axis=(1, 2)) | mesh.border)
    centres = mesh.points[shown].mean(axis=1)
    box: Box = (0, 0, width, height)
    middle = np.median(centres, axis=0)
    size = np.array([width, height], dtype=float)
    while len(shown) > MOST_TRIANGLES:
        size *= 0.99 * np.sqrt(MOST_TRIANGLES / len(shown))
        low = np.clip(middle - size / 2, 0, [width, height] - size)
        inside = ((centres >= low) & (centres <= low + size)).all(axis=1)
        shown, centres = shown[inside], centres[inside]
        box = (*low, *(low + size))
    return replace(mesh, points=mesh.points[shown], rgb=mesh.rgb[shown], opacity=mesh.opacity[shown],
                   border=mesh.border[shown]), box


def _window_note(box: Box, size: Tuple[int, int]) -> str:
    if box[:2] == (0, 0) and box[2:] == size:
        return "Triangles within flat areas are left out."
    left, top, right, bottom = np.rint(box).astype(int).tolist()
    return (f"The mesh is shown between {left} and {right} px from the left, {top} and {bottom} px from"
            f" the top: {MOST_TRIANGLES:,} triangles are enough for a browser.  Those within flat areas are"
            " left out.")


def _busiest(mesh: Triangles, size: Tuple[int, int]) -> Tuple[float, float]:
    """The middle of the square of 32 px with the most triangles, for a close-up."""
    if not len(mesh.points):
        return size[0] / 2, size[1] / 2
    cells = np.floor(mesh.points.mean(axis=1) / 32).astype(np.int64)
    different, count = np.unique(cells, axis=0, return_counts=True)
    column, row = different[count.argmax()].tolist()
    return column * 32 + 16, row * 32 + 16


def _painted(mesh: Triangles) -> str:
    """Triangles in their mean colours, one path for all of a colour."""
    alpha = np.rint(mesh.opacity * 255).astype(np.int64)
    key = mesh.rgb.astype(np.int64) @ [1 << 24, 1 << 16, 1 << 8] + alpha
    order = np.argsort(key, kind="stable")
    texts = _triangle_texts(mesh.points[order])
    starts = np.flatnonzero(np.diff(key[order], prepend=-1)).tolist()
    paths = []
    for start, end in zip(starts, [*starts[1:], len(texts)]):
        rgba = f"#{int(key[order[start]]):08x}"
        if not rgba.endswith("00"):
            colour = rgba[:7] if rgba.endswith("ff") else rgba
            paths.append(f'<path fill="{colour}" stroke="{colour}" d="{"".join(texts[start:end])}"/>')
    return f'<g transform="scale(.5)" stroke-width=".6">{"".join(paths)}</g>'


def _lined(mesh: Triangles) -> str:
    """The mesh as lines, its border triangles filled (paper, figure 6)."""
    texts = [_triangle_texts(mesh.points[members]) for members in (~mesh.border, mesh.border)]
    return (f'<g transform="scale(.5)"><path fill="none" d="{"".join(texts[0])}"/>'
            f'<path fill="#f93" fill-opacity=".8" d="{"".join(texts[1])}"/></g>')


def _triangle_texts(points: np.ndarray) -> List[str]:
    """Path data of each triangle (T, 3, 2), in half pixels: whole numbers, as vertices are pixel centres."""
    doubled = np.rint(2 * points).astype(np.int64)
    rows = np.concatenate([doubled[:, :1], np.diff(doubled, axis=1)], axis=1).reshape(-1, 6)
    return [f"M{x} {y}l{dx} {dy} {ex} {ey}z" for x, y, dx, dy, ex, ey in rows.tolist()]


# -- outlines and nodes -----------------------------------------------------------

def _loops(drawing: Drawing) -> List[Loop]:
    return [loop for shape in drawing.shapes for loop in shape.loops]


def _text(points: np.ndarray) -> List[str]:
    """Points (n, 2) as "x y"."""
    units = np.rint(points * 10**_DIGITS).astype(np.int64).tolist()
    return [f"{number_text(x, _DIGITS)} {number_text(y, _DIGITS)}" for x, y in units]


def _outlines(drawing: Drawing) -> str:
    """The closed polylines, and their points."""
    lines, dots = [], []
    for loop in _loops(drawing):
        texts = _text(loop.control[:, 0])
        lines.append(f"M{'L'.join(texts)}Z")
        dots.extend(texts)
    return f'<path class="fine" d="{"".join(lines)}"/><path class="fine dots" d="{_dots(dots)}"/>'


def _nodes(drawing: Drawing) -> str:
    """The nodes of all loops, and their handles."""
    loops = _loops(drawing)
    if not loops:
        return ""
    control = np.concatenate([loop.control for loop in loops])
    curved = control[np.concatenate([loop.degree for loop in loops]) > LINE]
    ends = [(_text(curved[:, node]), _text(curved[:, handle])) for node, handle in ((0, 1), (3, 2))]
    handles = {f"M{node}L{handle}" for nodes, tips in ends for node, handle in zip(nodes, tips)}
    tips = {tip for _, tips in ends for tip in tips}
    nodes = _dots(_text(control[:, 0]))
    return (f'<path class="fine" d="{"".join(sorted(handles))}"/><path class="fine ends" d="{_dots(tips)}"/>'
            f'<path class="fine rim" d="{nodes}"/><path class="fine dots" d="{nodes}"/>')


def _dots(texts: Iterable[str]) -> str:
    """Lines without length: with round ends they are dots as large on the screen at any zoom."""
    return "".join(f"M{text}h0" for text in sorted(set(texts)))


# -- three settings, and figures --------------------------------------------------

def _settings(options: TraceOptions) -> Iterator[_Setting]:
    yield _Setting("As asked for", options)
    simpler = replace(options, tolerance=min(4 * options.tolerance, 10), speckle=max(options.speckle, 16.0))
    yield _Setting("Simpler", simpler)
    paper = TraceOptions.preset("paper")
    if options == paper:
        yield _Setting("Past the paper", TraceOptions())
    else:
        yield _Setting("As in the paper", paper)


def _figure(number: int, setting: _Setting, image: np.ndarray, curves: Drawing) -> str:
    """One of the three traces with its caption."""
    drawing = trace(image, setting.options) if number else curves
    sizes = [sum(map(len, encoded(drawing, compressed))) for compressed in (False, True)]
    nodes = sum(len(loop.degree) for loop in _loops(drawing))
    words = f"{len(drawing.shapes):,} shapes, {nodes:,} nodes, {sizes[0]:,} bytes, {sizes[1]:,} compressed"
    return (f'<figure><div class="view"><svg data-view role="img" aria-label="{setting.title}">'
            f'{group(drawing, ids=f"setting{number}-")}</svg></div>\n<figcaption>'
            f"<strong>{setting.title}</strong>: {words}<br>{_said(setting.options)}</figcaption></figure>")


def _tables(figures: Report) -> Iterator[str]:
    """The report: a table for each of its groups."""
    for title, values in figures.to_dict().items():
        if isinstance(values, dict):
            named = ((WORDS.get(str(key), str(key)), value) for key, value in values.items())
            rows = "".join(f"<tr><th scope=row>{escape(name)}</th><td>{_number(value)}</td></tr>"
                           for name, value in named)
            yield f"<table><caption>{escape(title.capitalize())}</caption>{rows}</table>"


def _number(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:,.1f}"
    return f"{value:,}" if isinstance(value, int) else escape(str(value))
