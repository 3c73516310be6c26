# SPDX-License-Identifier: GPL-2.0-or-later
"""Documents of strangers: read whole or turned down, and nothing else is read or fetched."""

from __future__ import annotations

import base64
import io
import random
import socket
import threading
import time
from pathlib import Path

import pytest

inkex = pytest.importorskip("inkex")

from lxml import etree
from pathparser import parse

from ddt_trace import DdtTrace
from ddtcore.inkscape.document import load_document

PICTURE = Path(__file__).parent / "documents" / "picture.png"
PIXEL = base64.b64encode(
    b"GIF89a\x01\x00\x01\x00\x80\x00\x00\x10\x20\x30\x00\x00\x00,\x00\x00\x00\x00\x01\x00\x01\x00\x00\x02\x02D\x01\x00;"
).decode()
HEAD = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink" width="60" height="44"'
IMAGE = f'<image id="a" xlink:href="{PICTURE}"/>'
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"


def laughs(levels):
    """Entities of ten entities each."""
    more = "".join(f'<!ENTITY e{n + 1} "{f"&e{n};" * 10}">' for n in range(levels))
    return f'<!ENTITY e0 "ha">{more}'


def load(text):
    return load_document(io.BytesIO(text if isinstance(text, bytes) else text.encode()), "in.svg")


def refusal(text):
    with pytest.raises(inkex.AbortExtension) as caught:
        load(text)
    return str(caught.value)


def traced(tmp_path, body, *arguments, before=""):
    """Trace pictures of a document; returns what it became."""
    source, target = tmp_path / "in.svg", tmp_path / "out.svg"
    source.write_text(f"{before}<svg {HEAD}>{body}</svg>", encoding="utf-8")
    DdtTrace().run([*arguments, f"--output={target}", str(source)])
    return etree.parse(str(target), etree.XMLParser(resolve_entities=False)).getroot()


def message(capfd, tmp_path, body, *arguments):
    """The one sentence that a document which can't be traced is turned down with."""
    with pytest.raises(SystemExit) as caught:
        traced(tmp_path, body, *arguments)
    said = capfd.readouterr().err
    assert caught.value.code not in (0, None) and not (tmp_path / "out.svg").exists()
    assert said.rstrip().endswith(".") and said.count("\n") <= 1 and "Traceback" not in said
    return said


def paths(root):
    """Outlines of the drawing, each checked by a strict reader, which knows no NaN."""
    layer, = (element for element in root if element.get(LABEL) == "DDT Trace")
    found = [path.get("d") for path in layer.iter("{*}path")]
    assert found and all(map(parse, found))
    return found


@pytest.mark.parametrize("text", ["", "no markup", "<html/>", "<g/>", "\0\0", '{"a": 1}'])
def test_what_is_no_document(text):
    assert refusal(text) == "in.svg is not an SVG document."


@pytest.mark.parametrize("text, line", [
    (f"<svg {HEAD}>\n<g>\n</svg>", 3), (f"<svg {HEAD}>\n<rect id='a' id='b'/></svg>", 2), (f"<svg {HEAD}>\n\n<re", 3),
    (f"<svg {HEAD}>&undeclared;\n</svg>", None), (f"<svg {HEAD}/>\n<svg/>", 2)])
def test_a_damaged_document_is_not_read_in_part(text, line):
    said = refusal(text)
    assert said.startswith("in.svg is a damaged document") and (line is None or f"line {line}." in said)


def test_elements_without_a_namespace_do_no_harm(tmp_path):
    assert paths(traced(tmp_path, f'<x xmlns="" y="1"><z/></x>{IMAGE}'))


def test_prefixes_that_nobody_declared_do_no_harm():
    assert len(load(f'<svg {HEAD}><g inkscape:label="x" foo:bar="y"/></svg>').getroot()) == 1


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1"])
def test_documents_in_any_encoding(encoding):
    text = f'<?xml version="1.0" encoding="{encoding}"?><svg {HEAD}><title>größe</title></svg>'
    assert load(text.encode(encoding)).getroot()[0].text == "größe"


def test_pictures_of_many_megabytes():
    data = "A" * 30_000_000
    assert len(load(f'<svg {HEAD}><image xlink:href="data:{data}"/></svg>').getroot()[0].get("xlink:href")) > 3e7


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
@pytest.mark.parametrize("body", ["<text>&e12;</text>", '<text id="&e12;"/>', '<g xmlns:x="&e12;"/>'])
def test_entities_do_not_grow_without_limit(body, encoding):
    begin = time.process_time()
    text = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE svg [{laughs(12)}]><svg {HEAD}>{body}</svg>'
    try:
        tree = load(text.encode(encoding))
        assert len(etree.tostring(tree)) < 1_000_000
    except inkex.AbortExtension as error:
        assert "damaged" in str(error)
    assert time.process_time() - begin < 5


