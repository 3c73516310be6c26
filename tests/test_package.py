# SPDX-License-Identifier: GPL-2.0-or-later
"""The package as pip installs it: what is in the wheel, and that it works outside of the project."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import zipfile
from configparser import ConfigParser
from pathlib import Path

import pytest

import ddtcore

ROOT = Path(__file__).resolve().parent.parent
PICTURE = ROOT / "tests" / "images" / "stegosaurus.png"

pytest.importorskip("setuptools", "70.1")


def run(*arguments, folder, **environment):
    done = subprocess.run([sys.executable, *map(str, arguments)], cwd=folder, capture_output=True, text=True,
                          env={**os.environ, **environment})
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def installed(tmp_path_factory):
    """The wheel, unpacked into a folder."""
    project, target = tmp_path_factory.mktemp("project"), tmp_path_factory.mktemp("installed")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, project)
    shutil.copytree(ROOT / "ddtcore", project / "ddtcore", ignore=shutil.ignore_patterns("__pycache__"))
    run("-c", "import setuptools.build_meta as b; b.build_wheel('.')", folder=project)
    wheel, = project.glob("*.whl")
    assert wheel.name == f"ddt_trace-{ddtcore.__version__}-py3-none-any.whl"
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(target)
    return target


def test_wheel_holds_every_file_of_the_engine_and_nothing_else(installed):
    """But for the texts of the dialog in other languages, which Inkscape alone reads."""
    def files(folder):
        return {path.relative_to(folder).as_posix() for path in folder.rglob("*")
                if path.is_file() and not {"__pycache__", "locale"} & set(path.parts)}

    assert files(installed / "ddtcore") == files(ROOT / "ddtcore")
    assert "py.typed" in files(installed / "ddtcore")
    assert sorted(re.sub(r"-.*", "", path.name) for path in installed.iterdir()) == ["ddt_trace", "ddtcore"]


def test_command_is_declared_and_runs(installed, tmp_path):
    entries = ConfigParser()
    entries.read(next(installed.glob("*.dist-info")) / "entry_points.txt")
    assert dict(entries["console_scripts"]) == {"ddt-trace": "ddtcore.cli:main"}
    (tmp_path / "ddt-trace").write_text(
        f"import sys; sys.path.insert(0, {str(installed)!r})\n"
        "from ddtcore.cli import main; sys.exit(main())")
    for result, command in (("x.svg", []), ("x.html", ["compare"])):
        run("-I", "ddt-trace", *command, PICTURE, "-o", result, folder=tmp_path)
        assert (tmp_path / result).stat().st_size > 2000
    said = run("-I", "ddt-trace", "--help", folder=tmp_path)
    assert said.startswith("usage: ddt-trace [options] PICTURE...")


def test_metadata_ask_for_numpy_and_pillow_only(installed):
    text = (next(installed.glob("*.dist-info")) / "METADATA").read_text(encoding="utf-8")
    needs = [line.split(":")[1].strip() for line in text.splitlines() if line.startswith("Requires-Dist")]
    assert {re.split(r"[<>=~! ]", need)[0] for need in needs if "extra" not in need} == {"numpy", "pillow"}
