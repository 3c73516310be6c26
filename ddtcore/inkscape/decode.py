# SPDX-License-Identifier: GPL-2.0-or-later
"""From the bytes of a picture to its pixels: Pillow, or Inkscape itself where Pillow is missing."""

from __future__ import annotations

import base64
import os
import re
from tempfile import TemporaryDirectory
from typing import List

import numpy as np
from inkex.command import CommandNotFound, ProgramRunError, inkscape

from .png import read_png
from .source import PictureError
from .words import _

BROKEN = b"no picture"
"""What Inkscape shows for this is what it shows for anything it cannot decode."""

MOST_PIXELS = 20_000_000
"""Largest picture that is decoded without Pillow, px: it takes half a minute and a gigabyte."""


def decode(data: bytes) -> np.ndarray:
    """Decode a picture.

    Parameters
    ----------
    data : bytes
        A file of any bitmap format that Pillow, or else Inkscape, can read.

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8
        RGBA, turned upright as its EXIF data say.

    Raises
    ------
    PictureError
        The bytes cannot be decoded.
    """
    if re.match(rb"(\xef\xbb\xbf)?\s*<[?!a-z]", data[:64]):
        raise PictureError(_("it is a drawing already, not a bitmap"))
    try:
        from ..raster import ImageError, load_image

        return load_image(data)
    except ImportError:  # no Pillow, or one whose libraries do not load
        return decode_with_inkscape(data)
    except ImageError as error:
        said, colon, details = str(error).replace("the input ", "it ", 1).partition(": ")
        raise PictureError(_(said) + colon + details) from error


def decode_with_inkscape(data: bytes) -> np.ndarray:
    """Let Inkscape decode a picture: it exports an image element without a size, pixel for pixel.

    Parameters
    ----------
    data : bytes

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8

    Raises
    ------
    PictureError
    """
    try:
        picture, broken = _export([data, BROKEN])
    except PictureError:
        raise
    except (CommandNotFound, ProgramRunError, OSError, ValueError) as error:
        raise PictureError(_("Pillow is missing in the Python that Inkscape uses, and Inkscape could not"
                            " decode it either; install Pillow (Debian: python3-pil)")) from error
    if np.array_equal(picture, broken):
        raise PictureError(_("its data are damaged or of a kind that Inkscape cannot read"))
    return picture


def _export(pictures: List[bytes]) -> List[np.ndarray]:
    uris = ["data:image/png;base64," + base64.b64encode(data).decode("ascii") for data in pictures]
    images = "".join(f'<image id="i{number}" xlink:href="{uri}"/>' for number, uri in enumerate(uris))
    with TemporaryDirectory(prefix="ddt_trace") as folder:
        path = os.path.join(folder, "pictures.svg")
        with open(path, "w", encoding="ascii") as file:
            file.write('<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink">'
                       f"{images}</svg>")
        _check_sizes(inkscape(path, query_all=True))
        result = []
        for number in range(len(pictures)):
            target = os.path.join(folder, f"{number}.png")
            inkscape(path, export_filename=target, export_id=f"i{number}", export_id_only=True, export_dpi=96)
            with open(target, "rb") as file:
                result.append(read_png(file.read()))
    return result


def _check_sizes(answer: str) -> None:
    """Refuse what would take minutes; `answer` is what Inkscape says of its objects: id, x, y, width, height."""
    for width, height in re.findall(r"^i\d+,[^,]*,[^,]*,([\d.e+]+),([\d.e+]+)\s*$", answer, re.MULTILINE):
        if float(width) * float(height) > MOST_PIXELS:
            raise PictureError(_("it has more than 20 million pixels, the limit without Pillow; install Pillow"
                                 " (Debian: python3-pil)"))
