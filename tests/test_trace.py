# SPDX-License-Identifier: GPL-2.0-or-later
"""The whole pipeline: traced, rendered by resvg and laid over the truth."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest
from alignment import shift
from hypothesis import given, settings
from hypothesis import strategies as st
from meshes import clip_art, grey
from painted import render
from pathparser import parse
from pictures import BLACK, BLUE, RED, WHITE, any_picture, disc, picture, rectangle, star

from ddtcore import TraceOptions, trace
from ddtcore.model import CUBIC, LINE, QUADRATIC
from ddtcore.pipeline import STAGES

YELLOW = (250, 220, 60, 255)
PAPER = TraceOptions.preset("paper")
GOLDEN = Path(__file__).parent / "golden"


def ring(outer, inner):
    """One polygon for what lies between two circles."""
    return np.concatenate([outer, outer[:1], inner[:1], inner[::-1]])


def art(times=1):
    """A cartoon: an outlined face, a star, a block and a thin stroke; 96 x 80, or `times` that."""
    centre = np.array((30.3, 31.2))
    parts = [ring(disc(centre, 22), disc(centre, 19.2)), disc(centre, 19.2), star((69.2, 26.4), 18, 9, 5, 12),
             rectangle((70.4, 61.7), 38, 17, -8), rectangle((28.6, 64.3), 44, 1.4, 7)]
    colours = (WHITE, BLACK, YELLOW, RED, BLUE, BLACK)
    return picture(96 * times, 80 * times, [part * times for part in parts], colours).image


ART, TRUTH = art(), art(4)


def rendered(drawing, zoom):
    """RGB over white, float (h, w, 3)."""
    return render(drawing, zoom, page="white")[..., :3].astype(float)


def over_white(image):
    alpha = image[..., 3:] / 255
    return image[..., :3] * alpha + 255 * (1 - alpha)


def psnr(one, other):
    return 10 * np.log10(255 ** 2 / np.mean((one - other) ** 2))


def segments(drawing):
    return sum(len(loop.degree) for shape in drawing.shapes for loop in shape.loops)


def test_the_trace_lies_on_the_picture():
    drawing = trace(ART)
    for zoom, truth in ((1, ART), (4, TRUTH)):
        offset = shift(over_white(truth), rendered(drawing, zoom)) / zoom
        assert np.abs(offset).max() < 0.02


@pytest.mark.parametrize("options", [TraceOptions(), PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("name", ["stegosaurus", "sunglasses"])
def test_traces_of_clip_art_lie_on_it(name, options):
    image = clip_art(name)
    drawing = trace(image, options)
    back = rendered(drawing, 1)
    assert np.abs(shift(over_white(image), back)).max() < 0.05
    assert psnr(over_white(image), back) > (20 if options is PAPER else 25)


def test_enlarged_it_is_the_drawing_that_the_picture_was_made_from():
    drawing = trace(ART)
    assert psnr(over_white(TRUTH), rendered(drawing, 4)) > 38
    assert {shape.rgb for shape in drawing.shapes} == {c[:3] for c in (WHITE, BLACK, YELLOW, RED, BLUE)}
    assert len(drawing.shapes) == 6
    assert segments(drawing) < 45


TURNS = {
    "turned": np.rot90,
    "upside down": lambda a: np.rot90(a, 2),
    "turned back": lambda a: np.rot90(a, 3),
    "mirrored": lambda a: a[:, ::-1],
    "flipped": lambda a: a[::-1],
    "transposed": lambda a: np.swapaxes(a, 0, 1),
    "inverted": lambda a: np.concatenate([255 - a[..., :3], a[..., 3:]], axis=2),
}


@pytest.fixture(scope="module")
def upright():
    return {options: figures(ART, TRUTH, options) for options in (TraceOptions(), PAPER)}


def figures(image, truth, options):
    drawing = trace(np.ascontiguousarray(image), options)
    return psnr(over_white(truth), rendered(drawing, 4)), segments(drawing)


def levels(likeness):
    """The root mean square error that a PSNR stands for."""
    return 255 * 10 ** (-likeness / 20)


@pytest.mark.parametrize("options", [TraceOptions(), PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("turn", TURNS)
def test_turning_mirroring_or_inverting_the_picture_changes_little(turn, options, upright):
    likeness, count = figures(TURNS[turn](ART), TURNS[turn](TRUTH), options)
    # In decibels a difference of two tiny errors looks large: compare the errors, in levels of 255.
    assert abs(levels(likeness) - levels(upright[options][0])) < 0.5
    assert abs(count - upright[options][1]) <= 0.1 * upright[options][1] + 1


def test_progress_is_told_and_may_end_the_trace():
    told = []
    assert trace(SIGN, progress=lambda *what: told.append(what)).to_svg() == trace(SIGN).to_svg()
    assert dict(told) == STAGES and [share for _, share in told] == sorted(STAGES.values())
    assert told[0][1] == 0 and told[-1][1] < 1

    def stop(stage, share):
        if stage == "curves":
            raise InterruptedError(stage)

    with pytest.raises(InterruptedError, match="curves"):
        trace(SIGN, progress=stop)
    told.clear()
    trace(SIGN, TraceOptions(result="triangles"), lambda *what: told.append(what))
    assert [stage for stage, _ in told] == ["colours", "gradients", "triangles"]


def test_the_same_picture_gives_the_same_drawing():
    first = trace(ART).to_svg()
    assert trace(ART.copy()).to_svg() == first
    assert trace(np.asfortranarray(ART)).to_svg() == first


def test_the_picture_is_left_alone():
    image = ART.copy()
    for options in (TraceOptions(), PAPER, TraceOptions(result="triangles")):
        trace(image, options)
        assert np.array_equal(image, ART)


@pytest.mark.parametrize("changes, kinds", [({}, {LINE, CUBIC}), ({"curves": "quadratic"}, {LINE, QUADRATIC}),
                                            ({"result": "outlines"}, {LINE})])
def test_curves_are_of_the_kind_that_was_asked_for(changes, kinds):
    drawing = trace(ART, TraceOptions(**changes))
    assert {int(d) for shape in drawing.shapes for loop in shape.loops for d in loop.degree} == kinds


@pytest.mark.parametrize("result", ["triangles", "border"])
def test_the_mesh_as_a_result(result):
    drawing = trace(ART, TraceOptions(result=result))
    mesh = drawing.triangles
    assert not drawing.shapes and mesh.filled == (result == "triangles")
    assert 0 < mesh.border.sum() < len(mesh.border)
    if result == "triangles":
        assert psnr(over_white(ART), rendered(drawing, 1)) > 20


@pytest.mark.parametrize("result", ["outlines", "curves"])
def test_outlines_and_curves_as_a_result(result):
    for options in (TraceOptions(result=result), TraceOptions.preset("paper", result=result)):
        drawing = trace(ART, options)
        assert drawing.triangles is None
        areas = [shape.area for shape in drawing.shapes]
        assert areas == sorted(areas, reverse=True)
        assert psnr(over_white(TRUTH), rendered(drawing, 4)) > 20


CHECKERS = grey(np.indices((9, 9)).sum(axis=0) % 2 * 255)
NOISE = np.random.RandomState(0).randint(0, 256, (32, 32, 4)).astype(np.uint8)
ODD = {"1x1": grey([[70]]), "1x7": grey([[0, 0, 255, 255, 0, 0, 90]]), "7x1": grey([[9]] * 4 + [[200]] * 3),
       "2x2": np.array([[RED, BLUE], [BLACK, YELLOW]], np.uint8), "checkers": CHECKERS, "noise": NOISE,
       "clear": np.zeros((4, 5, 4), np.uint8), "one colour": np.tile(np.array(RED, np.uint8), (6, 9, 1))}


@pytest.mark.parametrize("options", [TraceOptions(), PAPER], ids=["default", "paper"])
@pytest.mark.parametrize("result", ["triangles", "border", "outlines", "curves"])
@pytest.mark.parametrize("name", ODD)
def test_odd_pictures_are_traced(name, result, options):
    image = ODD[name]
    drawing = trace(image, TraceOptions(**{**vars(options), "result": result}))
    assert (drawing.width, drawing.height) == (image.shape[1], image.shape[0])
    root = ElementTree.fromstring(drawing.to_svg())
    assert (float(root.get("width")), float(root.get("height"))) == (drawing.width, drawing.height)
    assert "nan" not in drawing.to_svg() and "inf" not in drawing.to_svg()


@pytest.mark.parametrize("name", ["1x1", "one colour"])
def test_one_colour_fills_the_picture(name):
    image = ODD[name]
    back = render(trace(image), 3)
    assert back.shape[:2] == (3 * image.shape[0], 3 * image.shape[1])
    assert (back == image[0, 0]).all()


def test_nothing_gives_nothing():
    assert not trace(ODD["clear"]).shapes


def test_four_pixels_are_four_quarters():
    back = render(trace(ODD["2x2"]), 16)
    assert np.array_equal(back[4::24, 4::24][:2, :2], ODD["2x2"])


def test_checkers_stay_half_black():
    assert rendered(trace(CHECKERS), 8).mean() / 255 == pytest.approx(CHECKERS[..., 0].mean() / 255, abs=0.1)


CHOICES = {name: st.sampled_from(TraceOptions.__dataclass_fields__[name].metadata["choices"])
           for name in ("result", "regions", "cost", "flips", "positions", "curves", "stacking")}


@given(any_picture(), st.fixed_dictionaries({
    **CHOICES, "speckle": st.sampled_from([0.0, 1.5, 50.0]), "colors": st.integers(0, 3),
    "suppression": st.integers(0, 3), "tolerance": st.sampled_from([0.02, 0.2, 3.0])}))
@settings(max_examples=80)
def test_any_picture_under_any_settings_gives_closed_loops(image, changes):
    drawing = trace(image, TraceOptions(**changes))
    for shape in drawing.shapes:
        for loop in shape.loops:
            assert len(loop.control) == len(loop.degree) > 0 and np.isfinite(loop.control).all()
            assert np.array_equal(loop.control[:, 3], np.roll(loop.control[:, 0], -1, axis=0))
    assert ElementTree.fromstring(drawing.to_svg()) is not None


def readable(svg: str) -> str:
    """One element per line."""
    return re.sub(r"(?<=>)(?=<)", "\n", svg) + "\n"


def paths_of(svg: str):
    """Fill and loops of every path, coordinates in px of the picture."""
    root = ElementTree.fromstring(svg)
    scale = float(root.get("width")) / float(root.get("viewBox").split()[2])

    def walk(element, fill):
        fill = element.get("fill", fill)
        if element.tag.endswith("path"):
            loops = parse(element.get("d"))
            yield fill, [[np.array(piece, float) * scale for piece in loop] for loop in loops]
        for child in element:
            yield from walk(child, fill)

    return list(walk(root, None))


def assert_same_paths(svg: str, expected: str, within: float) -> None:
    """Equal but for last digits, which may depend on the machine."""
    one, other = paths_of(svg), paths_of(expected)
    assert [fill for fill, _ in one] == [fill for fill, _ in other]
    for (_, loops), (_, expected_loops) in zip(one, other):
        assert [[len(piece) for piece in loop] for loop in loops] \
            == [[len(piece) for piece in loop] for loop in expected_loops]
        for loop, expected_loop in zip(loops, expected_loops):
            assert np.abs(np.concatenate(loop) - np.concatenate(expected_loop)).max() < within


SIGN = picture(32, 20, [ring(disc((9.3, 10.2), 8), disc((9.3, 10.2), 5.5)), disc((9.3, 10.2), 5.5),
                        rectangle((24.7, 9.8), 9, 7, 10)], (WHITE, BLACK, RED, BLUE)).image


@pytest.mark.parametrize("name, options, within", [("default", TraceOptions(), 0.05), ("paper", PAPER, 0.02)])
def test_golden_drawings(name, options, within, request):
    """Renew with --update-golden, and look at what has changed."""
    file, svg = GOLDEN / f"{name}.svg", trace(SIGN, options).to_svg()
    if request.config.getoption("--update-golden"):
        file.parent.mkdir(exist_ok=True)
        file.write_text(readable(svg), encoding="utf-8")
    assert_same_paths(svg, file.read_text(encoding="utf-8"), within)


def test_the_golden_check_can_fail():
    svg = trace(SIGN).to_svg()
    assert_same_paths(svg, svg, 1e-9)
    moved = np.roll(SIGN, 1, axis=1)
    for other in (trace(moved).to_svg(), trace(SIGN, PAPER).to_svg(), svg.replace("#fff", "#eee")):
        with pytest.raises(AssertionError):
            assert_same_paths(svg, other, 0.05)
