# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures of every kind, whole and damaged, and arrays of every shape."""

from __future__ import annotations

import io
import os
import struct
import subprocess
import sys
import warnings
import zlib

import numpy as np
import pytest
from PIL import Image

from ddtcore.raster import MAX_BYTES, ImageError, check_image, is_opaque, load_image

RGBA = np.random.default_rng(0).integers(0, 256, (5, 7, 4)).astype(np.uint8)
RGBA[..., 3] = 255


def written(image, kind, **settings):
    file = io.BytesIO()
    image.save(file, kind, **settings)
    return file.getvalue()


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(samples, colour_type, transparent=b"", size=None):
    """A PNG of 16 bits a sample; `samples` has the shape (H, W, channels)."""
    height, width = samples.shape[:2] if size is None else size
    rows = b"".join(b"\0" + row.astype(">u2").tobytes() for row in samples)
    return (b"\x89PNG\r\n\x1a\n"
            + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 16, colour_type, 0, 0, 0))
            + (chunk(b"tRNS", transparent) if transparent else b"")
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


@pytest.mark.parametrize("kind", ("PNG", "BMP", "TIFF", "TGA", "PPM", "WEBP"))
def test_lossless_formats_arrive_exactly(kind):
    settings = {"lossless": True} if kind == "WEBP" else {}
    data = written(Image.fromarray(RGBA[..., :3]), kind, **settings)
    assert (load_image(data) == RGBA).all()


def test_path_file_and_bytes_are_the_same(tmp_path):
    data = written(Image.fromarray(RGBA), "PNG")
    (tmp_path / "a.png").write_bytes(data)
    with open(tmp_path / "a.png", "rb") as file:
        for source in (data, io.BytesIO(data), file, tmp_path / "a.png", str(tmp_path / "a.png")):
            image = load_image(source)
            assert (image == RGBA).all() and image.dtype == np.uint8


def test_alpha_of_every_kind_of_png():
    rgba = RGBA.copy()
    rgba[..., 3] = np.arange(35).reshape(5, 7) * 7
    assert (load_image(written(Image.fromarray(rgba), "PNG")) == rgba).all()
    grey = Image.fromarray(rgba[..., [0, 3]], "LA")
    assert (load_image(written(grey, "PNG")) == rgba[..., [0, 0, 0, 3]]).all()
    palette = Image.fromarray((np.arange(35) % 3).reshape(5, 7).astype(np.uint8), "P")
    palette.putpalette([10, 20, 30, 40, 50, 60, 70, 80, 90])
    read = load_image(written(palette, "PNG", transparency=bytes([0, 128, 255])))
    assert read[0, :3].tolist() == [[10, 20, 30, 0], [40, 50, 60, 128], [70, 80, 90, 255]]
    one = Image.fromarray(RGBA[..., :3])
    read = load_image(written(one, "PNG", transparency=tuple(RGBA[2, 3, :3].tolist())))
    assert read[2, 3, 3] == 0 and read[..., 3].sum() == 34 * 255


def test_bilevel_and_cmyk():
    bits = Image.fromarray(RGBA[..., 0]).convert("1", dither=0)
    assert (load_image(written(bits, "PNG"))[..., 0] == np.asarray(bits) * 255).all()
    cmyk = Image.new("CMYK", (4, 4), (0, 255, 255, 0))
    assert load_image(written(cmyk, "TIFF"))[0, 0].tolist() == [255, 0, 0, 255]
    red, green, blue, _ = load_image(written(cmyk, "JPEG", quality=95))[0, 0].tolist()
    assert red > 240 and green < 15 and blue < 15


def test_deep_grey_is_scaled_and_not_clipped():
    deep = np.array([[0, 128, 257, 32768, 65535, 65278]])
    for data in (png(deep, 0), written(Image.fromarray(deep.astype(np.uint16)), "TIFF")):
        assert load_image(data)[0, :, 0].tolist() == [0, 0, 1, 128, 255, 254]
    dark = np.array([[0, 100, 255]])
    assert load_image(png(dark, 0))[..., :3].max() == 1, "a dark picture stays dark"
    assert load_image(png(deep, 0, struct.pack(">H", 257)))[0, :, 3].tolist() == [255, 255, 0, 255, 255, 255]


