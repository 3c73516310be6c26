# SPDX-License-Identifier: GPL-2.0-or-later
"""A strict reader of path data in exact arithmetic, to check what the project writes."""

from __future__ import annotations

import re
from fractions import Fraction

COUNTS = {"m": 2, "l": 2, "h": 1, "v": 1, "c": 6, "s": 4, "q": 4, "t": 2, "z": 0}
_TOKEN = re.compile(r"([MmLlHhVvCcSsQqTtZz])|([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)|[ ,\n]+")


def commands(data):
    """Pairs of (letter, numbers), repeated commands spelled out."""
    found = []
    end = 0
    for match in _TOKEN.finditer(data):
        assert match.start() == end, f"unreadable: {data[end:match.start()]!r}"
        end = match.end()
        if match.group(1):
            found.append((match.group(1), []))
        elif match.group(2):
            found[-1][1].append(Fraction(match.group(2)))
    assert end == len(data), f"unreadable: {data[end:]!r}"
    for letter, numbers in found:
        count = COUNTS[letter.lower()]
        assert (len(numbers) % count == 0 and numbers) if count else not numbers, (letter, numbers)
        for k in range(0, max(len(numbers), 1), max(count, 1)):
            yield letter, numbers[k:k + count]
            letter = {"m": "l", "M": "L"}.get(letter, letter)


def parse(data):
    """Closed loops as lists of segments; a segment is a list of two, three or four points."""
    loops = []
    here = start = (Fraction(0), Fraction(0))
    closed = True
    last_cubic = last_quadratic = None
    for letter, numbers in commands(data):
        base = here if letter.islower() else (0, 0)
        kind = letter.lower()
        if kind == "h":
            points = [(base[0] + numbers[0], here[1])]
        elif kind == "v":
            points = [(here[0], base[1] + numbers[0])]
        else:
            points = [(base[0] + x, base[1] + y) for x, y in zip(numbers[::2], numbers[1::2])]
        if kind == "m":
            assert closed, "a loop isn't closed"
            start, closed = points[0], False
            loops.append([])
        elif kind == "z":
            points, closed = [start], True
            if here != start:
                loops[-1].append([here, start])
        else:
            assert not closed, "a segment without a move"
            if kind == "s":
                points.insert(0, _mirror(last_cubic, here))
            if kind == "t":
                points.insert(0, _mirror(last_quadratic, here))
            loops[-1].append([here, *points])
        last_cubic = points[1] if kind in "cs" else None
        last_quadratic = points[0] if kind in "qt" else None
        here = points[-1]
    assert closed, "the last loop isn't closed"
    return loops


def _mirror(handle, here):
    return here if handle is None else (2 * here[0] - handle[0], 2 * here[1] - handle[1])
