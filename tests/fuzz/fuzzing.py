#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-2.0-or-later
"""Fuzzing: whatever bytes arrive, the outcome is a sound drawing or one plain sentence.

Usage: fuzzing.py SECONDS [FOLDER]

With atheris (libFuzzer for Python) the inputs follow the branches of the engine and of Pillow's
readers; without it they are random changes of the seeds.  Inputs that fail are kept in the folder.
"""

from __future__ import annotations

import hashlib
import io
import os
import random
import subprocess
import sys
import time
import traceback
from dataclasses import fields
from typing import Callable, Iterator, List, Tuple

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.path[:0] = [ROOT, os.path.join(ROOT, "tests")]

import numpy as np
from PIL import Image

LONGEST = 16
"""Largest side of the pictures that are traced, px."""

LIMIT = 1 << 20
"""Largest picture that is decoded, px."""


def try_input(data: bytes) -> None:
    """Take bytes as a picture file or as pixels, by the first one; raises if the outcome isn't sound."""
    if not data:
        return
    (try_file if data[0] % 2 else try_pixels)(data[1:])


def try_file(data: bytes) -> None:
    """Bytes as a file of any format."""
    from invariants import assert_sound

    from ddtcore import ImageError, TraceOptions, load_image, trace

    try:
        image = load_image(io.BytesIO(data), max_pixels=LIMIT)
    except ImageError as error:
        assert "\n" not in str(error) and str(error).startswith("the input ")
        return
    assert image.dtype == np.uint8 and image.ndim == 3 and image.shape[2] == 4 and image.size
    assert_sound(trace(image[:LONGEST, :LONGEST], TraceOptions(tolerance=1.0)))


def try_pixels(data: bytes) -> None:
    """Bytes as settings, size, palette and pixels."""
    from invariants import assert_sound

    from ddtcore import TraceOptions, trace

    reader = io.BytesIO(data)
    byte = lambda: (reader.read(1) or b"\0")[0]  # noqa: E731
    options = TraceOptions(**{setting.name: _value(setting, byte()) for setting in fields(TraceOptions)})
    width, height, colours = 1 + byte() % LONGEST, 1 + byte() % LONGEST, 1 + byte() % 8
    palette = np.zeros((colours, 4), np.uint8)
    own = reader.read(palette.size)
    palette.ravel()[:len(own)] = np.frombuffer(own, np.uint8)
    index = np.zeros(width * height, np.intp)
    rest = reader.read(index.size)
    index[:len(rest)] = np.frombuffer(rest, np.uint8) % colours
    image = palette[index].reshape(height, width, 4)
    assert_sound(trace(image, options), by_area=options.group == "none")


def _value(setting, byte: int):
    """A value of a setting, mostly the default."""
    meta = setting.metadata
    if byte < 128:
        return setting.default
    if isinstance(setting.default, bool):
        return byte % 2 == 1
    if meta["choices"]:
        return meta["choices"][byte % len(meta["choices"])]
    # Most of what differs does so near the lower end.
    if meta["low"] is None:
        return setting.default
    value = meta["low"] + (meta["high"] - meta["low"]) * ((byte - 128) / 127) ** 3
    return type(setting.default)(value)


def seeds() -> Iterator[bytes]:
    """A file of each format that Pillow writes, and a few pictures as pixels."""
    Image.init()
    random_ = np.random.RandomState(0)
    picture = Image.fromarray(random_.randint(0, 256, (9, 12, 3)).astype(np.uint8))
    for kind in sorted(set(Image.SAVE) & set(Image.OPEN)):
        for mode in ("RGB", "RGBA", "P", "1", "I;16", "F"):
            file = io.BytesIO()
            try:
                (picture.convert(mode) if mode != "I;16" else picture.convert("I").convert(mode)).save(file, kind)
            except Exception:
                continue
            yield b"\1" + file.getvalue()
    for size in (3, 5, 12):
        for colours in (2, 3, 6):
            head = bytes(random_.randint(0, 256, 15).tolist()) + bytes([size - 1, size - 1, colours - 1])
            yield b"\0" + head + random_.bytes(4 * colours + size * size)


def changed(data: bytes, random_: random.Random, others: List[bytes]) -> bytes:
    """Bytes changed, cut off, repeated, or joined with another seed's."""
    out = bytearray(data)
    for _ in range(random_.choice((1, 1, 2, 4, 8))):
        place, way = random_.randrange(len(out) or 1), random_.randrange(6)
        if way == 0:
            out[place:place + 1] = bytes([random_.randrange(256)])
        elif way == 1:
            out[place:place + 4] = random_.choice((b"\0\0\0\0", b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff", b"\1\0\0\0"))
        elif way == 2:
            del out[place:place + random_.randrange(1, 9)]
        elif way == 3:
            out[place:place] = out[place:place + random_.randrange(1, 40)]
        elif way == 4:
            out[place:] = random_.choice(others)[place:]
        elif random_.random() < 0.3:
            del out[place:]
        out = out or bytearray(b"\0")
    return bytes(out)


def try_random(inputs: int = 0, seconds: float = float("inf"), seed: int = 0,
               fault: Callable[[bytes], None] = lambda data: None) -> Tuple[int, int]:
    """Try changed seeds, so many or so long; `fault` hears of those that fail.  Returns tried and failed."""
    random_, pool, end = random.Random(seed), list(seeds()), time.monotonic() + seconds
    tried = failed = 0
    while (not inputs or tried < inputs) and time.monotonic() < end:
        data = changed(random_.choice(pool), random_, pool)
        tried += 1
        try:
            try_input(data)
        except Exception:
            failed += 1
            fault(data)
    return tried, failed


def _keep(folder: str) -> Callable[[bytes], None]:
    def keep(data: bytes) -> None:
        traceback.print_exc()
        name = os.path.join(folder, "fault-" + hashlib.sha1(data).hexdigest()[:12])
        with open(name, "wb") as file:
            file.write(data)
        print("kept as", name, file=sys.stderr)
    return keep


def _with_atheris(seconds: int, folder: str) -> int:
    """Let libFuzzer choose the inputs, in a process of its own, for it ends the process."""
    pool = os.path.join(folder, "seeds")
    os.makedirs(pool, exist_ok=True)
    for number, data in enumerate(seeds()):
        with open(os.path.join(pool, f"{number:03}"), "wb") as file:
            file.write(data)
    code = ("import atheris, sys\nwith atheris.instrument_imports(include=['ddtcore', 'PIL']):\n"
            "    import ddtcore.pipeline, ddtcore.svg, PIL.Image\n    PIL.Image.init()\n"
            "import fuzzing\natheris.Setup(sys.argv, fuzzing.try_input)\natheris.Fuzz()")
    path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), ROOT, os.path.join(ROOT, "tests")])
    return subprocess.call(
        [sys.executable, "-c", code, f"-max_total_time={seconds}", "-max_len=4096", "-timeout=60",
         "-rss_limit_mb=0", "-malloc_limit_mb=2000", "-print_final_stats=1", f"-artifact_prefix={folder}/", pool],
        env={**os.environ, "PYTHONPATH": path})


def main(seconds: int, folder: str) -> int:
    os.makedirs(folder, exist_ok=True)
    try:
        import atheris  # noqa: F401
    except ImportError:
        tried, failed = try_random(seconds=seconds, seed=int(time.time()), fault=_keep(folder))
        print(f"{tried} inputs tried at random (there is no atheris), {failed} failed")
        return 1 if failed else 0
    return _with_atheris(seconds, folder)


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]), *sys.argv[2:] or [os.path.join(ROOT, "build", "fuzz")]))
