"""Velocity A*: the best of all sequences, walked on a walker whose law is known."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.footsteps import (
    FitSettings,
    FootCostMap,
    Goal,
    SearchSettings,
    WalkingState,
    fit_motion_models,
    plan_footsteps,
    require_start,
    settings_for,
)
from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.framed_map import ball_heights
from jaxleas.footsteps.limits import Limits
from jaxleas.footsteps.search_states import start_node
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError
from tests.footsteps.brute_force import best_cost, distance_of, step
from tests.footsteps.made import IDENTITY, NOMINAL, RIDE_HEIGHT, walked

CELL, BUFFER = 0.02, 0.03
GOAL = Goal(1.8, 0.1, 0.0)
SLOW = np.array([0.4, 0.0, 0.0])


@pytest.fixture(scope="module")
def models():
    """Models of all movements, and of forward and left alone."""
    records = walked(20, 60, noise=0.001)
    return [
        fit_motion_models(records, FitSettings(movements, network=False)).model
        for movements in (
            ("forward", "left", "right", "clockwise", "counter-clockwise"),
            ("forward", "left"),
        )
    ]


def ground(gaps=(), rise=0.0, at=1.0) -> HeightMap:
    """Return 4 m by 2 m of ground; gaps are intervals of x without any, `rise` a step up."""
    x = -1.0 + CELL * np.arange(200)
    heights = np.where(x > at, rise, 0.0)[None] * np.ones((100, 1))
    for begin, end in gaps:
        heights[:, (x > begin) & (x < end)] = np.nan
    return HeightMap(heights.astype(np.float32), CELL, (-1.0, -1.0))


def costs_of(height_map, buffer=BUFFER):
    return FootCostMap.of(height_map, buffer)


def standing(x=0.0, y=0.0, yaw=0.0, pair=0):
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    feet = np.column_stack([NOMINAL @ turn.T + [x, y], np.zeros(4)])
    still = np.zeros(3)
    return WalkingState(np.array([x, y, RIDE_HEIGHT]), yaw, still, 0.0, feet, pair, still)


def shaken(seed):
    """Return a state and a course of gaps, at random."""
    generator = np.random.default_rng(seed)
    x, y = generator.uniform((-0.3, -0.2), (0.1, 0.2))
    state = standing(x, y, generator.uniform(-0.5, 0.5), int(generator.integers(2)))
    velocity = np.append(generator.uniform(0, 0.5, 2), 0.0)
    command = np.array([generator.integers(1, 9) / 10, 0.0, 0.0])
    gaps = [(begin, begin + 0.09) for begin in np.arange(-0.25, 1.5, generator.uniform(0.2, 0.3))]
    return replace(state, com_velocity=velocity, command=command), costs_of(ground(gaps))


@pytest.mark.parametrize("seed", range(6))
def test_no_sequence_of_commands_is_better_than_the_plan(models, seed):
    state, costs = shaken(seed)
    plan = plan_footsteps(models[1], costs, state, GOAL, SearchSettings(2))
    assert plan.cost == pytest.approx(best_cost(models[1], costs, state, GOAL, 2, 10.0), abs=1e-9)
    assert plan.gap == 0.0
    narrow = plan_footsteps(models[1], costs, state, GOAL, SearchSettings(2, width=20))
    if np.isfinite(plan.cost):
        assert plan.cost - 1e-9 <= narrow.cost <= plan.cost + 0.3
        assert narrow.cost - narrow.gap <= plan.cost + 1e-9


def test_three_footsteps_are_exact_too(models):
    state, costs = shaken(3)
    plan = plan_footsteps(models[1], costs, state, GOAL, SearchSettings(3))
    assert len(plan.footsteps) == 3
    assert plan.cost == pytest.approx(best_cost(models[1], costs, state, GOAL, 3, 10.0), abs=1e-9)


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_the_world_may_be_turned(models, yaw):
    """On flat ground far from borders only the goal's place in the robot's frame matters."""
    wide = HeightMap(np.zeros((400, 400), np.float32), CELL, (-4.0, -4.0))
    goal = Goal(2 * np.cos(yaw), 2 * np.sin(yaw), yaw)
    plan = plan_footsteps(models[0], costs_of(wide), standing(yaw=yaw), goal)
    ahead = plan_footsteps(models[0], costs_of(wide), standing(), Goal(2.0, 0.0, 0.0))
    assert plan.cost == pytest.approx(ahead.cost, abs=1e-6)
    np.testing.assert_array_equal(plan.command, ahead.command)


def test_each_planned_footstep_is_one_that_the_twin_allows(models):
    state, costs = shaken(2)
    plan = plan_footsteps(models[0], costs, state, GOAL, settings_for(4))
    assert plan.status == "horizon"
    velocity = np.append(state.com_velocity, state.yaw_rate)
    turn = -state.yaw
    velocity[:2] = [
        np.cos(turn) * velocity[0] - np.sin(turn) * velocity[1],
        np.sin(turn) * velocity[0] + np.cos(turn) * velocity[1],
    ]
    here = (list(state.com[:2]), state.yaw, velocity, state.feet.tolist(), state.pair)
    here = (*here, list(state.command))
    for each in plan.footsteps:
        stepped = step(models[0], costs, here, each.command.tolist())
        assert stepped is not None
        here, _ = stepped
        np.testing.assert_allclose(each.com, here[0], atol=1e-9)
        np.testing.assert_allclose(each.feet, here[3], atol=1e-9)
    assert [each.pair for each in plan.footsteps] == [(state.pair + k) % 2 for k in range(4)]


def test_gaps_are_stepped_over(models):
    """Planned again at each contact, by the model itself, the robot gets to its goal."""
    gaps = [(0.45, 0.53), (0.85, 0.93), (1.25, 1.33)]
    costs = costs_of(ground(gaps))
    state, goal = standing(), Goal(1.8, 0.0, 0.0)
    for _ in range(30):
        plan = plan_footsteps(models[0], costs, state, goal, settings_for(4))
        if not plan.footsteps:
            break
        first = plan.footsteps[0]
        after = step_state(models[0], costs, state, first)
        swung = list(IDENTITY.pairs[first.pair])
        for x in after.feet[swung, 0]:
            assert not any(b - BUFFER < x < e + BUFFER for b, e in gaps)
        state = after
    assert plan.status == "reached"
    assert np.hypot(*(state.com[:2] - (goal.x, goal.y))) < 0.05


def step_state(model, costs, state, planned):
    turn, (vx, vy, vz) = -state.yaw, state.com_velocity
    local = [np.cos(turn) * vx - np.sin(turn) * vy, np.sin(turn) * vx + np.cos(turn) * vy, vz]
    start = (list(state.com[:2]), state.yaw, [*local, state.yaw_rate], state.feet.tolist())
    (com, yaw, velocity, feet, pair, command), _ = step(
        model, costs, (*start, state.pair, list(state.command)), planned.command.tolist()
    )
    u, v, w, rate = velocity
    world = [np.cos(yaw) * u - np.sin(yaw) * v, np.sin(yaw) * u + np.cos(yaw) * v, w]
    position = np.array([*com, RIDE_HEIGHT])
    return WalkingState(
        position, yaw, np.array(world), rate, np.array(feet), pair, np.array(command)
    )


def test_a_step_above_the_swing_is_refused(models):
    low = plan_footsteps(models[0], costs_of(ground(rise=0.05, at=0.37)), standing(), GOAL)
    assert low.status == "horizon"
    high = costs_of(ground(rise=0.2, at=0.45))
    goal = Goal(1.0, 0.0, 0.0)
    state = standing()
    statuses = set()
    for _ in range(12):
        plan = plan_footsteps(models[1], high, state, goal)
        statuses.add(plan.status)
        if not plan.footsteps:
            break
        state = step_state(models[1], high, state, plan.footsteps[0])
        assert state.feet[:, 2].max() == 0.0
    assert plan.refused["step height"] + plan.refused["landing"] > 0


@pytest.mark.parametrize(("rise", "largest"), [(0.05, 0.5), (0.08, 0.3)])
def test_the_higher_a_foot_steps_the_slower_it_does(models, rise, largest):
    model = replace(models[0], controller=replace(IDENTITY, swing_height=0.10))
    costs = costs_of(ground(rise=rise, at=0.37))
    node = start_node(replace(standing(), com_velocity=SLOW, command=SLOW), costs)

    def fastest(limits):
        expander = Expander(model, costs, limits)
        children = expander.children([node])
        climbs = np.isclose(children.landings[..., 2], rise).any(axis=1)
        shares = np.abs(expander.commands / np.array(IDENTITY.max_speeds)).max(axis=1)
        return shares[children.command[climbs]].max()

    assert largest - 0.21 < fastest(Limits(climbing=0.5)) <= largest + 1e-9
    assert fastest(Limits()) > 0.5


def test_a_foot_that_steps_down_clears_the_edge_with_its_whole_ball(models):
    """The twin lowers the ball onto each cell; a small one steps down nearer to the edge."""
    state = replace(standing(), com_velocity=np.array([0.4, 0.0, 0.0]), command=SLOW)
    down, goal = costs_of(ground(rise=-0.05, at=0.59)), Goal(1.0, 0.0, 0.0)
    found = []
    for radius in (0.001, 0.06):
        model = replace(models[1], controller=replace(IDENTITY, foot_radius=radius))
        found.append(plan_footsteps(model, down, state, goal, SearchSettings(1)))
        wanted = best_cost(model, down, state, goal, 1, 10.0)
        assert found[-1].cost == pytest.approx(wanted, abs=1e-9)
    small, large = found
    assert small.footsteps[0].feet[0, 0] > 0.59 > large.footsteps[0].feet[0, 0]
    assert large.refused["swing"] > small.refused["swing"]


def test_a_ball_on_a_cell_touches_what_is_beside_it():
    heights = np.full((9, 9), np.nan)
    heights[:, :5], heights[:, 6:] = 0.1, -0.5
    touched = ball_heights(heights, 0.01, 0.025)
    np.testing.assert_allclose(touched[:, :5], 0.1)
    beside = [0.1 + np.sqrt(0.025**2 - apart**2) - 0.025 for apart in (0.01, 0.02)]
    np.testing.assert_allclose(touched[4, 5:7], beside)
    np.testing.assert_allclose(touched[:, 7:], -0.5)  # it does not reach across the hole


def test_commands_that_go_up_and_down_are_held_back(models):
    """The second change in turn is limited, that of the measured start included."""
    wide = costs_of(ground())
    fast, slow = np.array([0.8, 0.0, 0.0]), np.array([0.24, 0.0, 0.0])
    largest = np.array(IDENTITY.max_speeds)
    state = replace(standing(), command=slow, earlier=fast)
    free = plan_footsteps(models[1], wide, state, GOAL, SearchSettings(3))
    held = plan_footsteps(models[1], wide, state, GOAL, SearchSettings(3, sway=0.9))
    commands = {
        name: np.array([fast, slow, *(each.command for each in plan.footsteps)]) / largest
        for name, plan in (("free", free), ("held", held))
    }
    sway = {name: np.abs(np.diff(each, 2, axis=0)[:, 0]) for name, each in commands.items()}
    assert sway["free"][0] > 1.2
    assert (sway["held"] <= 0.9 + 1e-9).all()
    assert len(held.footsteps) == 3


def test_a_walking_robot_concedes_some_of_the_buffer_before_it_stops(models):
    ledges = costs_of(ground([(-1.1, -0.48), (-0.2, 0.2), (0.56, 2.0)]), 0.16)
    still, concessions = standing(), (0.75, 0.5, 0.25)
    settings = SearchSettings(1, concessions=concessions)
    walking = replace(still, com_velocity=np.array([0.2, 0.0, 0.0]), command=SLOW)
    assert plan_footsteps(models[0], ledges, walking, GOAL, SearchSettings(1)).status == "stand"
    assert plan_footsteps(models[0], ledges, still, GOAL, settings).status == "stand"
    plan = plan_footsteps(models[0], ledges, walking, GOAL, settings)
    (first,) = plan.footsteps
    swung = list(IDENTITY.pairs[first.pair])
    kept = [distance_of(ledges, x, y) or 0.0 for x, y in first.feet[swung, :2]]
    share = min(kept) / ledges.buffer
    assert 0.5 < share <= 1.0
    for less in concessions:  # the first share by which there is a plan
        alone = plan_footsteps(
            models[0], ledges, walking, GOAL, SearchSettings(1, concessions=(less,))
        )
        if alone.footsteps:
            np.testing.assert_array_equal(alone.command, plan.command)
            break


def test_where_no_command_is_safe_the_robot_stands_and_says_why(models):
    islands = ground([(-1.1, -0.4), (-0.28, 0.28), (0.4, 2.0)])
    y = -1.0 + CELL * np.arange(100)
    between = (np.abs(np.abs(y) - 0.2) > 0.06)[:, None] & (np.arange(200) < 150)
    islands.heights[between] = np.nan
    plan = plan_footsteps(models[0], costs_of(islands, 0.045), standing(), GOAL)
    assert plan.status == "stand"
    assert plan.miss is not None
    assert plan.miss.foot in ("LF", "RH")
    assert (plan.command == 0).all()
    words = plan.in_words()
    assert words.startswith("no safe command: stand (")
    assert f"foot {plan.miss.foot} at ({plan.miss.place[0]:.2f}" in words
    assert "cm short of safe" in words


def test_at_the_goal_it_stands(models):
    plan = plan_footsteps(models[0], costs_of(ground()), standing(1.79, 0.12), GOAL)
    assert (plan.status, plan.footsteps) == ("reached", ())
    turned = plan_footsteps(models[0], costs_of(ground()), standing(1.79, 0.12, yaw=0.4), GOAL)
    assert turned.command[2] < 0


def test_the_greedy_cost_of_the_thesis_has_its_name(models):
    state, costs = shaken(3)
    plan = plan_footsteps(models[0], costs, state, GOAL, SearchSettings(2, cost="thesis"))
    last = plan.footsteps[-1]
    near = sum(
        max(0.07 - float(costs.distance[cell]), 0.0)
        for foot in IDENTITY.pairs[last.pair]
        for cell in [tuple(np.floor((last.feet[foot, 1::-1] + 1.0) / CELL + 0.5).astype(int))]
    )
    assert plan.cost == pytest.approx(np.hypot(*(last.com - (GOAL.x, GOAL.y))) + near)


def test_the_budget_ends_a_search_with_what_it_has(models):
    state, costs = shaken(2)
    plan = plan_footsteps(models[0], costs, state, GOAL, SearchSettings(8, most_expansions=3))
    assert (plan.status, plan.expansions) == ("budget", 3)
    assert 1 <= len(plan.footsteps) < 8


def test_bad_starts_and_goals_are_named():
    costs = costs_of(ground([(0.3, 0.5)]))
    with pytest.raises(InputError, match=r"no ground under foot LF at \(0.34, 0.20\) m: the near"):
        require_start(standing(), costs, IDENTITY)
    with pytest.raises(InputError, match=r"foot LF starts on an unsafe cell at \(0.28.*is \(0.2\d"):
        require_start(standing(x=-0.06), costs, IDENTITY)
    require_start(standing(x=-0.15), costs, IDENTITY)


def test_goals_outside_the_map_are_refused(models):
    with pytest.raises(InputError, match=r"goal \(9, 0\) is outside the map, which has x from -1"):
        plan_footsteps(models[0], costs_of(ground()), standing(), Goal(9.0, 0.0, 0.0))
