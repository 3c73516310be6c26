# SPDX-License-Identifier: GPL-2.0-or-later
"""Fields have the lines of equal colour that the picture has."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.field import Field, refined, unexplained
from ddtcore.parallels import first_fields, parallels, slopes
from ddtcore.samples import Batch, Samples, squares, total_error, total_errors, weighted_quantile

LINEAR = Field("linear", np.array([0.7]))
CIRCLE = Field("radial", np.array([0.3, -0.4]))
ELLIPSE = Field("radial", np.array([0.3, -0.4, 0.5, -0.3]))


def points(count=1500):
    return np.random.RandomState(5).uniform(-1, 1, (count, 2))


def samples(field, colour=lambda place: np.stack([90 * place, 60 - 30 * place, place * 0], axis=1)):
    return Samples(points(), colour(field.places(points())), np.ones(len(points())))


def same(a, b):
    """The values of two fields; an axis has no sense."""
    if a.kind == "linear":
        return abs(np.sin(a.values[0] - b.values[0]))
    return np.abs(a.values - b.values).max()


@pytest.mark.parametrize("field", [LINEAR, CIRCLE, ELLIPSE])
def test_changes_are_the_derivatives_of_the_places(field):
    step = 1e-6
    for k in range(len(field.values)):
        moved = field.values.copy()
        moved[k] += step
        numeric = (Field(field.kind, moved).places(points()) - field.places(points())) / step
        np.testing.assert_allclose(field.changes(points(), field.places(points()))[k], numeric, atol=1e-3)


def test_places_are_lengths_along_the_axis_and_distances_from_the_centre():
    at = np.array([[0.3, -0.4], [1.3, -0.4], [0.3, 1.6]])
    np.testing.assert_allclose(Field("linear", np.array([np.pi / 2])).places(at), at[:, 1])
    np.testing.assert_allclose(CIRCLE.places(at), [0, 1, 2])
    np.testing.assert_allclose(Field("radial", np.array([0.3, -0.4, 0.5, 0])).places(at),
                               [0, np.sqrt(1.5), 2 * np.sqrt(0.5)])


@pytest.mark.parametrize("field", [LINEAR, CIRCLE, ELLIPSE])
@pytest.mark.parametrize("shape", ["slope", "ridge"])
def test_fields_are_found_whatever_the_colours_along_them(field, shape):
    def ridge(place):
        return np.stack([200 * np.abs(place - place.mean()), 0 * place, 0 * place], axis=1)

    known = samples(field, ridge) if shape == "ridge" else samples(field)
    batch = Batch.of([known])
    found, sound = first_fields([parallels(slopes(known, 0.25))], batch, field.kind, len(field.values) == 4)
    found = refined(found, batch)
    assert sound.all() and same(found.of(0), field) < 0.01
    # A ridge lies between two of the places where the free colours can bend.
    assert np.abs(unexplained(found, batch)).max() < (20 if shape == "ridge" else 0.1)


def test_steep_edges_do_not_outvote_the_slopes():
    known = samples(LINEAR)
    edge = np.abs(known.points[:, 0] - 0.9) < 0.02
    known.colour[edge] = 255
    found, _ = first_fields([parallels(slopes(known, 0.25))], Batch.of([known]), "linear")
    assert same(found.of(0), LINEAR) < 0.1


def test_a_centre_out_of_reach_is_no_radial_field():
    assert not Field("radial", np.array([100.0, 0])).sound
    assert not Field("radial", np.array([0, 0, 0.99, 0])).sound
    assert CIRCLE.sound and ELLIPSE.sound and LINEAR.sound


def test_slopes_are_those_of_planes():
    grid = np.stack(np.meshgrid(np.arange(12.0), np.arange(9.0)), axis=-1).reshape(-1, 2)
    colour = np.stack([3 * grid[:, 0] + 5, -2 * grid[:, 1], grid[:, 0] + grid[:, 1]], axis=1)
    known = slopes(Samples(grid, colour, np.ones(len(grid))), 3.0)
    assert len(known.points) == 12 and known.count.sum() == len(grid)
    np.testing.assert_allclose(known.slope, np.broadcast_to([[3, 0, 1], [0, -2, 1]], (12, 2, 3)), rtol=0.15)


def test_squares_number_the_points_they_hold():
    number, count, side = squares(np.array([[0, 0], [0.9, 0.9], [1.1, 0], [7, 7], [7.5, 7.9]]), 1.0)
    assert number.tolist() == [0, 0, 1, 2, 2] and (count, side) == (3, 1.0)


def test_a_quantile_goes_by_weight():
    values, weight = np.array([5.0, 1, 3]), np.array([1.0, 1, 8])
    assert [weighted_quantile(values, weight, share) for share in (0.05, 0.5, 0.95)] == [1, 3, 5]


def test_errors_of_wrong_pixels_are_limited():
    assert total_error(np.array([[3.0, 4.0], [1e4, 0.0]]), np.array([2.0, 1.0])) == 50 + 1024


@pytest.mark.parametrize("angle", [0.0, 0.4, 1.3])
def test_a_bent_strip_tells_the_axis_of_what_changes_along_it(angle):
    turn, across = np.meshgrid(np.linspace(0, 5, 300), [-1, 0, 1])
    points = np.stack([(60 + across) * np.cos(turn), (25 + across) * np.sin(turn)], axis=-1).reshape(-1, 2)
    place = points.dot([np.cos(angle), np.sin(angle)])
    # Across the strip, its edges are mixed with what is round it.
    colour = np.stack([120 + place, 90 - 0.5 * place], axis=1) + 20 * (across.reshape(-1, 1) > 0)
    samples = Samples(points / 50, colour, np.ones(len(points)))
    found, _ = first_fields([parallels(slopes(samples, 0.1))], Batch.of([samples]), "linear")
    assert abs(np.sin(found.values[0, 0] - angle)) < 0.1


@pytest.mark.parametrize("kind, size", [("linear", 1), ("radial", 2), ("radial", 4)])
def test_regions_do_not_matter_to_each_other(kind, size):
    """Fields of many regions at a time are those that each has alone."""
    random = np.random.RandomState(8)
    regions = [samples(field)._replace(count=random.uniform(0.1, 3, 1500)) for field in (LINEAR, CIRCLE, ELLIPSE)]
    regions = [Samples(*(values[:80 + 400 * k] for values in some)) for k, some in enumerate(regions)]

    def fitted(some):
        batch = Batch.of(some)
        fields, sound = first_fields([parallels(slopes(each, 0.25)) for each in some], batch, kind, size == 4)
        found = refined(fields, batch)
        return [(*found.values[k], error, sound[k]) for k, error in
                enumerate(total_errors(unexplained(found, batch), batch).tolist())]

    alone = [fitted([each])[0] for each in regions]
    np.testing.assert_allclose(fitted(regions), alone, rtol=1e-6, atol=1e-6)


def test_some_regions_of_a_batch_are_a_batch_of_them():
    regions = [Samples(*(values[:size] for values in samples(LINEAR))) for size in (5, 9, 2)]
    some, expected = Batch.of(regions).some(np.array([True, False, True])), Batch.of(regions[::2])
    for values, others in zip((*some.samples, some.region, some.starts),
                              (*expected.samples, expected.region, expected.starts)):
        np.testing.assert_array_equal(values, others)
    assert expected.sums(expected.samples.count).tolist() == [5, 2]
