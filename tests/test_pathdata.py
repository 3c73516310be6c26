# SPDX-License-Identifier: GPL-2.0-or-later
"""Path data: what a strict reader finds in them, and how short they are."""

from __future__ import annotations

import re

import numpy as np
import pytest
from loops import polygon, random_loop, rectangle, spline
from pathparser import commands, parse

from ddtcore.model import CUBIC, LINE, QUADRATIC, Loop
from ddtcore.pathdata import number_text, path_data, path_texts


def errors(data, loops, decimals):
    """Largest distance of each segment's points from where they should be, in units of the last digit."""
    found = parse(data)
    assert len(found) == len(loops)
    result = []
    for read, loop in zip(found, loops):
        assert [len(points) - 1 for points in read] == loop.degree.tolist()
        for points, control, degree in zip(read, loop.control, loop.degree):
            meant = control[{LINE: [0, 3], QUADRATIC: [0, 1, 3], CUBIC: [0, 1, 2, 3]}[degree]]
            result.append(np.abs(np.array(points, dtype=float) - meant).max() * 10**decimals)
    return np.array(result)


@pytest.mark.parametrize("decimals", range(6))
def test_every_point_is_within_half_a_unit_however_long_the_path(decimals):
    rng = np.random.default_rng(decimals)
    loops = [random_loop(rng, count) for count in (3, 40, 2000)]
    assert errors(path_data(loops, decimals), loops, decimals).max() <= 0.5 + 1e-6


def test_loops_close_and_follow_each_other():
    loops = [rectangle(1, 1, 8, 5), rectangle(3, 2, 2, 2), rectangle(300, 200, 4, 4)]
    assert [loop[0][0] for loop in parse(path_data(loops, 1))] == [(1, 1), (3, 2), (300, 200)]
    assert errors(path_data(loops, 1), loops, 1).max() == 0


@pytest.mark.parametrize("decimals", range(4))
@pytest.mark.parametrize("seed", range(5))
def test_smooth_quadratics_need_two_numbers_each_and_stay_within_a_unit(decimals, seed):
    rng = np.random.default_rng(seed)
    angle = np.linspace(0, 2 * np.pi, 1000, endpoint=False)
    radius = 400 + rng.normal(0, 3, 1000)
    loops = [spline(np.stack([500 + radius * np.cos(angle), 500 + radius * np.sin(angle)], axis=1))]
    data = path_data(loops, decimals)
    assert errors(data, loops, decimals).max() <= 1 + 1e-6
    assert [letter for letter, _ in commands(data)].count("q") == 1


def test_a_corner_between_quadratics_restarts_the_chain():
    loop = spline([(0, 0), (10, 0), (20, 3), (20, 10), (12, 15), (0, 10)])
    control = loop.control.copy()
    control[3, 1:3] += 4
    loops = [Loop(control, loop.degree)]
    data = path_data(loops, 2)
    assert errors(data, loops, 2).max() <= 1
    assert [letter for letter, _ in commands(data)] == list("Mqttqqtz")


@pytest.mark.parametrize("decimals", (0, 1, 2))
def test_nothing_in_the_text_is_superfluous(decimals):
    rng = np.random.default_rng(7)
    data = path_data([random_loop(rng, 30, size) for size in (5, 50, 500) for _ in range(20)], decimals)
    assert not re.search(r" -|[a-zA-Z] | [a-zA-Z]|\+|e|,", data)
    assert not re.search(r"(?<![\d.])0\d|(?<!\d)0\.|\.\d*0(?!\d)|\.(?!\d)|-0(?![\d.])", data)
    assert not re.search(r"\.\d+ \.", data), "a fraction ends where the next point begins"
    letters = re.findall("[a-zA-Z]", data)
    repeated = [a for a, b in zip(letters, letters[1:]) if a == b]
    assert repeated == [] and "ml" not in "".join(letters)


def curve(*points):
    """One cubic, closed by a line."""
    control = np.array([points, [points[3]] * 2 + [points[0]] * 2], dtype=float)
    return Loop(control, np.array([CUBIC, LINE], np.uint8))


def chain(*cubics):
    return Loop(np.array(cubics, dtype=float), np.full(len(cubics), CUBIC, np.uint8))


