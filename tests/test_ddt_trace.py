# SPDX-License-Identifier: GPL-2.0-or-later
"""The extension as Inkscape and its users see it: the dialog, and the direct call."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import fields
from pathlib import Path

import pytest

inkex = pytest.importorskip("inkex")

from inkex import tester
from inkex.tester.inx import InxMixin
from lxml import etree

from ddtcore.inkscape.settings import SOURCE_CHOICES
from ddtcore.options import PRESETS, TraceOptions

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = ROOT / "tests" / "documents"
INX = "{http://www.inkscape.org/namespace/inkscape/extension}"
LARGEST_INT = 2_000_000_000
"""The dialog's whole numbers have 32 bits."""

SCHEMAS = [path for path in (Path(tester.__file__).parent / "inkscape.extension.rng",
                             Path("/usr/share/inkscape/extensions/inkscape.extension.rng")) if path.exists()]


@pytest.fixture(scope="module")
def params():
    """Parameters of the dialog by name."""
    tree = etree.parse(str(ROOT / "ddt_trace.inx"))
    return {param.get("name"): param for param in tree.iter(INX + "param")}


def choices(param):
    return [option.get("value") for option in param.iter(INX + "option")]


def call(*arguments, **environment):
    """Run the extension as a program of its own."""
    return subprocess.run([sys.executable, str(ROOT / "ddt_trace.py"), *map(str, arguments)], timeout=60,
                          capture_output=True, env={**os.environ, **environment})


def document(tmp_path, body, name="in.svg"):
    path = tmp_path / name
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
                    f' width="60" height="44">{body}</svg>', encoding="utf-8")
    return path


PICTURE = f'<image id="a" xlink:href="{DOCUMENTS / "picture.png"}"/>'


