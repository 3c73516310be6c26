# SPDX-License-Identifier: GPL-2.0-or-later
"""Palettes as people write them, and as GIMP does."""

from __future__ import annotations

import pytest

from ddtcore.swatches import MANY, colours_of, palette_text

GIMP = """GIMP Palette
Name: Three colours
Columns: 4
#
  0   0   0\tBlack
255 255 255 White, with a name
 210  34  34

# 1 2 3 in a comment is no colour
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("value", [
    "#000 #fff #d22", "000,FFF,d22", " #000000; #ffffff;\t#DD2222 ", "#000 #fff #000 #d22 #fff",
    ["#000", "fff", (221, 34, 34)], ((0, 0, 0), (255.0, 255, 255), [0xdd, 0x22, 0x22])])
def test_lists_of_colours(value):
    text = palette_text(value)
    assert text == "#000000 #ffffff #dd2222" and palette_text(text) == text
    assert colours_of(text) == [(0, 0, 0), (255, 255, 255), (221, 34, 34)]


@pytest.mark.parametrize("value", ["", "  ", (), []])
def test_no_palette(value):
    assert palette_text(value) == "" and colours_of("") == []


@pytest.mark.parametrize("name", ["three.gpl", "with blanks.GPL"])
@pytest.mark.parametrize("text", [GIMP, "\ufeff" + GIMP, GIMP.replace("\n", "\r\n")])
def test_files_of_gimp(folder, name, text):
    (folder / name).write_bytes(text.encode())
    assert palette_text(name) == palette_text(str(folder / name)) == "#000000 #ffffff #d22222"


@pytest.mark.parametrize("value, said", [
    ("red", "not 'red'"), ("#12", "not '#12'"), ("#00000g", "not '#00000g'"), ("#000 #ffff", "not '#ffff'"),
    ("١٢٣", "not '١٢٣'"), (None, "not None"), (7, "not 7"), ([(1, 2)], "not (1, 2)"),
    ([(0, 0, 256)], "not (0, 0, 256)"), ([(0.5, 0, 0)], "not (0.5, 0, 0)"), ([None], "not [None]"),
    ([("a", "b", "c")], "not [("),
    ("missing.gpl", "not 'missing.gpl': No such file"),
    ("other.gpl", "first line says so, not 'other.gpl'"), ("empty.gpl", "not as in 'empty.gpl'"),
    ("loud.gpl", "not as in 'loud.gpl'"),
    (" ".join(f"#{k:06x}" for k in range(MANY + 1)), f"at most {MANY} colours, not {MANY + 1}"),
])
def test_what_is_no_palette_is_refused_in_a_sentence(folder, value, said):
    (folder / "other.gpl").write_text("Palette of something else\n0 0 0\n")
    (folder / "empty.gpl").write_text("GIMP Palette\n# nothing\n")
    (folder / "loud.gpl").write_text("GIMP Palette\n300 0 0\n")
    with pytest.raises(ValueError, match=r"^palette must ") as caught:
        palette_text(value)
    assert said in str(caught.value) and "\n" not in str(caught.value)
