# SPDX-License-Identifier: GPL-2.0-or-later
"""Numbers are sorted with their order, whether they can be packed with it or not."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.sorting import sorted_with_order


@pytest.mark.parametrize("dtype", [np.int32, np.int64, np.uint16])
@pytest.mark.parametrize("span", [1, 2, 300, 1 << 40, 1 << 62])
@pytest.mark.parametrize("count", [0, 1, 2, 1000])
def test_equal_numbers_keep_their_order(count, span, dtype):
    keys = np.random.RandomState(count).randint(0, min(span, 300), count).astype(dtype)
    keys[:1] = min(span - 1, np.iinfo(dtype).max)
    values, order = sorted_with_order(keys, span)
    expected = np.argsort(keys, kind="stable")
    np.testing.assert_array_equal(order, expected)
    np.testing.assert_array_equal(values, keys[expected])
    assert values.dtype == np.int64