def test_entities_stay_what_they_are(tmp_path):
    (tmp_path / "secret.txt").write_text("secret")
    doctype = ('<!DOCTYPE svg [<!ENTITY word "hello">'
               f'<!ENTITY file SYSTEM "{(tmp_path / "secret.txt").as_uri()}">]>')
    traced(tmp_path, IMAGE + "<text>&word;, &file;</text>", before=doctype)
    text = (tmp_path / "out.svg").read_text(encoding="utf-8")
    assert "&word;, &file;" in text and "secret.txt" in text and ">secret" not in text


@pytest.fixture
def server():
    """A server that counts who knocks."""
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()
        knocks = []

        def accept():
            try:
                while True:
                    knocks.append(listening.accept())
            except OSError:
                pass

        threading.Thread(target=accept, daemon=True).start()
        yield f"http://127.0.0.1:{listening.getsockname()[1]}", knocks
        time.sleep(0.1)
        listening.shutdown(socket.SHUT_RDWR)


def test_nothing_is_fetched_for_a_document(tmp_path, capfd, server):
    address, knocks = server
    doctype = (f'<!DOCTYPE svg SYSTEM "{address}/svg.dtd" [<!ENTITY remote SYSTEM "{address}/text">'
               f'<!ENTITY % more SYSTEM "{address}/more">]>')
    body = (f'<style>@import url("{address}/style.css");</style><script href="{address}/code.js"/>'
            f'<g xmlns:xi="http://www.w3.org/2001/XInclude"><xi:include href="{address}/part.svg"/></g>'
            f'<image id="b" xlink:href="{address}/b.png"/><use id="u" xlink:href="{address}/c.svg#d"/>')
    paths(traced(tmp_path, body + IMAGE, "--id=a", before=doctype))
    (tmp_path / "out.svg").unlink()
    for name in "bu":
        message(capfd, tmp_path, body + IMAGE, f"--id={name}")
    assert not knocks


@pytest.mark.parametrize("attributes, words", [
    ("", "no content"), ('xlink:href=""', "no content"), ('xlink:href="#a"', "no such file"),
    ('xlink:href="/dev/zero"', "no such file"), ('xlink:href="http://a.b/c"', "not fetched"),
    (f'xlink:href="{PICTURE}" width="-5"', "width or a height"),
    (f'xlink:href="{PICTURE}" height="0%"', "width or a height"),
    (f'xlink:href="{PICTURE}" transform="matrix(1 2 2 4 0 0)"', "nothing of it"),
    (f'xlink:href="{PICTURE}" transform="translate(1e999)"', "nothing of it")])
def test_pictures_that_cannot_be_traced_are_named(capfd, tmp_path, attributes, words):
    said = message(capfd, tmp_path, f'<image id="a&quot;b&lt;" {attributes}/>')
    assert said.startswith('The picture "a"b<" cannot be traced: ') and words in said


@pytest.mark.parametrize("attributes", [
    'width="1e-30" height="1e-30"', 'width="1e30" height="1e30"', 'x="-1e300" y="1e20"', 'width="nan"',
    'height="inf"', 'x="1e999"', 'transform="scale(1e-12)"', 'transform="matrix(nan,0,0,1,0,0)"',
    'transform="rotate(1e9) skewX(89.9999)"', 'style="opacity:nan;clip-path:url(#none);mask:url(#a)"',
    'preserveAspectRatio="nan slice"', 'width="5em"', 'transform="' + "rotate(1) " * 5000 + '"'])
def test_odd_numbers_give_a_drawing_or_a_sentence(capfd, tmp_path, attributes):
    body = IMAGE.replace("<image", f"<image {attributes}")
    try:
        root = traced(tmp_path, body)
    except SystemExit:
        said = capfd.readouterr().err
        assert said.startswith('The picture "a" cannot be traced: ') and said.count("\n") <= 1
    else:
        assert paths(root)
        assert not any(word in element.get("transform", "").lower()
                       for element in root[-1].iter() for word in ("nan", "inf"))


@pytest.mark.parametrize("box", ["0 0 0 0", "0 0 nan 5", "-1e300 0 1e300 1", "a b c d", "0 0 -5 5", ""])
def test_odd_view_boxes(capfd, tmp_path, box):
    body = f'<svg viewBox="{box}">{IMAGE}</svg>'
    try:
        paths(traced(tmp_path, body))
    except SystemExit:
        assert capfd.readouterr().err.count("\n") <= 1


