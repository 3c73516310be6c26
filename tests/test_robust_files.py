# SPDX-License-Identifier: GPL-2.0-or-later
"""Picture files of strangers: bombs, huge and broken metadata, animations, odd modes, damage of every kind.

See `test_raster` for what is read exactly, and for thousands of files with bytes changed and cut off.
"""

from __future__ import annotations

import io
import os
import struct
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from invariants import assert_sound
from PIL import Image
from test_raster import chunk, damaged_files, png, written

from ddtcore import ImageError, load_image, trace

ROOT = Path(__file__).resolve().parent.parent
SIZE = (9, 7)
PIXELS = np.random.RandomState(0).randint(0, 256, (SIZE[1], SIZE[0], 3)).astype(np.uint8)
PICTURE = Image.fromarray(PIXELS)
MEMORY = 700 << 20
"""What a process may use that reads one of these files, bytes; numpy and Pillow alone take a third of it."""


def outcome(data):
    """The sentence of the refusal, or "" for a picture, which can be traced then."""
    try:
        image = load_image(data, max_pixels=1 << 22)
    except ImageError as error:
        assert "\n" not in str(error) and str(error).startswith("the input ")
        return str(error)
    assert image.dtype == np.uint8 and image.ndim == 3 and image.shape[2] == 4 and image.size
    assert_sound(trace(image[:12, :12]))
    return ""


def zeros(megabytes):
    """Compressed zeros, a thousandth of their size."""
    packer = zlib.compressobj(9)
    return b"".join([packer.compress(bytes(1 << 20)) for _ in range(megabytes)] + [packer.flush()])


def with_chunk(kind, data):
    """A whole PNG with one more chunk before its pixels."""
    whole = written(PICTURE, "PNG")
    return whole[:33] + chunk(kind, data) + whole[33:]


BOMB = zeros(1024)
BOMBS = {
    "text": with_chunk(b"zTXt", b"a\0\0" + BOMB),
    "international text": with_chunk(b"iTXt", b"a\0\1\0\0\0" + BOMB),
    "profile": with_chunk(b"iCCP", b"a\0\0" + BOMB),
    "twice": with_chunk(b"iCCP", b"a\0\0" + zlib.compress(BOMB, 9)),
    "pixels": written(PICTURE, "PNG")[:33] + chunk(b"IDAT", BOMB) + chunk(b"IEND", b""),
    "many texts": written(PICTURE, "PNG")[:33] + 40 * chunk(b"zTXt", b"a\0\0" + zeros(50))
    + written(PICTURE, "PNG")[33:],
}


@pytest.mark.skipif(sys.platform == "win32", reason="limits of POSIX")
@pytest.mark.parametrize("name", BOMBS)
def test_what_unpacks_to_gigabytes_takes_little_memory(name, tmp_path):
    assert len(BOMBS[name]) < 3 << 20
    (tmp_path / "bomb.png").write_bytes(BOMBS[name])
    code = f"""if True:
        import resource, sys
        resource.setrlimit(resource.RLIMIT_DATA, ({MEMORY}, {MEMORY}))
        resource.setrlimit(resource.RLIMIT_CPU, (20, 20))
        from ddtcore import ImageError, load_image
        try:
            print(load_image(sys.argv[1]).shape)
        except ImageError as error:
            print(error)"""
    done = subprocess.run([sys.executable, "-c", code, str(tmp_path / "bomb.png")], cwd=ROOT, timeout=120,
                          capture_output=True, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})
    said = done.stdout.decode()
    assert (done.returncode, done.stderr) == (0, b"") and said.count("\n") == 1
    assert said == "(7, 9, 4)\n" or "can't be read" in said


def claims():
    """Headers that promise far more pixels than there are."""
    large, wide = 100_000, 65_535
    yield "PNG", png(np.zeros((2, 2)), 0, size=(large, large))
    yield "PPM", b"P6 %d %d 255\n" % (large, large) + bytes(99)
    yield "GIF", b"GIF89a" + struct.pack("<HHBBB", wide, wide, 0, 0, 0) + b"," + struct.pack(
        "<HHHHB", 0, 0, wide, wide, 0) + b"\2\2\x44\1\0;"
    yield "BMP", b"BM" + struct.pack("<IHHIIiiHHIIiiII", 99, 0, 0, 54, 40, large, large, 1, 24, 0, 0, 0, 0, 0, 0)
    yield "TGA", struct.pack("<BBBHHBHHHHBB", 0, 0, 2, 0, 0, 0, 0, 0, wide, wide, 24, 0) + bytes(99)
    entries = [(256, large), (257, large), (258, 8), (259, 1), (262, 1), (273, 8), (277, 1), (278, large), (279, 9)]
    yield "TIFF", b"II*\0" + struct.pack("<IH", 8, len(entries)) + b"".join(
        struct.pack("<HHII", tag, 4, 1, value) for tag, value in entries) + bytes(4)


