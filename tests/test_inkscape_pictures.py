# SPDX-License-Identifier: GPL-2.0-or-later
"""Which pictures are traced: what is selected, or the only one."""

from __future__ import annotations

import time

import pytest

inkex = pytest.importorskip("inkex")

from ddtcore.inkscape import pictures
from ddtcore.inkscape.pictures import cloned_ids, find_pictures, is_cloned


def svg(body):
    return inkex.load_svg('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
                          f' xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape">{body}</svg>').getroot()


def chains(body, *ids):
    return [[element.get("id") for element in picture.chain] for picture in find_pictures(svg(body), ids)]


def refusal(body, *ids):
    with pytest.raises(inkex.AbortExtension) as caught:
        find_pictures(svg(body), ids)
    return str(caught.value)


TWO = '<g id="g"><image id="a"/><g id="h"><image id="b"/><rect id="r"/></g></g>'


def test_selected_pictures_come_in_drawing_order_and_once():
    assert chains(TWO, "b", "a") == [["g", "a"], ["g", "h", "b"]]
    assert chains(TWO, "h", "g", "a", "b") == [["g", "a"], ["g", "h", "b"]]


def test_the_document_itself_may_be_selected():
    root = svg(TWO)
    root.set("id", "root")
    assert [picture.name for picture in find_pictures(root, ["root"])] == ["a", "b"]


def test_things_beside_the_pictures_do_not_matter():
    assert chains(TWO, "r", "a") == [["g", "a"]]


def test_nothing_selected_means_the_only_picture():
    beside = '<text id="t">a</text><defs><image id="d"/></defs>'
    assert chains(f'<g id="g"><image id="a"/></g>{beside}') == [["g", "a"]]
    assert chains('<image id="a"/><use id="u" xlink:href="#a"/>') == [["a"]]
    assert chains('<defs><image id="a"/></defs><use id="u" href="#a"/>') == [["u", "a"]]
    assert "shows no picture" in refusal("<rect/><defs><image/></defs>")
    assert "shows 2 pictures" in refusal(TWO)


@pytest.mark.parametrize("name", ['"', "'", "a b", "ü", "a'b\"c", "[1]", "#x", "//g"])
def test_ids_may_hold_any_character(name):
    quoted = name.replace('"', "&quot;")
    assert chains(f'<image id="{quoted}"/>', name) == [[name]]


def test_of_two_elements_with_one_id_the_first_counts():
    assert chains('<image id="a"/><rect id="a"/>', "a") == [["a"]]


def test_clones_lead_to_what_they_show():
    body = ('<defs id="d"><image id="a"/><g id="g"><use id="v" xlink:href="#a"/><rect/></g>'
            '<symbol id="s"><image id="b"/></symbol></defs>'
            '<use id="u" xlink:href="#g"/><use id="w" xlink:href="#s"/>')
    assert chains(body, "u") == [["u", "g", "v", "a"]]
    assert chains(body, "w") == [["w", "s", "b"]]
    shown, = find_pictures(svg(body), ["u"])
    assert shown.shown.get("id") == shown.name == "u" and shown.image.get("id") == "a"


def test_the_label_names_a_picture():
    assert find_pictures(svg('<image id="a" inkscape:label="Ein Bild"/>'), [])[0].name == "Ein Bild"


def test_cycles_of_clones_end():
    assert "holds none" in refusal('<use id="u" xlink:href="#u"/>', "u")
    assert chains('<g id="g"><use id="u" xlink:href="#g"/><image id="a"/></g>', "g") == [["g", "a"]]


def test_a_flood_of_clones_ends(monkeypatch):
    monkeypatch.setattr(pictures, "MOST_STEPS", 5000)
    levels = "".join(f'<g id="l{n}">' + f'<use xlink:href="#l{n + 1}"/>' * 10 + "</g>" for n in range(20))
    assert "too many clones" in refusal(levels + '<g id="l20"/>', "l0")


def test_a_long_chain_of_clones_ends():
    chain = "".join(f'<use id="u{n}" xlink:href="#u{n - 1}"/>' for n in range(1, 3000))
    begin = time.process_time()
    for ids in ((), ("u2999",), ("u10", "u2999")):
        assert "too many clones" in refusal(f'<image id="u0"/><image id="v"/>{chain}', *ids)
    assert time.process_time() - begin < 20
    assert len(chains(f'<image id="u0"/>{chain}', "u500")[0]) == 501


def test_a_large_document_holds_no_flood(monkeypatch):
    monkeypatch.setattr(pictures, "MOST_STEPS", 50)
    assert chains("<g>" + "<path/>" * 1000 + '</g><image id="a"/>') == [["a"]]


def test_thousands_of_nested_groups_are_no_trouble():
    depth = 2000
    assert len(chains("<g>" * depth + '<image id="a"/>' + "</g>" * depth, "a")[0]) == depth + 1


@pytest.mark.parametrize("body, name, words", [
    (TWO, "x", 'no object with the id "x"'),
    (TWO, "r", '"r" is not a picture'),
    ('<defs><g id="g"><image id="a"/></g></defs>', "a", "part of a definition"),
    ('<symbol id="s"><image id="a"/></symbol>', "s", "part of a definition"),
    ('<pattern id="p"><image/></pattern><pattern id="q" xlink:href="#p"/><rect id="r" fill="url(#q)"/>', "r",
     "Pattern to Objects"),
    ('<pattern id="p"><image/></pattern><rect id="r" style="fill:url(#p) none"/>', "r", "Pattern to Objects"),
    ('<pattern id="p" xlink:href="#p"/><rect id="r" fill="url(#p)"/>', "r", "is not a picture"),
])
def test_why_there_is_nothing_to_trace(body, name, words):
    message = refusal(body, name)
    assert words in message and message.endswith(".") and "\n" not in message


def test_clones_of_a_picture_and_of_what_holds_it():
    document = svg('<g id="g"><image id="a"/></g><use id="u" xlink:href="#a"/><use id="v" href="#g"/>'
                   '<use id="w" xlink:href="#u"/>')
    ids = cloned_ids(document)
    assert ids == {"a", "g", "u"}
    cloned = {element.get("id") for element in document.iterdescendants() if is_cloned(element, ids)}
    assert cloned == {"a", "g", "u"}
    assert cloned_ids(svg(TWO)) == frozenset() and not is_cloned(svg(TWO)[0], frozenset())
