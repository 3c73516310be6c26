# SPDX-License-Identifier: GPL-2.0-or-later
"""Read the document, which may be from a stranger.

Nothing outside it is read, entities stay what they are, and what they would grow to is
limited.  What inkex would repair, by leaving out all that follows a mistake, is turned
down: the result must hold the whole document.
"""

from __future__ import annotations

import io
from typing import IO, Any

import inkex
from inkex.elements._parser import NodeBasedLookup
from lxml import etree

from .words import _


class _Lookup(NodeBasedLookup):  # type: ignore[misc]
    """The classes of inkex, which knows no elements of strangers without a namespace."""

    def lookup(self, doc: Any, element: Any) -> Any:
        try:
            return super().lookup(doc, element)
        except KeyError:
            return self.default


def load_document(stream: IO[bytes], name: str) -> etree._ElementTree:
    """Parse an SVG document.

    Parameters
    ----------
    stream : binary file
    name : str
        What messages call it.

    Returns
    -------
    ElementTree
        With the element classes of inkex.

    Raises
    ------
    AbortExtension
        It is no SVG document, or a damaged one.
    """
    data = stream.read()
    # Undeclared prefixes of attributes are common, and recovered from without a loss.
    parser = etree.XMLParser(recover=True, strip_cdata=False, resolve_entities=False, no_network=True,
                             huge_tree=not _has_entities(data))
    parser.set_element_class_lookup(_Lookup())
    try:
        tree = etree.parse(io.BytesIO(data), parser)
    except etree.XMLSyntaxError:
        tree = None
    if tree is None or not isinstance(tree.getroot(), inkex.SvgDocumentElement):
        raise inkex.AbortExtension(_("{path} is not an SVG document.").format(path=name))
    for entry in parser.error_log:
        if entry.level == etree.ErrorLevels.FATAL:
            text = _("{path} is a damaged document: there is a mistake in line {line}.")
            raise inkex.AbortExtension(text.format(path=name, line=entry.line))
    return tree


def _has_entities(data: bytes) -> bool:
    # In any encoding: UTF-16 has zeros between the letters.  Where huge trees are allowed,
    # there is no limit to what entities of entities grow to.
    return b"<!ENTITY" in data.replace(b"\0", b"")
