# SPDX-License-Identifier: GPL-2.0-or-later
"""Work on many pixels or points in parts, on all processors at hand.

numpy lets other threads run while it works on an array, so threads are enough.  What each
part gives doesn't depend on the others: results are the same, however many there are.
"""

from __future__ import annotations

import os
import threading
from typing import Callable, List, Tuple

import numpy as np

LEAST, LEAST_ROWS = 1 << 14, 1 << 20
"""Fewest pixels of a part, and of one that is rows, for which less is to be done per pixel: threads would take
longer than less work does."""

MOST = 1 << 20
"""Most pixels of a part, which bounds the memory that its work needs."""

THREADS = 4
"""Most threads: beyond that memory is what they wait for."""

_limit: List[int] = []
_busy = threading.local()
"""Whether a thread does a part already, which is not to be done in parts again."""


def limit_threads(count: int) -> None:
    """Use at most `count` threads in this process from now on."""
    _limit[:] = [count]


def _threads() -> int:
    """How many threads there may be for work that begins now."""
    if getattr(_busy, "now", False):
        return 1
    if not _limit:
        here = getattr(os, "sched_getaffinity", None)
        limit_threads(min(THREADS, len(here(0)) if here else os.cpu_count() or 1))
    return _limit[0]


def in_parts(work: Callable[[slice], Tuple[np.ndarray, ...]], count: int, axis: int = 0,
             size: int = 1) -> Tuple[np.ndarray, ...]:
    """Do work on parts of some items, and join what it gives.

    Parameters
    ----------
    work : callable
        ``work(part)`` returns arrays for the items in a slice.
    count : int
        Number of items.
    axis : int
        That of the items in these arrays.
    size : int
        Pixels of an item, where items are rows.

    Returns
    -------
    tuple of ndarray
    """
    threads = max(min(_threads(), count * size // (LEAST if size == 1 else LEAST_ROWS), count), 1)
    number = max(threads, min(-(-count * size // MOST), count))
    ends = [count * k // number for k in range(number + 1)]
    parts = [slice(*pair) for pair in zip(ends, ends[1:])]
    if number == 1:
        return work(parts[0])
    results = _done(work, parts, threads)
    return tuple(np.concatenate(arrays, axis=axis) for arrays in zip(*results))


def _done(work: Callable[[slice], Tuple[np.ndarray, ...]], parts: List[slice],
          threads: int) -> List[Tuple[np.ndarray, ...]]:
    """What work gives for each part; each thread takes every n-th."""
    results: List[Tuple[np.ndarray, ...]] = [()] * len(parts)
    faults: List[BaseException] = []

    def run(first: int) -> None:
        _busy.now = True
        try:
            for k in range(first, len(parts), threads):
                results[k] = work(parts[k])
        except BaseException as error:  # Told to who waits.
            faults.append(error)
        finally:
            _busy.now = False

    others = [threading.Thread(target=run, args=(k,), daemon=True) for k in range(1, threads)]
    for thread in others:
        thread.start()
    run(0)
    for thread in others:
        thread.join()
    if faults:
        raise faults[0]
    return results
