# SPDX-License-Identifier: GPL-2.0-or-later
"""Documents, groups and files."""

from __future__ import annotations

import gzip
import os
import sys
import threading
import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from loops import random_loop, rectangle
from pathparser import parse

from ddtcore.model import Drawing, Gradient, Shape, Triangles
from ddtcore.svg import document, encoded, group, path_data, save

SVG = "{http://www.w3.org/2000/svg}"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def shape(loops, rgb=(10, 20, 30), opacity=1.0, gradient=None, name="a shape"):
    return Shape(name, rgb, opacity, tuple(loops), 1.0, gradient)


def drawing(*shapes, **changes):
    return Drawing(**{"width": 40, "height": 30, "shapes": shapes, "decimals": 1, **changes})


def drawing_of_fills(*fills):
    return drawing(*[shape([rectangle(k, 0, 1, 1)], rgb) for k, rgb in enumerate(fills)])


def paths_with_fills(root):
    """Fill and path of each path of a document, inherited fills included."""
    result = []
    for child in root:
        if child.tag == SVG + "g":
            result += [(child.get("fill", "black"), path) for path in child]
        elif child.tag == SVG + "path":
            result.append((child.get("fill", "black"), child))
    return result


def test_document_has_the_size_of_the_picture_and_counts_in_units_of_the_last_digit():
    loops = [random_loop(np.random.default_rng(1), 20, size=30)]
    root = ElementTree.fromstring(document(drawing(shape(loops), decimals=2)))
    assert (root.tag, root.get("width"), root.get("height")) == (SVG + "svg", "40", "30")
    assert root.get("viewBox") == "0 0 4000 3000"
    data = root[0].get("d")
    assert "." not in data
    expected = parse(path_data(loops, 2))
    assert [[[(x / 100, y / 100) for x, y in points] for points in loop] for loop in parse(data)] == expected


def test_empty_drawing_is_a_document_too():
    root = ElementTree.fromstring(document(drawing()))
    assert len(root) == 0 and root.get("viewBox") == "0 0 400 300"


def test_shapes_that_vanish_leave_no_path():
    speck = shape([rectangle(1, 1, 0.01, 0.01)])
    seen = shape([rectangle(1, 1, 2, 2)])
    assert document(drawing(speck, seen, speck)) == document(drawing(seen))
    assert group(drawing(speck, seen, speck)) == group(drawing(seen))


@pytest.mark.parametrize("rgb, expected", [
    ((255, 0, 0), "red"), ((0, 0, 255), "#00f"), ((210, 180, 140), "tan"), ((17, 34, 51), "#123"),
    ((17, 34, 50), "#112232"), ((255, 255, 255), "#fff"), ((0, 0, 128), "navy"), ((1, 2, 3), "#010203")])
def test_colours_have_their_shortest_form(rgb, expected):
    (fill, _), = paths_with_fills(ElementTree.fromstring(document(drawing_of_fills(rgb))))
    assert fill == expected


def test_black_is_left_out_in_documents_but_not_in_groups():
    assert "fill" not in document(drawing_of_fills((0, 0, 0)))
    assert 'fill="#000"' in group(drawing_of_fills((0, 0, 0)))


def test_order_and_fills_survive_the_sharing_of_attributes():
    fills = [(255, 0, 0), (255, 0, 0), (1, 2, 3), (255, 0, 0), (0, 0, 0), (0, 0, 0), (255, 0, 0), (255, 0, 0)]
    text = document(drawing_of_fills(*fills))
    found = paths_with_fills(ElementTree.fromstring(text))
    assert [fill for fill, _ in found] == ["red", "red", "#010203", "red", "black", "black", "red", "red"]
    assert [parse(path.get("d"))[0][0][0] for _, path in found] == [(10 * k, 0) for k in range(8)]
    assert text.count("red") == 3 and text.count("<g") == 2


