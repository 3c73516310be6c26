# SPDX-License-Identifier: GPL-2.0-or-later
"""The polish: disturbed shapes go back to where the pixels say they are, and never get worse."""

from __future__ import annotations

import numpy as np
import pytest
from pictures import away, coverage, disc, rectangle, star

import ddtcore.polish
from ddtcore import bezier
from ddtcore.coverage import SAGITTA
from ddtcore.newton import solve
from ddtcore.polish import FARTHEST, STRAY, Target, Wire, polish

CENTRE = np.array([20.3, 19.6])
INK = np.array([250.0, 200.0, 90.0, 255.0])


def pixels(share) -> np.ndarray:
    """A picture of ink on nothing, RGBA."""
    image = np.tile(INK.astype(np.uint8), (*share.shape, 1))
    image[..., 3] = np.rint(share * 255)
    return image


def polished(wire, image, rounds):
    return polish(wire, Target.of(image, wire.step, 0), rounds)[0]


def loop(nodes, handles, smooth, line) -> Wire:
    """A closed wire round ink, which lies on the right."""
    n = len(nodes)
    ends = np.stack([np.arange(n), (np.arange(n) + 1) % n], axis=1)
    return Wire(np.array(nodes, float), np.zeros((n, 2), bool), ends, np.array(handles, float),
                np.full(n, smooth), np.full(n, line), np.tile(-INK, (n, 1)))


def circle(centre, radius) -> Wire:
    """Four smooth nodes, clockwise."""
    out = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)], float)
    reach = 4 / 3 * (np.sqrt(2) - 1) * radius
    handles = np.stack([out[[1, 2, 3, 0]], out], axis=1) * reach
    return loop(centre + radius * out, handles, True, False)


def polygon(points) -> Wire:
    return loop(points, np.zeros((len(points), 2, 2)), False, True)


def outline(wire, count=60, begin=0.5):
    """Points along the wire."""
    t = np.tile((np.arange(count) + begin) / count, len(wire.ends))
    return bezier.evaluate(wire.control(), np.repeat(np.arange(len(wire.ends)), count), t)


def misfit(wire, image):
    """Squared difference of the picture and the shape that one closed wire encloses."""
    share = coverage(outline(wire), image.shape[1], image.shape[0])
    return ((share - image[..., 3] / 255) ** 2).sum()


def disturbed(wire, seed, much=0.4) -> Wire:
    """Moved nodes, turned and stretched handles; smooth nodes stay smooth."""
    random = np.random.RandomState(seed)
    turn = random.uniform(-0.1, 0.1, len(wire.nodes))[wire.ends]
    x, y = np.moveaxis(wire.handles * random.uniform(0.8, 1.2, (len(wire.ends), 2, 1)), 2, 0)
    handles = np.stack([np.cos(turn) * x - np.sin(turn) * y, np.sin(turn) * x + np.cos(turn) * y], axis=2)
    return wire._replace(nodes=wire.nodes + random.uniform(-much, much, wire.nodes.shape), handles=handles)


def rms(values):
    return np.sqrt(np.mean(np.square(values)))


@pytest.mark.parametrize("seed", range(5))
def test_circles_are_found_again(seed):
    image = pixels(coverage(disc(CENTRE, 13.4), 40, 40))
    rough = disturbed(circle(CENTRE, 13.4), seed)
    fine = polished(rough, image, 8)
    error = np.hypot(*(outline(fine) - CENTRE).T) - 13.4
    assert rms(np.hypot(*(outline(rough) - CENTRE).T) - 13.4) > 0.1
    assert rms(error) < 0.02
    assert abs(error.mean()) < 0.005


@pytest.mark.parametrize("radius", [8.2, 13.4, 17.5])
def test_a_circle_drawn_in_chords_comes_out_as_it_was(radius):
    """Rasterisers draw polygons in place of curves, which are smaller: told so, curves explain them at full size."""
    centre, sagitta = (22.3, 21.6), 0.04
    bend = np.hypot(*np.diff(circle(centre, radius).control()[0], 2, 0).T).max()
    count = int(np.ceil(np.sqrt(0.75 / sagitta * bend)))
    image = pixels(coverage(outline(circle(centre, radius), count, 0), 44, 44))
    wire = disturbed(circle(centre, radius), 2, 0.2)
    target = Target.of(image, wire.step, 0)
    exact, chords = (polish(wire, aim, 8)[0] for aim in (target, target._replace(sagitta=sagitta)))
    smaller, same = (np.hypot(*(outline(found) - centre).T).mean() - radius for found in (exact, chords))
    assert smaller < -0.01
    assert abs(same) < 0.005


