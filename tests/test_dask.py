# SPDX-License-Identifier: GPL-2.0-or-later
"""Many pictures on a cluster: the recipe of the README, on a cluster of two local processes."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from PIL import Image

import ddtcore

bag = pytest.importorskip("dask.bag")
distributed = pytest.importorskip("distributed")


@pytest.fixture(scope="module")
def cluster():
    """Two worker processes; the bags of this module are computed there."""
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True,
                                  dashboard_address=None) as cluster, distributed.Client(cluster) as client:
        yield client


@pytest.fixture
def pictures(tmp_path):
    paths = []
    for k in range(5):
        pixels = np.full((24, 32, 3), 255, dtype=np.uint8)
        pixels[6:18, 6:15 + k] = (30 * k, 40, 50)
        paths.append(str(tmp_path / f"picture{k}.png"))
        Image.fromarray(pixels).save(paths[-1])
    return paths


def attempt(path):
    """The file written, or what was wrong with the picture."""
    try:
        return ddtcore.trace_file(path)
    except ddtcore.ImageError as error:
        return str(error)


def test_the_files_are_those_that_one_process_writes(cluster, pictures):
    options = ddtcore.TraceOptions(tolerance=0.5)
    written = bag.from_sequence(pictures).map(ddtcore.trace_file, options=options).compute()
    assert written == [path[:-4] + ".svg" for path in pictures]
    for path, drawing in zip(pictures, written):
        with open(drawing, encoding="utf-8") as file:
            assert file.read() == ddtcore.trace(ddtcore.load_image(path), options).to_svg()


def test_errors_come_back_and_need_cost_no_other_picture(cluster, pictures):
    with open(pictures[2], "wb") as file:
        file.write(b"no picture")
    with pytest.raises(ddtcore.ImageError, match=r"picture2\.png"):
        bag.from_sequence(pictures).map(ddtcore.trace_file).compute()
    told = bag.from_sequence(pictures).map(attempt).compute()
    assert [text.endswith(".svg") for text in told] == [True, True, False, True, True]
    assert "picture2.png is not a picture" in told[2]


def test_pictures_in_memory_and_their_drawings_can_be_sent(cluster, pictures):
    images = [ddtcore.load_image(path) for path in pictures[:2]]
    drawings = bag.from_sequence(images, npartitions=2).map(ddtcore.trace).compute()
    assert [drawing.to_svg() for drawing in drawings] == [ddtcore.trace(image).to_svg() for image in images]
    assert pickle.loads(pickle.dumps(drawings[0])).to_svg() == drawings[0].to_svg()
