"""What the L1 norm does (T 5.3.2): its cost map, and the two worked scenarios."""

import numpy as np
import pytest

from benchmarks.contacts.l1 import START, scenario_a, scenario_a2, scenario_b
from jaxleas.contacts.certificate import certify
from jaxleas.contacts.programs.attempt import attempt
from jaxleas.contacts.programs.sl1m import plan_sl1m
from jaxleas.types.errors import InputError
from tests.contacts.worlds import content, problem, rectangle


def cost(asked, names: tuple[str, ...], points: np.ndarray) -> np.ndarray:
    """T eq. 5.12: the sum over surfaces of how far a point is outside its worst edge."""
    total = np.zeros(len(points))
    for name in names:
        corners = asked.surfaces[name].vertices[:, :2]
        low, high = corners.min(axis=0), corners.max(axis=0)
        total += np.maximum(np.maximum(low - points, points - high).max(axis=1), 0.0)
    return total


def test_scenario_a1_is_decided_by_the_relaxation() -> None:
    """The reach, 0.3 m, ends on S3's near edge or short of it: every optimum is on a surface."""
    found = attempt(problem(scenario_a(gap=0.0)), pruning=False)
    assert (found.status, found.undecided, found.combinations) == ("optimal", 0, 1)


def test_scenario_a2_needs_one_combination() -> None:
    """The cost is least between the surfaces: at the one place where three distances balance."""
    described = scenario_a2()
    found = attempt(problem(described), pruning=False)
    assert (found.status, found.undecided, found.combinations) == ("optimal", 1, 1)
    np.testing.assert_allclose(found.relaxed.footholds[0], [0.15, 0.15, 0.0], atol=1e-6)
    assert found.surfaces[0] in ("S2", "S3")  # equally near: the cheapest


def test_scenario_b_leaves_some_undecided_and_is_solved() -> None:
    asked = problem(scenario_b())
    plan = plan_sl1m(asked)
    assert plan.status == "feasible"
    assert plan.undecided is not None
    assert plan.undecided >= 1
    assert plan.combinations is not None
    assert 1 <= plan.combinations <= 36
    assert certify(asked, plan).certified


@pytest.mark.parametrize("described", [scenario_a(0.0), scenario_a(0.1), scenario_b()])
def test_the_relaxation_minimises_the_cost_map(described: dict) -> None:
    """No foothold that the step allows is cheaper than the relaxed first one plus the rest."""
    asked = problem(described)
    found = attempt(asked, pruning=False)
    feet, slack = found.relaxed.footholds, found.relaxed.slack
    names = [phase.candidates for phase in asked.steps]
    for index, candidates in enumerate(names):
        if len(candidates) > 1:
            here = float(cost(asked, candidates, feet[index : index + 1, :2])[0])
            assert slack[index].sum() == pytest.approx(here, abs=1e-7)
    x, y = np.meshgrid(np.linspace(-0.3, 0.9, 61), np.linspace(-0.6, 0.6, 61))
    grid = np.stack([x.ravel(), y.ravel()], axis=1)
    ends = np.array([asked.initial["RF"].position, *feet])
    before, after = ends[0, :2], feet[1, :2]
    fits = np.ones(len(grid), bool)
    for away in (grid - before, grid - after):  # p_2's two neighbours are right feet
        fits &= (np.abs(away[:, 0]) <= 0.3) & (away[:, 1] >= 0.15) & (away[:, 1] <= 0.4)
    best = cost(asked, names[0], feet[:1, :2])[0]
    assert fits.sum() > 20
    assert cost(asked, names[0], grid[fits]).min() >= best - 1e-7


def test_the_cap_on_combinations_is_kept_and_said() -> None:
    """As A.2, but S4 is out of reach from the two nearest surfaces: the third combination works."""
    surfaces = {
        **START,
        "S2": rectangle(0.0, 0.1, -0.2, 0.1),
        "S3": rectangle(0.2, 0.3, -0.2, 0.1),
        "S4": rectangle(0.35, 0.6, 0.0, 0.2),
        "S5": rectangle(0.0, 0.3, 0.28, 0.6),
    }
    asked = problem(content(surfaces, [["S2", "S3", "S5"], ["S4"]], model="feet"))
    plan = plan_sl1m(asked, pruning=False)
    assert (plan.status, plan.undecided, plan.combinations) == ("feasible", 1, 3)
    assert plan.surfaces == ("S5", "S4")
    for cap in (1, 2):
        plan = plan_sl1m(asked, pruning=False, max_combinations=cap, diagnose=False)
        assert (plan.status, plan.combinations) == ("not_found", cap)
        assert f"the first {cap} combinations of surfaces failed" in plan.reason
        assert "proves nothing" in plan.reason


def test_a_cap_must_not_be_negative() -> None:
    with pytest.raises(InputError, match="0 or more"):
        plan_sl1m(problem(scenario_b()), max_combinations=-1)
