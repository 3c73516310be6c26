# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure time and memory over the size of the picture, beside other tracers.

Some of the drawings in tests/images/vector are rendered at several sizes.  Each time is that
of a whole process, from the start of the interpreter to the written file; the least of a few
runs counts, as others only slow a run down.

    make bench                                                # prints the tables
    .venv/bin/python tests/benchmark/speed.py --save          # and keeps the figures for README.md
    .venv/bin/python tests/benchmark/speed.py --sizes 0.25,1  # quicker, in million pixels

vtracer and autotrace take part where they are installed: pip install vtracer pyautotrace.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path
from statistics import median

ROOT = Path(__file__).resolve().parent.parent.parent
FIGURES = Path(__file__).with_suffix(".json")
_PATHS = [str(ROOT), str(ROOT / "tests"), str(ROOT / "tests" / "benchmark")]
sys.path[:0] = _PATHS

DRAWINGS = ("card", "lens", "tiger")
SIZES = (0.25, 1.0, 4.0, 16.0)
RUNS = 2
SECONDS = 120

_OURS = "DDT Trace"
_OTHERS = {
    "vtracer": "import vtracer; vtracer.convert_image_to_svg_py(i, o, path_precision=2)",
    "autotrace": "import numpy as np; from PIL import Image; from autotrace import Bitmap;"
                 " Bitmap(np.asarray(Image.open(i).convert('RGB'))).trace(color_count=16).save(o)"}


def tracers():
    """Commands of those that are installed, by name; the two files follow."""
    found = {_OURS: [sys.executable, "-c", "import sys; from ddtcore.cli import main; i, o = sys.argv[1:];"
                     " sys.exit(main([i, '-o', o, '--quiet', '--timings', '--json']))"]}
    for module, code in _OTHERS.items():
        if find_spec(module):
            found[module] = [sys.executable, "-c", f"import sys; i, o = sys.argv[1:]; {code}"]
    return found


def render(name, megapixels, path):
    """Write a bitmap of a drawing; in a process of its own, as memory would count for those that follow."""
    code = ("import sys; from speed import paint; paint(sys.argv[1], float(sys.argv[2]), sys.argv[3])")
    subprocess.run([sys.executable, "-c", code, name, str(megapixels), str(path)], check=True,
                   env={**os.environ, "PYTHONPATH": os.pathsep.join(_PATHS)})


def paint(name, megapixels, path):
    """What `render` does, in this process."""
    from compare_tracers import render as rendered
    from lxml import etree
    from PIL import Image

    svg = (ROOT / "tests" / "images" / "vector" / f"{name}.svg").read_bytes()
    root = etree.fromstring(svg)
    width, height = (float(root.get(side)) for side in ("width", "height"))
    scale = math.sqrt(megapixels * 1e6 / (width * height))
    Image.fromarray(rendered(svg, round(width * scale), round(height * scale))).save(path, compress_level=1)


def run(command):
    """Seconds that a process took and what it said; None if it failed."""
    with tempfile.TemporaryFile() as said:
        begin = time.perf_counter()
        child = subprocess.Popen(command, stdout=said, stderr=subprocess.DEVNULL,
                                 env={**os.environ, "PYTHONPATH": str(ROOT)})
        try:
            child.wait(SECONDS)
        except subprocess.TimeoutExpired:
            child.kill()
            child.wait()
        seconds = time.perf_counter() - begin
        said.seek(0)
        return None if child.returncode else (seconds, said.read().decode())


def measure(found, drawings=DRAWINGS, sizes=SIZES, runs=RUNS):
    """Times of all tracers at all sizes, the stages and the memory of ours.

    Returns
    -------
    list of dict
        One for each drawing and size: `drawing`, `megapixels`, `seconds` by tracer (those that
        fail or take too long are missing, and not tried at larger sizes), `stages`.
    """
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        for drawing in drawings:
            able = dict(found)
            for megapixels in sorted(sizes):
                picture, result = Path(folder) / "picture.png", Path(folder) / "drawing.svg"
                render(drawing, megapixels, picture)
                row = {"drawing": drawing, "megapixels": megapixels, "seconds": {}}
                rows.append(row)
                for name, command in list(able.items()):
                    done = [run([*command, str(picture), str(result)]) for _ in range(runs)]
                    if None in done:
                        del able[name]
                        continue
                    seconds, said = min(done)
                    row["seconds"][name] = seconds
                    if name == _OURS:
                        row["stages"] = json.loads(said)["timings"]
                print(json.dumps({key: row[key] for key in ("drawing", "megapixels", "seconds")}),
                      file=sys.stderr, flush=True)
    return rows