@pytest.mark.parametrize("values, expected", [
    ([0, 0.5, 1], [0, 128, 255]), ([0, 100, 255], [0, 100, 255]), ([0, 500, 1000], [0, 128, 255]),
    ([-1, 0, 1], [0, 128, 255]), ([0, np.nan, 1], [0, 0, 255])])
def test_floating_grey(values, expected):
    data = written(Image.fromarray(np.array([values], dtype=np.float32)), "TIFF")
    assert load_image(data)[0, :, 0].tolist() == expected


def test_large_whole_numbers_fill_the_range():
    data = written(Image.fromarray(np.array([[0, 500_000, 1_000_000]], dtype=np.int32)), "TIFF")
    assert load_image(data)[0, :, 0].tolist() == [0, 128, 255]


@pytest.mark.parametrize("orientation, turned", [
    (1, RGBA), (2, RGBA[:, ::-1]), (3, RGBA[::-1, ::-1]), (4, RGBA[::-1]), (5, RGBA.swapaxes(0, 1)),
    (6, np.rot90(RGBA, -1)), (7, RGBA[::-1, ::-1].swapaxes(0, 1)), (8, np.rot90(RGBA))])
def test_exif_orientation_is_applied(orientation, turned):
    entry = struct.pack("<HHIHH", 0x0112, 3, 1, orientation, 0)
    exif = b"Exif\0\0II*\0" + struct.pack("<IH", 8, 1) + entry + bytes(4)
    data = written(Image.fromarray(RGBA[..., :3]), "PNG", exif=exif)
    assert load_image(data).shape == turned.shape and (load_image(data) == turned).all()


def test_broken_exif_does_not_cost_the_picture():
    broken = b"Exif\0\0II*\0\xff\xff\xff\x7f" + b"\x12\x01" * 9
    data = written(Image.fromarray(RGBA[..., :3]), "PNG", exif=broken)
    assert (load_image(data) == RGBA).all()


def test_first_frame_of_an_animation():
    frames = [Image.new("RGB", (6, 4), colour) for colour in ("red", "blue", "lime")]
    for kind in {"GIF", "TIFF", "PNG"} & set(Image.SAVE_ALL):
        data = written(frames[0], kind, save_all=True, append_images=frames[1:])
        assert (load_image(data) == (255, 0, 0, 255)).all()


def damaged_files():
    """Every format that Pillow writes and reads, with bytes changed and cut off: hundreds of files."""
    Image.init()
    rng = np.random.default_rng(1)
    picture = Image.fromarray(rng.integers(0, 256, (13, 17, 3)).astype(np.uint8))
    for kind in sorted(set(Image.SAVE) & set(Image.OPEN) - {"EPS"}):
        for mode in ("RGB", "P", "1"):
            try:
                whole = written(picture.convert(mode), kind)
                load_image(whole)
            except Exception:
                continue
            for number in range(8):
                data = bytearray(whole)
                for place in rng.integers(0, min(len(data), 300), rng.integers(1, 5)):
                    data[place] = rng.integers(0, 256)
                yield kind, bytes(data[:rng.integers(0, len(data))] if number % 2 else data)


def test_damaged_files_are_read_or_refused_in_one_sentence(recwarn, capfd):
    files = list(damaged_files())
    assert len(files) > 250 and len({kind for kind, _ in files}) > 10
    recwarn.clear()
    for _, data in files:
        try:
            image = load_image(data)
            assert image.ndim == 3 and image.shape[2] == 4 and image.dtype == np.uint8 and image.size
        except ImageError as error:
            assert str(error).startswith("the input ") and "\n" not in str(error)
    assert len(recwarn) == 0 and capfd.readouterr() == ("", "")


@pytest.mark.parametrize("size", [(100_000, 100_000), (0, 5), (5, 0), (2**31 - 1, 1)])
def test_sizes_that_the_header_only_claims_are_refused(size):
    with pytest.raises(ImageError):
        load_image(png(np.zeros((2, 2)), 0, size=size))


def test_limit_on_pixels_holds_before_decoding():
    cut_off = written(Image.new("RGB", (100, 100)), "BMP")[:60]
    for limit in (9_999, 1, 0):
        with pytest.raises(ImageError, match="million pixels"):
            load_image(cut_off, max_pixels=limit)
    with pytest.raises(ImageError, match="damaged"):
        load_image(cut_off, max_pixels=10_000)


