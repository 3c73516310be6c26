# SPDX-License-Identifier: GPL-2.0-or-later
"""Keep the links of a document to its pictures alive through an effect.

Inkscape writes links relative to the temporary copy that it hands to an extension.
Inkscape 1.4 does not turn them back in what the extension returns, so that every
relatively linked picture of the document is lost.  Absolute ``file:`` URIs survive,
and all versions save them as links relative to the document again.
"""

from __future__ import annotations

from pathlib import Path

import inkex

from .source import HREF, Folders, find_file, is_relative


def make_links_absolute(svg: inkex.SvgDocumentElement, folders: Folders) -> None:
    """Make every relative link to an existing picture an absolute one.

    Parameters
    ----------
    svg : SvgDocumentElement
    folders : tuple of str
        See `source.link_folders`.
    """
    for image in svg.iter():
        if not isinstance(image, inkex.Image):
            continue
        for name in HREF:
            reference = image.get(name)
            path = find_file(reference, folders) if reference and is_relative(reference) else None
            if path:
                image.set(name, Path(path).as_uri())
