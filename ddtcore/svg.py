# SPDX-License-Identifier: GPL-2.0-or-later
"""The drawing as SVG: a document, a group for another document, a file.

Shapes are written as small as they can be.  A document counts in fractions of a
pixel, by its viewBox, so that path data are whole numbers; a group keeps to pixels,
for it has to fit into the document of somebody else.  Meshes are written in the
paper's form (section III): one path of absolute positions for each triangle, with the
mean colour as fill and as stroke, which hides the seams between neighbours.
"""

from __future__ import annotations

import math
import os
import zlib
from contextlib import suppress
from itertools import groupby
from typing import Callable, Dict, Iterable, Iterator, List, NamedTuple, Sequence, Tuple, Union

import numpy as np

from .model import Drawing, Gradient, Shape, Triangles
from .pathdata import number_text, path_data, path_texts

__all__ = ["document", "encoded", "group", "path_data", "save", "write"]

_NAMESPACE = "http://www.w3.org/2000/svg"
_INKSCAPE = "http://www.inkscape.org/namespaces/inkscape"

_SHORT_NAMES = {
    "#f0ffff": "azure", "#f5f5dc": "beige", "#ffe4c4": "bisque", "#a52a2a": "brown", "#ff7f50": "coral",
    "#ffd700": "gold", "#808080": "gray", "#008000": "green", "#4b0082": "indigo", "#fffff0": "ivory",
    "#f0e68c": "khaki", "#faf0e6": "linen", "#800000": "maroon", "#000080": "navy", "#808000": "olive",
    "#ffa500": "orange", "#da70d6": "orchid", "#cd853f": "peru", "#ffc0cb": "pink", "#dda0dd": "plum",
    "#800080": "purple", "#f00": "red", "#fa8072": "salmon", "#a0522d": "sienna", "#c0c0c0": "silver",
    "#fffafa": "snow", "#d2b48c": "tan", "#008080": "teal", "#ff6347": "tomato", "#ee82ee": "violet",
    "#f5deb3": "wheat"}
"""Colours whose name is shorter than their number."""


class _Unit(NamedTuple):
    """How lengths are written: as whole units, `scale` to a pixel, `decimals` digits after the point."""

    scale: int
    decimals: int

    def text(self, pixels: float) -> str:
        return number_text(round(pixels * self.scale), self.decimals)


_CHUNK = 1 << 16
"""Triangles formatted at a time."""

_SEAM = ".5"
"""Width of the strokes that hide the seams of a mesh, px: the least that leaves no gap at 1x."""


def document(drawing: Drawing) -> str:
    """A complete SVG document, with nothing before the ``<svg>``."""
    return "".join(_document(drawing))


def group(drawing: Drawing, names: bool = False, ids: str = "gradient", runs: bool = False) -> str:
    """A ``<g>`` with the drawing in pixels, to be put into another document.

    Parameters
    ----------
    drawing : Drawing
    names : bool
        Give each path the name of its shape, as Inkscape's label.
    ids : str
        What the ids of gradients begin with; they must be unused where the group goes.
    runs : bool
        Put shapes of one colour that follow each other into a group of their own.

    Returns
    -------
    str
        XML that stands alone; every path has its own fill, for a parent may set another.
    """
    inkscape = f' xmlns:inkscape="{_INKSCAPE}"' if names else ""
    body = [f'<g xmlns="{_NAMESPACE}"{inkscape}>']
    if drawing.triangles is not None:
        body.extend(_mesh(drawing.triangles, drawing.decimals))
    else:
        unit = _Unit(10**drawing.decimals, drawing.decimals)
        paints, defs = _paints(drawing.shapes, unit, ids, black=' fill="#000"')
        body.append(defs)
        texts = _texts(drawing.shapes, unit)
        painted = [(paint, shape, text) for paint, shape, text in zip(paints, drawing.shapes, texts) if text]
        for _, run in groupby(painted, key=lambda item: item[0] if runs else None):
            body.extend(_run(list(run), names, runs))
    return "".join(body) + "</g>"


def _run(members: List[Tuple[str, Shape, str]], names: bool, together: bool) -> Iterator[str]:
    """Paths, each with its paint and, if wanted, its name; several together as a group named alike."""
    paths = (f'<path{_label(shape.name, names)}{paint} d="{text}"/>' for paint, shape, text in members)
    if together and len(members) > 1:
        yield f"<g{_label(members[0][1].name.split()[0], names)}>"
        yield from paths
        yield "</g>"
    else:
        yield from paths


