# SPDX-License-Identifier: GPL-2.0-or-later
"""README.md: its commands run, its tables are up to date, and what it points to is there."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import make_readme
import pytest
import readme_paint
from PIL import Image

import ddtcore

ROOT = Path(__file__).resolve().parent.parent
TEXT = (ROOT / "README.md").read_text(encoding="utf-8")

NOT_RUN = {
    "make demo": "sets up a machine; test_demo runs what it does then",
    "make test": "is what runs this",
    "make bench": "takes minutes; test_speed tests it",
    "sudo apt-get": "needs the network",
    "xvfb-run": "needs Inkscape: test_inkscape_runs_without_hands",
    "python3 -m ddtcore --preset paper --report --out-dir": "takes half a minute; one row is measured below",
    ".venv/bin/pip": "needs the network",
    ".venv/bin/python": "writes into the project; test_compare_tracers and this file test what",
}
"""Beginnings of commands that are shown only, and why."""

RENEW = "run .venv/bin/python tests/make_readme.py"


def blocks(language):
    """The fenced blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", TEXT, flags=re.MULTILINE | re.DOTALL)


def section(name):
    """What stands between the marks of a table."""
    return re.search(f"<!-- {name}: .*?<!-- end -->", TEXT, flags=re.DOTALL)[0]


def commands():
    """The shell commands that can be run here."""
    lines = [line.split("  #")[0].strip() for block in blocks("sh") for line in block.splitlines()]
    return [line for line in lines if not line.startswith(tuple(NOT_RUN))]


@pytest.fixture
def copy(tmp_path):
    """A folder that looks like the project, where commands may write."""
    shutil.copytree(ROOT / "tests" / "images", tmp_path / "tests" / "images")
    shutil.copytree(ROOT / "tests" / "documents", tmp_path / "tests" / "documents")
    for name in ("ddtcore", "ddt_trace.py", "ddt_trace.inx", "ddt_trace.svg", "LICENSE", "README.md", ".ci"):
        (tmp_path / name).symlink_to(ROOT / name)
    python = tmp_path / "bin" / "python3"
    python.parent.mkdir()
    python.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    python.chmod(0o755)
    return tmp_path


