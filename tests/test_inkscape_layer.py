# SPDX-License-Identifier: GPL-2.0-or-later
"""What a trace does to the document: one layer more, and nothing else."""

from __future__ import annotations

import copy
from pathlib import Path

import numpy as np
import pytest

inkex = pytest.importorskip("inkex")

from lxml import etree

import ddtcore
from ddt_trace import DdtTrace
from ddtcore.inkscape import layer
from ddtcore.model import Gradient

PICTURE = Path(__file__).parent / "documents" / "picture.png"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"
MODE = "{http://www.inkscape.org/namespaces/inkscape}groupmode"
IMAGE = f'<image id="%s" x="%s" width="60" height="44" xlink:href="{PICTURE}"/>'


def trace(tmp_path, body, *arguments, root=""):
    """Trace pictures of a document with `body`; returns the roots before and after."""
    source, target = tmp_path / "in.svg", tmp_path / "out.svg"
    source.write_text('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
                      ' xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
                      f' viewBox="0 0 200 100" {root}>{body}</svg>', encoding="utf-8")
    DdtTrace().run([*arguments, f"--output={target}", str(source)])
    return etree.parse(str(source)).getroot(), etree.parse(str(target)).getroot()


def layers(root):
    return [element for element in root if element.get(LABEL) == layer.LABEL]


def test_the_layer_lies_right_above_what_holds_the_picture(tmp_path):
    body = f'<g id="below"/><g id="holder">{IMAGE % ("a", 0)}</g><g id="above"/>'
    _, root = trace(tmp_path, body)
    assert [element.get("id") for element in root] == ["below", "holder", None, "above"]
    assert root[2].get(MODE) == "layer"


def test_one_group_per_picture_and_one_layer_per_holder(tmp_path):
    body = (f'<g id="g">{IMAGE % ("a", 0)}{IMAGE % ("b", 70)}</g>'
            + (IMAGE % ("c", 140)).replace("<image", '<image inkscape:label="Third"'))
    _, root = trace(tmp_path, body, "--id=c", "--id=g")
    assert [element.tag.rpartition("}")[2] for element in root] == ["g", "g", "image", "g"]
    assert [[group.get(LABEL) for group in one] for one in layers(root)] == [["a", "b"], ["Third"]]


def test_nothing_else_in_the_document_changes(tmp_path):
    body = ('<!-- comment --><style>.x { fill: red }</style><defs><linearGradient id="grad"/></defs>'
            f'<g style="opacity : .5; weird:;" class="x">{IMAGE % ("a", 0)}\n tail</g>'
            '<text xml:space="preserve"> a  b </text><foreign xmlns="urn:x" y="1"/>')
    before, after = trace(tmp_path, body, root='style="fill:blue" data-x="1"')
    for one in layers(after):
        after.remove(one)
    assert etree.tostring(after, method="c14n") == etree.tostring(before, method="c14n")


def test_paths_are_named_and_the_group_is_described(tmp_path):
    _, root = trace(tmp_path, IMAGE % ("a", 0), "--preset=clip-art", "--colors=5", "--tolerance=0.5")
    group, = layers(root)[0]
    assert all(path.get(LABEL) for path in group.iter("{*}path"))
    description = group.findtext("{*}desc")
    assert f"DDT Trace {ddtcore.__version__}" in description and "60 x 44 px" in description
    assert "preset=clip-art, colors=5, tolerance=0.5" in description


def test_larger_areas_lie_at_the_back(tmp_path):
    _, root = trace(tmp_path, IMAGE % ("a", 0))
    boxes = [inkex.Path(path.get("d")).bounding_box() for path in layers(root)[0].iter("{*}path")]
    areas = [box.width * box.height for box in boxes]
    assert areas == sorted(areas, reverse=True)


def test_ids_never_clash(tmp_path, monkeypatch):
    sliced = IMAGE.replace("<image", '<image preserveAspectRatio="xMidYMid slice" height="9"').replace(
        'width="60" height="44"', 'width="60"')
    body = (sliced % ("a", 0) + sliced % ("b", 70)
            + '<g id="ddt-trace-clip1-x"/><g id="ddt-trace-gradient2-"/>')
    ramp = Gradient("linear", (0, 0), (60, 0), ((0, (0, 0, 0), 1), (1, (255, 0, 0), 1)))
    drawing = ddtcore.trace(ddtcore.load_image(str(PICTURE)))
    shapes = tuple(copy.copy(shape) for shape in drawing.shapes)
    for shape in shapes:
        object.__setattr__(shape, "gradient", ramp)
    object.__setattr__(drawing, "shapes", shapes)
    monkeypatch.setattr("ddtcore.inkscape.effect.trace", lambda *_: drawing)
    _, root = trace(tmp_path, body, "--id=a", "--id=b")
    ids = root.xpath("//@id")
    assert len(ids) == len(set(ids))
    used = {value[5:-1] for value in root.xpath("//@fill | //@style") if value.startswith("url(#")}
    assert len(used) == 2 and used <= set(ids)