def _label(name: str, wanted: bool) -> str:
    return f' inkscape:label="{_escape(name)}"' if wanted else ""


def encoded(drawing: Drawing, compressed: bool = False) -> Iterator[bytes]:
    """The document as the bytes of a file, SVG or SVGZ, piece by piece; always the same ones."""
    pieces = (piece.encode() for piece in _document(drawing))
    return _compress(pieces) if compressed else pieces


def save(drawing: Drawing, path: Union[str, os.PathLike[str]]) -> None:
    """Write the document to a file, which appears complete or not at all.

    Parameters
    ----------
    drawing : Drawing
    path : str or path-like
        Compressed if it ends in ``.svgz``.

    Raises
    ------
    OSError
        If the file can't be written.
    """
    path = os.fspath(path)
    write(path, encoded(drawing, path.lower().endswith(".svgz")))


def write(path: str, pieces: Iterable[bytes]) -> None:
    """Write a file, which appears complete or not at all."""
    if os.path.exists(path) and not os.path.isfile(path):
        # A device or a pipe must be written to; renaming would put a file in its place.
        with open(path, "wb") as file:
            file.writelines(pieces)
    else:
        _replace(os.path.realpath(path), pieces)


def _replace(path: str, pieces: Iterable[bytes]) -> None:
    """Write beside a file, then rename; the permissions stay those of the file replaced."""
    beside = os.path.join(os.path.dirname(path), f".{os.urandom(8).hex()}.part")
    with open(beside, "xb") as file:
        try:
            file.writelines(pieces)
            file.close()
            if os.path.exists(path):
                os.chmod(beside, os.stat(path).st_mode & 0o777)
            os.replace(beside, path)
        except BaseException:
            # To close means to write what is left, which fails again where the disk is full.
            with suppress(OSError):
                file.close()
            os.unlink(beside)
            raise


def _compress(pieces: Iterable[bytes]) -> Iterator[bytes]:
    # 31: a gzip header, in which zlib leaves name and time empty.
    packer = zlib.compressobj(9, zlib.DEFLATED, 31)
    for piece in pieces:
        yield packer.compress(piece)
    yield packer.flush()


def _document(drawing: Drawing) -> Iterator[str]:
    width, height = drawing.width, drawing.height
    scale = 1 if drawing.triangles is not None else drawing.scale or 10**drawing.decimals
    yield (f'<svg xmlns="{_NAMESPACE}" width="{width}" height="{height}"'
           f' viewBox="0 0 {width * scale} {height * scale}">')
    if drawing.triangles is not None:
        yield from _mesh(drawing.triangles, drawing.decimals)
    else:
        yield from _shapes(drawing.shapes, _Unit(scale, 0))
    yield "</svg>\n"


def _shapes(shapes: Sequence[Shape], unit: _Unit) -> Iterator[str]:
    paints, defs = _paints(shapes, unit, "g")
    yield defs
    painted = ((paint, text) for paint, text in zip(paints, _texts(shapes, unit)) if text)
    for paint, run in groupby(painted, key=lambda item: item[0]):
        texts = [text for _, text in run]
        shared = bool(paint) and len(texts) > 1
        own = "" if shared else paint
        paths = "".join(f'<path{own} d="{text}"/>' for text in texts)
        yield f"<g{paint}>{paths}</g>" if shared else paths


def _texts(shapes: Sequence[Shape], unit: _Unit) -> List[str]:
    return path_texts([shape.loops for shape in shapes], unit.scale, unit.decimals)


def _paints(shapes: Sequence[Shape], unit: _Unit, ids: str, black: str = "") -> Tuple[List[str], str]:
    """Attributes of each shape's fill, those of black as given; and the definitions they need."""
    numbers: Dict[Gradient, int] = {}
    paints = []
    for shape in shapes:
        fill = f' fill="{_colour(shape.rgb)}"' if any(shape.rgb) else black
        if shape.gradient is None:
            fill += _opacity("fill-opacity", shape.opacity)
        else:
            fill = f' fill="url(#{ids}{numbers.setdefault(shape.gradient, len(numbers))})"'
        paints.append(fill)
    defs = "".join(_gradient(gradient, f"{ids}{number}", unit) for gradient, number in numbers.items())
    return paints, f"<defs>{defs}</defs>" if defs else ""


