# SPDX-License-Identifier: GPL-2.0-or-later
"""Candidate cubics: known curves come back, and the error told is the error there is."""

from __future__ import annotations

import numpy as np
import pytest
from pictures import apart

from ddtcore import bezier
from ddtcore.cubic import LINE_SHARE, SAMPLES, Ends, Track, fit_candidates

ARCH = np.array([[2, 30], [12, 5], [30, 8], [44, 28]], float)
BEND = np.array([[44, 28], [52, 39], [70, 41], [80, 20]], float)


def ends_of(*controls, smooth=True) -> Ends:
    control = np.array(controls)
    tangent = np.stack([control[:, 1] - control[:, 0], control[:, 2] - control[:, 3]], axis=1)
    tangent /= np.hypot(*np.moveaxis(tangent, 2, 0))[..., None]
    return Ends(control[:, [0, 3]], tangent, np.full((len(control), 2), smooth))


def points_on(control, count=40):
    t = (np.arange(count) + 0.5) / count
    return bezier.evaluate(control[None], np.zeros(count, int), t)


def fitted(points, first, last, ends, tolerance=0.2):
    points, first, last = np.asarray(points, float), np.array(first), np.array(last)
    return fit_candidates(Track.of(points, np.ones(len(points))), first, last, ends, np.full(len(first), tolerance))


def distances(control, points):
    """Distance of each point from a cubic, by dense sampling."""
    t = np.linspace(0, 1, 2001)
    curve = bezier.evaluate(np.broadcast_to(control, (1, 4, 2)), np.zeros(len(t), int), t)
    return apart(points, curve).min(axis=1)


@pytest.mark.parametrize("smooth", [True, False])
def test_cubics_are_found_again(smooth):
    """Points on one cubic need no second one within the default tolerance."""
    points = np.concatenate([points_on(ARCH), points_on(BEND)])
    fit = fitted(points, [0, 40], [40, 80], ends_of(ARCH, BEND, smooth=smooth))
    assert not fit.line.any()
    assert fit.error.max() < 0.2
    assert distances(fit.control[0], points[:40]).max() < 0.2
    assert distances(fit.control[1], points[40:]).max() < 0.2


def test_candidates_do_not_touch_each_other():
    """A batch gives what its candidates give one by one; ranges may overlap."""
    points = np.concatenate([points_on(ARCH), points_on(BEND)])
    first, last = [0, 40, 10, 0, 30], [40, 80, 30, 80, 30]
    ends = ends_of(ARCH, BEND, ARCH, BEND, BEND)
    batch = fitted(points, first, last, ends)
    for k in range(5):
        alone = fitted(points, first[k:k + 1], last[k:k + 1], Ends(*(part[k:k + 1] for part in ends)))
        assert np.allclose(alone.control[0], batch.control[k]) and alone.worst[0] == batch.worst[k]
        assert alone.error[0] == pytest.approx(batch.error[k])


@pytest.mark.parametrize("count", [SAMPLES, 40, 300])
@pytest.mark.parametrize("seed", range(8))
def test_the_error_is_that_of_the_worst_of_all_points(seed, count):
    random = np.random.RandomState(seed)
    points = points_on(ARCH, count) + random.normal(0, 0.15, (count, 2))
    points[random.randint(count)] += 0.7
    fit = fitted(points, [0], [count], ends_of(ARCH), tolerance=3)
    true = distances(fit.control[0], points)
    # The distance told is measured at one parameter, so it can only be too large, and hardly is.
    assert true.max() - 1e-3 <= fit.error[0] < 1.15 * true.max() + 0.02
    assert true[fit.worst[0]] > 0.85 * true.max()


@pytest.mark.parametrize("stray", range(2, 300, 17))
def test_no_point_that_strays_is_overlooked(stray):
    points = points_on(ARCH, 300)
    along = points[stray] - points[stray - 1]
    points[stray] += 0.5 * np.array([-along[1], along[0]]) / np.hypot(*along)
    fit = fitted(points, [0], [300], ends_of(ARCH))
    assert fit.error[0] > 0.2
    assert distances(fit.control[0], points[fit.worst[0]:fit.worst[0] + 1]) > 0.19


def test_tangents_are_kept_where_the_curve_goes_on():
    random = np.random.RandomState(3)
    ends = ends_of(ARCH)
    fit = fitted(points_on(ARCH) + random.normal(0, 0.3, (40, 2)), [0], [40], ends)
    handles = np.stack([fit.control[0, 1] - fit.control[0, 0], fit.control[0, 2] - fit.control[0, 3]])
    across = handles[:, 0] * ends.tangent[0, :, 1] - handles[:, 1] * ends.tangent[0, :, 0]
    assert np.abs(across).max() < 1e-3
    assert np.einsum("ed,ed->e", handles, ends.tangent[0]).min() > 0


def test_ends_are_kept_exactly():
    fit = fitted(points_on(ARCH) + 0.4, [0], [40], ends_of(ARCH))
    assert np.array_equal(fit.control[0, [0, 3]], ARCH[[0, 3]])


@pytest.mark.parametrize("stray, line", [(0.0, True), (0.9, True), (1.1, False)])
def test_lines_serve_as_far_as_their_share_of_the_tolerance(stray, line):
    start, end = np.array([3.0, 4.0]), np.array([33.0, 44.0])
    points = start + (end - start) * np.linspace(0.02, 0.98, 30)[:, None]
    points[12] += stray * LINE_SHARE * 0.2 * np.array([0.8, -0.6])
    ends = Ends(np.array([[start, end]]), np.array([[[0.6, 0.8], [-0.6, -0.8]]]), np.ones((1, 2), bool))
    fit = fitted(points, [0], [30], ends)
    assert fit.line[0] == line
    if line:
        assert np.allclose(fit.control[0], bezier.from_line(start[None], end[None])[0])
        assert fit.error[0] == pytest.approx(stray * LINE_SHARE * 0.2)


def test_points_beyond_the_ends_of_a_chord_are_no_line():
    points = np.array([[0.0, 0.0], [5.0, 0.0], [14.0, 0.0]])
    ends = Ends(np.array([[[0.0, 0.0], [10.0, 0.0]]]), np.array([[[1.0, 0.0], [-1.0, 0.0]]]),
                np.ones((1, 2), bool))
    assert fitted(points, [0], [3], ends).error[0] > 1


def test_candidates_without_points_are_lines_without_error():
    fit = fitted(np.zeros((0, 2)), [0], [0], ends_of(ARCH))
    assert fit.line[0] and fit.error[0] == 0 and fit.worst[0] == -1
    assert np.array_equal(fit.control[0, [0, 3]], ARCH[[0, 3]])


def test_weights_decide_whom_the_curve_follows():
    points = np.concatenate([points_on(ARCH)[::2], points_on(ARCH)[1::2] + np.array([0, 2.0])])
    order = np.argsort(points[:, 0])
    for favoured, other in ((0, 1), (1, 0)):
        weight = np.where(order < 20, [1, 0.01][favoured], [1, 0.01][other])
        fit = fit_candidates(Track.of(points[order], weight), np.array([0]), np.array([40]),
                             ends_of(ARCH, smooth=False), np.array([0.1]))
        of_points = distances(fit.control[0], points[order])
        assert of_points[weight == 1].mean() < 0.5 * of_points[weight < 1].mean()
