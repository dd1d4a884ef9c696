"""Stances with feet and a palm: touching, reach, equilibrium."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts import certify_stance
from jaxleas.contacts.stances import contact_pose
from jaxleas.terrain.scene import Scene
from jaxleas.types import Contact, InputError, RootPose, Stance
from tests.contacts.effectors import FLOOR, WALL, leaner


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