class TestDescriptor(InxMixin, tester.TestCase):
    """The check that Inkscape's own extensions have to pass."""

    def test_inx_matches_the_arguments(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(ROOT)
        self.assertInxIsGood("ddt_trace.inx")


@pytest.mark.parametrize("schema", SCHEMAS, ids=str)
def test_descriptor_is_valid(schema):
    grammar = etree.RelaxNG(etree.parse(str(schema)))
    grammar.assertValid(etree.parse(str(ROOT / "ddt_trace.inx")))


def test_dialog_shows_every_setting_and_nothing_else(params):
    assert set(params) == {"tab", "preset", "source", "palette_file",
                           *(setting.name for setting in fields(TraceOptions))}


@pytest.mark.parametrize("setting", fields(TraceOptions), ids=lambda setting: setting.name)
def test_dialog_agrees_with_the_options(params, setting):
    param, meta = params[setting.name], setting.metadata
    assert len(param.get("gui-description")) > 30
    if meta["choices"]:
        assert set(choices(param)) == set(meta["choices"])
        assert choices(param)[0] == setting.default
        return
    kind = type(setting.default)
    if kind is str:
        assert param.get("type") == "string" and (param.text or "") == setting.default
        return
    assert param.get("type") == kind.__name__
    assert kind(param.text) == setting.default
    assert float(param.get("min")) == meta["low"]
    assert float(param.get("max")) == min(meta["high"], LARGEST_INT if kind is int else meta["high"])
    if kind is float:
        digits = 10 ** int(param.get("precision"))
        assert all(value * digits == round(value * digits)
                   for value in (setting.default, meta["low"], meta["high"]))


def test_the_file_of_a_palette_can_be_chosen(params):
    param = params["palette_file"]
    assert (param.get("type"), param.get("mode"), param.get("filetypes")) == ("path", "file", "gpl")
    assert list(params).index("palette_file") == list(params).index("palette") + 1


def test_presets_come_first(params):
    assert next(iter(params)) == "preset"
    assert choices(params["preset"]) == list(PRESETS)
    assert choices(params["source"]) == list(SOURCE_CHOICES)


def test_icon_is_a_drawing():
    assert etree.parse(str(ROOT / "ddt_trace.svg")).getroot().tag == "{http://www.w3.org/2000/svg}svg"


def test_direct_call(tmp_path):
    path = document(tmp_path, PICTURE)
    done = call("--id=a", "--colors=4", path)
    assert (done.returncode, done.stderr) == (0, b"")
    result = etree.fromstring(done.stdout)
    layer = result[-1]
    assert layer.get("{http://www.inkscape.org/namespaces/inkscape}groupmode") == "layer"
    assert result[0].get("id") == "a"
    assert len(list(layer.iter("{*}path"))) >= 3
    by_option = call(f"--output={tmp_path / 'out.svg'}", "--colors=4", path)
    assert (by_option.returncode, by_option.stdout) == (0, b"")
    assert (tmp_path / "out.svg").read_bytes() == done.stdout


@pytest.mark.parametrize("body, arguments, words", [
    ("", [], "shows no picture"),
    ("<rect id='r'/>", ["--id=r"], '"r" is not a picture'),
    (PICTURE, ["--id=b"], 'no object with the id "b"'),
    (PICTURE + PICTURE.replace('"a"', '"b"'), [], "shows 2 pictures"),
    ('<image id="a" xlink:href="gone.png"/>', [], '"a" cannot be traced: it is linked to "gone.png"'),
    ('<image id="a" xlink:href="data:;base64,AAAA"/>', [], '"a" cannot be traced: it is not a picture'),
    (PICTURE.replace("<image", '<image width="0"'), [], "without a width or a height"),
])
def test_what_cannot_be_traced_gives_one_sentence(tmp_path, body, arguments, words):
    done = call(*arguments, document(tmp_path, body))
    message = done.stderr.decode()
    assert (done.returncode, done.stdout) == (251, b"")
    assert words in message
    assert message.count("\n") <= 1 and message.rstrip().endswith(".")


def test_messages_go_to_a_file_in_batch_runs(tmp_path):
    log = tmp_path / "log"
    failed = call(document(tmp_path, ""), DDT_TRACE_LOG=str(log))
    assert (failed.returncode, failed.stdout, failed.stderr) == (251, b"", b"")
    call(document(tmp_path, PICTURE), DDT_TRACE_LOG=str(log))
    lines = log.read_text(encoding="utf-8").splitlines()
    assert lines[0].startswith("The document shows no picture") and lines[1].startswith('"a": ')


@pytest.mark.parametrize("option", ["--colors=x", "--tolerance=-1", "--cost=no", "--nonsense", "--preset=x"])
def test_a_bad_option_is_status_2(tmp_path, option):
    done = call(option, document(tmp_path, PICTURE))
    assert (done.returncode, done.stdout) == (2, b"")
    assert option[2:].partition("=")[0].encode() in done.stderr


def test_what_is_no_document_is_said_plainly(tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("no markup")
    done = call(path)
    assert (done.returncode, done.stdout) == (251, b"")
    # Before that, inkex may say what its parser stumbled over.
    assert done.stderr.decode().endswith("notes.txt is not an SVG document.\n")


def test_a_wrong_colour_is_said_in_one_sentence(tmp_path):
    done = call("--palette=#12", document(tmp_path, PICTURE))
    message = done.stderr.decode()
    assert message.startswith("A setting is wrong: palette ") and message.count("\n") == 1
    done = call("--palette=#12", document(tmp_path, PICTURE), DDT_TRACE_LOG=str(tmp_path / "log"))
    assert (done.returncode, done.stderr) == (2, b"")
    assert "palette" in (tmp_path / "log").read_text(encoding="utf-8")


def test_from_standard_input_to_standard_output(tmp_path):
    path = document(tmp_path, PICTURE)
    done = subprocess.run([sys.executable, str(ROOT / "ddt_trace.py")], input=path.read_bytes(), timeout=60,
                          stdout=subprocess.PIPE, check=True)
    assert done.stdout == call(path).stdout


def test_a_document_is_written_whole_or_not_at_all(tmp_path):
    path = document(tmp_path, PICTURE)
    before = path.read_bytes()
    for target in (tmp_path / "no" / "out.svg", tmp_path):
        done = call(f"--output={target}", path)
        message = done.stderr.decode()
        assert done.returncode == 251 and "cannot be written" in message and message.count("\n") <= 1
    done = call(f"--output={path}", path)
    assert (done.returncode, done.stderr) == (0, b"")
    assert path.read_bytes() != before and [item.name for item in tmp_path.iterdir()] == ["in.svg"]


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="this system has no full device")
def test_a_full_disk_and_a_closed_pipe(tmp_path):
    program = [sys.executable, str(ROOT / "ddt_trace.py"), str(document(tmp_path, PICTURE))]
    with open("/dev/full", "wb") as full:
        done = subprocess.run(program, stdout=full, stderr=subprocess.PIPE, timeout=60)
    assert done.returncode == 251 and done.stderr.count(b"\n") <= 1 and b"No space left" in done.stderr
    reading, writing = os.pipe()
    os.close(reading)
    done = subprocess.run(program, stdout=writing, stderr=subprocess.PIPE, timeout=60)
    os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_missing_library_is_named(tmp_path):
    (tmp_path / "numpy.py").write_text("raise ImportError('broken', name='numpy')")
    done = call(document(tmp_path, PICTURE), PYTHONPATH=str(tmp_path))
    assert (done.returncode, done.stdout) == (1, b"")
    assert "cannot import numpy" in done.stderr.decode() and done.stderr.count(b"\n") == 1
    silent = call(document(tmp_path, PICTURE), PYTHONPATH=str(tmp_path), DDT_TRACE_LOG=str(tmp_path / "log"))
    assert (silent.returncode, silent.stderr) == (1, b"")
    assert "cannot import numpy" in (tmp_path / "log").read_text(encoding="utf-8")
