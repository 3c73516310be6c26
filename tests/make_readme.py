# SPDX-License-Identifier: GPL-2.0-or-later
"""Make what README.md shows: its pictures and its tables.

``.venv/bin/python tests/make_readme.py`` paints tests/images/readme/*.png and writes the
tables between the marks in README.md.  Everything is measured and painted anew; the
sources are the bundled pictures, the settings and the docstrings of the modules.
"""

from __future__ import annotations

import ast
import io
import re
import subprocess
import sys
import tempfile
from dataclasses import fields, replace
from pathlib import Path
from statistics import median

import browser
from PIL import Image
from readme_paint import beside, enlarge, nodes, paint, save
from readme_strips import STRIPS, strip

from ddtcore import TraceOptions, compare, load_image, trace
from ddtcore.options import PRESETS, PURPOSES
from ddtcore.report import report
from ddtcore.svg import encoded, group

ROOT = Path(__file__).resolve().parent.parent
README = ROOT / "README.md"
IMAGES = ROOT / "tests" / "images"
CRISP = sorted((IMAGES / "crisp").glob("*.png"))

PAPER_ROWS = {"Donald Duck": (1740, 85577, 139, 56), "Pumba": (4470, 233179, 129, 48),
              "Information": (233, 11293, 9, 4), "Goofy": (832, 39940, 53, 22)}
"""Table 1 of the paper: bitmap, DDT, curves, SVGZ in kilobytes."""

ROOMS = {
    "the whole": "pipeline model options choice budget reduction parts",
    "from outside": "__init__ __main__ cli files progress report compare inkscape",
    "picture in": "raster sprites ink enlarged resampling",
    "pixels to regions": "regions known canvas palette noise calm ringing bleeding mixes sides ridges strokes"
                         " strokeinks narrow spots patches filling residue margins ramps surfaces growing spans"
                         " detached overlays glazes shades astride hairlines scraps uneven unsteady regained dither"
                         " banded exact hatching posterise threshold areas merging components",
    "mesh": "triangulation quads cost ribbon flips",
    "outlines": "border outline splinters position flatten unblur staircase lattice",
    "curves": "fit runs corner segments arclength cubic polish newton coverage quadratic bezier",
    "paint": "paint members gradient samples field parallels stops knots prolonged tint bands recolour swatches"
             " perception",
    "drawing out": "stacking order sorting loops doors rankmap underlap shortcut grouping svg pathdata",
}
"""Modules of ddtcore in the order of reading; new ones appear at the end until they are named here."""


# -- pictures ---------------------------------------------------------------------

def traced(picture, preset="clip-art", **changes):
    """A trace with coordinates fine enough to be enlarged."""
    drawing = trace(load_image(picture), TraceOptions.preset(preset, **changes))
    return replace(drawing, decimals=3)


def make_poster():
    """A document with a bitmap, and with its trace in place of it."""
    document = ROOT / "tests" / "documents" / "poster.svg"
    command = [sys.executable, ROOT / "ddt_trace.py", "--id=glasses", "--source=remove", document]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE)
    box = (70, 60, 180, 100)
    save(beside([paint(svg.decode(), box, 3, folder=document.parent)
                 for svg in (document.read_bytes(), done.stdout)]), "poster")


def make_comparison():
    """The page of ``compare`` in a browser, with nodes; nothing where there is no browser."""
    if not browser.command():
        return
    with tempfile.TemporaryDirectory() as folder, browser.Browser(1080, 690) as window:
        page = Path(folder) / "page.html"
        dinosaur = load_image(IMAGES / "stegosaurus.png")
        page.write_text(compare.compare(dinosaur, name="stegosaurus.png"), encoding="utf-8")
        window.open(page)
        window.click("#close")
        window.press("5", *"[" * 10)
        window.value("document.activeElement.blur()")
        window.settle()
        with Image.open(io.BytesIO(window.shot())) as shot:
            save(shot.convert("RGB"), "compare")


def make_pictures():
    """Paint all pictures of the README."""
    dinosaur = IMAGES / "stegosaurus.png"
    whole, detail = (0, 0, 256, 156), (158, 12, 64, 39)
    drawing = traced(dinosaur)
    save(beside([enlarge(dinosaur, whole, 2), paint(group(drawing), whole, 2)],
                [enlarge(dinosaur, detail, 8), paint(group(drawing), detail, 8)]), "before-after")

    details = [(IMAGES / "doctor.png", (16, 2, 51, 51), 6),
               (IMAGES / "sunglasses.png", (150, 4, 102, 102), 3),
               (IMAGES / "crisp" / "arms.png", (376, 443, 102, 102), 3)]
    save(beside([enlarge(*detail) for detail in details],
                [paint(group(traced(picture)), box, zoom) for picture, box, zoom in details]), "details")

    zoom = 8
    for result in ("triangles", "border"):
        save(paint(group(traced(dinosaur, result=result, flips="everywhere")), detail, zoom), result)
    for result in ("outlines", "curves"):
        # Shapes that are cut out have nodes where they are seen, and nowhere under others.
        marks = nodes(traced(dinosaur, result=result, stacking="cutout"), zoom)
        save(paint(group(traced(dinosaur, result=result)) + marks, detail, zoom), result)

    butterfly, wing = IMAGES / "crisp" / "butterfly.png", (716, 74, 176, 110)
    save(beside([enlarge(butterfly, wing, 3), paint(group(traced(butterfly)), wing, 3)]), "butterfly")
    make_poster()
    make_comparison()
    for name in STRIPS:
        save(strip(name), f"setting-{name}", colours=256)

    crisp, close = IMAGES / "crisp" / "stegosaurus.png", (28, 350, 82, 72)
    save(beside([enlarge(crisp, close, 4)] + [paint(group(traced(crisp, preset)), close, 4)
                                              for preset in ("paper", "clip-art")]), "paper-and-default")


