"""SL1M's weights: the guide chooses among the candidates, and no combinations are tried."""

import numpy as np
import pytest

from benchmarks.contacts.l1 import scenario_a2, scenario_b
from jaxleas.contacts.certificate import certify
from jaxleas.contacts.from_guide import problem_from_guide
from jaxleas.contacts.programs.constraints import make_constraints
from jaxleas.contacts.programs.relaxation import relax
from jaxleas.contacts.programs.sl1m import plan_sl1m
from jaxleas.contacts.programs.slack_weights import SlackWeights, slack_weights
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath, InputError
from tests.contacts.worlds import problem

TILES = {
    f"{row}_{column}": np.array(
        [
            [0.4 * row + x, 0.4 * column - 0.6 + y, 0.02 * ((row + 2 * column) % 3)]
            for x, y in ((0.01, 0.01), (0.39, 0.01), (0.39, 0.39), (0.01, 0.39))
        ]
    )
    for row in range(-2, 8)
    for column in range(3)
}


def guide(aside: float = 0.0, speed: float = 0.08) -> GuidePath:
    """Walk 1.8 m straight ahead."""
    time = np.arange(0.0, 1.8 / speed, 0.2)
    position = np.stack([speed * time, np.full_like(time, aside), np.full_like(time, 1.0)], -1)
    return GuidePath(
        time=time,
        position=position,
        yaw=np.zeros_like(time),
        velocity=np.tile([speed, 0.0, 0.0], (len(time), 1)),
        valid=np.ones(len(time), dtype=bool),
    )


@pytest.fixture(scope="module")
def asked():
    return problem_from_guide(guide(), Scene(TILES), "talos")


def test_uniform_weights_are_the_published_sum(asked):
    candidates = [phase.candidates for phase in asked.steps]
    for row, names in zip(slack_weights(asked, candidates, "uniform"), candidates, strict=True):
        np.testing.assert_array_equal(row, np.ones(len(names)))


def test_the_surface_under_the_foot_weighs_as_much_as_all_the_others(asked):
    candidates = [phase.candidates for phase in asked.steps]
    assert max(map(len, candidates)) > 3
    for row, names, phase in zip(
        slack_weights(asked, candidates, "guide"), candidates, asked.steps, strict=True
    ):
        place = phase.root[:2] + np.array([0.0, 0.0848 if phase.foot == "LF" else -0.0848])
        chosen = names[int(np.argmax(row))]
        corners = asked.surfaces[chosen].vertices[:, :2]
        # Within the tile, or nowhere further from it than the seam is wide.
        assert (place >= corners.min(axis=0) - 0.02).all()
        assert (place <= corners.max(axis=0) + 0.02).all()
        assert sorted(row) == [1.0] * (len(row) - 1) + [float(len(row))]


def test_what_the_guide_chooses_needs_no_combinations():
    made: dict[SlackWeights, list[bool]] = {"uniform": [], "guide": []}
    for aside in (-0.25, -0.1, 0.05):
        asked = problem_from_guide(guide(aside), Scene(TILES), "talos")
        for weights, plans in made.items():
            plan = plan_sl1m(asked, max_combinations=1, weights=weights, diagnose=False)
            plans.append(plan.feasible)
            assert not plan.feasible or certify(asked, plan).certified
    assert all(made["guide"])
    assert not all(made["uniform"])


def test_weights_change_where_the_foot_goes_and_not_what_is_allowed(asked):
    candidates = [phase.candidates for phase in asked.steps]
    steps = make_constraints(asked)
    plain, guided = (relax(asked, steps, candidates, weights=each) for each in ("uniform", "guide"))
    assert plain.status == guided.status == "optimal"

    def total(found) -> float:
        return sum(float(slack.sum()) for slack in found.slack)

    # The uniform optimum is the least uniform sum there is; the guided one pays a little for it.
    assert total(plain) <= total(guided) + 1e-6


def test_without_heuristics_what_is_undecided_fails():
    asked = problem(scenario_a2())
    plan = plan_sl1m(asked, pruning=False, max_combinations=0)
    assert (plan.status, plan.undecided, plan.combinations) == ("not_found", 1, 0)
    assert plan_sl1m(asked, pruning=False, max_combinations=1).feasible


def test_without_a_root_the_guide_cannot_choose():
    with pytest.raises(InputError, match="has no root"):
        plan_sl1m(problem(scenario_b()), weights="guide")