def test_how_far_chords_stray_is_told_by_how_well_pixels_are_explained():
    target = Target.of(pixels(coverage(disc(CENTRE, 13.4), 40, 40)), np.array([INK]), 0)
    strays = [target.drawn_in_chords(off).sagitta for off in (0, 0.004, 0.008, 0.012, 0.5)]
    assert strays[0] == target.sagitta == SAGITTA
    assert np.allclose(strays[1:], [STRAY * 0.004, STRAY * 0.008, STRAY * 0.012, FARTHEST])
    wire = circle(CENTRE, 13.4)
    assert polish(wire, target, 8)[1] < 0.003
    noise = np.random.RandomState(0).normal(0, 0.03, (40, 40))
    noisy = pixels(np.clip(coverage(disc(CENTRE, 13.4), 40, 40) + noise, 0, 1))
    assert 0.01 < polish(wire, Target.of(noisy, wire.step, 0), 8)[1] < 0.04


@pytest.mark.parametrize("degrees", [0, 10, 33, 45])
@pytest.mark.parametrize("seed", range(3))
def test_squares_are_found_again(degrees, seed):
    truth = rectangle(CENTRE, 21, 17, degrees)
    image = pixels(coverage(truth, 40, 40))
    rough = disturbed(polygon(truth), seed)
    fine = polished(rough, image, 8)
    assert np.abs(away(outline(rough), truth)).max() > 0.1
    assert rms(away(outline(fine), truth)) < 0.02
    # Corners too, not only the sides.
    assert np.hypot(*(fine.nodes - truth).T).max() < 0.05


def test_thin_strokes_get_their_width():
    """No pixel of a stroke of 0.8 px is full: both sides are found together."""
    truth = rectangle(CENTRE, 25, 0.8, 20)
    image = pixels(coverage(truth, 40, 40))
    fine = polished(polygon(rectangle((20.4, 19.5), 25.3, 1.3, 21)), image, 10)
    sides = np.hypot(*(np.roll(fine.nodes, -1, axis=0) - fine.nodes).T)
    assert sides[[1, 3]] == pytest.approx(0.8, abs=0.03)
    assert rms(away(outline(fine), truth)) < 0.02


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("rounds", [1, 2, 3])
def test_the_picture_is_never_explained_worse(seed, rounds):
    truth = star(CENTRE, 15, 9, 5, 11 * seed)
    image = pixels(coverage(truth, 40, 40))
    for rough in (disturbed(circle(CENTRE, 12), seed), disturbed(polygon(truth), seed, 0.5)):
        assert misfit(polished(rough, image, rounds), image) <= 1.02 * misfit(rough, image)


def test_what_is_right_already_stays():
    truth = rectangle(CENTRE, 21, 17, 10)
    fine = polished(polygon(truth), pixels(coverage(truth, 40, 40)), 3)
    assert np.abs(fine.nodes - truth).max() < 0.005


@pytest.mark.parametrize("rounds", [2, 5, 50])
def test_rounds_end_when_nothing_is_gained(rounds, monkeypatch):
    solved = []
    monkeypatch.setattr(ddtcore.polish, "solve", lambda problem: solved.append(1) or solve(problem))
    truth = rectangle(CENTRE, 21, 17, 10)
    polished(polygon(truth), pixels(coverage(truth, 40, 40)), rounds)
    right = len(solved)
    polished(disturbed(polygon(truth), 1, 0.5), pixels(coverage(truth, 40, 40)), rounds)
    assert right <= 2 <= len(solved) - right <= min(rounds, 8)


def test_no_rounds_change_nothing():
    wire = disturbed(circle(CENTRE, 12), 1)
    fine = polished(wire, pixels(coverage(disc(CENTRE, 13), 40, 40)), 0)
    assert np.array_equal(fine.nodes, wire.nodes) and np.array_equal(fine.handles, wire.handles)


