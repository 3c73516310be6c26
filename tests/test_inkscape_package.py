# SPDX-License-Identifier: GPL-2.0-or-later
"""What is installed and published: the package, alone in a fresh profile of real Inkscape."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import make_catalogues
import pytest

pytest.importorskip("inkex")

from inkex import tester
from inkscape_host import EXTENSION_ID, ROOT, Inkscape
from lxml import etree

PICTURE = Path(__file__).parent / "documents" / "picture.png"
LABEL = "{http://www.inkscape.org/namespaces/inkscape}label"

pytestmark = pytest.mark.skipif(not shutil.which("bash"), reason="packages are made by a shell script")


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dist")
    done = subprocess.run([ROOT / ".ci" / "zip", folder], check=True, text=True, stdout=subprocess.PIPE)
    return Path(done.stdout.strip())


@pytest.fixture(scope="module")
def packaged(inkscape, package, tmp_path_factory):
    """Inkscape with nothing but what the package holds."""
    return Inkscape(inkscape.command, tmp_path_factory.mktemp("fresh"), package)


def document(folder, body):
    path = folder / "in.svg"
    path.write_text('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
                    f' width="60" height="44">{body}</svg>', encoding="utf-8")
    return path


def test_package_holds_what_the_gallery_asks_for_and_nothing_else(package):
    with zipfile.ZipFile(package) as archive:
        names = archive.namelist()
        assert archive.read("icon.svg") == (ROOT / "ddt_trace.svg").read_bytes()
        descriptor = etree.fromstring(archive.read("ddt_trace.inx"))
    top = {name.partition("/")[0] for name in names}
    assert top == {"ddt_trace.inx", "ddt_trace.py", "ddt_trace.svg", "icon.svg", "ddtcore", "locale",
                   "LICENSE", "README.md"}
    # Other names mean something else to the Extension Manager, or are no use to anybody.
    assert not [name for name in names if name.endswith(("setup.py", ".json", ".pyc", ".po", ".pot"))]
    assert [name for name in names if name.endswith(".inx")] == ["ddt_trace.inx"]
    assert descriptor.findtext("{*}id") == EXTENSION_ID
    assert descriptor.get("translationdomain") == make_catalogues.DOMAIN
    schema = Path(tester.__file__).parent / "inkscape.extension.rng"
    if schema.exists():  # that of Inkscape 1.4, which knows this attribute
        etree.RelaxNG(etree.parse(str(schema))).assertValid(descriptor)
    for language in make_catalogues.languages():
        path = make_catalogues.compiled_path(language)
        assert path.relative_to(make_catalogues.LOCALE.parent).as_posix() in names


def test_install_puts_the_same_files_there(package, tmp_path):
    subprocess.run([ROOT / ".ci" / "install", tmp_path], check=True, stdout=subprocess.DEVNULL)
    folder = tmp_path / "ddt_trace"
    installed = {path.relative_to(folder).as_posix(): path.read_bytes()
                 for path in folder.rglob("*") if path.is_file()}
    with zipfile.ZipFile(package) as archive:
        packed = {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}
    packed.pop("icon.svg")
    assert installed == packed


def test_package_traces(packaged, tmp_path):
    path = document(tmp_path, f'<image id="a" xlink:href="{PICTURE}"/>')
    packaged.trace(path, tmp_path / "out.svg", ["a"], log=tmp_path / "log")
    root = etree.parse(str(tmp_path / "out.svg")).getroot()
    layer, = (element for element in root if element.get(LABEL) == "DDT Trace")
    assert len(list(layer.iter("{*}path"))) >= 3
    assert "Settings: preset=" in layer.findtext("{*}g/{*}desc")


@pytest.mark.parametrize("language", ["de", "fr"])
def test_inkscape_finds_the_catalogues(packaged, tmp_path, language):
    text = "The document shows no picture that could be traced."
    translation = make_catalogues.read(make_catalogues.LOCALE / f"{language}.po")[text]
    packaged.trace(document(tmp_path, "<rect/>"), tmp_path / "out.svg", log=tmp_path / "log",
                   language=language)
    assert (tmp_path / "log").read_text(encoding="utf-8").strip() == translation != text
