# SPDX-License-Identifier: GPL-2.0-or-later
"""Measure DDT Trace beside other tracers, on drawings whose vector truth is known.

Each drawing in tests/images/vector is rendered with its long side at 512 px; every tracer
that is installed traces that bitmap; the results are rendered four times as large and
compared with the drawing itself at that size.  No drawing of these was looked at while
the engine was made.

    .venv/bin/pip install vtracer pyautotrace              # and the programs potrace, inkscape
    .venv/bin/python tests/benchmark/compare_tracers.py            # prints the table
    .venv/bin/python tests/benchmark/compare_tracers.py --readme   # and renews README.md

Inkscape's Trace Bitmap can be called without hands from version 1.4 on; name one that is
not on the PATH in DDT_TRACE_INKSCAPES (see tests/inkscape_host.py).
"""

from __future__ import annotations

import base64
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.util import find_spec
from pathlib import Path
from statistics import median

import numpy as np
import resvg_py
from lxml import etree
from PIL import Image

ROOT = Path(__file__).resolve().parent.parent.parent
DRAWINGS = sorted((ROOT / "tests" / "images" / "vector").glob("*.svg"))
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

import inkscape_host
from make_readme import table, with_table
from readme_paint import beside, labelled, save

SIZE, SCALE, COLOURS, SECONDS = 512, 4, 16, 120

_CROPS = (("tiger.svg", (46, 30, 44, 44)), ("card.svg", (24, 18, 44, 44)), ("lens.svg", (292, 250, 44, 44)))
"""Details shown eight times as large: drawing, and box in the bitmap."""

_ZOOM = 8
_ARGUMENTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "a": 7}


# -- tracers ----------------------------------------------------------------------

def python(code):
    """A tracer that is some Python; `i` and `o` are the names of its files."""
    return lambda i, o: run([sys.executable, "-c", f"import sys; i, o = sys.argv[1:]; {code}", i, o])


def run(command, **settings):
    subprocess.run(list(map(str, command)), check=True, timeout=SECONDS, stdout=subprocess.DEVNULL,
                   stderr=subprocess.DEVNULL, env={**os.environ, "PYTHONPATH": str(ROOT)}, **settings)


def potrace_stack(picture, drawing):
    """Potrace on stacked layers, dark ones on top: how Trace Bitmap traces colours."""
    image = Image.open(picture).convert("RGB").quantize(COLOURS, dither=Image.NONE)
    palette = np.array(image.getpalette()[:3 * COLOURS]).reshape(-1, 3)
    order = np.argsort(-palette.sum(axis=1), kind="stable")
    rank = np.argsort(order)[np.asarray(image)]
    width, height = image.size
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}">']
    for layer in np.unique(rank).tolist():
        bitmap = io.BytesIO()
        Image.fromarray(np.where(rank >= layer, 0, 255).astype(np.uint8)).convert("1").save(bitmap, "PPM")
        done = subprocess.run(["potrace", "-s", "--flat", "-o", "-", "-"], check=True,
                              input=bitmap.getvalue(), stdout=subprocess.PIPE)
        data = "".join(re.findall(r'<path d="([^"]*)"', done.stdout.decode()))
        fill = "#{:02x}{:02x}{:02x}".format(*palette[order[layer]])
        parts.append(f'<path fill="{fill}" transform="matrix(.1 0 0 -.1 0 {height})" d="{data}"/>')
    Path(drawing).write_text("\n".join([*parts, "</svg>"]))


def trace_bitmap(inkscape):
    """Inkscape's Trace Bitmap in many colours with its own defaults: smoothed, stacked."""
    def trace(picture, drawing):
        width, height = Image.open(picture).size
        data = base64.b64encode(Path(picture).read_bytes()).decode()
        document = Path(drawing).with_suffix(".document.svg")
        document.write_text(
            '<svg xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
            f' width="{width}" height="{height}" viewBox="0 0 {width} {height}"><image id="p"'
            f' width="{width}" height="{height}" xlink:href="data:image/png;base64,{data}"/></svg>')
        steps = ["select-by-id:p", f"object-trace:{COLOURS},true,true,false,2,1.0,0.2", "select-clear",
                 "select-by-id:p", "delete", f"export-filename:{drawing}", "export-plain-svg", "export-do"]
        run(["xvfb-run", "-a", *inkscape, "--batch-process", f"--actions={';'.join(steps)}", document])
    return trace


