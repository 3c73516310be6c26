# SPDX-License-Identifier: GPL-2.0-or-later
"""The page that compares a picture with its trace: what is in it, and what it does in a browser."""

from __future__ import annotations

import base64
import io
import os
import re

import browser
import numpy as np
import pytest
from lxml import html
from PIL import Image

import ddtcore
from ddtcore import TraceOptions, compare
from ddtcore.cli import main

LAYERS = ("triangles", "border", "outlines", "curves", "nodes")


def picture():
    """A red disc with a blue bar on white, 60 x 40 px, anti-aliased."""
    y, x = np.mgrid[:40, :60] + 0.5
    cover = np.clip(12.5 - np.hypot(x - 22, y - 20), 0, 1)[..., np.newaxis]
    image = np.full((40, 60, 4), 255, dtype=np.uint8)
    image[..., :3] = np.rint(cover * (200, 30, 40) + (1 - cover) * 255)
    image[8:30, 44:52, :3] = (20, 60, 220)
    return image


@pytest.fixture(scope="module")
def page():
    return compare.compare(picture(), name="disc.png")


def parsed(page):
    return html.document_fromstring(page)


# -- what is in it ----------------------------------------------------------------

def test_page_needs_nothing_else(page):
    tree = parsed(page)
    links = tree.xpath("//@href | //@src | //@data | //@action") + re.findall(r"url\(([^)]+)\)", page)
    assert links and all(link.startswith(("data:", "#")) for link in links)
    assert not tree.xpath("//iframe | //object | //embed | //script[@src] | //link[@rel='stylesheet']")
    assert "default-src 'none'" in tree.xpath("//meta[@http-equiv]/@content")[0]
    ids = tree.xpath("//@id")
    assert len(ids) == len(set(ids)) and "{{" not in page


def test_bitmap_is_there_pixel_for_pixel(page):
    uri, = parsed(page).xpath("//image/@href")
    with Image.open(io.BytesIO(base64.b64decode(uri.partition(",")[2]))) as image:
        assert np.array_equal(np.asarray(image.convert("RGBA")), picture())


def test_layers_hold_what_the_stages_made(page):
    tree = parsed(page)
    drawing = ddtcore.trace(picture())
    outlines = ddtcore.trace(picture(), TraceOptions(result="outlines", stacking="cutout"))
    assert len(tree.xpath("//*[@id='curves']//path")) == len(drawing.shapes)
    for layer, drawn in (("nodes", drawing), ("outlines", outlines)):
        points = np.concatenate([loop.control[:, 0] for shape in drawn.shapes for loop in shape.loops])
        dots = tree.xpath(f"//*[@id='{layer}']/path[@class='fine dots']/@d")[0]
        assert dots.count("h0") == len(np.unique(points.round(2), axis=0))
    meshes = ddtcore.trace(picture(), TraceOptions(result="border"))
    marked = tree.xpath("//*[@id='border']//path[@fill='#f93']/@d")[0]
    assert marked.count("z") == meshes.counts["border triangles"]
    painted = "".join(tree.xpath("//*[@id='triangles']//path/@d"))
    assert meshes.counts["border triangles"] <= painted.count("z") < meshes.counts["triangles"]


def test_figures_are_those_of_the_report(page):
    from ddtcore.report import report

    tree = parsed(page)
    cells = dict(zip(tree.xpath("//table//th/text()"), tree.xpath("//table//td/text()")))
    figures = report(picture()).to_dict()
    for key, value in [*figures["bytes"].items(), *figures["counts"].items()]:
        assert cells[compare.WORDS.get(key, key)] == f"{value:,}"
    assert set(compare.WORDS) == {*figures["bytes"], *figures["ratios"]}


def test_three_settings_are_three_different_traces(page):
    captions = parsed(page).xpath("//figcaption")
    assert len(captions) == 3 and len({caption.text_content() for caption in captions}) == 3
    said = [caption.text_content() for caption in captions]
    assert "the default settings" in said[0] and said[1].endswith("--tolerance 0.8")
    paper = parsed(compare.compare(picture(), TraceOptions.preset("paper"))).xpath("//figcaption")
    assert paper[0].find("code").text == captions[2].find("code").text
    assert "the default settings" in paper[2].text_content()


def test_choice_of_a_preset_is_told():
    sprite = np.kron(np.random.default_rng(1).integers(0, 2, (12, 12, 1)), np.ones((8, 8, 1)))
    image = np.concatenate([np.repeat(200 * sprite, 3, axis=2), np.full((96, 96, 1), 255)], axis=2)
    page = compare.compare(image.astype(np.uint8))
    assert "the look of the picture: pixel-art (" in page and "<code>--regions pixels --curves crisp" in page
    assert "the look of the picture" not in compare.compare(picture(), TraceOptions())


