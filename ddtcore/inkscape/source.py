# SPDX-License-Identifier: GPL-2.0-or-later
"""Where the bytes of a picture come from: the document itself, or a file it links to.

Inkscape hands an extension a temporary copy of the document and rewrites relative
links relative to that copy, so links are looked up beside the copy, beside the
document, and last by the absolute path that Inkscape notes in ``sodipodi:absref``.
Nothing is ever fetched from a network.
"""

from __future__ import annotations

import base64
import binascii
import os
import re
from typing import Iterator, Optional, Tuple
from urllib.parse import unquote_to_bytes

import inkex

from ..raster import MAX_BYTES
from .words import _, brief

HREF = ("href", "xlink:href")
"""Attributes that say where a picture is, the stronger one (by SVG 2, and in Inkscape 1.4) first."""

ABSREF = "sodipodi:absref"

Folders = Tuple[str, ...]
"""Folders in which relative links are looked up, first match wins."""


class PictureError(ValueError):
    """A picture has no readable bytes; the message completes the sentence "cannot be traced: …"."""


def link_folders(document: Optional[str], copy: Optional[str]) -> Folders:
    """The folders in which relative links are looked up.

    Parameters
    ----------
    document : str, optional
        Path of the document as Inkscape knows it (or, from a pipe, a folder); empty
        if it was never saved.
    copy : str, optional
        Path of the file that the extension reads.

    Returns
    -------
    tuple of str
    """
    paths = [os.path.abspath(path) for path in (copy, document) if path]
    return tuple(path if os.path.isdir(path) else os.path.dirname(path) for path in paths)


def href(element: inkex.BaseElement) -> str:
    """What `element` refers to, empty if nothing.

    Parameters
    ----------
    element : BaseElement
    """
    return next((value for value in map(element.get, HREF) if value), "").strip()


def read_picture(image: inkex.Image, folders: Folders) -> bytes:
    """Read the file that an image element holds or links to.

    Parameters
    ----------
    image : Image
    folders : tuple of str
        From `link_folders`.

    Returns
    -------
    bytes
        The file as it is: PNG, JPEG, ...

    Raises
    ------
    PictureError
    """
    reference = href(image)
    if not reference:
        raise PictureError(_("it has no content"))
    if reference[:5].lower() == "data:":
        return data_bytes(reference)
    path = find_file(reference, folders) or find_file(image.get(ABSREF) or "", ())
    if path is None:
        raise PictureError(_missing(reference))
    try:
        with open(path, "rb") as file:
            # No more than it claims to hold: some files in /proc, which claim nothing, have no end.
            return file.read(min(os.fstat(file.fileno()).st_size, MAX_BYTES + 1))
    except OSError as error:
        message = _('its file "{path}" cannot be read ({reason})')
        raise PictureError(message.format(path=brief(path), reason=error.strerror)) from error


def data_bytes(uri: str) -> bytes:
    """The bytes in a data URI (RFC 2397), read as leniently as browsers do.

    White space and a missing padding are forgiven; the media type is not believed.

    Parameters
    ----------
    uri : str
        Begins with ``data:``.

    Returns
    -------
    bytes

    Raises
    ------
    PictureError
        It holds nothing that can be decoded.
    """
    head, comma, body = uri.partition(",")
    data = unquote_to_bytes(body)
    if re.search(r";\s*base64\s*$", head, re.IGNORECASE):
        data = re.sub(rb"[\s=]+", b"", data).translate(bytes.maketrans(b"-_", b"+/"))
        try:
            data = base64.b64decode(data + b"=" * (-len(data) % 4), validate=True)
        except binascii.Error:
            data = b""
    if not (comma and data):
        raise PictureError(_("the data embedded in the document are empty or damaged"))
    return data


def find_file(reference: str, folders: Folders) -> Optional[str]:
    """The local file that a link means.

    Parameters
    ----------
    reference : str
        A relative or absolute path or a ``file:`` URI, percent-encoded or not.
    folders : tuple of str

    Returns
    -------
    str or None
        Path of a regular file; None if there is none, or the link leads to a network.
    """
    # isfile also turns down devices, pipes and names that no file can have.
    paths = filter(os.path.isfile, _local_paths(reference, folders))
    return next(map(os.path.abspath, paths), None)


def is_relative(reference: str) -> bool:
    """Whether a link is a path relative to the document.

    Parameters
    ----------
    reference : str
    """
    return bool(reference) and not _scheme(reference) and reference[0] not in "/\\#"


def _local_paths(reference: str, folders: Folders) -> Iterator[str]:
    for path in () if _is_remote(reference) else _readings(reference):
        if os.path.isabs(path):
            yield path
        else:
            yield from (os.path.join(folder, path) for folder in folders)


def _readings(reference: str) -> Tuple[str, str]:
    """The path in a link, percent-decoded and as it is: not every writer of links encodes them."""
    path = re.sub(r"^file:(//localhost(?=/)|//(?=/))?", "", reference, flags=re.IGNORECASE)
    if os.name == "nt":
        path = re.sub(r"^/(?=[A-Za-z]:)", "", path)
    return os.fsdecode(unquote_to_bytes(path)), path


def _is_remote(reference: str) -> bool:
    # Two slashes at the beginning name a share on another machine.
    return _scheme(reference) not in ("", "file") or any(
        re.match(r"[/\\]{2}", path) for path in _readings(reference))


def _scheme(reference: str) -> str:
    # One letter before the colon is a drive of Windows.
    found = re.match(r"([A-Za-z][A-Za-z0-9+.-]+):", reference)
    return found.group(1).lower() if found else ""


def _missing(reference: str) -> str:
    if _is_remote(reference):
        text = _('it is linked to "{link}", and pictures are not fetched from a network; embed it first')
    else:
        text = _('it is linked to "{link}", and there is no such file')
    return text.format(link=brief(reference))