def tracers():
    """Those that are installed, by name."""
    found = {"DDT Trace": lambda i, o: run([sys.executable, "-m", "ddtcore", i, "-o", o])}
    for command in inkscape_host.commands():
        said = subprocess.run([*command, "--action-list"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        if b"object-trace" in said.stdout:
            found["Inkscape's Trace Bitmap"] = trace_bitmap(command)
    codes = {
        "vtracer": "vtracer.convert_image_to_svg_py(i, o)",
        "autotrace": "import numpy as np; from PIL import Image; image = Image.open(i).convert('RGB');"
                     f" autotrace.Bitmap(np.asarray(image)).trace(color_count={COLOURS}).save(o)"}
    for module, code in codes.items():
        if find_spec(module):
            found[module] = python(f"import {module}; {code}")
    if shutil.which("potrace"):
        found["potrace, stacked"] = potrace_stack
    return found


# -- measures ---------------------------------------------------------------------

def render(svg, width, height):
    """An SVG stretched to a size, over white, uint8 (H, W, 3)."""
    root = etree.fromstring(svg, etree.XMLParser(huge_tree=True))
    if not root.get("viewBox"):
        lengths = (re.match(r"[\d.]+", root.get(name))[0] for name in ("width", "height"))
        root.set("viewBox", f"0 0 {' '.join(lengths)}")
    for name, value in (("width", width), ("height", height), ("preserveAspectRatio", "none")):
        root.set(name, str(value))
    png = resvg_py.svg_to_bytes(svg_string=etree.tostring(root, encoding="unicode"), background="white",
                                skip_system_fonts=True)
    return np.asarray(Image.open(io.BytesIO(bytes(png))).convert("RGB"))


def psnr(one, other):
    """Peak signal to noise ratio, dB; 99 for the same picture."""
    error = np.mean((one.astype(np.float64) - other) ** 2)
    return min(99.0, float(10 * np.log10(255**2 / max(error, 1e-9))))


def ssim(one, other, side=7):
    """Structural similarity: Wang, Bovik, Sheikh, Simoncelli 2004, over squares, of each channel."""
    def mean(values):
        sums = np.pad(values, ((1, 0), (1, 0))).cumsum(0).cumsum(1)
        rows = sums[side:] - sums[:-side]
        return (rows[:, side:] - rows[:, :-side]) / side**2

    means = []
    for x, y in zip(np.moveaxis(one, 2, 0).astype(np.float64), np.moveaxis(other, 2, 0).astype(np.float64)):
        mx, my = mean(x), mean(y)
        vx, vy, vxy = mean(x * x) - mx * mx, mean(y * y) - my * my, mean(x * y) - mx * my
        c1, c2 = (.01 * 255) ** 2, (.03 * 255) ** 2
        means.append(np.mean((2 * mx * my + c1) * (2 * vxy + c2) / ((mx**2 + my**2 + c1) * (vx + vy + c2))))
    return float(np.mean(means))


def nodes(svg):
    """Lines and curves of all paths."""
    count = 0
    for data in etree.fromstring(svg, etree.XMLParser(huge_tree=True)).xpath("//@d"):
        for letter, numbers in re.findall(r"([a-zA-Z])([^a-zA-Z]*)", re.sub(r"[eE]([-+]?\d)", r"\1", data)):
            found = len(re.findall(r"[-+]?(?:\d+\.?\d*|\.\d+)", numbers))
            count += found // _ARGUMENTS.get(letter.lower(), 1000) - (letter in "mM")
    return count


def measure(svg, truth, seconds):
    """A row of figures."""
    import zlib

    height, width = truth.shape[:2]
    drawn = render(svg, width, height)
    return {"PSNR": psnr(drawn, truth), "SSIM": ssim(drawn, truth), "SVGZ": len(zlib.compress(svg, 9)) + 12,
            "nodes": nodes(svg), "seconds": seconds}


def bitmap_of(drawing):
    """The bitmap of a drawing and the truth, both over white, uint8 (H, W, 3)."""
    svg = drawing.read_bytes()
    root = etree.fromstring(svg)
    width, height = (float(root.get(name)) for name in ("width", "height"))
    size = [round(SIZE * side / max(width, height)) for side in (width, height)]
    return render(svg, *size), render(svg, *(SCALE * side for side in size))


def measure_all(found, folder):
    """Figures of each tracer on each drawing; the traces stay in a folder."""
    rows = {name: [] for name in found}
    for drawing in DRAWINGS:
        bitmap, truth = bitmap_of(drawing)
        picture = folder / f"{drawing.stem}.png"
        Image.fromarray(bitmap).save(picture)
        for name, trace in found.items():
            result = folder / f"{drawing.stem}-{name.partition(' ')[0]}.svg"
            start = time.perf_counter()
            trace(picture, result)
            rows[name].append(measure(result.read_bytes(), truth, time.perf_counter() - start))
            print(drawing.stem, name, json.dumps(rows[name][-1]), file=sys.stderr, flush=True)
    return rows


def tracers_table(rows):
    """Medians, and the sum of the sizes."""
    cells = []
    for name, figures in rows.items():
        middle = {key: median(row[key] for row in figures) for key in figures[0]}
        total = sum(row["SVGZ"] for row in figures) / 1000
        cells.append([name, f"{middle['PSNR']:.1f}", f"{middle['SSIM']:.4f}", f"{total:,.0f}",
                      f"{middle['nodes']:,.0f}", f"{middle['seconds']:.1f}"])
    return table(["tracer", "PSNR at 4x, dB", "SSIM at 4x", "all as SVGZ, kB", "nodes", "seconds"], cells,
                 numbers=True)


def paint_crops(found, folder):
    """The same details of the bitmap and of each trace, enlarged."""
    rows = []
    for name, (x, y, width, height) in _CROPS:
        bitmap = Image.open(folder / name.replace(".svg", ".png"))
        size = (width * _ZOOM, height * _ZOOM)
        row = [bitmap.crop((x, y, x + width, y + height)).resize(size, Image.NEAREST)]
        for tracer in found:
            svg = (folder / name.replace(".svg", f"-{tracer.partition(' ')[0]}.svg")).read_bytes()
            whole = Image.fromarray(render(svg, bitmap.width * _ZOOM, bitmap.height * _ZOOM))
            row.append(whole.crop((x * _ZOOM, y * _ZOOM, x * _ZOOM + size[0], y * _ZOOM + size[1])))
        rows.append([part.resize((170, 170), Image.LANCZOS) for part in row])
    save(labelled(beside(*rows, gap=8), ["bitmap", *found], 8), "tracers", colours=80)


def main():
    """Measure, print, and with ``--readme`` write."""
    found = tracers()
    with tempfile.TemporaryDirectory() as folder:
        rows = measure_all(found, Path(folder))
        print(tracers_table(rows))
        if "--readme" in sys.argv:
            readme = ROOT / "README.md"
            text = with_table(readme.read_text(encoding="utf-8"), "tracers", tracers_table(rows))
            readme.write_text(text, encoding="utf-8")
            paint_crops(found, Path(folder))


if __name__ == "__main__":
    main()