@pytest.mark.parametrize("loops, decimals, expected", [
    ([rectangle(0, 0, 4, 2.5)], 1, "M0 0h4v2.5H0z"),
    ([rectangle(100, 100, 4, 4)], 1, "M100 100h4v4h-4z"),
    ([polygon([(1, 1), (1.5, 0.7), (1.7, 1.2)])], 1, "M1 1l.5-.3.2.5z"),
    ([polygon([(1, 1), (2, 3), (4, 7)]), polygon([(101, 101), (102, 103), (104, 99)])], 0,
     "M1 1l1 2 2 4zM101 101l1 2 2-4z"),
    ([polygon([(101, 101), (102, 103), (104, 99)]), polygon([(106, 106), (107, 108), (109, 104)])], 0,
     "M101 101l1 2 2-4zm5 5 1 2 2-4z"),
    ([curve((0, 0), (0, 0), (2, 3), (5, 3))], 0, "M0 0s2 3 5 3z"),
    ([curve((0, 0), (1, 2), (2, 3), (5, 3))], 0, "M0 0c1 2 2 3 5 3z"),
    ([chain([(0, 0), (0, 3), (2, 5), (5, 5)], [(5, 5), (8, 5), (9, 1), (5, 0)],
            [(5, 0), (4, 0), (3, -1), (0, 0)])], 0, "M0 0c0 3 2 5 5 5s4-4 0-5c-1 0-2-1-5 0z"),
    ([spline([(0, 0), (8, 0), (8, 8), (0, 8)])], 0, "M0 4q0-4 4-4t4 4-4 4-4-4z"),
    ([polygon([(101, 101), (99, 103), (104, 99)])], 0, "m101 101-2 2 5-4z"),
], ids=["h v H", "far from 0", "signs and points part", "absolute move", "relative move with lines",
        "first handle on the start", "cubic", "mirrored handle", "mirrored control point",
        "move with lines"])
def test_shortest_form(loops, decimals, expected):
    assert path_data(loops, decimals) == expected


def test_only_a_cubic_lends_its_handle_to_the_next():
    control = np.array([[(0, 0), (2, 4), (2, 4), (5, 5)], [(5, 5), (8, 6), (9, 1), (6, 0)],
                        [(6, 0), (9, 9), (8, 1), (5, 0)], [(5, 0), (2, -1), (1, 1), (0, 0)]], dtype=float)
    degree = np.array([QUADRATIC, CUBIC, LINE, CUBIC], np.uint8)
    assert path_data([Loop(control, degree)], 0) == "M0 0q2 4 5 5c3 1 4-4 1-5H5c-3-1-4 1-5 0z"


def test_cubics_with_both_handles_on_the_chord_are_lines():
    control = np.array([[(0, 0), (1, 1), (2, 2), (3, 3)], [(3, 3), (6, 3), (2, 3), (0, 3)],
                        [(0, 3), (0, 2), (0, -1), (0, 1)], [(0, 1), (0, 1), (0, 0), (0, 0)]], dtype=float)
    assert path_data([Loop(control, np.full(4, CUBIC))], 0) == "M0 0l3 3c3 0-1 0-3 0 0-1 0-4 0-2z"


def test_what_is_too_small_for_the_grid_vanishes_without_a_trace():
    speck = random_loop(np.random.default_rng(0), 9, size=0.04)
    sliver = polygon([(5, 5), (8, 5.01), (8, 5.02)])
    kept = rectangle(1, 1, 2, 2)
    assert path_data([speck], 1) == path_data([sliver], 1) == path_data([], 1) == ""
    assert path_data([speck, kept, sliver], 1) == path_data([kept], 1)
    assert path_texts([[speck], [kept], [], [sliver]], 10, 1) == ["", path_data([kept], 1), "", ""]


@pytest.mark.parametrize("seed", range(30))
def test_loops_near_the_size_of_the_grid_stay_readable(seed):
    rng = np.random.default_rng(seed)
    loops = [random_loop(rng, int(rng.integers(1, 8)), size=3) for _ in range(20)]
    joints = {tuple(point) for loop in loops for point in np.rint(loop.control[:, 0]).astype(int).tolist()}
    for loop in parse(path_data(loops, 0)):
        assert loop
        for points in loop:
            assert (points[0] in joints) and len(set(points)) > 1


def test_paths_written_together_are_those_written_alone():
    rng = np.random.default_rng(3)
    paths = [[random_loop(rng, 5) for _ in range(count)] for count in (2, 1, 0, 4)]
    assert path_texts(paths, 100, 2) == [path_data(loops, 2) for loops in paths]


def test_whole_numbers_count_units_of_the_last_digit():
    loops = [random_loop(np.random.default_rng(4), 50)]
    enlarged = [Loop(loop.control * 100, loop.degree) for loop in loops]
    assert path_texts([loops], 100, 0) == path_texts([enlarged], 1, 0)


@pytest.mark.parametrize("value", (np.nan, np.inf, -np.inf))
def test_points_that_are_no_numbers_are_refused(value):
    loop = rectangle(0, 0, 1, 1)
    loop.control[2, 1, 0] = value
    with pytest.raises(ValueError, match="finite"):
        path_data([loop], 1)


@pytest.mark.parametrize("units, decimals, text", [
    (0, 0, "0"), (0, 3, "0"), (-5, 0, "-5"), (5, 1, ".5"), (-50, 2, "-.5"), (105, 2, "1.05"),
    (1000, 2, "10"), (-1, 3, "-.001"), (120, 1, "12"), (10, 0, "10")])
def test_number_text(units, decimals, text):
    assert number_text(units, decimals) == text
