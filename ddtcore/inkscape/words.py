# SPDX-License-Identifier: GPL-2.0-or-later
"""The language of the user, for the messages that the extension writes.

Inkscape finds the catalogue of the dialog's texts (``locale`` beside the ``.inx``) and
names it to the programs it starts; the messages are in the same one.  Without Inkscape,
or without a catalogue for its language, they are English.
"""

from __future__ import annotations

import gettext
import os

DOMAIN = "ddt_trace"

_CATALOGUE = gettext.translation(DOMAIN, os.environ.get("INKEX_GETTEXT_DIRECTORY"), fallback=True)


def _(text: str) -> str:
    """A text in the language of the user; what stands in braces is filled in afterwards.

    Parameters
    ----------
    text : str
        Written out where it is called, for the template of the catalogues to find it.
    """
    return _CATALOGUE.gettext(text)


def brief(text: str, most: int = 200) -> str:
    """A name or a link of the document as part of a sentence: in one line, and not too long.

    Parameters
    ----------
    text : str
    most : int
        Letters to keep.
    """
    text = " ".join(text.split())
    return text if len(text) <= most else text[:most] + "…"
