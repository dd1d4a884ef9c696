"""Feet with soles of their own: problems, plans, certificates and files."""

import json
from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts import (
    ContactPlan,
    certify,
    plan_mip,
    plan_sl1m,
    problem_from_guide,
    read_problem,
)
from jaxleas.contacts.problem_file import write_problem
from jaxleas.robots import load_talos, write_robot
from jaxleas.terrain.scene import Scene
from jaxleas.types import InputError
from jaxleas.viewer.clips import plan_clip
from tests.contacts.sampling.worlds import straight
from tests.contacts.test_planners import twin
from tests.contacts.worlds import content, problem, random_world, rectangle

LONG, SHORT = [0.2, 0.15], [0.02, 0.01]
UNEQUAL = {"LF": LONG, "RF": SHORT}
FLOOR = {"floor": rectangle(-1.0, 3.0, -1.0, 1.0)}


def walk(half_sizes: dict | list) -> dict:
    """Return four steps on a floor, of a robot whose centre of mass moves little."""
    described = content(FLOOR, [["floor"]] * 4, foot_half_size=half_sizes)
    for each in ("COM_in_LF", "COM_in_RF"):
        described["polytopes"][each]["b"] = [0.22, 0.22, 0.25, 0.25, 0.95, -0.75]
    return described


@pytest.mark.parametrize("planner", [plan_mip, plan_sl1m])
def test_the_centre_of_mass_stays_over_the_sole_of_each_foot(planner) -> None:
    asked = problem(walk(UNEQUAL))
    plan = planner(asked)
    assert certify(asked, plan).certified
    places = {name: pose.position for name, pose in asked.initial.items()}
    for phase, landed, coms in zip(asked.steps, plan.footholds, plan.com, strict=True):
        (standing,) = set(places) - {phase.foot}
        places[phase.foot] = landed
        for com, name in zip(coms, (standing, phase.foot), strict=True):
            beyond = np.abs(com[:2] - places[name][:2]) - UNEQUAL[name]
            assert beyond.max() <= 1e-6, f"over {name}"


@pytest.mark.slow
def test_the_verdict_with_unequal_soles_is_that_of_brute_force() -> None:
    verdicts, unshown = [], [LONG, SHORT]
    for seed in range(30):
        described = {**random_world(seed, "two_com"), "foot_half_size": UNEQUAL}
        # From LF the centre of mass reaches farther: so either sole alone can be too small.
        described["polytopes"]["COM_in_LF"]["b"] = [0.3, 0.3, 0.33, 0.33, 0.95, -0.75]
        expected = twin(described)
        for start in (False, True):
            plan = plan_mip(problem(described), diagnose=False, start=start)
            assert plan.feasible == expected, (seed, start)
        assert plan_sl1m(problem(described), diagnose=False).feasible <= expected
        verdicts.append(expected)
        unshown = [
            size for size in unshown if twin({**described, "foot_half_size": size}) == expected
        ]
    assert {*verdicts} == {True, False}
    assert not unshown, "soles of one size would have given the same verdicts"


def test_a_plan_that_is_right_with_the_sole_of_the_other_foot_only_is_refused() -> None:
    swapped = {"LF": SHORT, "RF": LONG}
    asked, other = problem(walk(UNEQUAL)), problem(walk(swapped))
    plan = plan_mip(other)
    assert plan.com is not None
    assert plan.footholds is not None
    com = plan.com.copy()
    com[0, 0, :2] = [0.1, -0.1]  # RF stands at (0, -0.1), LF moves
    assert certify(other, plan).certified
    asked, other, plan = asked.prefix(1), other.prefix(1), _first_step(plan.but(com=com))
    assert certify(other, plan).certified
    worst = certify(asked, plan)
    assert not worst.certified
    assert worst.constraint == "centre of mass c0 over RF"
    assert worst.metres == pytest.approx(0.1 - SHORT[0])


def _first_step(plan: ContactPlan) -> ContactPlan:
    assert plan.footholds is not None
    assert plan.com is not None
    return plan.but(surfaces=plan.surfaces[:1], footholds=plan.footholds[:1], com=plan.com[:1])


def uneven():
    """Return Talos with a small right sole."""
    talos = load_talos()
    limbs = tuple(
        replace(limb, effector=replace(limb.effector, half_size=tuple(SHORT)))
        if limb.effector is not None and limb.effector.name == "RF"
        else limb
        for limb in talos.limbs
    )
    return replace(talos, name="uneven", limbs=limbs)


def test_a_problem_of_a_guide_has_the_soles_of_the_robot(tmp_path) -> None:
    write_robot(tmp_path / "uneven.json", uneven())
    robot = str(tmp_path / "uneven.json")
    scene = Scene({"floor": np.array(FLOOR["floor"])})
    asked = problem_from_guide(straight(1.0), scene, robot)
    assert dict(asked.half_sizes) == {"LF": (0.1, 0.06), "RF": tuple(SHORT)}
    plan = plan_mip(asked)
    assert certify(asked, plan).certified
    sizes = {each.effector: each.half_size for each in plan_clip("walk", asked, plan).footholds}
    assert sizes == {"LF": (0.1, 0.06), "RF": tuple(SHORT)}
    described = {**content(FLOOR, [["floor"]]), "robot": robot}
    del described["foot_half_size"]
    assert problem(described).half_sizes["RF"] == tuple(SHORT)


@pytest.mark.parametrize(
    ("given", "written"),
    [
        ([0.1, 0.06], [0.1, 0.06]),
        ({"LF": [0.1, 0.06], "RF": [0.1, 0.06]}, [0.1, 0.06]),
        (UNEQUAL, UNEQUAL),
        ({"LF": [0.1, 0.06], "RF": [0.0, 0.0]}, {"LF": [0.1, 0.06], "RF": [0.0, 0.0]}),
    ],
)
def test_half_sizes_survive_the_file_which_keeps_its_form_for_equal_soles(
    tmp_path, given, written
) -> None:
    asked = problem(walk(given))
    write_problem(tmp_path / "p.json", asked)
    assert json.loads((tmp_path / "p.json").read_text())["foot_half_size"] == written
    assert dict(read_problem(tmp_path / "p.json").half_sizes) == dict(asked.half_sizes)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"LF": LONG}, "foot_half_size is of LF: give .* each of LF, RF"),
        ({"LF": LONG, "RF": [0.1]}, "foot_half_size of RF must be two numbers"),
        ({"LF": LONG, "RF": [0.1, 0.0]}, "foot_half_size of RF .* is not between 0 and 1 m"),
        ({"LF": LONG, "Rf": SHORT}, "foot_half_size is of LF, Rf: give"),
    ],
)
def test_half_sizes_that_cannot_be_used_are_refused(given, words) -> None:
    with pytest.raises(InputError, match=words):
        problem(walk(given))


def test_a_problem_without_the_half_sizes_of_an_effector_is_refused() -> None:
    with pytest.raises(InputError, match="those of RF are missing"):
        replace(problem(walk(UNEQUAL)), half_sizes={"LF": (0.1, 0.06)})
