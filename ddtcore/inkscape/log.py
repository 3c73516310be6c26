# SPDX-License-Identifier: GPL-2.0-or-later
"""Messages for batch runs: into a file instead of a box that nobody can close.

Inkscape shows whatever an extension writes to stderr in a modal box, even without a
window.  If the environment variable ``DDT_TRACE_LOG`` names a file (by an absolute path,
for Inkscape runs extensions in their own folder), all messages, and the notes of
successful traces, go there instead.
"""

from __future__ import annotations

import os

VARIABLE = "DDT_TRACE_LOG"


def note(text: str) -> bool:
    """Append a line to the file that ``DDT_TRACE_LOG`` names.

    Parameters
    ----------
    text : str

    Returns
    -------
    bool
        False if there is no such file, or it cannot be written.
    """
    path = os.environ.get(VARIABLE)
    if not path:
        return False
    try:
        with open(path, "a", encoding="utf-8", errors="replace") as file:
            file.write(text.rstrip() + "\n")
    except OSError:
        return False
    return True
