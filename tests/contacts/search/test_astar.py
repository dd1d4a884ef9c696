"""The planner `astar`: exact by a slow twin, and by verdicts from outside."""

import json
import time

import numpy as np
import pytest

from jaxleas.contacts import (
    certify,
    plan_astar,
    plan_mip,
)
from jaxleas.contacts.search.decide_by_sets import decide_by_sets
from jaxleas.types import InputError
from tests.contacts.effectors import FLOOR
from tests.contacts.search.worlds import slow_twin, tilted_world
from tests.contacts.test_planners import MODELS
from tests.contacts.worlds import (
    content,
    moved,
    problem,
    random_world,
    rectangle,
    stones,
)

MARGIN = 1e-6  # verdicts nearer to the limits than this are not compared [m]


@pytest.mark.parametrize("twice", [False, True])
@pytest.mark.parametrize("model", MODELS)
def test_the_verdict_is_that_of_brute_force(model: str, twice: bool) -> None:
    verdicts = _against_the_twin(model, twice, range(9, 17))
    assert 2 <= sum(verdicts) <= 7, "worlds must be of both kinds"


@pytest.mark.slow
@pytest.mark.parametrize("twice", [False, True])
@pytest.mark.parametrize("model", MODELS)
def test_the_verdict_is_that_of_brute_force_on_more(model: str, twice: bool) -> None:
    _against_the_twin(model, twice, range(20, 32), steps=5)


def _against_the_twin(model: str, twice: bool, seeds: range, steps: int = 4) -> list[bool]:
    verdicts = []
    for seed in seeds:
        described = tilted_world(seed, model, steps, twice)
        room, asked = slow_twin(described), problem(described)
        plan = plan_astar(asked, diagnose=False)
        if abs(room) > MARGIN:
            assert plan.status == ("feasible" if room > 0.0 else "infeasible"), seed
        if plan.feasible:
            assert certify(asked, plan).certified
        verdicts.append(room > 0.0)
    return verdicts


@pytest.mark.parametrize("model", MODELS)
def test_the_least_gap_that_cannot_be_stepped_over(model: str) -> None:
    start, goal = rectangle(-0.5, 0.1, -0.5, 0.5), lambda gap: rectangle(gap, 2, -0.5, 0.5)
    for gap, feasible in ((0.39999, True), (0.40001, False)):
        described = content({"a": start, "b": goal(gap)}, [["a"], ["b"]], model)
        assert plan_astar(problem(described), diagnose=False).feasible == feasible


@pytest.mark.parametrize("model", MODELS)
def test_a_foot_that_moves_twice_may_correct_itself(model: str) -> None:
    """LF on a far stone, LF back beside RF, RF ahead: RF stands still in between.

    What LF can reach first bounds where RF stands, and so where LF lands next.
    """
    surfaces = {
        "floor": rectangle(-0.5, 0.5, -0.5, 0.5),
        "far": rectangle(0.55, 0.7, 0.05, 0.5),
        "goal": rectangle(0.65, 0.9, -0.5, 0.0),
        "beyond": rectangle(0.86, 1.2, 0.05, 0.5),
    }
    feet = ["RF", "LF", "LF", "LF"]
    for last, feasible in (("goal", True), ("beyond", False)):
        names = [["floor"], ["far"], ["floor"], ["far"] if last == "goal" else ["beyond"]]
        described = content(surfaces, names, model)
        for phase, foot in zip(described["phases"], feet, strict=True):
            phase["foot"] = foot
        plan = plan_astar(problem(described), diagnose=False)
        assert plan.feasible == feasible == plan_mip(problem(described), diagnose=False).feasible


@pytest.mark.parametrize("model", MODELS)
def test_verdicts_do_not_depend_on_where_and_whither(model: str) -> None:
    for seed in range(4):
        described = random_world(seed, model)
        here = plan_astar(problem(described), diagnose=False)
        for angle, shift in ((0.7, [3.0, -2.0, 1.0]), (-2.5, [0.0, 40.0, 0.0])):
            there = moved(described, angle, np.array(shift))
            assert plan_astar(problem(there), diagnose=False).status == here.status


def test_walls_and_a_point_foot() -> None:
    """A surface may stand upright, and a sole may be a point."""
    wall = [[0.2, -0.5, -0.1], [0.2, 0.5, -0.1], [0.2, 0.5, 0.3], [0.2, -0.5, 0.3]]
    surfaces = {"floor": rectangle(-0.5, 0.1, -0.5, 0.5), "wall": wall}
    described = content(surfaces, [["floor"], ["wall"], ["floor", "wall"]], foot_half_size=[0, 0])
    asked = problem(described)
    plan = plan_astar(asked)
    assert plan.feasible
    assert certify(asked, plan).certified
    assert plan.surfaces[1] == "wall"


def test_sets_grow_with_candidates_and_are_few() -> None:
    """36 steps over a row of stones: one expansion a step."""
    described = stones(0.1, count=36)
    free = problem(described).without_guide()
    found = decide_by_sets(free)
    assert found.status == "optimal"
    assert found.expansions == 36


def test_why_there_is_no_plan() -> None:
    asked = problem(stones(0.45))
    plan, other = plan_astar(asked), plan_mip(asked)
    assert (plan.status, plan.cause) == ("infeasible", "infeasible")
    assert plan.last_feasible_step == other.last_feasible_step
    assert plan.reason == other.reason


def test_other_than_two_feet_are_refused() -> None:
    described = content({"floor": FLOOR.tolist()}, [["floor"]], "feet")
    described["robot"] = "somebody"
    feet = ("LF", "RF", "MF")
    described["initial"]["MF"] = {"position": [-0.1, 0.0, 0.0], "yaw": 0.0}
    box = described["polytopes"]["RF_in_LF"]
    described["polytopes"] = {f"{a}_in_{b}": box for a in feet for b in feet if a != b}
    asked = problem(json.loads(json.dumps(described)))
    with pytest.raises(InputError, match="plans for two feet, and 3 stand here"):
        plan_astar(asked)


@pytest.mark.parametrize("limit", [0.0, -1.0, float("nan")])
def test_a_time_limit_must_be_positive(limit: float) -> None:
    with pytest.raises(InputError, match="positive number of seconds"):
        plan_astar(problem(stones(0.1)), time_limit=limit)


def test_a_time_limit_is_no_verdict() -> None:
    begin = time.perf_counter()
    plan = plan_astar(problem(stones(0.1)), time_limit=1e-6)
    assert plan.status == "time_limit"
    assert "not decided within the time limit" in plan.reason
    assert time.perf_counter() - begin < 20.0
