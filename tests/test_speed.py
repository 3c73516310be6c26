# SPDX-License-Identifier: GPL-2.0-or-later
"""The measurement of speed: what it counts, and the tables it makes of that."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parent / "benchmark"))

import speed
from PIL import Image

from ddtcore.pipeline import STAGES


def rows_of(exponent, names=("DDT Trace", "vtracer")):
    """Figures that grow with a power of the size."""
    rows = []
    for drawing, times in (("a", 1.0), ("b", 1.5), ("c", 9.0)):
        for size in (0.25, 1.0, 4.0, 16.0):
            seconds = times * size ** exponent
            stages = [{"stage": "reading", "seconds": 0.001, "peak_mb": 40.0},
                      {"stage": "curves", "seconds": seconds, "peak_mb": 100 * size}]
            rows.append({"drawing": drawing, "megapixels": size, "stages": stages,
                         "seconds": {name: seconds * (k + 1) for k, name in enumerate(names)}})
    return rows


def cells(table):
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]


@pytest.mark.parametrize("exponent", (0.5, 1.0, 1.7))
def test_growth_is_the_exponent(exponent):
    sizes = [1, 4, 9, 16]
    assert speed.growth(sizes, [3 * size ** exponent for size in sizes]) == pytest.approx(exponent)


def test_table_of_sizes():
    head, _, *body = cells(speed.sizes_table(rows_of(1.0)))
    assert head == ["million pixels", "DDT Trace, s", "vtracer, s", "times vtracer", "peak memory, MB"]
    assert body[1] == ["1", "1.50", "3.00", "0.5", "100"]
    assert [row[0] for row in body] == ["0.25", "1", "4", "16"]


def test_table_of_sizes_with_others_that_failed():
    rows = rows_of(1.0)
    for row in rows:
        if row["megapixels"] > 1:
            del row["seconds"]["vtracer"]
    *_, last = cells(speed.sizes_table(rows))
    assert last == ["16", "24.00", "-", "-", "1,600"]


def test_table_of_stages():
    head, _, *body = cells(speed.stages_table(rows_of(0.5)))
    assert head == ["stage", "0.25 MP, s", "1 MP, s", "4 MP, s", "16 MP, s", "growth"]
    assert body[0] == ["reading", "0.00", "0.00", "0.00", "0.00", ""]
    assert body[1] == ["curves", "0.75", "1.50", "3.00", "6.00", "0.50"]
    assert body[2][0] == "in all" and body[2][-1] == "0.50"


def test_pictures_have_the_size_that_is_asked_for(tmp_path):
    speed.render("lens", 0.02, tmp_path / "a.png")
    with Image.open(tmp_path / "a.png") as image:
        assert image.width * image.height == pytest.approx(20_000, rel=0.02)


def test_tracers_are_run_and_those_that_fail_are_left_out():
    found = {"DDT Trace": speed.tracers()["DDT Trace"], "broken": [sys.executable, "-c", "raise SystemExit(3)"]}
    rows = speed.measure(found, drawings=("lens",), sizes=(0.02, 0.01), runs=1)
    assert [row["megapixels"] for row in rows] == [0.01, 0.02]
    for row in rows:
        assert set(row["seconds"]) == {"DDT Trace"} and row["seconds"]["DDT Trace"] > 0.05
        assert [stage["stage"] for stage in row["stages"]] == ["start", "reading", *STAGES, "writing"]
        assert sum(stage["seconds"] for stage in row["stages"]) <= row["seconds"]["DDT Trace"]


def test_figures_that_were_kept_make_tables():
    kept = json.loads(speed.FIGURES.read_text(encoding="utf-8"))
    assert {row["drawing"] for row in kept["rows"]} == set(speed.DRAWINGS)
    text = speed.readme_text()
    assert kept["machine"] in text and text.count("| stage |") == 1
    head, _, *body = cells(text.split("\n\n")[0])
    assert "DDT Trace, s" in head and [float(row[0]) for row in body] == list(speed.SIZES)
