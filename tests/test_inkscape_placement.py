# SPDX-License-Identifier: GPL-2.0-or-later
"""Where Inkscape shows a picture, and that the drawing lies exactly there.

Each document in ``tests/documents`` is a grid of cells of 100 px with one picture, pN, in each.
"""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

inkex = pytest.importorskip("inkex")

import resvg_py
from alignment import over_white, shift
from hypothesis import given
from hypothesis import strategies as st

from ddt_trace import DdtTrace
from ddtcore.inkscape.pictures import find_pictures
from ddtcore.inkscape.placement import Box, fit, length, place
from ddtcore.inkscape.source import PictureError

DOCUMENTS = Path(__file__).parent / "documents"
CELL = 100
GRIDS = ("aspect", "clones", "effects", "sizes", "styles", "transforms", "viewports")
BY_RESVG = {"aspect": {17, 35}, "effects": set(), "styles": set(), "transforms": set()}
"""Documents that resvg shows as Inkscape does, and the cells in which it does not."""

SIZES = st.floats(0.1, 1000)
BOXES = st.builds(Box, st.floats(-500, 500), st.floats(-500, 500), SIZES, SIZES)
ALIGNMENTS = st.builds("x{}Y{} {}".format, *[st.sampled_from(["Min", "Mid", "Max"])] * 2,
                       st.sampled_from(["meet", "slice"]))


def trace(document, result):
    """Trace all pictures of a grid and take the pictures themselves out; returns how many there were."""
    ids = re.findall(r'\bid="(p\d+)"', document.read_text(encoding="utf-8"))
    DdtTrace().run([f"--output={result}", *(f"--id={name}" for name in ids), str(document)])
    tree = inkex.load_svg(str(result))
    for element in tree.getroot().xpath("//*[@id]"):
        if element.get("id") in ids:
            element.delete()
    tree.write(str(result))
    return len(ids)


@pytest.fixture(scope="module")
def grids(tmp_path_factory):
    """The documents, and in a folder ``after`` the same with drawings in place of the pictures."""
    folder = tmp_path_factory.mktemp("grids") / "documents"
    shutil.copytree(DOCUMENTS, folder)
    (folder / "after").mkdir()
    shutil.copy(folder / "picture.png", folder / "after")
    cells = {name: trace(folder / f"{name}.svg", folder / "after" / f"{name}.svg") for name in GRIDS}
    return folder, cells


def check(folder, name, cells, blank_cells=()):
    """Compare the documents before and after, cell by cell."""
    before, after = (over_white(str(path / f"{name}.png")) for path in (folder, folder / "after"))
    columns = before.shape[1] // CELL
    for cell in cells:
        row, column = divmod(cell, columns)
        part = np.s_[row * CELL:(row + 1) * CELL, column * CELL:(column + 1) * CELL]
        assert before[part].min() < 200 or cell in blank_cells, f"{name} p{cell}: no picture"
        assert np.abs(shift(before[part], after[part])).max() < 0.05, f"{name} p{cell}: shifted"
        assert np.abs(before[part] - after[part]).mean() < 2, f"{name} p{cell}: looks different"


@pytest.mark.parametrize("name", BY_RESVG)
def test_drawing_lies_over_the_picture_in_resvg(grids, name):
    folder, cells = grids
    for path in (folder / f"{name}.svg", folder / "after" / f"{name}.svg"):
        png = bytes(resvg_py.svg_to_bytes(svg_path=str(path), resources_dir=str(path.parent)))
        path.with_suffix(".png").write_bytes(png)
    check(folder, name, set(range(cells[name])) - BY_RESVG[name])


def test_drawing_lies_over_the_picture_in_inkscape(grids, inkscape):
    folder, cells = grids
    inkscape.render(*(path / f"{name}.svg" for path in (folder, folder / "after") for name in GRIDS))
    for name in GRIDS:
        # Inkscape 1.2 shows nothing where clip paths and masks are measured by the bounding box.
        check(folder, name, range(cells[name]), blank_cells=(1, 3) if name == "effects" else ())


def test_the_measure_sees_a_shift():
    picture = over_white(str(DOCUMENTS / "picture.png"))
    assert np.abs(shift(picture, picture)).max() < 1e-9
    halfway = (picture + np.roll(picture, 1, axis=1)) / 2
    assert shift(picture, halfway) == pytest.approx((0.5, 0), abs=0.1)


