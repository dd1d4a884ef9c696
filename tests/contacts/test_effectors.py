"""Robots with three feet, and with a palm: problems, plans, certificates, stances."""

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
    certify_stance,
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
from jaxleas.contacts.stances import contact_pose
from jaxleas.guide.files import write_guide_paths
from jaxleas.labels import MipSettings, Sl1mSettings, judge, read_verdicts
from jaxleas.robots import write_robot
from jaxleas.terrain.scene import Scene, write_scene
from jaxleas.types import Contact, InputError, RootPose, Stance
from tests.contacts.effectors import PLACES, leaner, tripod
from tests.contacts.sampling.worlds import straight
from tests.contacts.worlds import rectangle

FLOOR = np.array(rectangle(-2.0, 6.0, -1.5, 1.5))
WALL = np.array([[0.5, 1.0, 0.0], [0.5, -1.0, 0.0], [0.5, -1.0, 2.0], [0.5, 1.0, 2.0]])
"""Before the robot: counter-clockwise as the robot sees it, so that its normal is -x."""


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


def palm_on_the_wall() -> tuple[Stance, Scene]:
    yaw = 0.0
    contacts = [
        Contact("LF", "floor", contact_pose(np.array([0.0, 0.1, 0.0]), yaw, np.array([0, 0, 1.0]))),
        Contact(
            "RF", "floor", contact_pose(np.array([0.0, -0.1, 0.0]), yaw, np.array([0, 0, 1.0]))
        ),
        Contact(
            "RH", "wall", contact_pose(np.array([0.5, -0.2, 1.1]), yaw, np.array([-1.0, 0, 0]))
        ),
    ]
    return Stance.of(contacts), Scene({"floor": FLOOR, "wall": WALL})


ROOT = RootPose.from_yaw(np.array([0.0, 0.0, 0.9]), 0.0)
LEANING = np.array([0.12, 0.0, 0.9])
"""A centre of mass beyond the toes, which end at x = 0.05 [m]."""


def test_a_palm_touches_a_wall_in_a_certified_stance() -> None:
    stance, scene = palm_on_the_wall()
    found = certify_stance(leaner(), ROOT, stance, scene, LEANING)
    assert found.certified, found.complaint
    without = certify_stance(leaner(), ROOT, stance.breaking("RH"), scene, LEANING)
    assert "out of equilibrium" in without.complaint
    upright = np.array([0.0, 0.0, 0.9])
    assert certify_stance(leaner(), ROOT, stance.breaking("RH"), scene, upright).certified


def test_a_stance_is_certified_wherever_it_is_and_however_it_is_turned() -> None:
    stance, scene = palm_on_the_wall()
    for angle in (0.3, 2.0, -1.1):
        move = RootPose.from_yaw(np.array([3.0, -2.0, 0.5]), angle)
        turned = Stance.of(
            replace(each, pose=move @ each.pose) for each in stance.contacts.values()
        )
        there = Scene({name: move.transform(each) for name, each in scene.surfaces.items()})
        for com, expected in ((LEANING, True), (LEANING + np.array([0.9, 0.0, 0.0]), False)):
            moved = move.transform(com[None])[0]
            found = certify_stance(leaner(), move @ ROOT, turned, there, moved)
            assert found.certified == expected


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (
            lambda pose: replace(pose, position=pose.position - np.array([0.01, 0, 0])),
            "RH on the plane of 'wall' by 0.01 m",
        ),
        (
            lambda pose: replace(pose, position=pose.position + np.array([0, 1.17, 0])),
            "RH within the edges of 'wall' by 0.01 m",
        ),
        (
            lambda pose: contact_pose(pose.position, 0.0, np.array([1.0, 0.0, 0.0])),
            "RH facing away from 'wall' by 2 m",
        ),
        (
            lambda pose: replace(pose, position=pose.position + np.array([0, 0, 0.32])),
            "reach of RH by 0.02 m",
        ),
    ],
)
def test_a_palm_that_does_not_lie_on_its_wall_is_found(change, complaint) -> None:
    stance, scene = palm_on_the_wall()
    palm = stance["RH"]
    wrong = stance.making(replace(palm, pose=change(palm.pose)))
    found = certify_stance(leaner(), ROOT, wrong, scene, LEANING)
    if "edges" in complaint:
        assert found.constraint.startswith("reach") or complaint in found.complaint
    else:
        assert complaint in found.complaint


def test_an_effector_is_on_what_it_may_touch() -> None:
    stance, scene = palm_on_the_wall()
    for touch, complaint in (
        ({"wall": "feet"}, "has RH on 'wall', which palms may not touch"),
        ({"floor": "palms"}, "which feet may not touch"),
        ({"wall": "palms", "floor": "both"}, ""),
    ):
        found = certify_stance(leaner(), ROOT, stance, replace(scene, touch=touch), LEANING)
        assert complaint in found.complaint
        assert found.certified == (not complaint)


def test_friction_and_force_limits_count() -> None:
    stance, scene = palm_on_the_wall()
    robot = leaner()
    *feet, hand = robot.limbs
    assert hand.effector is not None
    weak = replace(hand, effector=replace(hand.effector, force_limit=5.0))
    found = certify_stance(replace(robot, limbs=(*feet, weak)), ROOT, stance, scene, LEANING)
    assert "carried by no forces within the effectors' limits" in found.complaint
    strong = replace(hand, effector=replace(hand.effector, force_limit=500.0))
    assert certify_stance(
        replace(robot, limbs=(*feet, strong)), ROOT, stance, scene, LEANING
    ).certified


def test_the_exact_cone_decides_on_a_slope() -> None:
    """A robot on a slope stands as long as tan(slope) <= mu, whichever way it faces."""
    robot = leaner()
    for mu_share, expected in ((0.999, True), (1.001, False)):
        slope = np.arctan(0.7 * mu_share)
        normal = np.array([-np.sin(slope), 0.0, np.cos(slope)])
        up = np.array([np.cos(slope), 0.0, np.sin(slope)])
        ground = np.array([a * up + b * np.array([0.0, 1.0, 0.0]) for a, b in SQUARE])
        for yaw in (0.0, 0.5, 2.2):
            pose = contact_pose(np.zeros(3), yaw, normal)
            stance = Stance.of([Contact("LF", "slope", pose)])
            root = RootPose.from_yaw(np.array([0.0, -0.1, 0.9]), 0.0)
            found = certify_stance(
                robot,
                root,
                stance,
                Scene({"slope": ground}, touch={"slope": "feet"}),
                np.array([0, 0, 0.0]),
            )
            assert found.certified == expected, (mu_share, yaw, found.complaint)


SQUARE = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def test_what_cannot_be_checked_is_refused() -> None:
    stance, scene = palm_on_the_wall()
    with pytest.raises(InputError, match="without contacts"):
        certify_stance(leaner(), ROOT, Stance({}), scene, LEANING)
    with pytest.raises(InputError, match="RH is on 'wall', which is no surface of the scene"):
        certify_stance(leaner(), ROOT, stance, Scene({"floor": FLOOR}), LEANING)


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
