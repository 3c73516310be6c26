# SPDX-License-Identifier: GPL-2.0-or-later
"""A palette that a person gives: a list of colours, or a file of them.

Files are palettes of GIMP (``.gpl``), which Inkscape keeps its own in too: a line
``GIMP Palette``, lines with a name and a number of columns, comments with ``#``, and
one colour a line, three numbers from 0 to 255 and a name.
"""

from __future__ import annotations

import os
import stat
from typing import Any, List, Sequence, Tuple, Union

MANY = 256
"""Most colours of a palette."""

_DIGITS = set("0123456789abcdefABCDEF")

RGB = Tuple[int, int, int]

_WANTED = "palette must be colours such as '#000 #fff #d22', or a GIMP palette (.gpl)"


def palette_text(value: Union[str, Sequence[Any]]) -> str:
    """A palette as a list of different colours.

    Parameters
    ----------
    value : str or sequence
        Colours of three or six hexadecimal digits with blanks or commas between; the path of
        a file that ends in ``.gpl``; or a sequence of colours, as such text or as (r, g, b).

    Returns
    -------
    str
        ``"#rrggbb #rrggbb"``; "" for none.

    Raises
    ------
    ValueError
        That is no palette; the message says why.

    Examples
    --------
    >>> palette_text("#000, #FFF d22")
    '#000000 #ffffff #dd2222'
    >>> palette_text([(0, 0, 0), "#fff"])
    '#000000 #ffffff'
    """
    if isinstance(value, str):
        text = value.strip()
        colours = _read(text) if text.lower().endswith(".gpl") else [
            _colour(word) for word in text.replace(",", " ").replace(";", " ").split()]
    else:
        try:
            colours = [_colour(item) for item in value]
        except TypeError:
            raise ValueError(f"{_WANTED}, not {value!r}") from None
    colours = list(dict.fromkeys(colours))
    if len(colours) > MANY:
        raise ValueError(f"palette must have at most {MANY} colours, not {len(colours)}")
    return " ".join("#{:02x}{:02x}{:02x}".format(*colour) for colour in colours)


def colours_of(text: str) -> List[RGB]:
    """The colours of what `palette_text` returns."""
    return [_colour(word) for word in text.split()]


def _colour(item: Any) -> RGB:
    if isinstance(item, str):
        digits = item[1:] if item.startswith("#") else item
        if len(digits) not in (3, 6) or not set(digits) <= _DIGITS:
            raise ValueError(f"{_WANTED}, not {item!r}")
        digits = digits if len(digits) == 6 else "".join(2 * digit for digit in digits)
        return int(digits[:2], 16), int(digits[2:4], 16), int(digits[4:], 16)
    r, g, b = item if len(item) == 3 else (-1, -1, -1)
    if not all(0 <= level <= 255 and level == int(level) for level in (r, g, b)):
        raise ValueError(f"{_WANTED}, not {item!r}")
    return int(r), int(g), int(b)


def _read(path: str) -> List[RGB]:
    try:
        if not stat.S_ISREG(os.stat(path).st_mode):
            raise ValueError(f"palette must be a regular file, not {path!r}")
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = file.read(1 << 20).splitlines()
    except OSError as error:
        reason = error.strerror or str(error)
        raise ValueError(f"palette must be a file that can be read, not {path!r}: {reason}") from None
    if not lines or not lines[0].lstrip("\ufeff").startswith("GIMP Palette"):
        raise ValueError(f"palette must be a GIMP palette, whose first line says so, not {path!r}")
    entries = [line.split()[:3] for line in lines[1:]]
    found = [tuple(map(int, entry)) for entry in entries if len(entry) == 3 and "".join(entry).isdecimal()]
    if not found or max(map(max, found)) > 255:
        raise ValueError(f"palette must hold colours of 0 to 255, not as in {path!r}")
    return [(r, g, b) for r, g, b in found]