@given(BOXES, BOXES, ALIGNMENTS)
def test_fit_keeps_the_shape_and_touches_the_box(box, content, aspect_ratio):
    transform, cut = fit(box, content, aspect_ratio)
    assert transform.a == transform.d > 0 and transform.b == transform.c == 0
    left, top = transform.apply_to_point((content.x, content.y))
    right, bottom = transform.apply_to_point((content.x + content.width, content.y + content.height))
    slack = 1e-6 * max(map(abs, (left, top, right, bottom, *box)))
    outer = (left, top, right, bottom) if cut else (box.x, box.y, box.x + box.width, box.y + box.height)
    inner = (box.x, box.y, box.x + box.width, box.y + box.height) if cut else (left, top, right, bottom)
    assert all(o <= i + slack for o, i in zip(outer[:2], inner[:2]))
    assert all(o >= i - slack for o, i in zip(outer[2:], inner[2:]))
    sides = np.abs(np.subtract(outer, inner)) <= slack
    assert (sides[0] and sides[2]) or (sides[1] and sides[3])
    for value, side in (("xMin", 0), ("YMin", 1), ("xMax", 2), ("YMax", 3)):
        assert value not in aspect_ratio or sides[side]


@given(BOXES, BOXES)
def test_fit_none_fills_the_box(box, content):
    transform, cut = fit(box, content, " none ")
    corner = transform.apply_to_point((content.x + content.width, content.y + content.height))
    assert not cut
    assert tuple(corner) == pytest.approx((box.x + box.width, box.y + box.height), abs=1e-6 * 2000)


@pytest.mark.parametrize("invalid", [None, "", "xmidymid", "defer xMinYMin", "xMidYMid meet slice", "slice"])
def test_fit_takes_anything_invalid_for_the_default(invalid):
    box, content = Box(3, 4, 50, 80), Box(0, 0, 10, 10)
    assert fit(box, content, invalid) == fit(box, content, "xMidYMid meet")


@pytest.mark.parametrize("box", [Box(0, 0, 0, 5), Box(0, 0, 5, -1)])
def test_fit_refuses_what_has_no_area(box):
    with pytest.raises(PictureError, match="without a width or a height"):
        fit(box, Box(0, 0, 10, 10), None)


def placed(attributes, before=""):
    """Where the only picture of a document of 10 x 10 px lies."""
    tree = inkex.load_svg(f'<svg xmlns="http://www.w3.org/2000/svg">{before}<image {attributes}/></svg>')
    return place(find_pictures(tree.getroot(), [])[0].chain, 10, 10)


@pytest.mark.parametrize("transform", ["scale(0)", "translate(1e400)", "matrix(1e300 0 0 1e300 0 0)"])
def test_what_cannot_be_seen_is_not_traced(transform):
    with pytest.raises(PictureError, match="nothing of it to be seen"):
        placed(f'transform="{transform}"')


@pytest.mark.parametrize("transform", ["matrix(nan 0 0 1 0 0)", "rotate(", "nonsense(3)"])
def test_a_transform_that_cannot_be_read_counts_for_nothing(transform):
    assert placed(f'transform="{transform}"') == placed("")


def test_style_sheets_that_cannot_be_read_do_no_harm():
    sheet = "<style>p { ] } image:future-thing(3), {} image::x { opacity: .3 } }</style>"
    frames = placed('style="opacity:0.5;clip-path:url(#c)" mask="url(#m)"', before=sheet).frames
    assert [frame.style for frame in frames] == [
        {"clip-path": "url(#c)", "mask": "url(#m)", "opacity": "0.5"}]


@pytest.mark.parametrize("text, value", [
    ("12", 12), (" 1.5e1 ", 15), ("-3px", -3), ("25.4mm", 96), ("2.54cm", 96), ("1in", 96), ("72pt", 96),
    ("6pc", 96), ("50%", 100), ("-10%", -20), (None, 7), ("", 7), ("auto", 7), ("3vw", 7)])
def test_length(text, value):
    assert length(text, 200, 7) == pytest.approx(value)
