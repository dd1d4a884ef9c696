"""The certificate finds what is wrong with a plan, whatever made it."""

import numpy as np
import pytest

from jaxleas.contacts.certificate import TOLERANCE, certify
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.programs.mip import plan_mip
from jaxleas.types.errors import InputError
from tests.contacts.worlds import content, problem, rectangle, stones

FLOOR = {"floor": rectangle(-1, 3, -1, 1)}


def by_hand(model: str = "two_com") -> tuple:
    """Two steps on a floor, known to keep every constraint."""
    asked = problem(content(FLOOR, [["floor"], ["floor"]], model))
    feet = np.array([[0.2, 0.1, 0.0], [0.2, -0.1, 0.0]])
    com = np.array([[[0.0, -0.1, 0.8], [0.2, 0.1, 0.8]], [[0.2, 0.1, 0.8], [0.2, -0.1, 0.8]]])
    plan = ContactPlan("hand", True, "feasible", "", ("floor", "floor"), feet, com)
    return asked, plan


@pytest.mark.parametrize("model", ["two_com", "feet"])
def test_a_good_plan_is_certified(model: str) -> None:
    worst = certify(*by_hand(model))
    assert worst.certified
    assert worst.metres <= 1e-12


@pytest.mark.parametrize("off", [2e-6, 0.01, 0.3])
@pytest.mark.parametrize(
    ("part", "index", "direction", "words", "start"),
    [
        ("footholds", (0,), (0, 0, 1), "plane", 0.0),
        ("footholds", (0,), (1, 0, 0), "reach of the step", 0.1),
        ("com", (0, 0), (1, 0, 0), "over RF", 0.1),
        ("com", (0, 1), (0, 1, 0), "over LF", 0.06),
        ("com", (1, 1), (0, -1, 0), "over RF", 0.06),
        ("com", (1, 0), (0, 0, 1), "reach of the centre of mass c0", 0.2),
    ],
)
def test_each_constraint_is_measured_in_metres(part, index, direction, words, start, off) -> None:
    asked, plan = by_hand()
    changed = getattr(plan, part).copy()
    changed[index] += (start + off) * np.array(direction, float)
    worst = certify(asked, plan.but(**{part: changed}))
    assert not worst.certified
    if off < 0.05:  # beyond, other constraints may be violated more
        assert worst.phase == index[0]
        assert words in worst.constraint
        assert worst.metres == pytest.approx(off, rel=1e-6)


def test_edges_are_measured() -> None:
    asked = problem(content({"small": rectangle(-0.2, 0.15, -0.2, 0.2)}, [["small"]]))
    _, plan = by_hand()
    plan = plan.but(surfaces=("small",), footholds=plan.footholds[:1], com=plan.com[:1])
    worst = certify(asked, plan)
    assert worst.metres == pytest.approx(0.05)
    assert "edges" in worst.constraint


def test_the_frames_turn_with_the_feet() -> None:
    """Where the standing foot is turned, so is its reach: a plan known by hand, turned by 90."""
    described = content(FLOOR, [["floor"]])
    described["initial"]["RF"]["yaw"] = described["initial"]["LF"]["yaw"] = np.pi / 2
    described["initial"]["RF"]["position"] = [0.1, 0.0, 0.0]
    described["initial"]["LF"]["position"] = [-0.1, 0.0, 0.0]
    described["phases"][0]["yaw"] = np.pi / 2
    feet = np.array([[-0.1, 0.25, 0.0]])
    com = np.array([[[0.1, 0.0, 0.8], [-0.1, 0.25, 0.8]]])
    plan = ContactPlan("hand", True, "feasible", "", ("floor",), feet, com)
    assert certify(problem(described), plan).certified
    for number, foot in ((0, [0.1, 0.0]), (1, [-0.1, 0.25])):
        along, aside = com.copy(), com.copy()
        along[0, number, :2] = np.add(foot, [0.0, 0.099])  # the sole is long along y now
        aside[0, number, :2] = np.add(foot, [0.099, 0.0])
        assert certify(problem(described), plan.but(com=along)).certified
        assert not certify(problem(described), plan.but(com=aside)).certified


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"surfaces": ("floor", "moon")}, "stands on 'moon'"),
        ({"surfaces": ("floor",)}, "1 surfaces and 2 footholds, the problem 2 steps"),
        ({"com": None}, "lacks 'com'"),
        ({"feasible": False, "status": "infeasible"}, "is 'infeasible' and has no footholds"),
        ({"footholds": np.full((2, 3), np.nan)}, "not finite"),
    ],
)
def test_a_plan_of_another_problem_is_refused(changes: dict, words: str) -> None:
    asked, plan = by_hand()
    with pytest.raises(InputError, match=words):
        certify(asked, plan.but(**changes))


def test_tolerance_is_what_the_issue_asks() -> None:
    assert TOLERANCE == 1e-6
    plan = plan_mip(problem(stones(0.1)))
    assert plan.max_violation is not None
    assert plan.max_violation <= TOLERANCE
