# SPDX-License-Identifier: GPL-2.0-or-later
"""Hidden borders: few lines, round the shape, under nothing but what is painted later."""

from __future__ import annotations

import numpy as np
import pytest

from ddtcore.doors import MARGIN, Hidden, open_doors, pinched
from ddtcore.shortcut import take_shortcuts
from ddtcore.underlap import hidden_lines


class Painted:
    """Stands in for a `RankMap`: the rank at a point is a function of x and y."""

    def __init__(self, rank):
        self.rank = rank

    def lowest(self, points, level):
        reach = (0, 1, 2)[level]
        around = [(dx, dy) for dx in (-reach, 0, reach) for dy in (-reach, 0, reach)]
        return np.min([self.rank(*(points + step).T) for step in around], axis=0)


def everything_later(x, y):
    return np.full(len(x), 9)


def stretch(points, closed=False):
    """One hidden border of a shape of rank 3 along a polyline, sampled finely."""
    points = np.asarray(points, float)
    parts = [points[:1]]
    for a, b in zip(points[:-1], points[1:]):
        steps = int(np.ceil(np.hypot(*(b - a)) / 1.5))
        parts.append(a + (b - a) * np.arange(1, steps + 1)[:, None] / steps)
    points = np.concatenate(parts)
    return Hidden(np.array([0, len(points)]), points, np.array([3], np.int32), np.array([closed]))


def circle(radius, turn):
    angle = np.linspace(0, 2 * np.pi, 60) * turn
    return np.stack([50 + radius * np.cos(angle), 50 + radius * np.sin(angle)], axis=1)


def inside(polygon, points):
    """Non-zero winding of a closed polygon round points."""
    a = polygon[None] - points[:, None]
    b = np.roll(polygon, -1, axis=0)[None] - points[:, None]
    turn = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=2))
    return np.abs(turn.sum(axis=1)) > 1


def test_a_straight_border_takes_two_lines_under_what_is_later():
    hidden = stretch([(10, 20), (40, 20)])
    _, points = hidden_lines(hidden, Painted(everything_later))
    assert len(points) == 3
    assert (points[[0, -1]] == [(10, 20), (40, 20)]).all()
    # The shape is on the right of someone who walks to larger x, so outwards is up.
    assert points[1, 1] < 20 - MARGIN


def test_all_later_shapes_lie_under_a_ring_in_few_lines():
    hidden = stretch(circle(20, 1), closed=True)
    _, points = hidden_lines(hidden, Painted(everything_later))
    assert (points[0] == points[-1]).all() and len(points) <= 6
    assert inside(points[:-1], hidden.points).all()


def test_a_hole_shrinks():
    hidden = stretch(circle(20, -1), closed=True)
    _, points = hidden_lines(hidden, Painted(everything_later))
    assert len(points) <= 6
    assert not inside(points[:-1], hidden.points).any()


@pytest.mark.parametrize("width", [1.6, 3.0, 5.0])
def test_the_border_keeps_between_the_shape_and_the_far_side(width):
    ranks = Painted(lambda x, y: np.where((y > 20 - width) & (y < 60), 9, 1))
    doors = open_doors(stretch([(10, 20), (60, 20)]), ranks)
    middle = slice(8, -8)
    assert (doors.low[middle] > 0.3).all()
    assert (doors.low[middle] <= doors.high[middle]).all()
    assert (doors.high[middle] < width - 0.3).all()
    _, points = hidden_lines(stretch([(10, 20), (60, 20)]), ranks)
    assert (points[:, 1] > 20 - width).all() and (points[:, 1] <= 20).all()


def test_far_more_room_is_not_used_where_it_ends():
    ranks = Painted(lambda x, y: np.where((x > 32) & (y < 16), 1, 9))
    _, points = hidden_lines(stretch([(10, 20), (60, 20)]), ranks)
    for share in np.linspace(0, 1, 50):
        line = points[:-1] + (points[1:] - points[:-1]) * share
        assert (ranks.lowest(line, 0) == 9).all()


def test_pinched_borders_are_found():
    thin = Painted(lambda x, y: np.where(np.abs(y - 20) < 0.4, 9, 1))
    assert pinched(stretch([(10, 20), (40, 20)]), thin).all()
    assert not pinched(stretch([(10, 20), (40, 20)]), Painted(everything_later)).any()


def test_nothing_hidden_gives_nothing():
    none = Hidden(np.zeros(1, int), np.zeros((0, 2)), np.zeros(0, np.int32), np.zeros(0, bool))
    starts, points = hidden_lines(none, Painted(everything_later))
    assert starts.tolist() == [0] and points.shape == (0, 2)
    assert pinched(none, Painted(everything_later)).shape == (0,)


def test_several_stretches_keep_apart():
    a, b = stretch([(10, 20), (40, 20)]), stretch(circle(20, 1), closed=True)
    both = Hidden(np.array([0, len(a.points), len(a.points) + len(b.points)]),
                  np.concatenate([a.points, b.points]), np.array([3, 3], np.int32), np.array([False, True]))
    starts, points = hidden_lines(both, Painted(everything_later))
    alone = [hidden_lines(one, Painted(everything_later))[1] for one in (a, b)]
    assert np.array_equal(points[:starts[1]], alone[0])
    assert np.array_equal(points[starts[1]:], alone[1])


NOTCH = np.array([(0, 20), (10, 20), (12, 28), (14, 20), (30, 20)], float)


def test_shortcuts_pass_notches():
    starts, points = take_shortcuts(np.array([0, 5]), NOTCH, np.array([3]), Painted(everything_later))
    assert starts.tolist() == [0, len(points)]
    assert points.tolist() == [[0, 20], [30, 20]]


def test_shortcuts_respect_what_is_painted_earlier():
    earlier = Painted(lambda x, y: np.where(np.hypot(x - 12, y - 22) < 0.8, 1, 9))
    assert len(take_shortcuts(np.array([0, 5]), NOTCH, np.array([3]), earlier)[1]) == 5


SPIKE = NOTCH * [1, -1] + [0, 60]


def test_shortcuts_cut_spikes_that_hold_nothing_of_the_shape():
    _, points = take_shortcuts(np.array([0, 5]), SPIKE, np.array([3]), Painted(everything_later))
    assert points.tolist() == [[0, 40], [30, 40]]


@pytest.mark.parametrize("rank", [3, 1])
def test_shortcuts_never_cut_the_shape_nor_bare_what_is_painted_earlier(rank):
    kept = Painted(lambda x, y: np.where(np.hypot(x - 12, y - 37) < 0.8, rank, 9))
    _, points = take_shortcuts(np.array([0, 5]), SPIKE, np.array([3]), kept)
    assert [12, 32] in points.tolist()


def test_shortcuts_leave_out_corners_that_are_none():
    narrow = Painted(lambda x, y: np.where(np.abs(y - 20) < 1, 9, 1))
    line = np.array([(10, 20), (14, 20.1), (18, 20), (22, 20.1), (26, 20)])
    _, points = take_shortcuts(np.array([0, 5]), line, np.array([3]), narrow)
    assert points[[0, -1]].tolist() == [[10, 20], [26, 20]] and len(points) < 4

