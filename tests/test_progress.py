# SPDX-License-Identifier: GPL-2.0-or-later
"""The line that shows how far a trace is, and the times of the stages."""

from __future__ import annotations

import io
import json
import sys
import time

from ddtcore.progress import Lap, ProgressLine, Stopwatch, peak_memory


def seen(text):
    """What a terminal shows after some text with carriage returns."""
    line = []
    for run in text.split("\r"):
        line[:len(run)] = run
    return "".join(line)


def test_each_text_replaces_the_one_before():
    stream = io.StringIO()
    line = ProgressLine(stream)
    for text in ("picture.png: colours", "a longer text than that one", "short", "curves, 40%"):
        line.show(text)
        assert seen(stream.getvalue()).rstrip() == text
    line.clear()
    assert seen(stream.getvalue()).strip() == "" and stream.getvalue().endswith("\r")


def test_nothing_is_written_where_nothing_was_shown():
    stream = io.StringIO()
    line = ProgressLine(stream)
    line.clear()
    assert stream.getvalue() == ""
    line.show("x")
    line.clear()
    before = stream.getvalue()
    line.clear()
    assert stream.getvalue() == before


def test_a_line_never_wraps():
    stream = io.StringIO()
    line = ProgressLine(stream)
    line.show("folder/" * 40 + "a.png: curves, 40%")
    shown = seen(stream.getvalue())
    assert len(shown) == 79 and shown.endswith("a.png: curves, 40%")


def test_every_stage_is_timed_until_the_next_one_begins():
    watch = Stopwatch()
    began = time.perf_counter()
    for stage, seconds in (("one", 0.02), ("two", 0.05)):
        watch(stage, 0.5)
        time.sleep(seconds)
    watch.stop()
    took = time.perf_counter() - began
    assert [lap.stage for lap in watch.laps] == ["one", "two"]
    assert watch.laps[0].seconds >= 0.02 and watch.laps[1].seconds >= 0.05
    assert sum(lap.seconds for lap in watch.laps) <= took


def test_no_time_is_lost_between_two_stages(monkeypatch):
    # A clock of our own: on a busy machine anything may pass between two looks at the real one.
    moments = iter((10.0, 10.25, 11.0, 14.5))
    monkeypatch.setattr(time, "perf_counter", lambda: next(moments))
    watch = Stopwatch()
    for stage in ("one", "two", "three"):
        watch(stage, 0.5)
    watch.stop()
    assert [(lap.stage, lap.seconds) for lap in watch.laps] == [("one", 0.25), ("two", 0.75), ("three", 3.5)]


def test_laps_as_table_and_for_programs():
    watch = Stopwatch()
    watch.laps += [Lap("colours", 1.25, 300.0), Lap("curves", 0.5, 410.0)]
    rows = [line.split() for line in watch.to_text().splitlines()]
    assert rows == [["colours", "1.250", "s", "300", "MB"], ["curves", "0.500", "s", "410", "MB"],
                    ["in", "all", "1.750", "s", "410", "MB"]]
    assert json.loads(json.dumps(watch.to_dicts())) == [
        {"stage": "colours", "seconds": 1.25, "peak_mb": 300.0}, {"stage": "curves", "seconds": 0.5, "peak_mb": 410.0}]


def test_peak_memory_is_that_of_this_process(monkeypatch):
    before = peak_memory()
    if sys.platform != "win32":
        assert 5 < before < 100_000
    held = bytearray(200_000_000)
    assert len(held) and (peak_memory() >= 200 or sys.platform == "win32")
    assert peak_memory() >= before
    monkeypatch.setitem(sys.modules, "resource", None)
    assert peak_memory() == 0