def _gradient(gradient: Gradient, name: str, unit: _Unit) -> str:
    (x, y), (end_x, end_y) = gradient.start, gradient.end
    if gradient.kind == "linear":
        places = {"x1": x, "y1": y, "x2": end_x, "y2": end_y}
    elif gradient.across is None:
        places = {"cx": x, "cy": y, "r": math.hypot(end_x - x, end_y - y)}
    else:
        places = {}
    where = "".join(f' {key}="{unit.text(value)}"' for key, value in places.items())
    if gradient.across is not None and gradient.kind == "radial":
        columns = (end_x - x, end_y - y, gradient.across[0] - x, gradient.across[1] - y, x, y)
        matrix = " ".join(unit.text(value) for value in columns)
        where = f' cx="0" cy="0" r="1" gradientTransform="matrix({matrix})"'
    stops = "".join(f'<stop offset="{_fraction(offset)}" stop-color="{_colour(rgb)}"'
                    f'{_opacity("stop-opacity", opacity)}/>' for offset, rgb, opacity in gradient.stops)
    return (f'<{gradient.kind}Gradient id="{name}" gradientUnits="userSpaceOnUse"{where}>'
            f"{stops}</{gradient.kind}Gradient>")


def _colour(rgb: Tuple[int, int, int]) -> str:
    """The shortest name or number of a colour."""
    number = "#{:02x}{:02x}{:02x}".format(*rgb)
    if number[1::2] == number[2::2]:
        number = "#" + number[1::2]
    return _SHORT_NAMES.get(number, number)


def _opacity(attribute: str, opacity: float) -> str:
    text = _fraction(opacity)
    return "" if text == "1" else f' {attribute}="{text}"'


def _fraction(value: float) -> str:
    # A thousandth tells all 256 levels apart.
    return number_text(round(value * 1000), 3)


def _escape(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")


def _mesh(mesh: Triangles, decimals: int) -> Iterator[str]:
    """Mean colours, or the bare mesh with its border triangles marked (the paper's figure 6)."""
    # Vertices lie at half pixels, which no digit would merge.
    decimals = max(decimals, 1)
    if mesh.filled:
        yield f'<g stroke-width="{_SEAM}" stroke-linejoin="round">\n'
        visible = np.flatnonzero(mesh.opacity > 0)
        for start in range(0, len(visible), _CHUNK):
            part = visible[start:start + _CHUNK]
            yield _painted_triangles(mesh.points[part], mesh.rgb[part], mesh.opacity[part], decimals)
        yield "</g>"
        return
    yield '<g stroke="#888" stroke-width=".06" stroke-linejoin="round">'
    for fill, members in (("none", ~mesh.border), ("#f93", mesh.border)):
        chosen = np.flatnonzero(members)
        yield f'<path fill="{fill}" d="' if len(chosen) else ""
        for start in range(0, len(chosen), _CHUNK):
            yield _bare_triangles(mesh.points[chosen[start:start + _CHUNK]], decimals)
        yield '"/>' if len(chosen) else ""
    yield "</g>"


def _painted_triangles(points: np.ndarray, rgb: np.ndarray, opacity: np.ndarray, decimals: int) -> str:
    rows = np.empty((len(points), 9), dtype=object)
    rows[:, :6] = _coordinate_texts(points, decimals)
    numbers = (rgb.astype(np.int64) << (16, 8, 0)).sum(axis=1)
    rows[:, 6] = rows[:, 7] = _look_up(numbers, lambda number: f"#{number:06x}")
    levels = np.rint(opacity * 1000).astype(np.int64)
    rows[:, 8] = _look_up(levels, lambda level: _opacity("opacity", level / 1000))
    form = '<path d="M %s %s L %s %s L %s %s Z" stroke="%s" fill="%s"%s/>\n'
    return (form * len(rows)) % tuple(rows.ravel().tolist())


def _bare_triangles(points: np.ndarray, decimals: int) -> str:
    texts = _coordinate_texts(points, decimals)
    return ("M%s %sL%s %s %s %sz" * len(texts)) % tuple(texts.ravel().tolist())


def _coordinate_texts(points: np.ndarray, decimals: int) -> np.ndarray:
    """Texts of the six coordinates of each triangle, object (T, 6)."""
    units = np.rint(points * 10.0**decimals).astype(np.int64)
    return _look_up(units.ravel(), lambda value: number_text(value, decimals)).reshape(-1, 6)


def _look_up(values: np.ndarray, text: Callable[[int], str]) -> np.ndarray:
    """The text of each value, object; each different value is formatted once."""
    different, place = np.unique(values, return_inverse=True)
    return np.array([text(value) for value in different.tolist()], dtype=object)[place]
