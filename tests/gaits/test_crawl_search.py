"""Crawls found by the search: legal episodes of the task, and honest where there is no way."""

from dataclasses import replace

import jax
import numpy as np
import pytest

from jaxleas.envs.gait_planning import GaitPlanning, GaitPlanningConfig, GaitWorldsConfig
from jaxleas.envs.gait_planning.actions import action_of
from jaxleas.gaits import CrawlSettings, search_crawls
from jaxleas.gaits.on_terrain import OnTerrain
from tests.gaits.worlds import platform, with_gap

CONFIG = GaitPlanningConfig()
NARROW = CrawlSettings(width=2)
START, GOAL = (0.2, 2.0, 0.0), (1.9, 2.0)


def crawl(terrain, settings=NARROW, start=START, goal=GOAL):
    place = OnTerrain(CONFIG, terrain)
    return place, search_crawls(CONFIG, place.footing, place.stand(start, goal), settings)[0]


@pytest.fixture(scope="module")
def across():
    return crawl(with_gap(0.16))


def test_a_crawl_crosses_a_gap_to_the_goal(across):
    _, gait = across
    last = gait.states.phase.com[-1, :2]
    assert gait.ending == "reached"
    assert np.linalg.norm(last - gait.states.goal[-1]) < CONFIG.goal_radius
    assert 8 <= len(gait.commands.turn) <= 60


@pytest.mark.parametrize("placing", ["base_first", "feet_first"])
def test_the_task_accepts_every_transition_and_gets_to_the_same_states(across, placing):
    place, gait = across
    task = GaitPlanning(GaitPlanningConfig(placing=placing), GaitWorldsConfig())
    weights = {f"reward.{name}": value for name, value in CONFIG.reward}
    state = jax.tree.map(lambda leaf: leaf[:1], gait.states)
    for number in range(len(gait.commands.turn)):
        command = type(gait.commands)(*(part[number : number + 1] for part in gait.commands))
        ground = place.footing.ground
        after = jax.tree.map(lambda leaf, row=number + 1: leaf[row : row + 1], gait.states.phase)
        action = action_of(task.config, state, command, after)
        state, result = task.advance(
            ground, weights, replace(state, step=0 * state.step), action, ()
        )
        assert not result.terminated[0], (number, result.measures)
        moved = after.support != 0  # a foot in the air is where the command plans it
        np.testing.assert_array_equal(state.phase.support, after.support)
        np.testing.assert_allclose(state.phase.com, after.com, atol=1e-5)
        np.testing.assert_allclose(state.phase.feet, after.feet, atol=1e-4 if moved else 1e-5)
    assert result.reached[0]


def test_a_gap_too_wide_is_not_crossed_and_the_way_ends_before_it():
    _, gait = crawl(with_gap(0.6), replace(NARROW, most_phases=30))
    assert gait.ending != "reached"
    edge = 1.5 - 0.3  # in the task's frame, which begins at the map's corner
    assert gait.states.phase.feet[..., 0].max() < edge
    assert gait.states.phase.com[-1, 0] > gait.states.phase.com[0, 0]


def test_several_robots_are_planned_for_as_each_alone():
    place = OnTerrain(CONFIG, platform())
    ahead = place.stand(START, (1.3, 2.0))
    back = place.stand((1.8, 2.0, 3.0), (0.7, 2.1))
    both = jax.tree.map(lambda *leaves: np.concatenate(leaves), ahead, back)
    together = search_crawls(CONFIG, place.footing, both, NARROW)
    for each, alone in zip(together, (ahead, back), strict=True):
        (expected,) = search_crawls(CONFIG, place.footing, alone, NARROW)
        assert each.ending == expected.ending == "reached"
        np.testing.assert_array_equal(each.states.phase.feet, expected.states.phase.feet)
