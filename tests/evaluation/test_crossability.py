"""The truth of the limits: laws of the search, and its conditions against the exact twins."""

import math

import numpy as np
import pytest

from jaxleas.conditions import exact_collision, exact_strict_reachability
from jaxleas.evaluation.crossability import (
    can_cross,
    crossability,
    free_configurations,
    lattice,
)
from jaxleas.robots import load_robot
from jaxleas.terrain import Bar, Limit, limit_scenario

TALOS = load_robot("talos")
ANGLE = 0.4


def barrier(height, thickness=0.05):
    return Limit(bars=(Bar(thickness, math.inf, 0.0, height),))


def posts(room, thickness=0.05):
    return Limit(bars=(Bar(thickness, thickness, 0.0, 1.5),), period=thickness + room)


LADDERS = {
    "ledge up": lambda size: Limit(rise=size),
    "ledge down": lambda size: Limit(rise=-size),
    "gap": lambda size: Limit(gap=size),
    "hurdle": barrier,
    "posts": lambda size: posts(1.2 - size),
}
KINDS = {  # no size touches the trunk at a height of the search to the bit
    "ledge up": Limit(rise=0.3037),
    "ledge down": Limit(rise=-0.3037),
    "gap": Limit(gap=0.2537),
    "hurdle": barrier(0.3537),
    "posts": posts(0.7),
}


@pytest.mark.parametrize("kind", LADDERS)
def test_what_is_crossed_is_crossed_when_smaller_and_not_when_huge(kind):
    sizes = (0.1, 0.3, 0.5, 1.0)
    crossed = [can_cross(TALOS, LADDERS[kind](size), on_bars=True) for size in sizes]
    assert crossed == sorted(crossed, reverse=True)
    assert crossed[0]
    assert not crossed[-1]


@pytest.mark.parametrize("height", [0.7, 1.5])
@pytest.mark.parametrize("thickness", [0.02, 0.3])
def test_no_wall_is_too_thin_to_stop_the_trunk(height, thickness):
    assert crossability(TALOS, barrier(height, thickness)) == "hopeless"


def test_the_three_answers_follow_each_other_as_a_gap_grows():
    answers = [crossability(TALOS, Limit(gap=size)) for size in (0.1, 0.27, 0.4)]
    assert answers == ["crossable", "between", "hopeless"]


def test_the_widest_gap_is_the_diagonal_of_the_square_under_the_root():
    """R* reads |x|, |y| <= 0.1 m: at 45 degrees its corners are 0.283 m apart (T eq. 3.6)."""
    assert can_cross(TALOS, Limit(gap=0.27), on_bars=False)
    assert not can_cross(TALOS, Limit(gap=0.31), on_bars=False)


def test_a_low_bar_that_is_wider_than_the_square_is_stepped_on_or_stops():
    wide = barrier(0.1, 0.45)
    assert can_cross(TALOS, wide, on_bars=True)
    assert not can_cross(TALOS, wide, on_bars=False)


def test_a_larger_obstacle_is_larger_in_every_size():
    worse = Limit(-0.3, 0.2, (Bar(0.05, 0.05, 0.0, 0.9),), 1.0).worse(0.04)
    bar = worse.bars[0]
    sizes = (worse.rise, worse.gap, worse.period, bar.thickness, bar.length, bar.bottom, bar.top)
    assert sizes == pytest.approx((-0.34, 0.24, 1.0, 0.09, 0.09, 0.0, 0.94))


@pytest.mark.parametrize("kind", KINDS)
def test_configurations_are_free_where_the_exact_twins_say_so(kind):
    """On the polygons of the scene, turned by an angle that the search does not know."""
    limit = KINDS[kind]
    free = free_configurations(TALOS, limit, on_bars=False)
    headings, across, along, heights = lattice(TALOS, limit)
    picked = np.random.default_rng(0).integers(0, free.shape, size=(1500, 4))
    mine = free[tuple(picked.T)]
    local = np.column_stack([across[picked[:, 1]], along[picked[:, 2]]])
    turn = np.array([[math.cos(ANGLE), -math.sin(ANGLE)], [math.sin(ANGLE), math.cos(ANGLE)]])
    position = np.column_stack([local @ turn.T, heights[picked[:, 3]]])
    yaw = headings[picked[:, 0]] + ANGLE
    scene = limit_scenario(kind, limit, ANGLE).scene
    surfaces = list(scene.surfaces.values())
    everything = [*surfaces, *scene.obstacles.values()]
    exact = exact_strict_reachability(TALOS, surfaces, position, yaw)
    exact &= exact_collision(TALOS, everything, position, yaw)
    assert 100 < mine.sum() < 1490
    assert not (mine & ~exact).any()
    # The other way round, points 1 cm apart miss what the legs reach by less.
    assert (exact & ~mine).mean() < 0.01
