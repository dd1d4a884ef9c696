"""Robots with three and four modelled legs: plans and their certificates."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.contacts import certify_postures, plan_sampling
from jaxleas.contacts.problem import FootPose
from jaxleas.contacts.sampling import SamplingSettings, plan_contacts
from jaxleas.files import write_npz
from jaxleas.robots import Robot, load_talos, write_robot
from jaxleas.terrain.scene import Scene
from jaxleas.terrain.scene_file import write_scene
from jaxleas.types import InputError

from .toys import HEIGHT, quadruped, stepping_stones, tripod
from .worlds import flat, floor, straight

SETTINGS = SamplingSettings(samples=2500, keep_every=2)
GUIDE = straight(1.8, height=HEIGHT)


@pytest.fixture(scope="module", params=[tripod, quadruped], ids=lambda make: make.__name__)
def toy(request) -> Robot:
    return request.param()


@pytest.mark.parametrize("scene", [flat(), stepping_stones()], ids=["flat", "stones"])
def test_a_robot_of_many_legs_gets_a_certified_plan(toy: Robot, scene: Scene) -> None:
    plan = plan_sampling(GUIDE, scene, SETTINGS, robot=toy)
    assert plan.feasible, plan.reason
    assert plan.postures
    assert {posture.moved for posture in plan.postures} == {None, *toy.foot_names}
    certificate = certify_postures(plan, GUIDE, scene, toy)
    assert certificate.certified, certificate.complaint
    assert certificate.worst.metres < 1e-6
    used = {name for posture in plan.postures for name in posture.surfaces.values()}
    assert len(used) >= min(len(scene.surfaces), 6)


def test_the_foot_that_moves_is_the_oldest_that_can(toy: Robot) -> None:
    plan = plan_contacts(flat(), GUIDE, SETTINGS, robot=toy)
    moved = plan.moved[plan.moved >= 0].tolist()
    assert len(moved) > 2 * len(toy.feet)
    same = [one == two for one, two in pairwise(moved)]
    assert not any(same), "a foot that has just moved is the youngest"


def test_a_foot_that_is_elsewhere_is_seen(toy: Robot) -> None:
    plan = plan_sampling(GUIDE, flat(), SETTINGS, robot=toy)
    assert plan.postures
    last = toy.foot_names[-1]
    postures = list(plan.postures)
    for number in range(1, len(postures)):
        pose = postures[number].feet[last]
        there = FootPose(pose.position - np.array([0.2, 0.3, 0.0]), pose.yaw)
        postures[number] = replace(postures[number], feet={**postures[number].feet, last: there})
    made = [each.feet[each.moved].position for each in postures if each.moved]
    shifted = plan.but(postures=tuple(postures), footholds=np.array(made))
    assert not certify_postures(shifted, GUIDE, flat(), toy).certified


def test_a_posture_without_one_of_the_feet_is_refused(toy: Robot) -> None:
    plan = plan_sampling(GUIDE, flat(), SETTINGS, robot=toy)
    assert plan.postures
    with pytest.raises(
        InputError, match=r"posture 0 has .* in contact; robot 'talos' stands on LF"
    ):
        certify_postures(plan, GUIDE, flat(), load_talos())


def test_a_hole_that_stops_them_is_explained(toy: Robot) -> None:
    scene = Scene({"here": floor(-2.0, 1.0, -2.0, 2.0), "there": floor(2.5, 8.0, -2.0, 2.0)})
    plan = plan_sampling(straight(2.4, height=HEIGHT), scene, SETTINGS, robot=toy)
    assert plan.status == "not_found"
    assert "no foot finds a contact" in plan.reason
    for foot in toy.foot_names:
        assert f"{foot} " in plan.reason.partition(": ")[2]


def test_a_start_between_gaps_is_found_foot_by_foot(toy: Robot) -> None:
    """No surface lies below the reference places of the feet on the left."""
    y = 0.15
    scene = Scene({"right": floor(-2, 8, -2.0, y), "left": floor(-2, 8, y + 0.07, 2.0)})
    plan = plan_contacts(scene, straight(0.5, height=HEIGHT), SETTINGS, robot=toy)
    assert len(plan) > 0, plan.reason
    left = plan.soles[0, 0, 1]
    assert left <= y or left >= y + 0.07
    assert plan.robustness[0] >= SETTINGS.least_robustness


def test_from_the_command_line(tmp_path, monkeypatch, capsys) -> None:
    monkeypatch.chdir(tmp_path)
    write_robot("robots/quadruped.json", quadruped())
    columns = ("time", "position", "yaw", "velocity", "valid")
    write_npz("guide.npz", **{each: getattr(GUIDE, each) for each in columns})
    write_scene("scene.json", stepping_stones())
    line = "contacts guide.npz --scene scene.json --planner sampling --robot quadruped"
    cli.run([*line.split(), "--out", "plan.json", "--picture", "plan.png"])
    assert "sampling: feasible" in capsys.readouterr().out
    line = "check plan.json --guide guide.npz --scene scene.json --robot quadruped"
    cli.run(line.split())
    assert "is certified" in capsys.readouterr().out
    assert (tmp_path / "plan.png").stat().st_size > 5000


def test_legs_that_differ_are_each_planned_with_their_own() -> None:
    """The right leg of Talos twice as heavy, its sole shorter and more slippery."""
    talos = load_talos()
    left, right = talos.limbs
    assert right.model
    assert right.effector
    odd = replace(
        right,
        model=replace(right.model, link_mass=2.0 * right.model.link_mass),
        effector=replace(right.effector, half_size=(0.07, 0.05), friction=0.4),
    )
    robot = replace(talos, limbs=(left, odd))
    plan = plan_sampling(straight(1.5), flat(), SamplingSettings(samples=6000), robot=robot)
    assert plan.feasible
    assert plan.postures
    certificate = certify_postures(plan, straight(1.5), flat(), robot)
    assert certificate.certified, certificate.complaint
    assert "centre of mass" in certify_postures(plan, straight(1.5), flat(), talos).complaint
