"""The sampling planner's answers as contact plans: certified, written, read, checked, drawn."""

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import certify_postures, plan_sampling, read_plan, write_plan
from jaxleas.contacts.checking import NotCertifiedError
from jaxleas.contacts.plan_sampling import problem_of_steps
from jaxleas.contacts.posture_limbs import about, chain
from jaxleas.contacts.problem import FootPose
from jaxleas.contacts.sampling.follower import GuideFollower
from jaxleas.files import write_json, write_npz
from jaxleas.robots import load_robot, load_talos
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, hole, stairs, straight

TALOS = load_robot("talos")

GUIDE, SCENE = straight(2.4, climbing=True), stairs()


@pytest.fixture(scope="module")
def climb():
    return plan_sampling(GUIDE, SCENE, robot=TALOS)


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    for name, guide in (("guide", GUIDE), ("flat", straight(2.0)), ("long", straight(4.0))):
        columns = ("time", "position", "yaw", "velocity", "valid")
        write_npz(f"{name}.npz", **{each: getattr(guide, each) for each in columns})
    write_scene("scene.json", SCENE)
    write_scene("hole.json", hole())
    return tmp_path


def run(line: str) -> None:
    cli.run(line.split())


def test_a_plan_says_where_each_step_goes(climb) -> None:
    assert (climb.planner, climb.status, climb.reason) == ("sampling", "feasible", "")
    assert climb.max_violation <= 1e-6
    assert climb.last_feasible_step == len(climb.surfaces) - 1 == len(climb.footholds) - 1
    assert climb.surfaces[-1] in ("step_4", "step_5")
    assert [each.configuration for each in climb.postures][:: len(climb.postures) - 1] == [0, 120]
    assert len(climb.robustness) == len(climb.postures)
    assert min(climb.robustness) >= 2.0
    made = problem_of_steps(climb, GUIDE, SCENE, TALOS)
    for phase, name, point in zip(made.steps, climb.surfaces, climb.footholds, strict=True):
        assert phase.candidates == (name,)
        assert float(made.surfaces[name].distance(point)) < 1e-9


def with_postures(plan, postures: list):
    moved = [each for each in postures if each.moved]
    footholds = np.array([each.feet[each.moved].position for each in moved])
    return plan.but(postures=tuple(postures), footholds=footholds)


def with_shifted_foot(plan, foot: str, shift: list[float], first: int = 1):
    """Shift a foot in all postures from one on."""
    postures = list(plan.postures)
    for number in range(first, len(postures)):
        pose = postures[number].feet[foot]
        feet = {**postures[number].feet, foot: FootPose(pose.position + shift, pose.yaw)}
        postures[number] = replace(postures[number], feet=feet)
    return with_postures(plan, postures)


@pytest.mark.parametrize(
    ("shift", "words"),
    [
        ([0.0, 0.0, 0.01], "on its surface's plane in posture [0-9]+ by 0.01 m"),
        ([0.0, 2.0, 0.0], "reach of LF"),
        ([0.0, 0.004, 0.0], "LF standing still|centre of mass"),
    ],
)
def test_a_foot_that_is_elsewhere_is_seen(climb, shift: list[float], words: str) -> None:
    certificate = certify_postures(with_shifted_foot(climb, "LF", shift), GUIDE, SCENE, TALOS)
    assert not certificate.certified
    assert re.search(words, certificate.complaint), certificate.complaint


def test_a_foot_beyond_the_edge_is_seen(climb) -> None:
    narrow = {name: each * [1.0, 0.01, 1.0] for name, each in SCENE.surfaces.items()}
    complaint = certify_postures(
        climb, GUIDE, replace(SCENE, surfaces=narrow), robot=TALOS
    ).complaint
    assert "within the surface's edges" in complaint


def test_a_leg_that_is_too_short_is_seen(climb) -> None:
    """The same footholds under a guide that walks 0.15 m higher."""
    higher = replace(GUIDE, position=GUIDE.position + np.array([0.0, 0.0, 0.15]))
    certificate = certify_postures(climb, higher, SCENE, TALOS)
    assert "reach of" in certificate.complaint or "centre of mass" in certificate.complaint
    assert certificate.worst.metres > 0.01


