# SPDX-License-Identifier: GPL-2.0-or-later
"""The measurement beside other tracers: its measures, and the tracers that need no installation."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image, ImageFilter

sys.path.insert(0, str(Path(__file__).resolve().parent / "benchmark"))

import compare_tracers

SIGN = next(path for path in compare_tracers.DRAWINGS if path.stem == "sign")


@pytest.fixture(scope="module")
def bitmap():
    return compare_tracers.bitmap_of(SIGN)


def test_bitmap_and_truth_show_the_same(bitmap):
    small, large = bitmap
    assert max(small.shape) == compare_tracers.SIZE
    assert large.shape[:2] == tuple(compare_tracers.SCALE * side for side in small.shape[:2])
    shrunk = Image.fromarray(large).resize(small.shape[1::-1], Image.BOX)
    assert compare_tracers.psnr(np.asarray(shrunk), small) > 40


def test_measures_are_best_for_the_truth_and_fall_with_blur(bitmap):
    small, _ = bitmap
    image = Image.fromarray(small)
    blurred = [np.asarray(image.filter(ImageFilter.GaussianBlur(radius))) for radius in (0, 1, 3)]
    for measure in (compare_tracers.psnr, compare_tracers.ssim):
        values = [measure(other, small) for other in blurred]
        assert values[0] > values[1] > values[2]
    assert compare_tracers.psnr(small, small) == 99 and compare_tracers.ssim(small, small) == pytest.approx(1)
    noisy = np.clip(small.astype(int) + 10 * (-1) ** np.arange(small.shape[1])[:, np.newaxis], 0, 255)
    grey = np.full_like(small, 100)
    assert compare_tracers.psnr(grey, grey + 10) == pytest.approx(28.13, abs=.01)
    assert compare_tracers.ssim(noisy.astype(np.uint8), small) < .99


@pytest.mark.parametrize("data, count", [
    ("M0 0h4v2.5H0z", 3), ("M0 0L1 1 2 2 3 3", 3), ("M0 0 1 1 2 0z", 2), ("M0 0c1 1 2 2 3 3-1-1 2 2 3 3", 2),
    ("m0,0 c.5.5.6.6.7.7s1e1 2 3 4", 2), ("M0 0q1 1 2 0t2 0 2 0m1 1l1 1", 4)])
def test_nodes_are_counted(data, count):
    svg = f'<svg xmlns="http://www.w3.org/2000/svg"><path d="{data}"/></svg>'
    assert compare_tracers.nodes(svg.encode()) == count


@pytest.mark.parametrize("name, least", [("DDT Trace", 30), ("potrace, stacked", 20)])
def test_tracers_trace(bitmap, tmp_path, name, least):
    if name.startswith("potrace") and not shutil.which("potrace"):
        pytest.skip("potrace is not installed")
    small, large = bitmap
    picture, result = tmp_path / "sign.png", tmp_path / "sign.svg"
    Image.fromarray(small).save(picture)
    compare_tracers.tracers()[name](picture, result)
    figures = compare_tracers.measure(result.read_bytes(), large, 1.0)
    assert figures["PSNR"] > least and figures["SSIM"] > .9 and 10 < figures["nodes"] < 2000
