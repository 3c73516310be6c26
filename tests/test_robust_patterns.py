# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures that are hard to trace: checkers, combs, spirals, rings, noise, ramps to the border, lines of pixels."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from invariants import assert_sound
from painted import render

from ddtcore import TraceOptions, trace

ROOT = Path(__file__).resolve().parent.parent
COLOURS = np.array([(255, 255, 255, 255), (0, 0, 0, 255), (220, 30, 40, 255)], np.uint8)
OPTIONS = {"stacked": TraceOptions(), "cutout": TraceOptions(stacking="cutout"),
           "paper": TraceOptions.preset("paper"), "automatic": None}
SECONDS = 20
"""Longest processor time of one trace; the slowest takes a fifteenth of it."""


def spiral(size):
    """A line one pixel wide, with gaps as wide, that winds to the middle."""
    out = np.zeros((size, size), int)
    row = col = out[0, 0] = 0
    step, lengths = (0, 1), [size - 1, *(k for k in range(size - 1, 0, -2) for _ in (0, 1))]
    for length in lengths:
        for _ in range(length):
            row, col = row + step[0], col + step[1]
            out[row, col] = 1
        step = step[1], -step[0]
    return out


def rings(size, distance):
    row, col = np.indices((size, size)) - size // 2
    return np.rint(distance(np.abs(row), np.abs(col))).astype(int) % 2


COMB = np.tile(np.arange(21) % 2, (12, 1))
LINE = (np.arange(10_000) % 7 > 2).astype(int)[None]
NOISE = np.random.RandomState(0)
PATTERNS = {
    "checkers": np.indices((24, 24)).sum(axis=0) % 2, "comb": COMB, "comb on its side": COMB.T,
    "comb with a back": np.pad(COMB, ((0, 6), (0, 0)), mode="constant", constant_values=1),
    "spiral": spiral(21), "squares": rings(21, np.maximum), "rings": rings(31, np.hypot),
    "noise": NOISE.randint(0, 2, (40, 40)), "noise of three": NOISE.randint(0, 3, (40, 40)),
    "row": LINE, "column": LINE.T, "row of ones": np.arange(2_000)[None] % 2}


def traced(image, options):
    """A drawing made in time."""
    begun = time.process_time()
    drawing = trace(image, options)
    assert time.process_time() - begun < SECONDS
    assert_sound(drawing)
    return drawing


@pytest.mark.parametrize("options", [pytest.param(options, id=name) for name, options in OPTIONS.items()])
@pytest.mark.parametrize("name", PATTERNS)
def test_each_colour_keeps_its_area(name, options):
    index = PATTERNS[name]
    points = render(traced(COLOURS[index], options), 2 if index.size > 5000 else 8, antialias=False)
    share = np.array([(points == colour).all(axis=2).mean() for colour in COLOURS])
    pixels = np.bincount(index.ravel(), minlength=3) / index.size
    # Where curves cross in one pixel, cut-out shapes leave a gap the width of a hair.
    assert (points[..., 3] == 255).mean() > 0.999
    within = 0.05 if options is OPTIONS["paper"] else 0.015
    assert np.abs(share - pixels).max() < (within if name == "noise of three" else 0.01)


RAMP = np.linspace(0, 255, 48)
RAMPS = {"across": np.tile(RAMP, (20, 1)), "down": np.tile(RAMP[:, None], (1, 20)),
         "diagonal": (RAMP + RAMP[:, None]) / 2, "round": 5 * np.hypot(*np.indices((48, 48)))}


@pytest.mark.parametrize("alpha", [False, True], ids=["opaque", "fading"])
@pytest.mark.parametrize("name", RAMPS)
def test_ramps_that_reach_the_border(name, alpha):
    level = np.clip(np.rint(RAMPS[name]), 0, 255).astype(np.uint8)
    full = np.full_like(level, 255)
    image = np.stack([full, level, full if alpha else level, level if alpha else full], axis=2)
    for options in OPTIONS.values():
        drawing = traced(image, options)
    back = render(trace(image, TraceOptions()), 1)
    assert np.abs(back - image)[..., 3].mean() < 3
    assert np.abs(back - image)[..., 1][level > 40].mean() < 4
    assert drawing.shapes


def test_noise_without_end_is_traced_in_bounded_time():
    """All colours, opaque or not."""
    for shape in ((48, 48), (1, 1000), (1000, 1), (100, 3)):
        image = np.random.RandomState(1).randint(0, 256, (*shape, 4)).astype(np.uint8)
        for options in OPTIONS.values():
            traced(image, options)


@pytest.mark.parametrize("name", ["rings", "noise of three"])
def test_bytes_do_not_depend_on_hashes_or_on_the_process(name, tmp_path):
    np.save(tmp_path / "picture.npy", COLOURS[PATTERNS[name]])
    code = ("import sys, numpy, ddtcore; sys.stdout.write(ddtcore.trace(numpy.load(sys.argv[1])).to_svg()"
            " + ddtcore.trace(numpy.load(sys.argv[1]), ddtcore.TraceOptions()).to_svg())")
    texts = {subprocess.run([sys.executable, "-c", code, str(tmp_path / "picture.npy")], cwd=ROOT, check=True,
                            stdout=subprocess.PIPE, env={**os.environ, "PYTHONHASHSEED": seed}).stdout
             for seed in ("0", "1", "4294967295")}
    here = "".join(trace(COLOURS[PATTERNS[name]], options).to_svg() for options in (None, TraceOptions()))
    assert texts == {here.encode()}