@pytest.mark.parametrize("opacity, expected", [
    (1.0, None), (0.5, ".5"), (1 / 255, ".004"), (254 / 255, ".996")])
def test_opacity(opacity, expected):
    root = ElementTree.fromstring(document(drawing(shape([rectangle(0, 0, 2, 2)], opacity=opacity))))
    assert root[0].get("fill-opacity") == expected


LINEAR = Gradient("linear", (1.0, 2.0), (11.5, 2.0), ((0.0, (255, 0, 0), 1.0), (1.0, (0, 0, 255), 0.5)))
RADIAL = Gradient("radial", (5.0, 5.0), (8.0, 9.0), (
    (0.0, (0, 0, 0), 1.0), (0.25, (1, 1, 1), 1.0), (1.0, (2, 2, 2), 1.0)))


def test_gradients_lie_where_they_belong_and_are_defined_once():
    square = [rectangle(0, 0, 5, 5)]
    made = drawing(shape(square, gradient=LINEAR), shape(square), shape(square, gradient=RADIAL),
                   shape(square, gradient=LINEAR))
    root = ElementTree.fromstring(document(made))
    linear, radial = root.find(SVG + "defs")
    assert {linear.get("gradientUnits"), radial.get("gradientUnits")} == {"userSpaceOnUse"}
    assert [linear.get(key) for key in ("x1", "y1", "x2", "y2")] == ["10", "20", "115", "20"]
    assert [radial.get(key) for key in ("cx", "cy", "r")] == ["50", "50", "50"]
    assert [(stop.get("offset"), stop.get("stop-color"), stop.get("stop-opacity")) for stop in linear] == [
        ("0", "red", None), ("1", "#00f", ".5")]
    fills = [fill for fill, _ in paths_with_fills(root)]
    first, second = f"url(#{linear.get('id')})", f"url(#{radial.get('id')})"
    assert fills == [first, "#0a141e", second, first]


def test_group_is_in_pixels_with_names_and_ids_of_its_own():
    odd = 'a "name" <with> & ümlaut'
    loops = [random_loop(np.random.default_rng(2), 9, size=30)]
    made = drawing(shape(loops, name=odd, gradient=LINEAR))
    root = ElementTree.fromstring(group(made, names=True, ids="trace7-"))
    assert root.tag == SVG + "g" and not root.get("transform")
    assert root.find(SVG + "defs")[0].get("id") == "trace7-0"
    assert root.find(SVG + "defs")[0].get("x2") == "11.5"
    path = root.find(SVG + "path")
    assert (path.get(LABEL), path.get("fill")) == (odd, "url(#trace7-0)")
    assert parse(path.get("d")) == parse(path_data(loops, 1))


def mesh(filled, decimals=0):
    """Two quads, of which one diagonal leans each way; the last triangle is transparent."""
    points = np.array([[(0.5, 0.5), (1.5, 0.5), (0.5, 1.5)], [(1.5, 0.5), (1.5, 1.5), (0.5, 1.5)],
                       [(1.5, 0.5), (2.5, 0.5), (2.5, 1.5)], [(1.5, 0.5), (2.5, 1.5), (1.5, 1.5)]])
    rgb = np.array([(255, 0, 0), (0, 0, 0), (1, 2, 3), (9, 9, 9)], dtype=np.uint8)
    border = np.array([False, True, False, False])
    opacity = np.array([1, 1, 0.5, 0])
    return drawing(triangles=Triangles(points, rgb, opacity, border, filled), decimals=decimals)


@pytest.mark.parametrize("write", (document, group))
def test_filled_mesh_has_the_form_of_the_paper(write):
    root = ElementTree.fromstring(write(mesh(True)))
    paths = list(root.iter(SVG + "path"))
    assert [path.get("fill") for path in paths] == [path.get("stroke") for path in paths] == [
        "#ff0000", "#000000", "#010203"]
    assert [path.get("opacity") for path in paths] == [None, None, ".5"]
    assert paths[0].get("d") == "M .5 .5 L 1.5 .5 L .5 1.5 Z"
    assert [[points[0] for points in parse(path.get("d"))[0]] for path in paths] == [
        [tuple(point) for point in triangle] for triangle in mesh(True).triangles.points[:3].tolist()]


