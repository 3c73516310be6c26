# SPDX-License-Identifier: GPL-2.0-or-later
"""Work in parts: the same result with any number of threads, and no fault is lost."""

from __future__ import annotations

import signal
import threading

import numpy as np
import pytest
from pictures import picture, star

from ddtcore import files, parts, trace
from ddtcore.parts import LEAST, MOST, in_parts


@pytest.fixture(autouse=True)
def restored(monkeypatch):
    monkeypatch.setattr(parts, "_limit", [])


@pytest.mark.parametrize("threads", [1, 2, 3, 4, 9])
@pytest.mark.parametrize("count", [0, 1, LEAST, 2 * LEAST - 1, 2 * LEAST, 5 * LEAST + 3, 2 * MOST + 1])
def test_items_come_once_and_in_order(threads, count):
    parts.limit_threads(threads)
    sizes = []

    def work(part):
        sizes.append(part.stop - part.start)
        numbers = np.arange(part.start, part.stop)
        return np.stack([numbers, 2 * numbers]), numbers[None]

    pairs, numbers = in_parts(work, count, axis=1)
    assert np.array_equal(numbers, np.arange(count)[None])
    assert np.array_equal(pairs, np.stack([np.arange(count), 2 * np.arange(count)]))
    assert sum(sizes) == count and max(sizes) <= MOST
    assert len(sizes) == 1 or min(sizes) >= LEAST


@pytest.mark.parametrize("where", [0, LEAST, 4 * LEAST - 1])
def test_a_fault_in_any_part_is_raised(where):
    parts.limit_threads(4)

    def work(part):
        if part.start <= where < part.stop:
            raise ZeroDivisionError(where)
        return (np.arange(part.start, part.stop),)

    with pytest.raises(ZeroDivisionError, match=str(where)):
        in_parts(work, 4 * LEAST)


def test_little_work_starts_no_threads(monkeypatch):
    monkeypatch.setattr(threading, "Thread", None)
    parts.limit_threads(4)
    assert in_parts(lambda part: (np.arange(part.start, part.stop),), 2 * LEAST - 1)[0].size == 2 * LEAST - 1


def test_drawings_are_the_same_with_any_number_of_threads(monkeypatch):
    monkeypatch.setattr(parts, "LEAST", 100)
    art = picture(120, 100, [star((60, 50), 44, 25, 9, 3), star((60, 50), 20, 12, 7, 8)]).image
    drawings = []
    for threads in (1, 2, 4):
        parts.limit_threads(threads)
        drawings.append(trace(art).to_svg())
    assert drawings[0] == drawings[1] == drawings[2]


def test_workers_of_a_batch_use_one_thread(monkeypatch):
    monkeypatch.setattr(signal, "signal", lambda number, handler: None)
    files._settle_worker()
    assert parts._threads() == 1
