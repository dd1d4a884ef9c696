"""Robots with three feet, and with a palm: problems, plans and their certificates."""

import itertools
import json
import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog

from jaxleas import cli
from jaxleas.contacts import (
    Stepping,
    certify,
    plan_mip,
    plan_sl1m,
    problem_from_guide,
    read_problem,
    stances_of,
    write_problem,
)
from jaxleas.contacts.planner_settings import stored_settings
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import parse_problem
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import MipSettings, Sl1mSettings, judge, read_verdicts
from jaxleas.robots import write_robot
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.effectors import FLOOR, PLACES, WALL, leaner, tripod
from tests.contacts.sampling.worlds import straight
from tests.contacts.worlds import rectangle


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_robot("robots/tripod.json", tripod())
    write_robot("robots/leaner.json", leaner())
    return tmp_path


def guide(length: float = 1.2):
    path = straight(length)
    return replace(path, position=path.position * [1.0, 1.0, 0.0] + [0.0, 0.0, 0.6])


def three_feet(**options) -> ContactProblem:
    stepping = Stepping(**({"model": "feet", "every": 5} | options))
    return problem_from_guide(guide(), Scene({"floor": FLOOR}), "tripod", stepping)


@pytest.mark.parametrize("planner", [plan_mip, plan_sl1m])
def test_a_three_legged_robot_gets_a_certified_plan(here, planner) -> None:
    asked = three_feet()
    names = [phase.foot for phase in asked.steps]
    assert names == [list(PLACES)[index % 3] for index in range(len(asked))]
    plan = planner(asked)
    assert plan.feasible
    assert certify(asked, plan).certified
    stances = stances_of(asked, plan)
    assert len(stances) == len(asked) + 1
    for phase, before, after in zip(asked.steps, stances, stances[1:], strict=False):
        assert set(before.changed(after)) <= {phase.foot}
        assert len(after) == 3


def test_every_standing_foot_counts(here) -> None:
    asked = three_feet()
    plan = plan_mip(asked)
    assert plan.footholds is not None
    for phase in range(3, len(asked)):
        for axis, sign in itertools.product((0, 1), (-1.0, 1.0)):
            moved = plan.footholds.copy()
            moved[phase, axis] += sign * 0.8
            worst = certify(asked, plan.but(footholds=moved))
            assert not worst.certified
            assert worst.metres > 0.1


def test_a_problem_of_three_feet_survives_its_file(here) -> None:
    asked = three_feet()
    write_problem("p.json", asked)
    after = read_problem("p.json")
    assert after.effectors == tuple(PLACES)
    assert list(after.polytopes.relative) == list(asked.polytopes.relative)
    one, two = plan_mip(asked), plan_mip(after)
    np.testing.assert_allclose(one.footholds, two.footholds, atol=1e-9)


def stones_for_three(seed: int) -> dict:
    """Return a problem whose stones are here and there, of any three feet."""
    rng = np.random.default_rng(seed)
    surfaces = {"start": rectangle(-0.5, 0.5, -0.4, 0.4)}
    for number in range(3):
        x, y = rng.uniform([0.2, -0.3], [0.9, 0.3])
        surfaces[f"s{number}"] = rectangle(x, x + 0.2, y, y + 0.2, rng.uniform(-0.2, 0.2))
    order = rng.permutation(list(PLACES) * 2)[:4]
    phases = [
        {
            "foot": foot,
            "yaw": rng.uniform(-0.3, 0.3),
            "candidates": rng.permutation(list(surfaces))[:2].tolist(),
        }
        for foot in order.tolist()
    ]
    initial = {name: {"position": [*xy, 0.0], "yaw": 0.0} for name, xy in PLACES.items()}
    return {
        "robot": "tripod",
        "model": "feet",
        "surfaces": surfaces,
        "initial": initial,
        "phases": phases,
    }


def by_brute_force(problem: ContactProblem) -> bool:
    """Try every choice of surfaces with a linear program each, written for itself."""
    every = [phase.candidates for phase in problem.steps]
    return any(_placed(problem, choice) for choice in itertools.product(*every))


def _placed(problem: ContactProblem, choice: tuple[str, ...]) -> bool:
    size = 3 * len(choice)
    upper, bound, equal, offset = [], [], [], []
    where: dict[str, tuple[int | None, np.ndarray]] = {
        name: (None, pose.position) for name, pose in problem.initial.items()
    }
    for index, (phase, name) in enumerate(zip(problem.steps, choice, strict=True)):
        block = np.zeros((3, size))
        block[:, 3 * index : 3 * index + 3] = np.eye(3)
        corners = problem.surfaces[name].vertices
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        equal.append(normal @ block)
        offset.append(normal @ corners[0])
        for one, other in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            out = np.cross(other - one, normal)
            upper.append(out @ block)
            bound.append(out @ one)
        c, s = np.cos(phase.yaw), np.sin(phase.yaw)
        back = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
        for foot, (number, position) in where.items():
            if foot == phase.foot:
                continue
            reach = problem.polytopes.relative[f"{foot}_in_{phase.foot}"]
            there = np.zeros((3, size))
            if number is not None:
                there[:, 3 * number : 3 * number + 3] = np.eye(3)
            rows = reach.normals @ back
            upper += list(rows @ (there - block))
            bound += list(reach.offsets - (0.0 if number is not None else rows @ position))
        where[phase.foot] = (index, np.zeros(3))
    answer = linprog(
        np.zeros(size),
        A_ub=np.array(upper),
        b_ub=np.array(bound),
        A_eq=np.array(equal),
        b_eq=np.array(offset),
        bounds=(None, None),
    )
    return answer.status == 0