def test_bare_mesh_marks_the_border_triangles():
    root = ElementTree.fromstring(document(mesh(False, decimals=2)))
    assert root.get("viewBox") == "0 0 40 30"
    regular, border = root.iter(SVG + "path")
    assert (regular.get("fill"), border.get("fill")) == ("none", "#f93")
    assert len(parse(regular.get("d"))) == 3
    assert [points[0] for points in parse(border.get("d"))[0]] == [(1.5, 0.5), (1.5, 1.5), (0.5, 1.5)]


def test_large_meshes_lose_no_triangle_between_chunks(monkeypatch):
    whole = document(mesh(True)), document(mesh(False))
    monkeypatch.setattr("ddtcore.svg._CHUNK", 2)
    assert (document(mesh(True)), document(mesh(False))) == whole


def example(count=30):
    rng = np.random.default_rng(5)
    return drawing(*[shape([random_loop(rng, 8, size=30)], tuple(rng.integers(0, 256, 3).tolist()))
                     for _ in range(count)])


def test_files_hold_the_document_and_the_same_input_gives_the_same_bytes(tmp_path):
    save(example(), tmp_path / "a.svg")
    save(example(), str(tmp_path / "b.SVGZ"))
    assert (tmp_path / "a.svg").read_bytes() == document(example()).encode() == b"".join(encoded(example()))
    packed = (tmp_path / "b.SVGZ").read_bytes()
    assert gzip.decompress(packed) == (tmp_path / "a.svg").read_bytes()
    assert packed == b"".join(encoded(example(), compressed=True)) and packed[4:8] == bytes(4)
    assert len(packed) <= len(gzip.compress(document(example()).encode(), 9)) + 20
    assert sorted(os.listdir(tmp_path)) == ["a.svg", "b.SVGZ"]


@pytest.mark.parametrize("fault", (OSError(28, "No space left on device"), KeyboardInterrupt()))
def test_interrupted_write_leaves_the_old_file_and_nothing_else(tmp_path, monkeypatch, fault):
    def pieces(*arguments):
        yield b"half a "
        raise fault

    (tmp_path / "a.svg").write_text("old")
    monkeypatch.setattr("ddtcore.svg.encoded", pieces)
    with pytest.raises(type(fault)):
        save(example(), tmp_path / "a.svg")
    assert os.listdir(tmp_path) == ["a.svg"] and (tmp_path / "a.svg").read_text() == "old"


@pytest.mark.skipif(sys.platform == "win32", reason="POSIX permissions, links and pipes")
class TestUnix:
    def test_replaced_file_keeps_its_permissions(self, tmp_path):
        (tmp_path / "a.svg").write_text("old")
        os.chmod(tmp_path / "a.svg", 0o640)
        save(example(), tmp_path / "a.svg")
        assert os.stat(tmp_path / "a.svg").st_mode & 0o777 == 0o640

    def test_link_stays_a_link(self, tmp_path):
        (tmp_path / "real.svg").write_text("old")
        os.symlink(tmp_path / "real.svg", tmp_path / "link.svg")
        save(example(), tmp_path / "link.svg")
        assert os.path.islink(tmp_path / "link.svg")
        assert (tmp_path / "real.svg").read_text() == document(example())

    def test_pipe_is_written_to_and_not_replaced(self, tmp_path):
        os.mkfifo(tmp_path / "pipe.svg")
        read = []
        reader = threading.Thread(
            target=lambda: read.append((tmp_path / "pipe.svg").read_text()), daemon=True)
        reader.start()
        save(example(), tmp_path / "pipe.svg")
        reader.join(10)
        assert read == [document(example())] and os.listdir(tmp_path) == ["pipe.svg"]