def test_pillow_is_left_as_it_was():
    before = Image.MAX_IMAGE_PIXELS, list(warnings.filters)
    load_image(written(Image.fromarray(RGBA), "PNG"), max_pixels=1000)
    with pytest.raises(ImageError):
        load_image(b"")
    assert (Image.MAX_IMAGE_PIXELS, list(warnings.filters)) == before


@pytest.mark.parametrize("data", (b"", b"hello", b"\x89PNG\r\n\x1a\n", b"%PDF-1.4"))
def test_what_is_no_picture(data):
    with pytest.raises(ImageError, match=r"^the input "):
        load_image(data)


def test_vector_formats_run_no_other_program(monkeypatch):
    monkeypatch.setattr(subprocess, "Popen", lambda *arguments, **named: pytest.fail("a program was started"))
    with pytest.raises(ImageError, match="is a vector drawing, not a bitmap: EPS"):
        load_image(written(Image.new("RGB", (4, 4)), "EPS"))


def test_only_regular_files_are_opened(tmp_path):
    for name in (tmp_path, tmp_path / "missing.png", os.devnull, "http://example.org/a.png", "a\0b"):
        with pytest.raises(ImageError):
            load_image(name)
    if sys.platform != "win32":
        os.mkfifo(tmp_path / "pipe.png")
        with pytest.raises(ImageError, match="not a regular file"):
            load_image(tmp_path / "pipe.png")


def test_files_too_large_or_empty_are_not_read(tmp_path, monkeypatch):
    (tmp_path / "empty.png").write_bytes(b"")
    with open(tmp_path / "large.png", "wb") as file:  # a hole: it takes no room
        file.truncate(MAX_BYTES + 1)
    monkeypatch.setattr("builtins.open", lambda *_: pytest.fail("a file was opened"))
    for name, words in (("empty.png", "empty.png is empty"), ("large.png", "large.png has more than 2.1 GB")):
        with pytest.raises(ImageError, match=words):
            load_image(tmp_path / name)
    monkeypatch.setattr("ddtcore.raster.MAX_BYTES", 9)
    with pytest.raises(ImageError, match="the input has more than"):
        load_image(bytes(10))


def test_errors_name_the_file(tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    with pytest.raises(ImageError, match=r"text\.png is not a picture"):
        load_image(tmp_path / "text.png")


# -- arrays -----------------------------------------------------------------------

def test_arrays_become_rgba():
    assert check_image(RGBA) is RGBA
    assert (check_image(RGBA[..., :3]) == RGBA).all()
    assert (check_image(RGBA[..., 0]) == np.dstack([RGBA[..., 0]] * 3 + [RGBA[..., 3]])).all()
    turned = check_image(RGBA.swapaxes(0, 1)[::-1])
    assert turned.flags.c_contiguous and (turned == RGBA.swapaxes(0, 1)[::-1]).all()


@pytest.mark.parametrize("shape", [
    (), (5,), (5, 7, 1), (5, 7, 2), (5, 7, 5), (2, 5, 7, 4), (0, 7, 4), (5, 0)])
def test_other_shapes_are_named(shape):
    with pytest.raises(ImageError) as caught:
        check_image(np.zeros(shape, dtype=np.uint8))
    assert str(shape) in str(caught.value) and "image" in str(caught.value)


@pytest.mark.parametrize("image, named", [
    (RGBA.astype(float), "float64"), (RGBA > 9, "bool"), (RGBA.tolist(), "list"),
    (Image.fromarray(RGBA), "Image"), (None, "NoneType")])
def test_other_types_are_named(image, named):
    with pytest.raises(TypeError, match=f"image must .*{named}"):
        check_image(image)


@pytest.mark.parametrize("place, alpha", [((0, 0), 254), ((6, 8), 0), ((3, 4), 127), ((3, 4), 255)])
def test_one_pixel_that_lets_through_is_seen(place, alpha):
    image = np.random.RandomState(2).randint(0, 256, (7, 9, 4)).astype(np.uint8)
    image[..., 3] = 255
    image[place][3] = alpha
    assert is_opaque(image) == (alpha == 255)
    assert is_opaque(image[::2, ::-1]) == is_opaque(image[::2])
