# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of every kind, embedded in every form: the drawing looks like what Inkscape shows."""

from __future__ import annotations

import base64
import io
import textwrap
import urllib.parse
from pathlib import Path

import numpy as np
import pytest

inkex = pytest.importorskip("inkex")

from alignment import over_white, shift
from PIL import Image, features

from ddt_trace import DdtTrace

PICTURE = Image.open(Path(__file__).parent / "documents" / "picture.png").convert("RGBA")
CELL, COLUMNS = 100, 6


def flat(mode="RGB"):
    """The picture on white paper."""
    paper = Image.new("RGBA", PICTURE.size, "white")
    return Image.alpha_composite(paper, PICTURE).convert(mode)


def grey16():
    grey = np.asarray(flat("L"), np.uint16) * 257
    return Image.frombytes("I;16", PICTURE.size, grey.astype("<u2").tobytes())


def saved(picture, kind, **options):
    file = io.BytesIO()
    picture.save(file, kind, **options)
    return file.getvalue()


def turned(orientation):
    exif = Image.Exif()
    exif[0x0112] = orientation
    return saved(flat(), "JPEG", quality=95, exif=exif)


FILES = {
    "png": saved(PICTURE, "PNG"),
    "png-palette": saved(flat().quantize(16), "PNG"),
    "png-bilevel": saved(flat("L").point(lambda level: 255 * (level > 127)).convert("1"), "PNG"),
    "png-grey": saved(flat("L"), "PNG"),
    "png-grey-alpha": saved(PICTURE.convert("LA"), "PNG"),
    "png-grey-16": saved(grey16(), "PNG"),
    "jpeg": saved(flat(), "JPEG", quality=95),
    "jpeg-grey": saved(flat("L"), "JPEG", quality=95),
    "jpeg-progressive": saved(flat(), "JPEG", quality=95, progressive=True),
    "gif": saved(flat().quantize(16), "GIF"),
    "bmp": saved(flat(), "BMP"),
    "tiff": saved(flat(), "TIFF"),
    "tiff-lzw": saved(flat(), "TIFF", **({"compression": "tiff_lzw"} if features.check("libtiff") else {})),
    "ppm": saved(flat(), "PPM"),
    **{f"exif-{orientation}": turned(orientation) for orientation in range(1, 9)},
}
"""Files that Inkscape shows, by what is special about them."""

PNG = base64.b64encode(FILES["png"]).decode()
FORMS = {
    "wrapped": "data:image/png;base64,\n" + textwrap.fill(PNG, 76),
    "charset": f"data:image/png;charset=utf-8;base64,{PNG}",
    "wrong-type": f"data:image/jpeg;base64,{PNG}",
    "no-padding": "data:image/png;base64," + PNG.rstrip("="),
}
"""The same file in odd forms of data URIs that Inkscape shows."""

UNSEEN = {
    "no-type": f"data:;base64,{PNG}",
    "quoted": "data:image/png;base64," + urllib.parse.quote(PNG, safe=""),
    "percent": "data:image/png," + urllib.parse.quote(FILES["png"]),
    "cmyk": "data:image/jpeg;base64," + base64.b64encode(saved(flat("CMYK"), "JPEG", quality=95)).decode(),
    **({"webp": "data:image/webp;base64," + base64.b64encode(saved(flat(), "WEBP", quality=95)).decode()}
       if features.check("webp") else {}),
}
"""Pictures that some Inkscapes show otherwise, or not at all; they are traced all the same."""


def uris():
    shown = {name: f"data:image/{name.partition('-')[0]};base64,{base64.b64encode(data).decode()}"
             for name, data in FILES.items()}
    return {**{name: uri.replace("image/exif", "image/jpeg") for name, uri in shown.items()}, **FORMS, **UNSEEN}


def body(link):
    """The images, one in each cell."""
    images = []
    for number, (name, uri) in enumerate(uris().items()):
        row, column = divmod(number, COLUMNS)
        images.append(f'<image id="{name}" x="{column * CELL + 20}" y="{row * CELL + 28}" width="60" height="44"'
                      f' preserveAspectRatio="none" {link}="{uri}"/>')
    return "".join(images)


def write(path, content):
    rows = -(-len(uris()) // COLUMNS)
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
                    f' width="{COLUMNS * CELL}" height="{rows * CELL}">{content}</svg>', encoding="utf-8")


@pytest.fixture(scope="module")
def documents(tmp_path_factory):
    """A document with all pictures, and one with their drawings in place of them."""
    folder = tmp_path_factory.mktemp("kinds")
    write(folder / "before.svg", body("xlink:href"))
    DdtTrace().run([f"--output={folder / 'after.svg'}", "--source=remove", "--tolerance=0.1",
                    *(f"--id={name}" for name in uris()), str(folder / "before.svg")])
    return folder / "before.svg", folder / "after.svg"


def cells(path):
    picture = over_white(str(path.with_suffix(".png")))
    for number, name in enumerate(uris()):
        row, column = divmod(number, COLUMNS)
        yield name, picture[row * CELL:(row + 1) * CELL, column * CELL:(column + 1) * CELL]


def test_drawings_look_like_what_inkscape_shows(documents, inkscape):
    inkscape.render(*documents)
    before, after = (dict(cells(path)) for path in documents)
    for name, shown in before.items():
        if name not in UNSEEN:
            assert shown.min() < 128, f"{name}: not shown"
            assert np.abs(shift(shown, after[name])).max() < 0.05, f"{name}: shifted"
            assert np.abs(shown - after[name]).mean() < 3, f"{name}: looks different"
    for name in UNSEEN:
        difference = np.abs(after[name] - after["png"]).mean()
        assert difference < 3, f"{name}: does not look like the same picture"


def test_href_without_a_prefix_is_the_same(documents, tmp_path):
    write(tmp_path / "in.svg", body("href"))
    DdtTrace().run([f"--output={tmp_path / 'out.svg'}", "--source=remove", "--tolerance=0.1",
                    *(f"--id={name}" for name in uris()), str(tmp_path / "in.svg")])
    traced, again = (inkex.load_svg(str(path)).getroot() for path in (documents[1], tmp_path / "out.svg"))
    paths = [[path.get("d") for path in root.iter("{*}path")] for root in (traced, again)]
    assert paths[0] == paths[1]
