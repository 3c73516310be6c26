# SPDX-License-Identifier: GPL-2.0-or-later
"""Lines enlarged as Pillow does it, and made small again."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.resampling import FILTERS, enlarging, shrinking

Image = pytest.importorskip("PIL.Image")

PILLOW = {"linear": Image.BILINEAR, "cubic": Image.BICUBIC, "lanczos": Image.LANCZOS}
SIZES = [(64, 128), (100, 150), (101, 151), (97, 146), (50, 150), (131, 197)]


def lines(size):
    rng = np.random.RandomState(size)
    levels = rng.randint(60, 196, (3, 5, size // 4 + 1)).repeat(4, axis=2)[:, :, :size]
    return levels.astype(np.float32)


@pytest.mark.parametrize("small, large", SIZES)
@pytest.mark.parametrize("name", PILLOW)
def test_lines_are_enlarged_as_by_pillow(name, small, large):
    given = lines(small)
    ours = enlarging(small, large, name)(given)
    theirs = [np.asarray(Image.fromarray(plane, "F").resize((large, len(plane)), PILLOW[name])) for plane in given]
    assert ours.shape == (3, 5, large)
    # Pillow leaves pixels beyond the ends out; here lines go on as they end.
    assert np.abs(ours - theirs)[:, :, 10:-10].max() < 0.01


@pytest.mark.parametrize("small, large", SIZES)
@pytest.mark.parametrize("name", FILTERS)
def test_enlarged_lines_are_made_small_again(name, small, large):
    given = lines(small)
    again = shrinking(small, large, name)(enlarging(small, large, name)(given))
    assert again.shape == given.shape
    assert np.abs(again - given).max() < 12 and np.sqrt(np.mean((again - given) ** 2)) < 2


@pytest.mark.parametrize("small, large", SIZES)
def test_flat_lines_stay_flat(small, large):
    for name in FILTERS:
        assert (enlarging(small, large, name)(np.full((1, 2, small), 77, np.float32)) == 77).all()
        assert (shrinking(small, large, name)(np.full((1, 2, large), 77, np.float32)) == 77).all()