def test_names_and_notes_are_text_and_not_markup(monkeypatch):
    page = compare.compare(picture(), name='<img src="x">&')
    tree = parsed(page)
    assert tree.xpath("//h1")[0].text == '<img src="x">&' and not tree.xpath("//img")


def test_large_meshes_are_shown_in_a_window_and_that_is_said(monkeypatch, page):
    monkeypatch.setattr(compare, "MOST_TRIANGLES", 200)
    small = compare.compare(picture())
    tree = parsed(small)
    shown = "".join(tree.xpath("//*[@id='border']//path/@d")).count("z")
    assert 100 <= shown <= 200 and "The mesh is shown between" in small
    assert "The mesh is shown between" not in page


@pytest.mark.parametrize("image", [
    np.zeros((1, 1, 4), np.uint8), np.full((1, 1, 4), 255, np.uint8), np.zeros((5, 7, 4), np.uint8),
    np.full((1, 30, 4), 90, np.uint8)], ids=["nothing", "one pixel", "all transparent", "one row"])
def test_degenerate_pictures_have_a_page(image):
    assert parsed(compare.compare(image)).xpath("//*[@id='viewer']")


def test_same_picture_same_page(page):
    assert compare.compare(picture(), name="disc.png") == page


# -- the command ------------------------------------------------------------------

def test_command_writes_the_page(tmp_path, monkeypatch, page, capsys):
    monkeypatch.chdir(tmp_path)
    Image.fromarray(picture()).save("disc.png")
    assert main(["compare", "disc.png"]) == main(["compare", "disc.png", "-o", "x.html"]) == 0
    for name in ("disc.html", "x.html"):
        assert (tmp_path / name).read_text(encoding="utf-8") == page
    assert capsys.readouterr() == ("", "") and sorted(os.listdir()) == ["disc.html", "disc.png", "x.html"]


@pytest.mark.parametrize("arguments, said", [
    (["compare"], "no picture given"),
    (["compare", "disc.png", "-o", "x.svg"], "-o must end in .html or .htm, not 'x.svg'"),
    (["compare", "disc.png", "--tolerence", "1"], "did you mean --tolerance?"),
])
def test_command_refuses_bad_usage(arguments, said, capsys):
    with pytest.raises(SystemExit) as caught:
        main(arguments)
    assert caught.value.code == 2 and said in capsys.readouterr().err


# -- in a browser -----------------------------------------------------------------

@pytest.fixture(scope="module")
def opened(page, tmp_path_factory):
    """The page in a real browser."""
    if not browser.command():
        if os.environ.get("DDT_TRACE_NEED_BROWSER"):
            pytest.fail(browser.MISSING)
        pytest.skip(browser.MISSING)
    file = tmp_path_factory.mktemp("page") / "page.html"
    file.write_text(page, encoding="utf-8")
    with browser.Browser(1000, 800) as window:
        window.open(file)
        yield window
        assert window.faults == []
        asked = {address for address in window.requests if not address.startswith("data:")}
        assert asked == {file.resolve().as_uri()}


@pytest.fixture
def window(opened):
    """The same, as it was at first."""
    opened.call("Page.reload")
    opened.value("new Promise(done => document.readyState == 'complete' ? done(1)"
                 " : addEventListener('load', done))")
    opened.settle()
    return opened


def split(window):
    return int(window.value("document.getElementById('divider').getAttribute('aria-valuenow')"))


def view(window):
    """Left, top, width and height of what the viewer shows, px of the picture."""
    boxes = window.value("[...document.querySelectorAll('svg[data-view]')]"
                         ".map(svg => svg.getAttribute('viewBox'))")
    assert len(boxes) == 5 and len(set(boxes)) == 1
    return np.array(boxes[0].split(), dtype=float)


def seen(window, x, y):
    """The colour at a point of the picture, as far as it is in the viewer."""
    left, top, width, height = window.place("#viewer > svg")
    at = view(window)
    with Image.open(io.BytesIO(window.shot())) as shot:
        return shot.convert("RGB").getpixel((round(left + (x - at[0]) / at[2] * width),
                                             round(top + (y - at[1]) / at[3] * height)))


def near(colour, expected):
    return np.abs(np.subtract(colour, expected)).max() <= 4


def test_picture_is_shown_as_a_whole_at_first(window):
    left, top, width, height = view(window)
    assert left <= 0 and top <= 0 and left + width >= 60 and top + height >= 40
    assert min(width / 60, height / 40) == pytest.approx(1 / .97)
    assert split(window) == 50
    for x, y, colour in ((20, 20, (200, 30, 40)), (48, 20, (20, 60, 220)), (5, 5, (255, 255, 255))):
        assert near(seen(window, x, y), colour)


