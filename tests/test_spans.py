# SPDX-License-Identifier: GPL-2.0-or-later
"""Spans name the same pixels as a list of them all."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.spans import renumber, spans_of

AREAS = np.random.RandomState(6).randint(-1, 3, (17, 23)).repeat(3, axis=1).astype(np.int32)


@pytest.mark.parametrize("number", range(3))
def test_spans_have_the_pixels_of_their_area(number):
    spans = spans_of(AREAS, 3)[number]
    cells = np.flatnonzero(number == AREAS)
    assert spans.size == cells.size
    np.testing.assert_array_equal(spans.every(1), cells)
    np.testing.assert_array_equal(spans.every(7), cells[::7])
    row, col = np.divmod(cells, AREAS.shape[1])
    assert spans.window(AREAS.shape, 0) == (slice(row.min(), row.max() + 1), slice(col.min(), col.max() + 1))
    assert spans.window(AREAS.shape, 99) == (slice(0, AREAS.shape[0]), slice(0, AREAS.shape[1]))


def test_two_areas_come_one_after_the_other():
    one, _, other = spans_of(AREAS, 3)
    np.testing.assert_array_equal(one.and_those_of(other).every(1), np.append(one.every(1), other.every(1)))


def test_no_areas_have_no_spans():
    assert spans_of(np.full((4, 5), -1), 0) == []


def test_areas_are_renumbered_in_place():
    areas = AREAS.copy()
    renumber(areas, np.array([5, -1, 0, -1], np.int32))
    np.testing.assert_array_equal(areas, np.select([AREAS == 0, AREAS == 2], [5, 0], -1))