def test_a_wrong_centre_of_mass_or_robustness_is_seen(climb) -> None:
    postures = list(climb.postures)
    postures[3] = replace(postures[3], com=postures[3].com + np.array([0.0, 0.0, 0.02]))
    lean = with_postures(climb, postures)
    assert (
        "centre of mass in posture 3 by 0.02 m"
        in certify_postures(lean, GUIDE, SCENE, TALOS).complaint
    )
    bold = climb.but(robustness=(*climb.robustness[:-1], 2.0 * climb.robustness[-1]))
    assert (
        "states a robustness that is wrong" in certify_postures(bold, GUIDE, SCENE, TALOS).complaint
    )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"postures": None}, "no postures to check"),
        ({"robustness": (1.0,)}, "postures and 1 robustnesses"),
        ({"footholds": np.zeros((2, 3))}, "not those of the postures"),
    ],
)
def test_a_plan_that_is_none_is_refused(climb, change: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        certify_postures(climb.but(**change), GUIDE, SCENE, TALOS)


def test_a_plan_for_another_guide_or_scene_is_refused(climb) -> None:
    with pytest.raises(InputError, match="does not follow this guide with 51"):
        certify_postures(climb, straight(1.0), SCENE, TALOS)
    with pytest.raises(InputError, match="perhaps it is for another guide"):
        certify_postures(climb, straight(3.0, climbing=True), SCENE, TALOS)
    with pytest.raises(InputError, match="stands on 'bottom', not in this scene"):
        certify_postures(climb, GUIDE, flat(), TALOS)
    held = replace(SCENE, touch={"bottom": "palms"})
    with pytest.raises(InputError, match="stands on 'bottom', which feet may not touch"):
        certify_postures(climb, GUIDE, held, TALOS)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_joint_by_joint_chain_is_the_legs_kinematics(side: float) -> None:
    left = load_talos().limbs[0].model
    mirror = np.diag([1.0, side, 1.0])
    for angles in np.random.default_rng(0).uniform(left.chain.lower, left.chain.upper, (20, 6)):
        own = angles if side > 0 else angles * left.chain.mirror_signs
        model = load_talos().limbs[0 if side > 0 else 1].model
        frames, origins, sole, turn = chain(model, own)
        posture = left.posture(angles)
        np.testing.assert_allclose(sole, mirror @ posture.tip, atol=1e-12)
        np.testing.assert_allclose(turn, mirror @ posture.tip_rotation @ mirror, atol=1e-12)
        np.testing.assert_allclose(origins, posture.origins @ mirror, atol=1e-12)
        np.testing.assert_allclose(np.linalg.det(frames), 1.0, atol=1e-12)
    np.testing.assert_allclose(about("z", math.pi / 2) @ [1, 0, 0], [0, 1, 0], atol=1e-12)


def test_what_was_reached_is_kept_where_the_walk_stops() -> None:
    plan = plan_sampling(straight(4.0), hole(), robot=TALOS)
    assert (plan.feasible, plan.status) == (False, "not_found")
    assert "neither foot finds a contact" in plan.reason
    assert 0 < plan.postures[-1].configuration < 200
    assert plan.max_violation <= 1e-6
    aside = plan_sampling(straight(4.0, y=2.9), hole(), robot=TALOS)
    assert (aside.status, aside.last_feasible_step, aside.max_violation) == ("not_found", -1, None)


def test_why_neither_foot_moved_is_explained_whatever_the_words(monkeypatch) -> None:
    stop = GuideFollower._stop
    monkeypatch.setattr(
        GuideFollower,
        "_stop",
        lambda self, guide, ending, reason: stop(self, guide, ending, "besetzt"),
    )
    plan = plan_sampling(straight(4.0), hole(), robot=TALOS)
    assert re.search("besetzt: LF .*; RF ", plan.reason)
    assert plan_sampling(straight(4.0), flat(), time_limit=1e-9, robot=TALOS).status == "time_limit"


def test_a_guide_that_leaves_the_scene_is_refused() -> None:
    with pytest.raises(InputError, match="leaves the scene: configuration 426, with its root at"):
        plan_sampling(straight(9.0), flat(), robot=TALOS)


def test_late_is_late_and_not_a_verdict() -> None:
    plan = plan_sampling(straight(4.0), flat(), time_limit=1e-9, robot=TALOS)
    assert (plan.feasible, plan.status) == (False, "time_limit")
    expected = "not decided within the time limit of 1e-09 s: stopped at configuration 0"
    assert plan.reason.startswith(expected)
    with pytest.raises(InputError, match="positive number of seconds"):
        plan_sampling(straight(4.0), flat(), time_limit=0.0, robot=TALOS)


def test_a_plan_survives_its_file(climb, tmp_path) -> None:
    write_plan(tmp_path / "plan.json", climb)
    read = read_plan(tmp_path / "plan.json")
    assert certify_postures(read, GUIDE, SCENE, TALOS).certified
    assert read.robustness == climb.robustness
    assert [each.how for each in read.postures] == [each.how for each in climb.postures]


def test_from_guide_to_plan_to_check(folder, capsys) -> None:
    line = "contacts guide.npz --scene scene.json --planner sampling --out plan.json"
    cli.run([*line.split(), "--picture", "plan.svg"])
    assert "sampling: feasible" in capsys.readouterr().out
    run("check plan.json --guide guide.npz --scene scene.json --picture again.png")
    said = capsys.readouterr().out
    assert "is certified: " in said
    assert "least robustness" in said
    assert (folder / "again.png").stat().st_size > 5000
    assert "left foot" in (folder / "plan.svg").read_text()


def test_a_stop_is_an_answer_with_a_picture(folder, capsys) -> None:
    line = "contacts long.npz --scene hole.json --planner sampling --out plan.json"
    cli.run([*line.split(), "--picture", "stop.svg"])
    assert "sampling: not_found (configuration " in capsys.readouterr().out
    assert "ff00ff" in (folder / "stop.svg").read_text()
    run("check plan.json --guide long.npz --scene hole.json")
    assert "which end early" in capsys.readouterr().out


def test_a_plan_that_was_tampered_with(folder) -> None:
    run("contacts flat.npz --scene scene.json --planner sampling --out plan.json")
    written = json.loads((folder / "plan.json").read_text())
    written["robustness"][0] += 1.0
    write_json("plan.json", written)
    with pytest.raises(NotCertifiedError, match="robustness that is wrong"):
        run("check plan.json --guide flat.npz --scene scene.json")
    written["postures"][1]["LF"]["position"] = [0.0, "left", 0.0]
    write_json("plan.json", written)
    with pytest.raises(InputError, match=r"plan\.json: posture 1 is not a posture"):
        run("check plan.json --guide flat.npz --scene scene.json")


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("plan missing.json --planner sampling --out p.json", "missing.json does not exist"),
        ("contacts guide.npz --scene scene.json --cost linear", "--cost is for mip, sl1m and"),
        ("contacts guide.npz --scene scene.json --problem a.json", "--problem is for mip"),
        ("contacts guide.npz --scene scene.json --robot spot", "there is no robot .spot."),
        ("contacts guide.npz --scene scene.json --every 0", "every 0 must be at least 1"),
        ("contacts guide.npz --scene scene.json --time-limit -1", "positive number of seconds"),
        ("contacts guide.npz --scene scene.json --query 2", "no path 2"),
        ("contacts guide.npz --scene nowhere.json", "nowhere.json does not exist"),
    ],
)
def test_a_mistake_is_one_sentence(folder, line: str, words: str) -> None:
    more = [] if "--out" in line else ["--planner", "sampling", "--out", "p.json"]
    with pytest.raises(InputError, match=words):
        cli.run([*line.split(), *more])
    assert not (folder / "p.json").exists()


def test_check_asks_for_what_the_plan_needs(folder, climb) -> None:
    write_plan("plan.json", climb)
    with pytest.raises(InputError, match=r"--guide GUIDE\.npz --scene"):
        run("check plan.json scene.json --guide guide.npz")
    write_plan("plan.json", climb.but(planner="mip", postures=None))
    with pytest.raises(InputError, match="say which problem"):
        cli.run(["check", "plan.json"])