@pytest.mark.parametrize("fate, remaining", [("keep", "image"), ("hide", "image"), ("remove", None)])
def test_what_becomes_of_the_picture(tmp_path, fate, remaining):
    body = (IMAGE % ("a", 0)).replace("<image", '<image style="display:inline; opacity:.9"')
    _, root = trace(tmp_path, body, f"--source={fate}")
    found = root.xpath("//*[@id='a']")
    assert len(found) == (remaining is not None)
    if fate == "hide":
        assert found[0].get("style") == "opacity:.9;display:none"
    assert len(layers(root)) == 1


@pytest.mark.parametrize("body", [
    IMAGE % ("a", 0) + '<use xlink:href="#a"/>',
    f'<g id="g">{IMAGE % ("a", 0)}</g><use xlink:href="#g"/>'])
def test_a_picture_that_clones_show_is_kept(tmp_path, body):
    _, root = trace(tmp_path, body, "--id=a", "--source=remove")
    assert root.xpath("//*[@id='a']")
    assert "picture was kept" in layers(root)[0][0].findtext("{*}desc")


def test_of_a_clone_the_clone_is_hidden_and_nothing_more(tmp_path):
    shared = f'<defs>{IMAGE % ("a", 0)}<g id="g">{IMAGE % ("b", 0)}<rect/></g></defs>'
    _, root = trace(tmp_path, shared + '<use id="u" xlink:href="#a"/>', "--id=u", "--source=hide")
    assert root.xpath("//*[@id='u']")[0].get("style") == "display:none"
    assert root.xpath("//*[@id='a']")[0].get("style") is None
    _, root = trace(tmp_path, shared + '<use id="u" xlink:href="#g"/>', "--id=u", "--source=hide")
    assert root.xpath("//*[@id='u']")[0].get("style") is None


def test_one_failing_picture_stops_the_whole_trace(tmp_path):
    with pytest.raises(SystemExit):
        trace(tmp_path, IMAGE % ("a", 0) + '<image id="b" xlink:href="gone.png"/>', "--id=a", "--id=b")
    assert not (tmp_path / "out.svg").exists()


def test_a_picture_shown_twice_is_traced_once(tmp_path, monkeypatch):
    calls = []

    def counting(image, options):
        calls.append(image)
        return ddtcore.trace(np.asarray(image), options)

    monkeypatch.setattr("ddtcore.inkscape.effect.trace", counting)
    _, root = trace(tmp_path, IMAGE % ("a", 0) + IMAGE % ("b", 70), "--id=a", "--id=b")
    assert len(calls) == 1 and len(layers(root)) == 2


@pytest.mark.parametrize("result", ["triangles", "border", "outlines", "curves"])
def test_every_result_can_be_shown(tmp_path, result):
    _, root = trace(tmp_path, IMAGE % ("a", 0), f"--result={result}")
    assert len(list(layers(root)[0].iter("{*}path"))) >= 2


def test_one_group_for_each_colour(tmp_path):
    body = f'<image id="a" xlink:href="{PICTURE.parent.parent / "images" / "stegosaurus.png"}"/>'
    _, plain = trace(tmp_path, body)
    _, root = trace(tmp_path, body, "--group=color")
    picture, = layers(root)[0]
    groups = [element for element in picture if element.tag.endswith("}g")]
    assert groups and not list(layers(plain)[0][0].iterchildren("{*}g"))
    for group in groups:
        assert {path.get("fill") for path in group} == {group[0].get("fill")} and len(group) > 1
        assert all(path.get(LABEL).startswith(group.get(LABEL)) for path in group)
    names = [sorted(path.get(LABEL) for path in layers(one)[0].iter("{*}path")) for one in (plain, root)]
    assert names[0] == names[1]


@pytest.mark.parametrize("attributes", ['style="display:none"', 'visibility="hidden"', 'display="none"',
                                        's:insensitive="true" style="opacity:1"'])
def test_the_drawing_of_a_picture_in_a_hidden_or_locked_layer_is_neither(tmp_path, attributes):
    body = (f'<g xmlns:s="http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd" {attributes}>'
            f'{IMAGE % ("a", 0)}</g>')
    before, root = trace(tmp_path, body, "--id=a")
    drawn, = layers(root)
    assert drawn.getprevious() is root[0] and dict(root[0].attrib) == dict(before[0].attrib)
    for element in drawn.iter():
        text = " ".join(element.attrib.values())
        assert not any(word in text for word in ("none", "hidden")) and len(element.attrib) <= 4
        assert not [name for name in element.attrib if "insensitive" in name]
