"""The policies that are shipped do what the README says, on terrain nobody has looked at."""

from dataclasses import replace
from pathlib import Path

import pytest

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.evaluation.contender import contender
from jaxleas.evaluation.exact import judge_exact
from jaxleas.evaluation.examination import examine, load_candidate
from jaxleas.evaluation.suites import Suite, make_suite
from jaxleas.guide.leas import leas
from jaxleas.labels import Judge
from jaxleas.training.policy import read_policy

PRETRAINED = Path(__file__).resolve().parents[2] / "pretrained"


@pytest.mark.slow
def test_the_pretrained_policy_crosses_and_stops_where_it_cannot():
    candidate = load_candidate(PRETRAINED / "leas_p1.npz")
    for name in ("transitions", "dead_end"):
        for cell in examine(candidate, suite_of(name, 60), baseline=False).cells:
            assert cell.invalid == 0.0, (cell.name, cell.yaw)
            if name == "transitions":
                assert cell.reached == 1.0, (cell.name, cell.yaw)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("planner", "name", "cells"),
    [
        ("sampling", "transitions", ("rubble", "stairs_up")),
        ("sampling", "tables", ("rotation", "hole_rim")),
        ("mip", "footsteps", ("stairs_down", "long_course")),
    ],
)
def test_a_policy_that_knows_its_planner_is_planned_for(planner, name, cells):
    policy = read_policy(PRETRAINED / f"leas_p2_{planner}.npz")
    env = SteeringEnv(policy.config)
    suite = suite_of(name, 10)
    suite = replace(suite, cells=tuple(each for each in suite.cells if each.name in cells))
    with Judge(planner, robot="talos") as judge:
        results = judge_exact(
            env, {"p2": contender(env, leas(env, policy))}, suite, {planner: judge}
        )
    # 98 % in the worst of these cells: one miss a cell, and two in all, are within chance.
    missed = [round(each.starts * (1.0 - (each.planned or 0.0))) for each in results]
    assert max(missed) <= 1
    assert sum(missed) <= 2
    if planner == "mip":
        assert min(each.mean_step or 0.0 for each in results) > 0.26


def suite_of(name: str, starts: int) -> Suite:
    """Return a suite on terrain that is neither trained on nor in any table."""
    return make_suite(name, starts, seed=7, held_out=True)
