# SPDX-License-Identifier: GPL-2.0-or-later
"""Bring the catalogues of texts up to date: ``make i18n``.

Texts come from the dialog, ``ddt_trace.inx``, and from what is written as ``_("...")`` in
``ddt_trace.py`` and ``ddtcore/inkscape``.  They go to the template ``ddtcore/locale/ddt_trace.pot``.  Each
catalogue beside it, ``LANGUAGE.po``, gets the new texts without a translation, loses
those that are gone, and is compiled to where gettext looks for it.

To add a language, copy the template to ``LANGUAGE.po`` and translate it.  File formats:
GNU gettext manual, "The Format of PO Files" and "The Format of GNU MO Files".
"""

from __future__ import annotations

import ast
import re
import struct
from pathlib import Path

from lxml import etree

ROOT = Path(__file__).resolve().parent.parent
INX = ROOT / "ddt_trace.inx"
MODULES = [ROOT / "ddt_trace.py", *sorted((ROOT / "ddtcore" / "inkscape").glob("*.py"))]
LOCALE = ROOT / "ddtcore" / "locale"
DOMAIN = "ddt_trace"
TEMPLATE = LOCALE / f"{DOMAIN}.pot"
NAMESPACE = "{http://www.inkscape.org/namespace/inkscape/extension}"
SHOWN = ("name", "label", "option", "menu-tip")
"""Elements whose text the dialog shows."""

ENGINE = ("is not a picture of a kind that can be read", "can't be read, it may be damaged",
          "needs more memory than there is", "has no pixels", "is empty", "has more than 200 million pixels, the limit",
          "has more than 2.1 GB, the limit", "is a vector drawing, not a bitmap")
"""What the engine says of a picture that it cannot read."""

NOTICE = "# SPDX-License-Identifier: GPL-2.0-or-later\n"
HEADER = ("Project-Id-Version: DDT Trace\nLanguage: {language}\nMIME-Version: 1.0\n"
          "Content-Type: text/plain; charset=UTF-8\nContent-Transfer-Encoding: 8bit\n")
ENTRY = re.compile(r'^msgid ((?:".*"\s*)+)^msgstr ((?:".*"\s*)+)', re.MULTILINE)


def dialog_texts():
    """The texts of the dialog, each with the place where it is shown."""
    for element in etree.parse(str(INX)).iter(NAMESPACE + "*"):
        place = f"{INX.name}: {element.get('name') or element.tag[len(NAMESPACE):]}"
        texts = [element.get("gui-text"), element.get("gui-description")]
        if element.tag[len(NAMESPACE):] in SHOWN:
            texts.append(element.text)
        elif element.tag == NAMESPACE + "submenu":
            texts.append(element.get("name"))
        yield from ((text, place) for text in texts if text)


def inkscape_texts():
    """What Inkscape adds to a dialog with a preview, but looks up in the catalogue of the extension."""
    for text in ("Live preview", "Is the effect previewed live on canvas?"):
        yield text, "Inkscape, below the dialog"


def message_texts():
    """The texts in the program, each with its file."""
    for path in MODULES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            is_text = isinstance(node, ast.Call) and getattr(node.func, "id", "") == "_"
            if is_text and isinstance(node.args[0], ast.Constant):
                yield node.args[0].value, path.relative_to(ROOT).as_posix()


def engine_texts():
    """What the engine says, as the extension puts it."""
    for text in ENGINE:
        yield f"it {text}", "ddtcore/raster.py"


def texts():
    """All texts and, for each, where it is from."""
    found = {}
    for text, place in (*dialog_texts(), *inkscape_texts(), *message_texts(), *engine_texts()):
        found.setdefault(text, []).append(place)
    return found


def read(path):
    """Translations by text; untranslated ones are empty."""
    entries = ENTRY.findall(path.read_text(encoding="utf-8"))
    return {ast.literal_eval(f"({text})"): ast.literal_eval(f"({translation})")
            for text, translation in entries if ast.literal_eval(f"({text})")}


def written(language, translations):
    """A catalogue as a PO file."""
    parts = [NOTICE + 'msgid ""\nmsgstr ""\n' + "".join(
        f"{quoted(line)}\n" for line in HEADER.format(language=language).splitlines(keepends=True))]
    for text, places in texts().items():
        note = "".join(f"#: {place}\n" for place in dict.fromkeys(places))
        parts.append(f"{note}msgid {quoted(text)}\nmsgstr {quoted(translations.get(text, ''))}\n")
    return "\n".join(parts)


def quoted(text):
    """A text as PO files have it, on one line."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'


def compiled(language, translations):
    """A catalogue as an MO file."""
    pairs = {"": HEADER.format(language=language), **translations}
    ordered = sorted((text.encode(), pairs[text].encode()) for text in pairs if pairs[text])
    count = len(ordered)
    tables, strings = b"", b""
    for column in zip(*ordered):
        for text in column:
            tables += struct.pack("<II", len(text), 28 + 16 * count + len(strings))
            strings += text + b"\0"
    return struct.pack("<7I", 0x950412DE, 0, count, 28, 28 + 8 * count, 0, 0) + tables + strings


def compiled_path(language):
    """Where gettext, and Inkscape, look for the catalogue of a language."""
    return LOCALE / language / "LC_MESSAGES" / f"{DOMAIN}.mo"


def languages():
    """The languages there are catalogues for."""
    return sorted(path.stem for path in LOCALE.glob("*.po"))


def main():
    """Write the template, and all catalogues anew."""
    TEMPLATE.write_text(written("", {}), encoding="utf-8")
    present = texts()
    for language in languages():
        path = LOCALE / f"{language}.po"
        translations = {text: translation for text, translation in read(path).items() if text in present}
        path.write_text(written(language, translations), encoding="utf-8")
        target = compiled_path(language)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(compiled(language, translations))
        missing = [text for text in present if not translations.get(text)]
        print(f"{path.name}: {len(missing)} of {len(present)} texts are not translated")
        print("".join(f"  {text}\n" for text in missing), end="")


if __name__ == "__main__":
    main()