@pytest.mark.parametrize("kind, data", [pytest.param(kind, data, id=kind) for kind, data in claims()])
def test_sizes_that_a_header_claims_are_refused_before_anything_is_unpacked(kind, data):
    assert "limit" in outcome(data) or "too large" in outcome(data)


def animated(kind):
    frames = [Image.new("RGB", SIZE, (k % 256, 0, 0)) for k in range(300)]
    return written(frames[0], kind, save_all=True, append_images=frames[1:])


@pytest.mark.parametrize("kind", sorted({"GIF", "PNG", "TIFF", "WEBP"} & set(Image.SAVE_ALL)))
def test_of_hundreds_of_frames_the_first_is_read_even_if_others_are_broken(kind):
    data = animated(kind)
    assert load_image(data)[0, 0, 0] <= 1 and not outcome(data)
    for cut in (len(data) // 2, len(data) * 3 // 4):
        outcome(data[:cut])


def test_megabytes_of_metadata_are_passed_over():
    large = os.urandom(1 << 22)
    texts = b"".join(chunk(b"tEXt", b"key%d\0" % k + bytes(64)) for k in range(5000))
    whole = written(PICTURE, "PNG")
    for data in (with_chunk(b"eXIf", b"II*\0" + large), with_chunk(b"juNk", large), with_chunk(b"iCCP", large),
                 whole[:33] + texts + whole[33:], whole + large, written(PICTURE, "GIF", comment=large[:60_000]),
                 written(PICTURE, "TIFF", description="x" * (1 << 20))):
        outcome(data)
    assert (load_image(whole + large)[..., :3] == PIXELS).all()


BROKEN = {"empty": b"", "short": b"\0" * 9, "no profile": b"x" * 500, "wrong length": b"\xff\xff\xff\xff" + b"\0" * 200,
          "claims": struct.pack(">I4sI4s4s4s", 2**31 - 1, b"lcms", 0, b"mntr", b"CMYK", b"XYZ ") + bytes(300)}


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "TIFF", "WEBP"])
@pytest.mark.parametrize("name", BROKEN)
def test_broken_profiles_and_exif_data_do_not_cost_the_picture(name, kind):
    assert not outcome(written(PICTURE, kind, icc_profile=BROKEN[name]))
    if kind != "TIFF":
        for head in (b"", b"Exif\0\0", b"Exif\0\0MM\0*"):
            assert not outcome(written(PICTURE, kind, exif=head + BROKEN[name]))


MODES = ("1", "L", "LA", "La", "P", "PA", "RGB", "RGBX", "RGBA", "RGBa", "CMYK", "YCbCr", "LAB", "HSV", "I", "F",
         "I;16", "I;16B", "I;16L")


@pytest.mark.parametrize("mode", MODES)
def test_every_mode_in_every_format_that_holds_it(mode):
    Image.init()
    try:
        image = Image.frombytes(mode, SIZE, bytes(range(256))[:63] * 8) if ";" in mode else Image.new(mode, SIZE)
    except (ValueError, KeyError):
        pytest.skip("this version of Pillow has no such mode")
    count = 0
    for kind in sorted(set(Image.SAVE) & set(Image.OPEN) - {"EPS"}):
        try:
            data = written(image, kind)
        except Exception:
            continue
        count += 1
        outcome(data)
    assert count or mode in ("La", "RGBa", "PA", "HSV", "I;16L")


def test_what_can_still_be_read_of_damaged_files_can_be_traced():
    read = [data for _, data in damaged_files() if not outcome(data)]
    assert len(read) > 50


@pytest.mark.parametrize("name", ["con", "a\nb", "a" * 300, "\udcff", "", "..", "/dev/stdin", "/dev/zero",
                                  "\\\\host\\a", "ftp://example.org/a.png", "file:///etc/passwd",
                                  "data:image/png;base64,AAAA"])
def test_names_that_are_no_regular_files(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ImageError):
        load_image(name)


def test_a_file_that_shrinks_or_fails_while_it_is_read():
    class Failing(io.BytesIO):
        def read(self, size=-1):
            if self.tell() > 40:
                raise OSError("the medium was removed")
            return super().read(size)

    with pytest.raises(ImageError, match="the input"):
        load_image(Failing(written(PICTURE, "PNG")))
