# SPDX-License-Identifier: GPL-2.0-or-later
"""The catalogues of texts: complete, up to date, and true to what they translate."""

from __future__ import annotations

import gettext
import io
import re
import subprocess
import sys

import pytest

pytest.importorskip("lxml")

import make_catalogues
from make_catalogues import ROOT, TEMPLATE, compiled, compiled_path, languages, quoted, read, texts, written

RENEW = "run make i18n, translate what it lists in ddtcore/locale/*.po, and run it again"
LANGUAGES = languages()


def braces(text):
    return sorted(re.findall(r"\{.*?\}", text))


def test_there_are_catalogues():
    assert {"de", "fr"} <= set(LANGUAGES)


def test_template_is_up_to_date():
    assert TEMPLATE.read_text(encoding="utf-8") == written("", {}), RENEW


@pytest.mark.parametrize("language", LANGUAGES)
def test_catalogue_is_complete_and_up_to_date(language):
    path = TEMPLATE.with_name(f"{language}.po")
    translations = read(path)
    assert set(translations) == set(texts()), RENEW
    assert all(translations.values()), RENEW
    assert path.read_text(encoding="utf-8") == written(language, translations), RENEW
    assert compiled_path(language).read_bytes() == compiled(language, translations), RENEW


@pytest.mark.parametrize("language", LANGUAGES)
def test_translations_keep_what_is_filled_in(language):
    for text, translation in read(TEMPLATE.with_name(f"{language}.po")).items():
        assert braces(translation) == braces(text), text
        if text.endswith((".", ":")):
            assert translation.endswith(text[-1]), text


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_program_speaks_the_language(language):
    code = 'from ddtcore.inkscape.words import _; print(ascii(_("it has no content")))'
    said = subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=True, text=True, stdout=subprocess.PIPE,
                          env={"INKEX_GETTEXT_DIRECTORY": str(make_catalogues.LOCALE), "LANGUAGE": language})
    translation = read(TEMPLATE.with_name(f"{language}.po"))["it has no content"]
    assert said.stdout.strip() == ascii(translation) != ascii("it has no content")


def test_every_text_of_the_dialog_is_found():
    found = dict(make_catalogues.dialog_texts())
    for text in ("DDT Trace", "Images", "Clip art", "Help"):
        assert text in found
    shown = (ROOT / "ddt_trace.inx").read_text(encoding="utf-8")
    assert shown.count("gui-description=") <= len([text for text in found if len(text) > 30])


def test_compiled_catalogues_are_what_gettext_reads():
    translations = {"a": "ä", "b\nc": 'd "e"', "unknown": ""}
    catalogue = gettext.GNUTranslations(io.BytesIO(compiled("xx", translations)))
    assert [catalogue.gettext(text) for text in translations] == ["ä", 'd "e"', "unknown"]
    assert catalogue.info()["content-type"] == "text/plain; charset=UTF-8"


def test_texts_survive_the_file(tmp_path):
    odd = 'a "quoted" back\\slash, two\nlines: ü'
    path = tmp_path / "xx.po"
    path.write_text(f"msgid {quoted(odd)}\nmsgstr {quoted(odd[::-1])}\n", encoding="utf-8")
    assert read(path) == {odd: odd[::-1]}
    path.write_text('msgid ""\n"a "\n"b"\nmsgstr ""\n"c "\n"d"\n', encoding="utf-8")
    assert read(path) == {"a b": "c d"}
