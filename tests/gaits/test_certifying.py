"""Certificates of gait plans: good plans hold, and each kind of damage is found."""

from dataclasses import replace

import jax
import numpy as np
import pytest

from jaxleas.envs.gait_planning import GaitPlanningConfig
from jaxleas.gaits import (
    CrawlSettings,
    OnTerrain,
    certify_gait,
    plan_of,
    read_gait_plan,
    search_crawls,
    write_gait_plan,
)
from jaxleas.types import InputError
from tests.gaits.worlds import with_gap

CONFIG = GaitPlanningConfig()
TERRAIN = with_gap(0.12)


@pytest.fixture(scope="module")
def plan():
    place = OnTerrain(CONFIG, TERRAIN)
    state = place.stand((0.3, 2.0, 0.0), (1.2, 2.0))
    (gait,) = search_crawls(CONFIG, place.footing, state, CrawlSettings(width=2))
    return plan_of(CONFIG, place.in_its_frame(gait), "search")


@pytest.fixture(scope="module")
def short(plan):
    """The first transitions alone: each is certified in a tenth of a second."""
    phases = jax.tree.map(lambda leaf: leaf[:6], plan.phases)
    return replace(plan, phases=phases, times=plan.times[:5])


def damaged(plan, **changes):
    return replace(plan, phases=replace(plan.phases, **changes))


def test_a_plan_of_the_search_holds(plan):
    found = certify_gait(plan, TERRAIN)
    assert plan.ending == "reached"
    assert found.holds
    assert found.confirmed == found.transitions == plan.length
    assert found.least_margin >= CONFIG.least_margin - 1e-6


def test_a_foothold_over_the_edge_is_named(short):
    feet = short.phases.feet.copy()
    feet[0, 0, 0] = 1.0  # above the gap
    found = certify_gait(damaged(short, feet=feet), TERRAIN)
    assert "LF of phase 0" in found.unsafe
    assert not found.holds


def test_a_centre_of_mass_outside_the_feet_is_not_confirmed(short):
    com = short.phases.com.copy()
    com[2, 1] += 0.3
    found = certify_gait(damaged(short, com=com), TERRAIN)
    assert found.confirmed < found.transitions
    assert not found.holds


def test_a_foot_out_of_reach_is_not_confirmed(short):
    lifted = int(np.flatnonzero(short.phases.support == 0)[0])
    feet = short.phases.feet.copy()
    feet[lifted, 1, 0] -= 0.7
    assert not certify_gait(damaged(short, feet=feet), TERRAIN).holds


def test_a_block_under_the_trunk_is_found(short):
    heights = TERRAIN.heights.copy()
    x, y = (short.phases.com[0, :2] - TERRAIN.origin) / TERRAIN.resolution
    heights[round(y), round(x)] += 0.45
    found = certify_gait(short, replace(TERRAIN, heights=heights))
    assert 0 in found.trunk
    assert not found.holds


def test_a_plan_comes_back_from_its_file(plan, tmp_path):
    write_gait_plan(tmp_path / "plan.json", plan, {"holds": True})
    back = read_gait_plan(tmp_path / "plan.json")
    assert (back.planner, back.ending, back.goal) == (plan.planner, plan.ending, plan.goal)
    assert back.robot == plan.robot
    assert back.program == plan.program
    for name in ("com", "yaw", "velocity", "feet", "support"):
        np.testing.assert_array_equal(getattr(back.phases, name), getattr(plan.phases, name))
    np.testing.assert_array_equal(back.times, plan.times)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"version": 1', '"version": 7', "version"),
        ('"times": [', '"times": [[1.0, 1.0], ', "one phase more than"),
        ('"RH": [', '"XX": [', "feet must be LF, RF, LH, RH"),
        ('"yaw": 0.0', '"yaw": "north"', "yaw"),
    ],
)
def test_a_damaged_file_is_refused_in_one_sentence(plan, tmp_path, old, new, message):
    path = tmp_path / "plan.json"
    write_gait_plan(path, plan, {})
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=message):
        read_gait_plan(path)