def test_the_verdict_on_three_feet_is_that_of_brute_force(here) -> None:
    verdicts = []
    for seed in range(40):
        asked = parse_problem("p.json", json.loads(json.dumps(stones_for_three(seed))))
        expected = by_brute_force(asked)
        assert plan_mip(asked, diagnose=False).feasible == expected, seed
        assert plan_mip(asked, start=False, diagnose=False).feasible == expected, seed
        found = plan_sl1m(asked, diagnose=False)
        assert found.feasible <= expected, seed
        verdicts.append(expected)
    assert {*verdicts} == {True, False}


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"model": "two_com"}, "lacks COM_in_FL, COM_in_FR, COM_in_H, which model 'two_com' needs"),
        ({"initial": {"FL": {"position": [0, 0, 0], "yaw": 0}}}, "where FL and FR and H stand"),
    ],
)
def test_a_problem_that_does_not_fit_the_robot_is_refused(here, change, sentence) -> None:
    polytopes = {
        name: {"A": each.normals.tolist(), "b": each.offsets.tolist()}
        for name, each in tripod().steps.items()
    }
    described = {**stones_for_three(0), "polytopes": polytopes, **change}
    with pytest.raises(InputError, match=sentence):
        parse_problem("p.json", json.loads(json.dumps(described)))


def test_model_and_first_foot_are_asked_of_the_robot(here) -> None:
    with pytest.raises(InputError, match="model two_com is of two feet, and 3 stand here"):
        three_feet(model="two_com")
    with pytest.raises(InputError, match="first foot must be FL or FR or H, not 'LF'"):
        three_feet(first_foot="LF")
    assert three_feet(first_foot="H").steps[1].foot == "FL"


def test_a_three_legged_robot_is_labelled_by_its_name(here) -> None:
    write_guide_paths(here / "walks.npz", [guide(), guide(9.0)], ["reached"] * 2)
    write_scene(here / "floor.json", Scene({"floor": FLOOR}))
    line = "label walks.npz --scene floor.json --robot tripod --processes 1"
    cli.run(
        [
            *line.split(),
            *["--planner", "mip", "--model", "feet", "--keep-every", "5", "--out", "labels"],
        ]
    )
    (provenance, first), (_, second) = read_verdicts("labels")
    assert provenance["robot"]["name"] == "tripod"
    assert (first.success, second.success) == (True, False)
    with pytest.raises(InputError, match="tripod"):
        cli.run([*line.split(), *["--planner", "sampling", "--out", "others"]])


@pytest.mark.parametrize("kind", [MipSettings, Sl1mSettings])
def test_a_stated_first_foot_that_the_robot_lacks_is_refused_but_the_default_is_not(
    here, kind
) -> None:
    name = "mip" if kind is MipSettings else "sl1m"
    scene, options = Scene({"floor": FLOOR}), {"model": "feet", "keep_every": 5}
    ask = lambda settings: judge(name, scene, [guide()], settings, robot="tripod")  # noqa: E731
    assert ask(kind(**options))[0].success
    with pytest.raises(InputError, match="first foot must be FL or FR or H, not 'LF'"):
        ask(kind(**options, first_foot="LF"))
    copied = pickle.loads(pickle.dumps(kind(**options, first_foot="LF")))  # as a worker gets it
    with pytest.raises(InputError, match="first foot must be FL or FR or H, not 'LF'"):
        ask(copied.model_copy(update={"keep_every": 6}))


def test_stored_settings_state_only_what_is_not_the_default(here) -> None:
    given = MipSettings(model="feet", keep_every=5)
    stored = json.loads(json.dumps(given.model_dump(mode="json")))
    after = stored_settings("mip", stored)
    assert after == given
    verdicts = judge("mip", Scene({"floor": FLOOR}), [guide()], after, robot="tripod")
    assert verdicts[0].success
    with pytest.raises(InputError, match="--samples is for the planner sampling, not for mip"):
        stored_settings("mip", {**stored, "samples": 500})


def test_a_palm_is_planned_onto_a_wall(here) -> None:
    described = {
        "robot": "leaner",
        "model": "feet",
        "surfaces": {
            "floor": FLOOR.tolist(),
            "wall": WALL.tolist(),
            "rest": (WALL - [0.1, 0, 0]).tolist(),
        },
        "initial": {
            "LF": {"position": [0.0, 0.1, 0.0], "yaw": 0.0},
            "RF": {"position": [0.0, -0.1, 0.0], "yaw": 0.0},
            "RH": {"position": [0.4, -0.2, 1.0], "yaw": 0.0},
        },
        "phases": [
            {"foot": "RH", "yaw": 0.0, "candidates": ["wall"]},
            {"foot": "LF", "yaw": 0.0, "candidates": ["floor"]},
        ],
    }
    asked = parse_problem("p.json", described)
    plan = plan_mip(asked)
    assert plan.feasible
    assert certify(asked, plan).certified
    palm = stances_of(asked, plan)[-1]["RH"]
    np.testing.assert_allclose(palm.normal, [-1.0, 0.0, 0.0], atol=1e-9)
    assert plan.footholds is not None
    assert plan.footholds[0, 0] == pytest.approx(0.5)
