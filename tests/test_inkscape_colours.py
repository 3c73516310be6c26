# SPDX-License-Identifier: GPL-2.0-or-later
"""Colour settings and presets in real Inkscape."""

from __future__ import annotations

import pytest
from lxml import etree
from test_inkscape_program import PICTURE, image, write


def fills(root):
    """The colours of all paths, and of the groups that paint them."""
    found = {element.get("fill") or dict(part.split(":") for part in (element.get("style") or "").split(";")
                                         if ":" in part).get("fill") for element in root.iter("{*}g", "{*}path")}
    return {fill for fill in found if fill and fill != "none"}


@pytest.mark.parametrize("by_file", [False, True])
def test_a_palette_that_is_typed_or_chosen_as_a_file(inkscape, tmp_path, by_file):
    file = tmp_path / "my colours.gpl"
    file.write_text("GIMP Palette\n#\n1 2 3 dark\n255 255 255 white\n250 200 10 yellow\n")
    write(tmp_path / "in.svg", image("only", 0, PICTURE))
    inkscape.trace(tmp_path / "in.svg", tmp_path / "out.svg", log=tmp_path / "log",
                   **({"palette_file": str(file)} if by_file else {"palette": "#010203 #fff #fac80a"}))
    root = etree.parse(str(tmp_path / "out.svg")).getroot()
    assert fills(root) <= {"#010203", "#fff", "#ffffff", "#fac80a"} and len(fills(root)) >= 2


def test_the_description_says_what_was_chosen(inkscape, tmp_path):
    write(tmp_path / "in.svg", image("only", 0, PICTURE))
    inkscape.trace(tmp_path / "in.svg", tmp_path / "out.svg", log=tmp_path / "log")
    description = etree.parse(str(tmp_path / "out.svg")).getroot().findtext("{*}g/{*}g/{*}desc")
    assert "preset=automatic; clip-art (" in description
