# SPDX-License-Identifier: GPL-2.0-or-later
"""Work in parts: the same result with any number of threads, and no fault is lost."""

from __future__ import annotations

import signal
import threading

import numpy as np
import pytest
from pictures import picture, star

from ddtcore import files, parts, trace
from ddtcore.parts import LEAST, LEAST_ROWS, MOST, in_parts


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


def ramped(size=110):
    """A disc on a soft ramp."""
    down, across = np.mgrid[:size, :size]
    out = np.full((size, size, 4), 255, np.uint8)
    out[..., 0], out[..., 1] = across, 255 - down
    out[np.hypot(down - 60, across - 50) < 25, :3] = 20, 30, 200
    return out


@pytest.mark.parametrize("art", [
    picture(120, 100, [star((60, 50), 44, 25, 9, 3), star((60, 50), 20, 12, 7, 8)]).image, ramped(),
    np.repeat(np.random.RandomState(5).randint(0, 256, (90, 80, 1)).astype(np.uint8), 4, axis=2)],
    ids=["flat", "ramp", "noise"])
def test_drawings_are_the_same_with_any_number_of_threads_and_parts(art, monkeypatch):
    drawings = []
    for threads, least, rows, most in ((1, LEAST, LEAST_ROWS, MOST), (1, 100, 100, 700), (2, 100, 100, 1 << 20),
                                       (4, 100, 100, 90), (4, 100, 1000, 3000)):
        for name, value in (("LEAST", least), ("LEAST_ROWS", rows), ("MOST", most)):
            monkeypatch.setattr(parts, name, value)
        parts.limit_threads(threads)
        drawings.append(trace(art).to_svg())
    assert all(drawing == drawings[0] for drawing in drawings)


@pytest.mark.parametrize("rows", [1, 7, 900, 3000])
def test_rows_come_once_and_in_order(rows):
    parts.limit_threads(3)
    sizes = []

    def work(part):
        sizes.append(part.stop - part.start)
        return (np.arange(part.start, part.stop),)

    numbers, = in_parts(work, rows, size=2000)
    assert np.array_equal(numbers, np.arange(rows))
    assert max(sizes) * 2000 <= MOST or len(sizes) == rows
    assert len(sizes) == 1 or rows * 2000 > LEAST_ROWS


def test_parts_are_not_parted_among_threads_again():
    parts.limit_threads(2)
    names = set()

    def inner(part):
        names.add((threading.current_thread(), part.start))
        return (np.zeros(part.stop - part.start),)

    def outer(part):
        in_parts(inner, 4 * LEAST)
        return (np.zeros(part.stop - part.start),)

    in_parts(outer, 4 * LEAST)
    assert len({thread for thread, _ in names}) == 2 and {start for _, start in names} == {0}
    assert parts._threads() == 2


def test_workers_of_a_batch_use_one_thread(monkeypatch):
    monkeypatch.setattr(signal, "signal", lambda number, handler: None)
    files._settle_worker()
    assert parts._threads() == 1