def test_divider_parts_bitmap_and_trace(window):
    window.click("input[value=curves]")  # the side of the trace is empty now
    disc, bar = (200, 30, 40), (20, 60, 220)
    assert near(seen(window, 20, 20), disc) and not near(seen(window, 48, 20), bar)
    left, top, width, height = window.place("#viewer")
    middle = top + height / 2
    window.drag((left + width / 2, middle), (left + width - 5, middle))
    assert split(window) >= 99 and near(seen(window, 48, 20), bar)
    window.drag((left + width - 5, middle), (left + width * .1, middle))
    assert split(window) == 10 and not near(seen(window, 20, 20), disc)
    assert view(window)[0] < 0  # the picture stayed where it was


def test_divider_obeys_the_keyboard(window):
    window.value("document.getElementById('divider').focus()")
    for key, expected in (("ArrowLeft", 48), ("ArrowRight", 50), ("End", 100), ("Home", 0), ("]", 2)):
        window.press(key)
        assert split(window) == expected


def test_picture_is_dragged_and_zoomed_about_the_pointer(window):
    left, top, width, height = window.place("#viewer > svg")
    before = view(window)
    window.drag((left + 100, top + 100), (left + 160, top + 130))
    moved = view(window)
    assert (before - moved)[:2] == pytest.approx([60 * before[2] / width, 30 * before[3] / height])
    window.mouse("wheel", left + 100, top + 100, deltaX=0, deltaY=-240)
    window.settle()
    closer = view(window)
    assert closer[2] < .7 * moved[2]
    pointer = np.array([100 / width, 100 / height])
    under = [at[:2] + pointer * at[2:] for at in (moved, closer)]
    assert np.abs(under[0] - under[1]).max() < moved[2] / width  # a pixel of the screen


def test_two_fingers_zoom(window):
    left, top, width, height = window.place("#viewer")
    x, y, before = left + width / 3, top + height / 2, view(window)
    for kind, apart in (("touchStart", 40), ("touchMove", 60), ("touchMove", 80), ("touchEnd", None)):
        fingers = [] if apart is None else [(1, x - apart), (2, x + apart)]
        window.call("Input.dispatchTouchEvent", type=kind,
                    touchPoints=[{"x": x, "y": y, "id": number} for number, x in fingers])
    window.settle()
    assert view(window)[2] == pytest.approx(before[2] / 2, rel=.02)


def test_keys_zoom_and_move(window):
    window.value("document.getElementById('viewer').focus()")
    whole = view(window)
    window.press("+", "+", "-", "ArrowRight")
    closer = view(window)
    assert closer[2] == pytest.approx(whole[2] / 1.25) and closer[0] + closer[2] / 2 > 30
    window.press("0")
    assert view(window) == pytest.approx(whole)
    for _ in range(40):
        window.press("+")
    assert window.value("document.getElementById('zoom').textContent") == "51200 %"


def test_layers_are_switched_by_boxes_and_keys(window):
    def shown():
        return [name for name in LAYERS if window.value(
            f"document.getElementById('{name}').getBoundingClientRect().width > 0")]

    assert shown() == ["curves"]
    for key, name in enumerate(LAYERS, 1):
        was = shown()
        window.click(f"input[value={name}]")
        assert set(shown()) ^ set(was) == {name}
        window.press(str(key))
        assert shown() == was


def test_page_colour_is_behind_the_picture(window):
    outside = -2, 20
    assert near(seen(window, *outside), (255, 255, 255))
    window.value("(() => { const box = document.getElementById('paper'); box.value = '#f0f';"
                 " box.dispatchEvent(new Event('change')) })()")
    window.settle()
    assert near(seen(window, *outside), (255, 0, 255))


def test_narrow_windows_have_no_sideways_scrolling(window):
    window.call("Emulation.setDeviceMetricsOverride", width=360, height=640, deviceScaleFactor=2, mobile=True)
    try:
        window.settle()
        assert window.value("document.documentElement.scrollWidth") <= 360
        left, _, width, _ = view(window)
        assert left <= 0 and left + width >= 60
    finally:
        window.call("Emulation.clearDeviceMetricsOverride")
        window.settle()


def test_a_hidden_viewer_is_shown_right_later(window):
    before = view(window)
    for display in ("none", "block"):
        window.value(f"document.getElementById('viewer').style.display = '{display}'")
        window.value("document.getElementById('fit').click()")
        window.settle()
    assert view(window) == pytest.approx(before)


def test_all_controls_have_names(window):
    names = window.value(
        "[...document.querySelectorAll('button, select, input, output, [role=slider], [role=group]')]"
        ".map(e => e.getAttribute('aria-label') || e.closest('label')?.textContent || e.textContent)")
    assert len(names) >= 14 and all(name.strip() for name in names)
