# SPDX-License-Identifier: GPL-2.0-or-later
"""Pictures to triangulate, labels made of their exact colours, and pictures made of meshes."""

from __future__ import annotations

import os
from typing import Tuple

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st
from PIL import Image

from ddtcore.cost import framed_levels
from ddtcore.model import Labels, Mesh
from ddtcore.options import TraceOptions
from ddtcore.ribbon import Ribbon
from ddtcore.triangulation import start_ribbon

# The same examples in every run, however slow the machine.
settings.register_profile("fixed", derandomize=True, deadline=None, max_examples=50)
settings.load_profile("fixed")

CLIP_ART = ("doctor", "stegosaurus", "sunglasses")


def clip_art(name: str, shrink: int = 1) -> np.ndarray:
    """A bundled picture, RGBA, each pixel the mean of `shrink` x `shrink`."""
    with Image.open(os.path.join(os.path.dirname(__file__), "images", name + ".png")) as file:
        image = np.asarray(file.convert("RGBA")).astype(np.float64)
    image[..., :3] *= image[..., 3:]
    rows, cols = image.shape[0] // shrink, image.shape[1] // shrink
    blocks = image[:rows * shrink, :cols * shrink].reshape(rows, shrink, cols, shrink, 4)
    mean = blocks.mean(axis=(1, 3))
    mean[..., :3] /= np.maximum(mean[..., 3:], 1)
    return np.round(mean).astype(np.uint8)


def exact_labels(image: np.ndarray) -> Labels:
    """One label for each colour."""
    palette, index = np.unique(image.reshape(-1, 4), axis=0, return_inverse=True)
    index = index.reshape(image.shape[:2]).astype(np.int32)
    return Labels(index, palette.astype(np.float64), np.zeros(index.shape, bool))


def one_label(image: np.ndarray) -> Labels:
    """The same label everywhere."""
    return Labels(np.zeros(image.shape[:2], np.int32), np.zeros((1, 4)), np.zeros(image.shape[:2], bool))


def grey(rows) -> np.ndarray:
    """An opaque picture from rows of grey levels."""
    levels = np.asarray(rows, np.uint8)
    return np.stack([levels] * 3 + [np.full_like(levels, 255)], axis=2)


@st.composite
def pictures(draw, longest: int = 9) -> np.ndarray:
    """Small pictures: noise of few or many colours, opaque or not."""
    shape = draw(st.tuples(st.integers(1, longest), st.integers(1, longest)))
    random = np.random.RandomState(draw(st.integers(0, 2 ** 32 - 1)))
    colours = random.randint(0, 256, (draw(st.sampled_from([1, 2, 3, 5, 50])), 4)).astype(np.uint8)
    if draw(st.booleans()):
        colours[:, 3] = 255
    return colours[random.randint(0, len(colours), shape)]


def ribbon_of(image: np.ndarray, everywhere: bool = True, cost: str = "yu") -> Tuple[Ribbon, np.ndarray]:
    """The ribbon that `triangulate` starts with, under exact labels."""
    flips = "everywhere" if everywhere else "boundaries"
    return start_ribbon(image, exact_labels(image), TraceOptions(flips=flips, cost=cost))


def edge_set(mesh: Mesh) -> set:
    """All edges, as (smaller, larger) vertex number."""
    ends = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    return set(map(tuple, np.sort(ends, axis=1).tolist()))


def triangle_set(mesh: Mesh) -> set:
    """All triangles, as vertex numbers in rising order."""
    return set(map(tuple, np.sort(mesh.triangles, axis=1).tolist()))


def enlarged(mesh: Mesh, image: np.ndarray, times: int) -> np.ndarray:
    """The picture as the mesh interpolates it, float64 (times * H, times * W, 4)."""
    height, width = image.shape[:2]
    corners = mesh.points(mesh.triangles) * times - 0.5
    least = np.ceil(corners.min(axis=1)).astype(int)
    size = np.floor(corners.max(axis=1)).astype(int) + 1 - least
    count = size.prod(axis=1)
    triangle = np.repeat(np.arange(len(corners)), count)
    step = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    at = least[triangle] + np.stack([step % size[triangle, 0], step // size[triangle, 0]], axis=1)
    a, b, c = np.moveaxis(corners[triangle], 1, 0)
    weights = np.stack([_cross(c - b, at - b), _cross(a - c, at - c), _cross(b - a, at - a)]) / times ** 2
    size = np.array([width, height]) * times
    inside = (weights >= 0).all(axis=0) & (at >= 0).all(axis=1) & (at < size).all(axis=1)
    at, colours = at[inside], framed_levels(image)[mesh.triangles[triangle[inside]]]
    result = np.full((size[1], size[0], 4), np.nan)
    result[at[:, 1], at[:, 0]] = np.einsum("kn,nkc->nc", weights[:, inside], colours)
    return result


def _cross(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    return one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
