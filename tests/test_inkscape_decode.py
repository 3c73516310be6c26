# SPDX-License-Identifier: GPL-2.0-or-later
"""Pixels out of bytes, with Pillow and without it."""

from __future__ import annotations

import io
import struct
import sys
import zlib

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from ddtcore.inkscape.png import SIGNATURE, read_png

pytest.importorskip("inkex")

from ddtcore.inkscape import decode as module
from ddtcore.inkscape.decode import decode, decode_with_inkscape
from ddtcore.inkscape.source import PictureError


def picture(height=9, width=13, seed=0):
    """RGBA with ramps and noise, so that encoders use all filters."""
    noise = np.random.RandomState(seed).randint(0, 40, (height, width, 4))
    return (np.cumsum(noise // 20, axis=1) * 9 + noise).astype(np.uint8)


def encoded(rgba, kind="PNG", mode="RGBA", **options):
    file = io.BytesIO()
    Image.fromarray(rgba).convert(mode).save(file, kind, **options)
    return file.getvalue()


def chunk(name, body):
    return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))


def filtered(rgba, filters):
    """A PNG whose rows have the given filters, by the definitions in the specification."""
    height, width = rgba.shape[:2]
    padded = np.zeros((height + 1, width + 1, 4), int)
    padded[1:, 1:] = rgba
    left, above, corner = padded[1:, :-1], padded[:-1, 1:], padded[:-1, :-1]
    guess = left + above - corner
    candidates = np.stack([left, above, corner])
    paeth = np.take_along_axis(candidates, np.abs(candidates - guess).argmin(0)[None], 0)[0]
    predicted = np.stack([np.zeros_like(left), left, above, (left + above) // 2, paeth])
    rows = (rgba - predicted[filters, np.arange(height)]) % 256
    raw = b"".join(bytes([kind]) + row.astype(np.uint8).tobytes() for kind, row in zip(filters, rows))
    packed = zlib.compress(raw)
    return SIGNATURE + b"".join([chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)),
                                 chunk(b"IDAT", packed[:5]), chunk(b"IDAT", packed[5:]), chunk(b"IEND", b"")])


@given(st.integers(1, 12), st.data(), st.integers(0, 1000))
def test_png_with_any_filters(width, data, seed):
    filters = data.draw(st.lists(st.integers(0, 4), min_size=1, max_size=12))
    rgba = picture(len(filters), width, seed)
    assert np.array_equal(read_png(filtered(rgba, filters)), rgba)


@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (33, 57)])
def test_png_as_pillow_writes_it(shape):
    rgba = picture(*shape)
    assert np.array_equal(read_png(encoded(rgba)), rgba)


@pytest.mark.parametrize("data", [
    b"", b"GIF89a", SIGNATURE, encoded(picture())[:60], encoded(picture())[:-30],
    encoded(picture(), mode="RGB"), encoded(picture(), mode="P")])
def test_png_that_cannot_be_read(data):
    with pytest.raises(ValueError):
        read_png(data)


def test_decode_with_pillow():
    rgba = picture()
    assert np.array_equal(decode(encoded(rgba)), rgba)
    grey = decode(encoded(rgba, "GIF", "L"))
    assert grey.shape == rgba.shape and (grey[..., 3] == 255).all()


def test_decode_turns_the_picture_upright():
    exif = Image.Exif()
    exif[0x0112] = 6  # turned by a quarter
    rgba = picture()
    assert np.array_equal(decode(encoded(rgba, exif=exif)), np.rot90(rgba, -1))


@pytest.mark.parametrize("text", ["<svg/>", "<?xml version='1.0'?><svg/>", "\ufeff <!DOCTYPE svg>"])
def test_a_drawing_is_no_bitmap(text):
    with pytest.raises(PictureError, match="a drawing already"):
        decode(text.encode())


@pytest.mark.parametrize("data", [b"nonsense", encoded(picture())[:40]])
def test_damaged_data_give_half_a_sentence(data):
    with pytest.raises(PictureError, match=r"^it ") as caught:
        decode(data)
    assert not str(caught.value).endswith(".")


def test_without_pillow_inkscape_decodes(monkeypatch):
    rgba = picture()
    monkeypatch.setitem(sys.modules, "PIL", None)
    monkeypatch.setattr(module, "_export", lambda pictures: [rgba, rgba[1:]])
    assert decode(b"data") is rgba
    monkeypatch.setattr(module, "_export", lambda pictures: [rgba, rgba])
    with pytest.raises(PictureError, match="damaged or of a kind"):
        decode(b"data")


def test_without_pillow_and_without_inkscape(monkeypatch):
    monkeypatch.setattr("inkex.command.INKSCAPE_EXECUTABLE_NAME", "no-such-program")
    with pytest.raises(PictureError, match="install Pillow"):
        decode_with_inkscape(b"data")


@pytest.mark.parametrize("kind, mode", [("PNG", "RGBA"), ("PNG", "P"), ("GIF", "P"), ("BMP", "RGB"),
                                        ("TIFF", "RGB"), ("JPEG", "L")])
def test_real_inkscape_decodes_as_pillow_does(inkscape, monkeypatch, tmp_path, kind, mode):
    monkeypatch.setattr("inkex.command.INKSCAPE_EXECUTABLE_NAME", inkscape.command[0])
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path))
    rgba = picture(20, 30)
    rgba[..., 3] = 255
    data = encoded(rgba, kind, mode)
    assert np.abs(decode_with_inkscape(data).astype(int) - decode(data)).max() <= 2


def test_real_inkscape_cannot_decode_nonsense(inkscape, monkeypatch, tmp_path):
    monkeypatch.setattr("inkex.command.INKSCAPE_EXECUTABLE_NAME", inkscape.command[0])
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path))
    with pytest.raises(PictureError, match="damaged or of a kind"):
        decode_with_inkscape(b"RIFF of a kind that nobody knows")


def test_real_inkscape_is_not_asked_for_large_pictures(inkscape, monkeypatch, tmp_path):
    monkeypatch.setattr("inkex.command.INKSCAPE_EXECUTABLE_NAME", inkscape.command[0])
    monkeypatch.setenv("INKSCAPE_PROFILE_DIR", str(tmp_path))
    bilevel = io.BytesIO()
    Image.new("1", (5000, 4001)).save(bilevel, "PNG")
    with pytest.raises(PictureError, match="more than 20 million pixels, the limit without Pillow"):
        decode_with_inkscape(bilevel.getvalue())


@pytest.mark.parametrize("answer, large", [
    ("", False), ("svg1,0,0,9e9,9e9\ni0,0,0,5000,4000\ni1,0,0,640,640\n", False), ("i0,0,0,5000,4001", True),
    ("svg1,0,0,5,5\r\ni0,-1.5,0,1e+05,1e5\r\n", True), ("i0,nonsense", False)])
def test_sizes_that_inkscape_says(answer, large):
    if large:
        with pytest.raises(PictureError, match="million pixels"):
            module._check_sizes(answer)
    else:
        module._check_sizes(answer)
