# SPDX-License-Identifier: GPL-2.0-or-later
"""Picture files to drawing files, alone and many together."""

from __future__ import annotations

import os
import pickle
import signal
import sys
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from PIL import Image

import ddtcore
from ddtcore import ImageError, TraceOptions, load_image, trace, trace_file
from ddtcore.files import Job, default_target, run_all
from ddtcore.pipeline import STAGES


@pytest.fixture
def pictures(tmp_path):
    """Six small pictures, each different."""
    paths = []
    for k in range(6):
        pixels = np.full((8, 12, 3), 255, dtype=np.uint8)
        pixels[2:6, 2:5 + k] = (30 * k, 40, 50)
        paths.append(str(tmp_path / f"picture{k}.png"))
        Image.fromarray(pixels).save(paths[-1])
    return paths


def jobs_for(pictures, **settings):
    return [Job(path, default_target(path), TraceOptions(**settings)) for path in pictures]


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def test_trace_file_is_load_trace_save(pictures):
    for options in (None, TraceOptions(decimals=1, result="outlines")):
        written = trace_file(pictures[0], options=options)
        assert written == pictures[0][:-4] + ".svg"
        assert text_of(written) == trace(load_image(pictures[0]), options).to_svg()


def test_trace_file_writes_where_it_is_told(pictures, tmp_path):
    out = tmp_path / "drawing.svgz"
    assert trace_file(pictures[0], out) == str(out)
    with open(out, "rb") as file:
        assert file.read(2) == b"\x1f\x8b"


def test_trace_file_can_be_sent_to_other_processes(pictures):
    assert pickle.loads(pickle.dumps(trace_file)) is trace_file
    with ProcessPoolExecutor(2) as pool:
        written = list(pool.map(ddtcore.trace_file, pictures[:3]))
    assert written == [path[:-4] + ".svg" for path in pictures[:3]]


def test_trace_file_raises(pictures, tmp_path):
    with pytest.raises(ImageError, match="missing"):
        trace_file(tmp_path / "missing.png")
    with pytest.raises(OSError):
        trace_file(pictures[0], tmp_path / "no folder" / "a.svg")


def test_picture_is_never_overwritten(pictures, tmp_path):
    disguised = tmp_path / "picture.svg"
    os.rename(pictures[0], disguised)
    before = disguised.read_bytes()
    with pytest.raises(ImageError, match="the picture itself"):
        trace_file(disguised)
    assert disguised.read_bytes() == before


@pytest.mark.parametrize("source, folder, target", [
    ("a.png", None, "a.svg"), ("b/a.tar.png", None, "b/a.tar.svg"), ("b/a", None, "b/a.svg"),
    ("b/a.png", "c", os.path.join("c", "a.svg")), ("b/.png", "c", os.path.join("c", ".png.svg"))])
def test_default_target(source, folder, target):
    assert default_target(source, folder) == target


@pytest.mark.parametrize("workers", (1, 3, 0))
def test_same_bytes_and_order_whatever_the_number_of_workers(pictures, workers):
    outcomes = list(run_all(jobs_for(pictures), workers))
    assert [outcome.job.source for outcome in outcomes] == pictures
    assert all(outcome.error == "" for outcome in outcomes)
    for path in pictures:
        assert text_of(default_target(path)) == trace(load_image(path)).to_svg()


@pytest.mark.parametrize("workers", (1, 2))
def test_a_bad_picture_costs_no_other(pictures, workers):
    with open(pictures[2], "wb") as file:
        file.write(b"no picture")
    os.remove(pictures[4])
    errors = [outcome.error for outcome in run_all(jobs_for(pictures), workers)]
    assert [bool(error) for error in errors] == [False, False, True, False, True, False]
    assert "picture2.png" in errors[2] and "picture4.png" in errors[4]
    assert [os.path.exists(default_target(path)) for path in pictures] == [not error for error in errors]


def attempt_or_die(job):
    """Stands in for the tracing of a picture, which kills the worker where the picture is number 1 or 4."""
    if job.source[-5] in "14":
        os.kill(os.getpid(), signal.SIGKILL)
    return ddtcore.files.Outcome(job)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
@pytest.mark.parametrize("workers", (2, 5))
def test_a_killed_worker_costs_its_picture_and_no_other(pictures, workers, monkeypatch):
    monkeypatch.setattr(ddtcore.files, "_attempt", attempt_or_die)
    errors = {outcome.job.source: outcome.error for outcome in run_all(jobs_for(pictures), workers)}
    assert set(errors) == set(pictures)
    assert [path for path in pictures if errors[path]] == [pictures[1], pictures[4]]
    assert "was killed" in errors[pictures[1]]


@pytest.mark.parametrize("fault, said", [
    (RuntimeError("first line\nsecond line"), "unexpected RuntimeError: first line second line"),
    (MemoryError(), "more memory than there is"),
    (OSError(28, "No space left on device"), "can't be written: No space")])
def test_whatever_goes_wrong_becomes_one_line(pictures, monkeypatch, fault, said):
    def fail(*arguments):
        raise fault

    monkeypatch.setattr("ddtcore.svg.save", fail)
    outcome, = run_all(jobs_for(pictures[:1]))
    assert said in outcome.error and "picture0" in outcome.error and "\n" not in outcome.error


def test_stages_are_told_with_a_share_that_grows(pictures):
    told = []
    jobs = jobs_for(pictures[:2])
    assert not any(outcome.error for outcome in run_all(jobs, 1, lambda *what: told.append(what)))
    for job in jobs:
        stages = [(stage, share) for whose, stage, share in told if whose is job]
        assert [stage for stage, _ in stages] == ["start", "reading", *STAGES, "writing"]
        shares = [share for _, share in stages]
        assert shares == sorted(shares) and shares[0] == 0 and shares[-1] < 1


def test_no_jobs_are_no_work():
    assert list(run_all([], 0)) == []
