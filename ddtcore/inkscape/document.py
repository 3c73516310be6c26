# SPDX-License-Identifier: GPL-2.0-or-later
"""Read the document, which may be from a stranger, and write it whole or not at all.

Nothing outside it is read, entities stay what they are, and what they would grow to is
limited.  What inkex would repair, by leaving out all that follows a mistake, is turned
down: the result must hold the whole document.
"""

from __future__ import annotations

import io
import os
import sys
from typing import IO, Any, Union

import inkex
from inkex.elements._parser import NodeBasedLookup
from lxml import etree

from ..svg import write
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
    data = getattr(stream, "buffer", stream).read()
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


def save_document(tree: etree._ElementTree, target: Union[str, IO[bytes]]) -> None:
    """Write an SVG document.

    Parameters
    ----------
    tree : ElementTree
    target : str or binary file
        A file with a path appears complete or not at all.

    Raises
    ------
    AbortExtension
        It cannot be written.
    """
    data = etree.tostring(tree)
    try:
        if isinstance(target, str):
            write(target, [data])
        else:
            target.write(data)
            target.flush()
    except OSError as error:
        path = target if isinstance(target, str) else _drop(target)
        if not isinstance(error, BrokenPipeError):  # then the reader has what it wanted
            text = _("{path} cannot be written ({reason}).")
            raise inkex.AbortExtension(text.format(path=path, reason=error.strerror)) from error


def _drop(stream: IO[bytes]) -> str:
    """Drop what a stream still holds, for Python would complain of it in the end."""
    if stream.fileno() == sys.stdout.fileno():
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    return str(stream.name)


def _has_entities(data: bytes) -> bool:
    # In any encoding: UTF-16 has zeros between the letters.  Where huge trees are allowed,
    # there is no limit to what entities of entities grow to.
    return b"<!ENTITY" in data.replace(b"\0", b"")
