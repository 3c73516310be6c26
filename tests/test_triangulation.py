# SPDX-License-Identifier: GPL-2.0-or-later
"""The data dependent triangulation as a whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from invariants import assert_valid_mesh
from meshes import (
    CLIP_ART,
    clip_art,
    edge_set,
    enlarged,
    exact_labels,
    grey,
    one_label,
    pictures,
    triangle_set,
)

from ddtcore.components import components
from ddtcore.cost import mesh_cost, premultiplied_levels
from ddtcore.flips import flip_rounds
from ddtcore.model import Labels, Mesh
from ddtcore.options import TraceOptions
from ddtcore.triangulation import LABEL_ROUNDS, ribbon_mesh, start_ribbon, triangulate

settings_of_flips = st.builds(
    TraceOptions, flips=st.sampled_from(["boundaries", "everywhere"]), cost=st.sampled_from(["yu", "paper"]),
    result=st.sampled_from(["triangles", "curves"]), work=st.sampled_from([0, 500, 10 ** 9]))


def psnr(one: np.ndarray, other: np.ndarray) -> float:
    return 10 * np.log10(255 ** 2 / np.mean((one - other) ** 2))


@given(pictures(), settings_of_flips)
def test_every_mesh_is_valid(image, options):
    mesh = triangulate(image, exact_labels(image), options)
    assert_valid_mesh(mesh)
    assert mesh.shape == (image.shape[0] + 2, image.shape[1] + 2)
    assert mesh.finished or options.work < 10 ** 9


@pytest.mark.parametrize("flips", ["boundaries", "everywhere"])
@pytest.mark.parametrize("result", ["triangles", "curves"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1), (2, 2), (5, 4)])
def test_pictures_of_one_colour(shape, result, flips):
    image = np.full((*shape, 4), 200, np.uint8)
    mesh = triangulate(image, exact_labels(image), TraceOptions(result=result, flips=flips))
    assert_valid_mesh(mesh)
    assert mesh.flips == 0 and mesh.finished
    touching = np.ones(mesh.quads.shape, bool)
    touching[1:-1, 1:-1] = result == "triangles"
    assert np.array_equal(mesh.quads, touching)


@given(pictures(), st.sampled_from(["boundaries", "everywhere"]))
def test_quads_with_several_labels_are_meshed(image, flips):
    labels = exact_labels(image)
    mesh = triangulate(image, labels, TraceOptions(flips=flips))
    framed = np.pad(labels.index, 1, mode="constant", constant_values=-1)
    corners = np.stack([framed[:-1, :-1], framed[:-1, 1:], framed[1:, :-1], framed[1:, 1:]])
    mixed = (corners != corners[0]).any(axis=0)
    if flips == "boundaries":
        assert np.array_equal(mesh.quads, mixed)
    else:
        assert np.all(mesh.quads[mixed])


def test_everywhere_reaches_one_quad_past_all_that_is_not_flat():
    image = grey(np.zeros((9, 9)))
    image[4, 4] = 50
    mesh = triangulate(image, one_label(image), TraceOptions(flips="everywhere"))
    expected = np.zeros((10, 10), bool)
    expected[[0, -1]] = expected[:, [0, -1]] = True
    expected[3:7, 3:7] = True
    assert np.array_equal(mesh.quads, expected)


@given(pictures())
def test_no_flip_touches_the_frame(image):
    mesh = triangulate(image, exact_labels(image), TraceOptions(flips="everywhere"))
    row, col = np.divmod(mesh.triangles, mesh.shape[1])
    framed = ((row == 0) | (row == mesh.shape[0] - 1) | (col == 0) | (col == mesh.shape[1] - 1)).any(axis=1)
    assert np.all(np.ptp(row[framed], axis=1) == 1) and np.all(np.ptp(col[framed], axis=1) == 1)


@given(pictures(), settings_of_flips)
def test_the_full_mesh_contains_that_of_the_ribbon(image, options):
    labels = exact_labels(image)
    part, full = (triangulate(image, labels, replace(options, work=10 ** 9, result=result))
                  for result in ("curves", "border"))
    assert full.quads.all()
    assert triangle_set(part) <= triangle_set(full)
    assert part.flips == full.flips


@given(pictures())
def test_edges_along_thin_strokes_survive(image):
    exact = exact_labels(image)
    thin = np.random.RandomState(image.size).rand(*image.shape[:2]) < 0.3
    labels = Labels(exact.index, exact.palette, thin)
    for flips in ("boundaries", "everywhere"):
        options = TraceOptions(flips=flips)
        kept = edge_set(triangulate(image, labels, options))
        index, thins = np.pad(exact.index, 1).ravel(), np.pad(thin, 1).ravel()
        for p, q in edge_set(ribbon_mesh(*start_ribbon(image, labels, options))):
            if index[p] == index[q] and (thins[p] or thins[q]):
                assert (p, q) in kept


@pytest.mark.parametrize("art", CLIP_ART)
def test_at_boundaries_four_rounds_are_done(art):
    image = clip_art(art)
    labels, options = exact_labels(image // 64 * 64), TraceOptions()
    ribbon, _ = start_ribbon(image, labels, options)
    per_round = list(flip_rounds(ribbon, options.work))
    assert len(per_round) > LABEL_ROUNDS == 4
    assert triangulate(image, labels, options).flips == sum(per_round[:4]) > 0.75 * sum(per_round)


@pytest.mark.parametrize("art", CLIP_ART)
def test_everywhere_look_ahead_follows_when_single_flips_are_done(art):
    image = clip_art(art, shrink=2)
    options = TraceOptions(flips="everywhere")
    ribbon, _ = start_ribbon(image, one_label(image), options)
    single, ahead = (sum(flip_rounds(ribbon, options.work, look_ahead)) for look_ahead in (False, True))
    assert ahead > 0
    assert triangulate(image, one_label(image), options).flips == single + ahead


@pytest.mark.parametrize("art", CLIP_ART)
def test_flips_enlarge_clip_art_better_than_the_diagonals_they_start_from(art):
    truth = premultiplied_levels(clip_art(art))
    image = clip_art(art, shrink=4)
    truth = truth[:image.shape[0] * 4, :image.shape[1] * 4]
    everywhere = TraceOptions(flips="everywhere", result="triangles")
    start, flipped = (triangulate(image, one_label(image), replace(everywhere, work=work))
                      for work in (0, 10 ** 9))
    assert start.flips == 0 and flipped.finished
    assert psnr(enlarged(flipped, image, 4), truth) > psnr(enlarged(start, image, 4), truth) + 0.1


@pytest.mark.parametrize("cost", ["yu", "paper"])
@pytest.mark.parametrize("art", CLIP_ART)
def test_a_quarter_turn_of_the_picture_hardly_changes_the_cost(art, cost):
    image = clip_art(art, shrink=2)
    turned = np.ascontiguousarray(np.rot90(image))
    for work, change in ((0, 1e-9), (10 ** 9, 0.04)):
        options = TraceOptions(flips="everywhere", cost=cost, work=work)
        one, other = (mesh_cost(triangulate(im, one_label(im), options), im, cost) for im in (image, turned))
        assert other == pytest.approx(one, rel=change)


def test_the_work_budget_bites_and_is_told():
    image = clip_art("doctor")
    few, many = (triangulate(image, one_label(image), TraceOptions(flips="everywhere", work=work))
                 for work in (50_000, 20_000_000))
    assert not few.finished and many.finished
    assert 0 < few.flips < many.flips
    assert_valid_mesh(few)


def test_colours_under_transparent_pixels_do_not_matter():
    image = clip_art("sunglasses")
    noise = np.random.RandomState(0).randint(0, 256, image.shape).astype(np.uint8)
    noise[..., 3] = 0
    hidden = np.where(image[..., 3:] == 0, noise, image)
    assert np.any(hidden != image)
    options = TraceOptions(flips="everywhere")
    one, other = (triangulate(im, one_label(im), options) for im in (image, hidden))
    assert np.array_equal(one.triangles, other.triangles) and np.array_equal(one.twins, other.twins)


def line_picture(angle: float, width: float, size: int = 48) -> np.ndarray:
    """A black line on white, anti-aliased by 8 x 8 samples a pixel."""
    at = (np.arange(size * 8) + 0.5) / 8 - size / 2
    distance = np.abs(at[:, np.newaxis] * np.cos(angle) - at * np.sin(angle) - 0.31)
    ink = (distance < width / 2).reshape(size, 8, size, 8).mean(axis=(1, 3))
    return grey(np.round(255 * (1 - ink)))


def pieces(mesh: Mesh, index: np.ndarray, label: int) -> int:
    """How many connected pieces the mesh makes of the pixels of a label."""
    vertex = np.pad(index, 1, mode="constant", constant_values=-1).ravel()
    ends = np.array(sorted(edge_set(mesh)))
    own = ends[(vertex[ends] == label).all(axis=1)]
    return len(np.unique(components(len(vertex), *own.T)[vertex == label]))


def test_flips_join_thin_lines():
    whole = {"start": 0, "flipped": 0}
    for angle in np.arange(0.05, 3.1, 0.15):
        image = line_picture(angle, width=1.0)
        index = (image[..., 0] < 128).astype(np.int32)
        labels = Labels(index, np.zeros((2, 4)), np.zeros(index.shape, bool))
        for name, work in (("start", 0), ("flipped", 10 ** 9)):
            mesh = triangulate(image, labels, TraceOptions(work=work))
            whole[name] += pieces(mesh, index, 1) == 1
    assert whole["flipped"] >= whole["start"] + 7, whole