def test_smooth_nodes_stay_smooth():
    image = pixels(coverage(star(CENTRE, 14, 11, 5), 40, 40))
    fine = polished(disturbed(circle(CENTRE, 12), 2), image, 6)
    arriving, leaving = np.roll(fine.handles[:, 1], 1, axis=0), fine.handles[:, 0]
    cross = arriving[:, 0] * leaving[:, 1] - arriving[:, 1] * leaving[:, 0]
    size = np.hypot(*arriving.T) * np.hypot(*leaving.T)
    assert np.abs(cross / size).max() < 1e-9
    assert (np.einsum("nd,nd->n", arriving, leaving) < 0).all()


def test_lines_stay_lines():
    wire = polygon(star(CENTRE, 15, 9))
    fine = polished(wire, pixels(coverage(disc(CENTRE, 12), 40, 40)), 5)
    assert fine.line.all()
    control = fine.control()
    assert np.allclose(control, bezier.from_line(control[:, 0], control[:, 3]))


def divided(top, bottom, left=(255, 60, 0, 255), right=(20, 90, 250, 255)):
    """A picture of two colours divided by a line from (top, 0) to (bottom, 20), and its wire."""
    share = coverage([(top, 0), (60, 0), (60, 20), (bottom, 20)], 30, 20)[..., None]
    image = np.rint(np.array(right) * share + np.array(left) * (1 - share)).astype(np.uint8)
    nodes = np.array([(top, 0), (30, 0), (30, 20), (bottom, 20), (0, 20), (0, 0)])
    fixed = np.ones((6, 2), bool)
    fixed[[0, 3], 0] = False
    ends = np.array([(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 0), (0, 3)])
    # Beside the picture's border the outside is on the left, and is 0.
    step = -np.array([right, right, right, left, left, left, np.subtract(left, right)], float)
    return image, Wire(nodes, fixed, ends, np.zeros((7, 2, 2)), np.zeros(6, bool), np.ones(7, bool), step)


def test_nodes_on_the_border_of_the_picture_stay_there_and_glide_along_it():
    image, truth = divided(12.3, 17.8)
    nodes = truth.nodes.copy()
    nodes[[0, 3], 0] += [0.6, -0.7]
    rough = truth._replace(nodes=nodes)
    fine = polished(rough, image, 6)
    assert np.array_equal(fine.nodes[truth.fixed], truth.nodes[truth.fixed])
    assert np.abs(fine.nodes - truth.nodes).max() < 0.01


def test_a_pixel_of_quite_another_colour_hardly_counts():
    """Speckles merged into their neighbour, say, must not bend the curves."""
    truth = rectangle(CENTRE, 21, 17, 10)
    image = pixels(coverage(truth, 40, 40))
    middle = truth[:2].mean(axis=0).astype(int)
    image[middle[1], middle[0]] = [0, 0, 255, 255]
    fine = polished(disturbed(polygon(truth), 1), image, 8)
    assert rms(away(outline(fine), truth)) < 0.1


@pytest.mark.parametrize("seed", range(4))
def test_pictures_that_no_curve_explains_do_no_harm(seed):
    random = np.random.RandomState(seed)
    image = random.randint(0, 256, (40, 40, 4)).astype(np.uint8)
    rough = disturbed(circle(CENTRE, 12), seed)
    fine = polished(rough, image, 4)
    assert np.isfinite(fine.nodes).all() and np.isfinite(fine.handles).all()
    # A round moves a node by a pixel at most.
    assert np.hypot(*(fine.nodes - rough.nodes).T).max() <= 4 + 1e-9


def test_a_step_that_makes_things_worse_is_taken_back():
    """In noise some steps do: then one more round gives the very same wire."""
    random = np.random.RandomState(2)
    image = random.randint(0, 256, (40, 40, 4)).astype(np.uint8)
    rough = disturbed(circle(CENTRE, 12), 2)
    nodes = [polished(rough, image, rounds).nodes for rounds in range(9)]
    assert any(np.array_equal(one, other) for one, other in zip(nodes, nodes[1:]))


@pytest.mark.parametrize("length, size, block", [(14000, 1000, 1), (20000, 1000, 2), (20000, 500, 1), (35000, 500, 2)])
def test_many_pixels_are_explained_in_blocks_sooner_where_outlines_are_sparse(length, size, block):
    image = np.zeros((size, size, 4), np.uint8)
    assert Target.of(image, np.ones((1, 4)), length).block == block
