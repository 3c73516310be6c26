# SPDX-License-Identifier: GPL-2.0-or-later
"""Splinters join what lies beside them; whole regions, and pictures without ripples, stay as they are."""

from __future__ import annotations

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from meshes import grey
from PIL import Image

from ddtcore import load_image, trace
from ddtcore.model import Labels
from ddtcore.options import TraceOptions
from ddtcore.outline import link_outlines
from ddtcore.splinters import SHARE, join_splinters
from ddtcore.triangulation import triangulate

SPECK = 24.0
AREA = int(SHARE * SPECK)

CAUGHT = ["0000001", "0000011", "0000101", "0000111", "0001111", "0011111", "0111111"]
"""A pixel of the left region among those of a stroke: both are connected over the corner between them."""


def labelled(rows, thin=1, speck=SPECK):
    """Labels from rows of digits; those of one of them are thin."""
    index = np.array([list(map(int, row)) for row in rows], np.int32)
    return Labels(index, np.zeros((index.max() + 1, 4)), index == thin, speck=speck)


def mapped(labels, image=None):
    image = grey(labels.index * 40) if image is None else image
    return link_outlines(triangulate(image, labels, TraceOptions()), labels)


def test_a_pixel_caught_by_a_stroke_joins_it():
    labels = labelled(CAUGHT)
    assert mapped(labels).face_areas[mapped(labels).pixel_faces[2, 5]] == 1
    joined = join_splinters(labels, mapped(labels))
    assert joined.index[2, 5] == 1
    assert np.count_nonzero(joined.index != labels.index) == 1
    assert len(mapped(joined).face_areas) == 3


def test_without_ripples_labels_stay():
    labels = labelled(CAUGHT, speck=0.0)
    assert join_splinters(labels, mapped(labels)) is labels


def test_a_dot_is_no_splinter():
    labels = labelled(["111111", "110111", "111111", "111000", "111000"])
    assert np.array_equal(join_splinters(labels, mapped(labels)).index, labels.index)


@pytest.mark.parametrize("area, stays", [(AREA - 1, False), (AREA, True)])
def test_larger_pieces_stay(area, stays):
    index = np.ones((AREA + 8, 8), np.int32)
    index[:4, :4] = 0
    index[4:4 + area, 4] = 0
    labels = Labels(index, np.zeros((2, 4)), index == 1, speck=SPECK)
    assert np.array_equal(join_splinters(labels, mapped(labels)).index, index) == stays


@given(st.integers(0, 2 ** 32 - 1), st.integers(2, 4))
def test_only_small_faces_change_and_join_a_large_one_beside_them(seed, count):
    random = np.random.RandomState(seed)
    index = np.repeat(random.randint(0, count, (9, 4)), 3, axis=1).astype(np.int32)
    index[random.rand(*index.shape) < 0.2] = 0
    labels = Labels(index, np.zeros((count, 4)), random.rand(*index.shape) < 0.3, speck=SPECK)
    planar = mapped(labels, grey(random.randint(0, 256, index.shape)))
    joined = join_splinters(labels, planar)
    area = planar.face_areas[planar.pixel_faces]
    changed = joined.index != index
    assert (area[changed] < AREA).all()
    assert not (joined.thin & (changed | ~labels.thin)).any()
    around = np.pad(np.where(area >= AREA, index, -1), 1, mode="constant", constant_values=-1)
    for face in np.unique(planar.pixel_faces[changed]):
        some = np.pad(planar.pixel_faces == face, 1, mode="constant")
        beside = np.zeros_like(some)
        for axis in (0, 1):
            for step in (1, -1):
                beside |= np.roll(some, step, axis=axis)
        assert set(joined.index[some[1:-1, 1:-1]]) <= set(around[beside])


def test_splinters_of_a_jpeg_are_no_paths(monkeypatch):
    y, x = (place / 4 for place in np.mgrid[:512, :512])
    soft = np.stack([90 + x, 140 + x / 2, 250 - x / 2], axis=-1)
    far = np.hypot(x - 64, y - 64)
    soft[far > 42] = 205, 205, 225
    soft[far > 58] = 255
    soft[(abs(far - 42) < 0.4) | (abs(far - 58) < 0.4)] = 0
    file = io.BytesIO()
    Image.fromarray(soft.astype(np.uint8)).resize((128, 128), Image.BOX).save(file, "JPEG", quality=50)
    image = load_image(io.BytesIO(file.getvalue()))
    paths = len(trace(image, TraceOptions()).shapes)
    monkeypatch.setattr("ddtcore.splinters.join_splinters", lambda labels, planar: labels)
    assert paths < len(trace(image, TraceOptions()).shapes)


@pytest.mark.parametrize("factor, some", [(1, False), (2, True)])
def test_enlarged_pictures_may_have_splinters(monkeypatch, factor, some):
    y, x = np.mgrid[:140, :140]
    art = np.where(np.hypot(x - 70, y - 60)[..., None] < 45.5, (30, 90, 200), (255, 255, 255)).astype(np.uint8)
    art = Image.fromarray(art).resize((70, 70), Image.BOX)
    art = art.resize((70 * factor, 70 * factor), Image.BILINEAR).convert("RGBA")
    asked = []
    monkeypatch.setattr("ddtcore.splinters.join_splinters", lambda labels, planar: asked.append(labels.speck) or labels)
    trace(np.asarray(art), TraceOptions())
    assert [speck > 0 for speck in asked] == [some]
