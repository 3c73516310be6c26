# SPDX-License-Identifier: GPL-2.0-or-later
"""A reader for the one kind of PNG that Inkscape exports: 8-bit RGBA, not interlaced.

It is needed where Pillow is missing, as Debian's Inkscape does without it.  Format
and filters: W3C, "Portable Network Graphics (PNG) Specification", sections 5 and 9.
"""

from __future__ import annotations

import struct
import zlib
from typing import Iterator, Tuple

import numpy as np

SIGNATURE = b"\x89PNG\r\n\x1a\n"


def read_png(data: bytes) -> np.ndarray:
    """Read a PNG of 8-bit RGBA.

    Parameters
    ----------
    data : bytes

    Returns
    -------
    ndarray of shape (H, W, 4) and dtype uint8

    Raises
    ------
    ValueError
        It is no PNG, a damaged one, or one of another kind.
    """
    chunks = list(_chunks(data))
    if not chunks or chunks[0][0] != b"IHDR" or len(chunks[0][1]) != 13:
        raise ValueError("this is not a PNG file")
    width, height, *kind = struct.unpack(">IIBBBBB", chunks[0][1])
    if kind != [8, 6, 0, 0, 0]:
        raise ValueError(f"only 8-bit RGBA without interlacing is read, not {kind}")
    try:
        raw = zlib.decompress(b"".join(body for name, body in chunks if name == b"IDAT"))
        lines = np.frombuffer(raw, np.uint8).reshape(height, 1 + 4 * width)
    except (zlib.error, ValueError) as error:
        raise ValueError("this PNG file is damaged") from error
    return _unfilter(lines[:, 0], lines[:, 1:].reshape(height, width, 4))


def _chunks(data: bytes) -> Iterator[Tuple[bytes, bytes]]:
    at = len(SIGNATURE) if data.startswith(SIGNATURE) else len(data)
    while at + 12 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        yield name, data[at + 8:at + 8 + length]
        at += 12 + length


def _unfilter(filters: np.ndarray, lines: np.ndarray) -> np.ndarray:
    """Undo the filters of all rows at once, one diagonal of the picture after the other.

    A pixel needs its neighbours on the left, above, and above left.  Sheared by one
    column per row, they all lie in the two sheared columns before its own.
    """
    height, width = lines.shape[:2]
    rows = np.arange(height)
    columns = rows[:, None] + np.arange(width)
    sheared = np.zeros((width + height + 1, height + 1, 4), np.int16)  # margins of zeros
    sheared[columns + 2, rows[:, None] + 1] = lines
    inside = np.zeros((width + height + 1, height), bool)
    inside[columns + 2, rows[:, None]] = True
    for step in range(2, width + height + 1):
        left, above, corner = sheared[step - 1, 1:], sheared[step - 1, :-1], sheared[step - 2, :-1]
        guesses = [np.zeros_like(left), left, above, (left + above) // 2, _paeth(left, above, corner)]
        predicted = np.choose(filters[:, None], guesses)
        sheared[step, 1:] = np.where(inside[step][:, None], (sheared[step, 1:] + predicted) & 255, 0)
    return np.asarray(sheared[columns + 2, rows[:, None] + 1], np.uint8)


def _paeth(left: np.ndarray, above: np.ndarray, corner: np.ndarray) -> np.ndarray:
    guess = left + above - corner
    far_left, far_above, far_corner = abs(guess - left), abs(guess - above), abs(guess - corner)
    return np.where((far_left <= far_above) & (far_left <= far_corner), left,
                    np.where(far_above <= far_corner, above, corner))