def by_size(rows):
    """The rows of each size, smallest first."""
    sizes = sorted({row["megapixels"] for row in rows})
    return [(size, [row for row in rows if row["megapixels"] == size]) for size in sizes]


def growth(sizes, seconds):
    """The exponent b of the power law a * size**b that fits best; 1 is growth with the pixels.

    Examples
    --------
    >>> growth([1, 4, 16], [2, 4, 8])
    0.5
    """
    x, y = ([math.log(value) for value in values] for values in (sizes, seconds))
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return (sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x))


def sizes_table(rows):
    """Markdown: median seconds of each tracer at each size, and our ratios and peak memory."""
    from make_readme import table

    names = list(dict.fromkeys(name for row in rows for name in row["seconds"]))
    others = [name for name in names if name != _OURS]
    cells = []
    for size, here in by_size(rows):
        cell = [f"{size:g}"]
        for name in names:
            cell.append(_middle([row["seconds"][name] for row in here if name in row["seconds"]], "{:.2f}"))
        for name in others:
            cell.append(_middle([row["seconds"][_OURS] / row["seconds"][name] for row in here
                                 if {_OURS, name} <= set(row["seconds"])], "{:.1f}"))
        peaks = [max(stage["peak_mb"] for stage in row["stages"]) for row in here if "stages" in row]
        cells.append([*cell, _middle(peaks, "{:,.0f}")])
    heads = ["million pixels", *(f"{name}, s" for name in names), *(f"times {name}" for name in others),
             "peak memory, MB"]
    return table(heads, cells, numbers=True)


def stages_table(rows):
    """Markdown: median seconds of our stages at each size, and how they grow with it."""
    from make_readme import table

    sizes = [(size, [row for row in here if "stages" in row]) for size, here in by_size(rows)]
    sizes = [(size, here) for size, here in sizes if here]
    stages = [stage["stage"] for stage in sizes[0][1][0]["stages"]]
    cells = []
    for number, name in [*enumerate(stages), (None, "in all")]:
        seconds = [median(_seconds(row, number) for row in here) for _, here in sizes]
        large = [(size, value) for (size, _), value in zip(sizes, seconds) if size >= 1]
        steady = len(large) > 1 and max(seconds) >= 0.1
        cells.append([name, *(f"{value:.2f}" for value in seconds),
                      f"{growth(*zip(*large)):.2f}" if steady else ""])
    return table(["stage", *(f"{size:g} MP, s" for size, _ in sizes), "growth"], cells, numbers=True)


def _seconds(row, number):
    """Seconds of a stage, or of all."""
    stages = row["stages"]
    return max(1e-4, sum(stage["seconds"] for stage in (stages if number is None else [stages[number]])))


def _middle(values, form):
    return form.format(median(values)) if values else "-"


def readme_text():
    """Both tables of the figures that were kept, for README.md."""
    kept = json.loads(FIGURES.read_text(encoding="utf-8"))
    return "\n".join([sizes_table(kept["rows"]), "", stages_table(kept["rows"]), "",
                      f"Measured with {kept['machine']}."])


def machine():
    """What the figures depend on besides the code, in a line."""
    import numpy

    return (f"Python {platform.python_version()}, numpy {numpy.__version__},"
            f" {os.cpu_count()} processors, {platform.system()} {platform.machine()}")


def main():
    """Measure and print, and with ``--save`` keep the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default=",".join(f"{size:g}" for size in SIZES), help="million pixels")
    parser.add_argument("--runs", type=int, default=RUNS)
    parser.add_argument("--save", action="store_true", help=f"write {FIGURES.name}")
    chosen = parser.parse_args()
    rows = measure(tracers(), sizes=[float(size) for size in chosen.sizes.split(",")], runs=chosen.runs)
    print("\n".join([sizes_table(rows), "", stages_table(rows), "", machine()]))
    if chosen.save:
        FIGURES.write_text(json.dumps({"machine": machine(), "rows": rows}, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