def test_cycles_of_every_kind_end(capfd, tmp_path):
    body = ('<g id="g"><use id="u" xlink:href="#h"/></g><g id="h"><use id="v" xlink:href="#g"/></g>'
            '<clipPath id="c" clip-path="url(#c)"><use xlink:href="#u"/></clipPath>'
            '<mask id="m" mask="url(#m)"><use xlink:href="#m"/></mask>'
            '<pattern id="p" xlink:href="#q"/><pattern id="q" xlink:href="#p"/><rect id="r" fill="url(#p)"/>')
    for name in ("u", "v", "g", "r"):
        assert "is not a picture" in message(capfd, tmp_path, body, f"--id={name}")
    picture = IMAGE.replace("<image", '<image clip-path="url(#c)" mask="url(#m)"')
    assert paths(traced(tmp_path, body + picture, "--id=a"))


ODD = ("", "nan", "-1", "0", "1e400", "1e-400", "5em", "10%", "auto", "url(#x)", "url(", "url(#c) none", "#", "a b",
       ";", ":", "a:b;c", "{}", "}", "/*", "'", '"', "rotate(", "rotate(1,2)", "rotate(a)", "matrix(1,2)", "scale()",
       "skewX(90)", "translate(1,2,3,4)", "xMidYMid meet x", "0 0 10", "1 2 3 4 5", "data:", "http://a/b", "//a/b",
       "file://", "%", "C:x", "var(--x)", "calc(1px + 2%)", "1px px", "١", "!important", "clip-path:url( #c )", "\\0")
EVERYTHING = f"""<svg id="root" {HEAD} viewBox="0 0 60 44" style="opacity:1">
<style id="t">image {{ opacity: .9 }} .c {{ clip-path: url(#c) }} #a {{ mask: url(#m) }}</style>
<defs><clipPath id="c"><rect width="40" height="30"/></clipPath><mask id="m"><rect width="1" height="1"/></mask>
<symbol id="s" viewBox="0 0 9 9" refX="1" preserveAspectRatio="xMidYMid slice">{IMAGE.replace('"a"', '"b"')}</symbol>
<pattern id="p" width="4" height="4"><image xlink:href="{PICTURE}"/></pattern></defs>
<g id="g" transform="translate(2,3) rotate(10)" style="filter:url(#f)">
<svg id="n" x="1" y="2" width="30" height="20" viewBox="0 0 9 9" preserveAspectRatio="none"><image id="a" class="c"
x="1" width="8" height="7" transform="skewX(9)" preserveAspectRatio="xMinYMax slice" xlink:href="{PICTURE}"/>
</svg><use id="u" xlink:href="#s" x="3" width="9" height="9" transform="scale(2)"/><use id="v" xlink:href="#a"/>
<rect id="r" width="5" height="5" style="fill:url(#p)"/></g></svg>"""


@pytest.mark.parametrize("name", ["", "root", "g", "n", "a", "u", "v", "r"])
def test_attributes_changed_at_random_give_a_drawing_or_a_sentence(name, tmp_path, capfd):
    rng = random.Random(name)
    for number in range(25):
        root = etree.fromstring(EVERYTHING)
        for _ in range(rng.choice((1, 1, 2, 4))):
            element = rng.choice(list(root.iter()))
            key, value = rng.choice([*element.attrib, "transform", "style", "viewBox", "mask"]), rng.choice(ODD)
            old = element.get(key, "")
            place = rng.choice((0, rng.randrange(len(old) + 1)))
            element.set(key, old[:place] + value + old[place:] if place else value)
        source, target = tmp_path / f"{number}.svg", tmp_path / f"{number}-traced.svg"
        source.write_bytes(etree.tostring(root))
        try:
            DdtTrace().run([*([f"--id={name}"] if name else []), f"--output={target}", str(source)])
        except SystemExit as ended:
            said = capfd.readouterr().err
            assert ended.code == inkex.utils.ABORT_STATUS and said.count("\n") <= 1, (said, source.read_text())
            assert not target.exists()
        else:
            assert paths(etree.parse(str(target)).getroot())


def test_names_and_links_do_not_break_a_sentence(capfd, tmp_path):
    said = message(capfd, tmp_path, f'<image id="a&#10;{"b" * 999}" xlink:href="c&#10;d.png"/>')
    assert said.startswith('The picture "a bbb') and '"c d.png"' in said and len(said) < 400


def test_a_thousand_pictures(tmp_path):
    begin = time.process_time()
    image = f'<image x="%d" width="1" height="1" xlink:href="data:;base64,{PIXEL}"/>'
    body = "<style>rect { fill: red }</style><g id='g'>" + "".join(image % n for n in range(1000)) + "</g>"
    root = traced(tmp_path, body, "--id=g", "--source=remove")
    assert len(paths(root)) == 1000
    assert root.find(".//{*}image") is None
    assert time.process_time() - begin < 30


def test_deep_documents(tmp_path):
    body = "<g transform='translate(1)'>" * 200 + IMAGE + "</g>" * 200
    assert paths(traced(tmp_path, body))
