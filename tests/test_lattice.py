# SPDX-License-Identifier: GPL-2.0-or-later
"""Outlines along the edges of pixels."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from meshes import exact_labels, grey
from painted import render
from pictures import any_picture

from ddtcore.lattice import FINE, MOST, along_pixels, magnified, parts, square_mesh
from ddtcore.model import LINE
from ddtcore.options import TraceOptions
from ddtcore.outline import link_outlines
from ddtcore.pipeline import trace


def traced(image):
    labels = exact_labels(image)
    mesh = square_mesh(image, labels, TraceOptions())
    planar = link_outlines(mesh, labels)
    return planar, *along_pixels(mesh, planar)


def area(points):
    x, y = points.T
    return (x * np.roll(y, -1) - y * np.roll(x, -1)).sum() / 2


@given(any_picture())
@settings(deadline=None)
def test_faces_have_the_area_of_their_pixels(image):
    planar, _, curves = traced(image)
    own = np.zeros(len(planar.face_labels))
    for arc in range(len(planar.tail)):
        part = curves.control[curves.starts[arc]:curves.starts[arc + 1]]
        swept = (part[:, 0, 0] * part[:, 3, 1] - part[:, 0, 1] * part[:, 3, 0]).sum() / 2
        own[planar.right[arc]] += swept
        own[planar.left[arc]] -= swept
    assert np.allclose(own[1:], np.bincount(planar.pixel_faces.ravel(), minlength=len(own))[1:])


def mosaic():
    """Pictures of many colours, where four meet in a point."""
    return st.builds(lambda seed, size: grey(np.random.RandomState(seed).permutation(size ** 2).reshape(size, size)),
                     st.integers(0, 99), st.integers(2, 6))


@given(st.one_of(any_picture(), mosaic()))
@settings(deadline=None)
def test_lines_run_from_corner_to_corner_of_pixels_and_join(image):
    planar, lines, curves = traced(image)
    assert (curves.degree == LINE).all() and np.array_equal(curves.control, np.rint(curves.control))
    step = curves.control[:, 3] - curves.control[:, 0]
    assert (step == 0).any(axis=1).all()
    for arc in range(len(planar.tail)):
        part = curves.control[curves.starts[arc]:curves.starts[arc + 1]]
        points = lines.points[lines.starts[arc]:lines.starts[arc + 1]]
        assert len(part) and len(points) and np.array_equal(part[1:, 0], part[:-1, 3])
        assert np.array_equal(part[:, 0], points[:len(part)])
        if planar.rings[arc]:
            assert np.array_equal(part[-1, 3], part[0, 0]) and len(points) == len(part) and area(points) != 0
        assert len(part) == 1 or (part[:, 0] != part[:, 3]).any(axis=1).all(), "no line is a point"
        turn = step[curves.starts[arc]:curves.starts[arc + 1]]
        assert ((turn[1:] * turn[:-1]).sum(axis=1) == 0).all(), "no line goes straight on"


def test_magnified_maps_are_the_same_in_finer_pixels():
    planar, lines, curves = traced(grey([[0, 255]]))
    large, points, control = magnified(planar, lines, curves, 3)
    assert large.pixel_faces.shape == (3, 6) and np.array_equal(large.pixel_faces[::3, ::3], planar.pixel_faces)
    assert np.array_equal(points.points, 3 * lines.points)
    assert np.array_equal(control.control, 3 * curves.control)


def test_large_pictures_are_not_magnified():
    assert parts((64, 64)) == FINE and parts((MOST, 1)) == 1 and parts((10 ** 5, 10 ** 5)) == 1


def test_gradients_lie_where_their_pixels_are():
    """Shapes are cut at a multiple of the picture's size; what they are painted with must follow."""
    image = np.full((40, 60, 4), 255, np.uint8)
    image[8:32, 10:50, 0] = np.linspace(20, 235, 40).astype(np.uint8)
    drawing = trace(image, TraceOptions(curves="crisp"))
    soft = [shape for shape in drawing.shapes if shape.gradient is not None]
    assert len(soft) == 1
    assert np.abs(render(drawing, 1, page="white")[..., :3].astype(float) - image[..., :3]).max() < 8