# -- tables -----------------------------------------------------------------------

def table(head, rows, numbers=False):
    """A table in Markdown; with numbers, all columns but the first are aligned to the right."""
    rule = ["---", *["---:" if numbers else "---"] * (len(head) - 1)]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in [head, rule, *rows])


def figures_of(picture):
    """A row of `ratios_table`: kilobytes and ratios with the preset `paper`, kilobytes by default."""
    image = load_image(picture)
    paper = report(image, TraceOptions.preset("paper"))
    default = sum(map(len, encoded(trace(image))))
    sizes = [size / 1000 for size in (paper.bmp, paper.ddt_svg, paper.svg, paper.svgz)]
    return [*sizes, paper.bmp / paper.svg, paper.ddt_svg / paper.svgz, default / 1000]


def ratios_table():
    """The paper's Table 1: our pictures with the preset `paper`, then the paper's own."""
    digits = (0, 0, 1, 1, 1, 0, 1)
    figures = {picture.stem: figures_of(picture) for picture in CRISP}
    rows = [[name, *(f"{value:,.{n}f}" for value, n in zip(row, digits))]
            for name, row in figures.items()]
    middle = [median(row[k] for row in figures.values()) for k in (4, 5)]
    rows.append(["*median*", "", "", "", "", f"{middle[0]:.1f}", f"{middle[1]:,.0f}", ""])
    for name, (bmp, ddt, svg, svgz) in PAPER_ROWS.items():
        rows.append([f"{name} (paper)", f"{bmp:,}", f"{ddt:,}", svg, svgz,
                     f"{bmp / svg:.1f}", f"{ddt / svgz:,.0f}", ""])
    head = ["picture", "BMP", "DDT SVG", "SVG", "SVGZ", "BMP / SVG", "DDT SVG / SVGZ",
            "SVG, default settings"]
    return table(head, rows, numbers=True)


def settings_table():
    """All settings with their ranges and defaults."""
    rows = []
    for setting in fields(TraceOptions):
        meta = setting.metadata
        values = ", ".join(f"`{choice}`" for choice in meta["choices"])
        if meta["low"] is None and not values:
            values = "text"
        elif not values:
            values = f"{meta['low']:,.15g} to {meta['high']:,.15g} {meta['unit']}".rstrip()
        default = setting.default if isinstance(setting.default, str) else f"{setting.default:,.15g}"
        rows.append([f"`--{setting.name}`", meta["help"], values, f"`{default}`" if default else "none"])
    return table(["setting", "what it says", "values", "default"], rows)


def presets_table():
    """What each preset is for, and its settings that differ from the defaults."""
    rows = []
    for name, changes in PRESETS.items():
        flags = ", ".join(f"`--{key} {value}`" for key, value in changes.items())
        rows.append([f"`{name}`", PURPOSES[name], flags or "the defaults"])
    rows[0][2] = "what the chosen one sets"
    return table(["preset", "for", "what it sets"], rows)


def rooms_table():
    """Each module of ddtcore with the first line of its docstring."""
    modules = {path.stem: path for path in (ROOT / "ddtcore").glob("*.py")}
    modules.update({path.parent.name: path for path in (ROOT / "ddtcore").glob("*/__init__.py")})
    groups = {title: names.split() for title, names in ROOMS.items()}
    named = {name for names in groups.values() for name in names}
    groups["more"] = sorted(set(modules) - named)
    lines = []
    for title, names in groups.items():
        present = [name for name in names if name in modules]
        if present:
            lines.append(f"\n{title}")
            lines += [f"  {_shown(modules[name]):<18}{_first_line(modules[name])}" for name in present]
    return "```text" + "\n".join(lines) + "\n```"


def _shown(path):
    is_folder = path.name == "__init__.py" and path.parent.name != "ddtcore"
    return f"{path.parent.name}/" if is_folder else path.name


def _first_line(path):
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    return text.splitlines()[0].rstrip(".")


def speed_table():
    """The figures that ``make bench`` measured last when it was told to keep them."""
    sys.path.insert(0, str(ROOT / "tests" / "benchmark"))
    import speed

    return speed.readme_text()


TABLES = {"ratios": ratios_table, "speed": speed_table, "settings": settings_table, "presets": presets_table,
          "rooms": rooms_table}


def with_table(text, name, content):
    """The README with other content between the marks of a table."""
    parts = re.split(rf"(<!-- {name}: [^>]*-->\n).*?(<!-- end -->)", text, flags=re.DOTALL)
    if len(parts) != 4:
        raise ValueError(f"README.md must have one place for the table {name!r}")
    before, begin, end, after = parts
    return f"{before}{begin}{content}\n{end}{after}"


def with_tables(text, names=tuple(TABLES)):
    """The README with some of its tables made anew."""
    for name in names:
        text = with_table(text, name, TABLES[name]())
    return text


if __name__ == "__main__":
    make_pictures()
    README.write_text(with_tables(README.read_text(encoding="utf-8")), encoding="utf-8")
