# SPDX-License-Identifier: GPL-2.0-or-later
"""Border triangles, barycentres, and the mesh as a drawing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from meshes import clip_art, exact_labels, grey, one_label, pictures

from ddtcore.border import barycentres, border_triangles, draw_mesh
from ddtcore.cost import framed_levels
from ddtcore.model import Labels, Mesh
from ddtcore.options import TraceOptions
from ddtcore.triangulation import triangulate

EVERYWHERE = TraceOptions(flips="everywhere", result="triangles")


def framed(labels: Labels) -> np.ndarray:
    return np.pad(labels.index, 1, mode="constant", constant_values=-1).ravel()


def in_picture(mesh: Mesh) -> np.ndarray:
    """Triangles without vertices in the frame."""
    row, col = np.divmod(mesh.triangles, mesh.shape[1])
    return ((row > 0) & (row < mesh.shape[0] - 1) & (col > 0) & (col < mesh.shape[1] - 1)).all(axis=1)


@given(pictures())
def test_triangles_of_several_labels_are_border_triangles(image):
    labels = exact_labels(image)
    mesh = triangulate(image, labels, EVERYWHERE)
    marked = border_triangles(mesh, framed(labels), framed_levels(image), threshold=1000)
    several = [len(set(t)) > 1 for t in framed(labels)[mesh.triangles].tolist()]
    assert marked.tolist() == several


@given(pictures())
def test_irregular_triangles_across_a_large_step_are_border_triangles(image):
    mesh = triangulate(image, one_label(image), EVERYWHERE)
    levels = framed_levels(image)
    for threshold in (0, 60, 200):
        marked = border_triangles(mesh, np.zeros(len(levels), int), levels, threshold)
        for triangle, mark in zip(mesh.triangles, marked):
            sides = [(mesh.points(triangle[i]) - mesh.points(triangle[i - 1])) for i in range(3)]
            steps = [levels[triangle[i]] - levels[triangle[i - 1]] for i in range(3)]
            irregular = max(side @ side for side in sides) > 2
            assert mark == (irregular and max(step @ step for step in steps) > threshold ** 2)


def test_a_soft_ramp_is_no_border():
    rows, cols = np.mgrid[:20, :20]
    image = grey(rows + 2 * cols + (rows * cols) % 3)
    labels = one_label(image)
    mesh = triangulate(image, labels, EVERYWHERE)
    assert mesh.flips > 0
    levels = TraceOptions(threshold=20).threshold_levels
    marked = border_triangles(mesh, framed(labels), framed_levels(image), levels)
    assert not marked[in_picture(mesh)].any()
    assert border_triangles(mesh, framed(labels), framed_levels(image), 0)[in_picture(mesh)].any()


def test_the_full_threshold_is_the_step_from_black_to_white():
    assert TraceOptions(threshold=100).threshold_levels == pytest.approx(np.linalg.norm([255] * 3))
    assert TraceOptions(threshold=0).threshold_levels == 0


@pytest.mark.parametrize("name", ["vertex_labels", "vertex_colours"])
def test_labels_and_colours_must_be_those_of_all_vertices(name):
    image = grey([[0, 1], [2, 3]])
    mesh = triangulate(image, one_label(image), EVERYWHERE)
    values = {"vertex_labels": np.zeros(16, int), "vertex_colours": np.zeros((16, 4))}
    values[name] = values[name][:4]
    with pytest.raises(ValueError, match=f"{name} must have 16 rows.*not 4"):
        border_triangles(mesh, threshold=0, **values)


def test_a_barycentre_is_the_mean_of_the_vertices():
    image = grey([[0, 255, 0], [255, 0, 0]])
    mesh = triangulate(image, one_label(image), EVERYWHERE)
    expected = mesh.points(mesh.triangles).sum(axis=1) / 3
    assert np.allclose(barycentres(mesh, np.arange(len(mesh.triangles))), expected)
    some = np.arange(len(mesh.triangles)) % 3 == 0
    assert np.allclose(barycentres(mesh, some), expected[some])
    first = barycentres(mesh, np.array([0]))
    assert first.tolist() in ([[pytest.approx(1 / 6), pytest.approx(-1 / 6)]],
                              [[pytest.approx(-1 / 6), pytest.approx(-1 / 6)]])


@given(pictures())
def test_a_drawn_mesh_covers_the_picture_exactly(image):
    labels = exact_labels(image)
    drawing = draw_mesh(image, labels, triangulate(image, labels, EVERYWHERE), EVERYWHERE)
    points = drawing.triangles.points
    one, other = points[:, 1] - points[:, 0], points[:, 2] - points[:, 0]
    areas = (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2
    assert areas.min() > 0
    assert areas.sum() == image.shape[0] * image.shape[1]
    assert points.min() == 0 and points.max(axis=(0, 1)).tolist() == [image.shape[1], image.shape[0]]


@given(pictures())
def test_triangles_are_drawn_in_the_mean_of_their_colours(image):
    mesh = triangulate(image, exact_labels(image), EVERYWHERE)
    triangles = draw_mesh(image, exact_labels(image), mesh, EVERYWHERE).triangles
    assert triangles.rgb.dtype == np.uint8
    vertices = np.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge").reshape(-1, 4)
    colours = vertices[mesh.triangles].astype(float)
    alpha = colours[..., 3:]
    assert np.allclose(triangles.opacity, alpha.mean(axis=(1, 2)) / 255)
    seen = alpha.sum(axis=(1, 2)) > 0
    mean = ((colours[..., :3] * alpha).sum(axis=1)[seen] / alpha.sum(axis=1)[seen])
    assert np.abs(triangles.rgb[seen] - mean).max(initial=0) <= 0.5 + 1e-9


@pytest.mark.parametrize("result", ["triangles", "border"])
def test_counts_and_marks_are_those_of_the_mesh(result):
    image = clip_art("stegosaurus", shrink=2)
    labels = exact_labels(image // 64 * 64)
    options = TraceOptions.preset("paper", result=result)
    mesh = triangulate(image, labels, options)
    drawing = draw_mesh(image, labels, mesh, options)
    marked = border_triangles(mesh, framed(labels), framed_levels(image), options.threshold_levels)
    assert drawing.counts == {"triangles": len(mesh.triangles), "flips": mesh.flips,
                              "border triangles": marked.sum()}
    assert np.array_equal(drawing.triangles.border, marked)
    assert drawing.triangles.filled == (result == "triangles")
    assert (drawing.width, drawing.height) == (image.shape[1], image.shape[0])