def run(arguments, folder, **environment):
    """Run a command as a person would, and return what it printed."""
    path = os.pathsep.join([str(folder / "bin"), os.environ["PATH"]])
    done = subprocess.run(arguments, cwd=folder, env={**os.environ, "PATH": path, **environment}, text=True,
                          capture_output=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def files(folder):
    return {path for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("command", commands())
def test_commands_do_something(copy, command):
    before = files(copy)
    printed = run(["bash", "-c", command], copy)
    new = files(copy) - before
    assert new or printed
    for path in new:
        assert path.suffix in (".svg", ".svgz", ".html") and path.stat().st_size > 500


def test_inkscape_runs_without_hands(copy, inkscape):
    command, = (line for block in blocks("sh") for line in block.splitlines() if line.startswith("xvfb-run"))
    run(["bash", "-c", command.replace("inkscape ", shlex.join(inkscape.command) + " ", 1)], copy,
        INKSCAPE_PROFILE_DIR=str(inkscape.profile), PATH=f"/usr/bin:{os.environ['PATH']}")
    traced = (copy / "traced.svg").read_text(encoding="utf-8")
    assert "DDT Trace" in traced and traced.count("<path") > 2


def test_extension_is_installed_as_the_table_says(copy):
    """The commands for Unix, with an Inkscape that only says where its folder is."""
    rows = re.findall(r"^\| (?:Linux|macOS)[^|]*\| `([^`]+)` \|$", TEXT, flags=re.MULTILINE)
    assert len(rows) == 4 and sum(row.startswith("make install") for row in rows) == 3
    (copy / "bin" / "inkscape").write_text(f"#!/bin/sh\necho {copy}/profile\n")
    for name in ("flatpak", "mac"):
        shutil.copy(copy / "bin" / "inkscape", copy / "bin" / name)
    for path in (copy / "bin").iterdir():
        path.chmod(0o755)
    shutil.copy(ROOT / "Makefile", copy)
    for row in rows:
        here = row.replace("/Applications/Inkscape.app/Contents/MacOS/inkscape", str(copy / "bin" / "mac"))
        run(["bash", "-c", here], copy, HOME=str(copy / "home"))
        folder = copy / ("home/snap/inkscape/current/.config/inkscape" if "snap" in row else "profile")
        installed = folder / "extensions" / "ddt_trace"
        assert {"ddt_trace.inx", "ddt_trace.py", "ddtcore"} <= {path.name for path in installed.iterdir()}
        shutil.rmtree(installed)


def test_demo(copy, virtual_screen):
    (copy / ".venv" / "bin").mkdir(parents=True)
    shutil.copy(copy / "bin" / "python3", copy / ".venv" / "bin" / "python")
    said = run([".ci/demo", "tests/images/doctor.png"], copy)
    with Image.open(copy / "demo" / "doctor.png") as picture:
        assert picture.size == (88, 256) and "demo/doctor.svg" in said


def test_changelog_names_this_version():
    changes = TEXT[TEXT.index("## Changelog"):]
    assert changes.index(f"- **{ddtcore.__version__}** ") < 20


@pytest.mark.parametrize("code", blocks("python"))
def test_python_examples_run(copy, code):
    before = files(copy)
    run(["python3", "-c", code], copy)
    assert {path.name for path in files(copy) - before} == set(re.findall(r'[("]([\w]+\.svgz?)"', code))


def test_commands_are_found_at_all():
    assert len(commands()) >= 12 and len(blocks("python")) == 1


def test_exceptions_are_still_in_the_text():
    lines = [line for block in blocks("sh") for line in block.splitlines()]
    assert [start for start in NOT_RUN if not any(line.startswith(start) for line in lines)] == []


@pytest.mark.parametrize("name", ["settings", "presets", "speed"])
def test_tables_are_up_to_date(name):
    assert make_readme.with_tables(TEXT, [name]) == TEXT, RENEW


def test_all_rooms_are_named():
    listed, present = (set(re.findall(r"^  (\w+(?:\.py|/)) +[^ ]", text, flags=re.MULTILINE))
                       for text in (section("rooms"), make_readme.rooms_table()))
    assert listed == present, RENEW


def test_table_of_the_paper_is_as_measured():
    """One row of it, and not to the last byte: small changes of the curves need no new table."""
    names = re.findall(r"^\| (\w+) \|", section("ratios"), flags=re.MULTILINE)
    assert names == ["picture", *(path.stem for path in make_readme.CRISP)], RENEW
    picture, = (path for path in make_readme.CRISP if path.stem == "stegosaurus")
    row, = re.findall(r"^\| stegosaurus \|(.*)\|$", TEXT, flags=re.MULTILINE)
    shown = [float(cell.replace(",", "")) for cell in row.split("|")]
    assert shown == pytest.approx(make_readme.figures_of(picture), rel=0.1), RENEW


def test_claim_of_the_paper_holds():
    row, = re.findall(r"^\| \*median\* \|(.*)\|$", TEXT, flags=re.MULTILINE)
    bmp_svg, ddt_svgz = [float(cell.replace(",", "")) for cell in row.split("|") if cell.strip()]
    assert bmp_svg >= 20 and ddt_svgz >= 900


def test_links_lead_somewhere():
    targets = re.findall(r"\]\(([^)]+)\)", TEXT)
    headings = {re.sub(r"[^\w\- ]", "", line.lstrip("# ")).lower().replace(" ", "-")
                for line in TEXT.splitlines() if line.startswith("#")}
    local = [target for target in targets if not target.startswith("http")]
    assert local
    for target in local:
        assert target[1:] in headings if target.startswith("#") else (ROOT / target).exists(), target


def test_pictures_are_shown_and_small():
    shown = set(re.findall(r"tests/images/readme/([\w-]+\.png)", TEXT))
    present = {path.name: path for path in readme_paint.PICTURES.iterdir()}
    assert shown == set(present)
    for path in present.values():
        with Image.open(path) as picture:
            picture.load()
            assert picture.width <= 1100 and path.stat().st_size < 60_000
