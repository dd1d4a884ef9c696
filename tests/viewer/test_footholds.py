"""Footholds of robots with three legs, and of one whose palm is on a wall."""

from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem, FootPose, Step
from jaxleas.contacts.surfaces import make_surface
from jaxleas.robots import write_robot
from jaxleas.types import InputError
from jaxleas.viewer.clips import plan_clip
from jaxleas.viewer.footholds import footholds_of
from jaxleas.viewer.playback import THICKNESS, middle_of_sole, robot_to_draw
from jaxleas.viewer.robot_shape import LIMBS, limb_colour
from tests.contacts.effectors import FLOOR, PLACES, WALL, leaner, tripod
from tests.contacts.worlds import problem, stones

SOLE = (0.05, 0.04)


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_robot("robots/tripod.json", tripod())
    write_robot("robots/leaner.json", leaner())


def asked(robot: str, initial: dict, steps: list) -> ContactProblem:
    """A problem on a floor before a wall."""
    return replace(
        problem(stones(0.05)),
        robot=robot,
        model="feet",
        surfaces={"floor": make_surface(FLOOR, "floor"), "wall": make_surface(WALL, "wall")},
        initial=initial,
        steps=tuple(steps),
        half_sizes=dict.fromkeys(initial, SOLE),
    )


def answer(surfaces: list[str], points: list) -> ContactPlan:
    return ContactPlan(
        "mip", True, "feasible", surfaces=tuple(surfaces), footholds=np.array(points, float)
    )


@pytest.fixture
def leaning(here):
    """The robot stands, and then puts its palm on the wall."""
    feet = {name: FootPose(np.array([0.0, y, 0.0]), 0.3) for name, y in (("LF", 0.1), ("RF", -0.1))}
    palm = {"RH": FootPose(np.array([0.5, -0.2, 0.9]), 0.0)}
    touch = Step("RH", 0.2, ("wall",))
    found = asked("leaner", feet | palm, [touch])
    return footholds_of(found, answer(["wall"], [[0.5, -0.3, 1.1]]), 1.0)


def test_a_palm_lies_on_the_wall(leaning):
    for palm in (each for each in leaning if each.effector == "RH"):
        np.testing.assert_allclose(palm.pose.rotation[:, 2], [-1.0, 0.0, 0.0], atol=1e-12)
        corners = palm.pose.transform(np.array([[x, y, 0.0] for x in (-1, 1) for y in (-1, 1)]))
        np.testing.assert_allclose(corners[:, 0], 0.5, atol=1e-12)
        # The drawn sole is before the wall, not above the palm.
        np.testing.assert_allclose(
            middle_of_sole(palm) - palm.pose.position, [-0.5 * THICKNESS, 0.0, 0.0], atol=1e-12
        )


def test_a_foot_stays_flat_on_the_ground_with_its_heading(leaning):
    left = leaning[0]
    assert left.effector == "LF"
    half = 0.5 * 0.3
    np.testing.assert_allclose(
        left.pose.quaternion, [np.cos(half), 0.0, 0.0, np.sin(half)], atol=1e-12
    )
    np.testing.assert_allclose(middle_of_sole(left), [0.0, 0.1, 0.5 * THICKNESS], atol=1e-12)


def test_a_contact_ends_when_the_same_effector_touches_elsewhere(leaning):
    assert [(each.effector, each.time, each.until) for each in leaning] == [
        ("LF", 0.0, np.inf),
        ("RF", 0.0, np.inf),
        ("RH", 0.0, 1.0),
        ("RH", 1.0, np.inf),
    ]


def test_three_legs_have_three_colours_and_points_for_feet(here):
    initial = {name: FootPose(np.array([*xy, 0.0]), 0.0) for name, xy in PLACES.items()}
    step = Step("H", 0.0, ("floor",))
    found = footholds_of(
        asked("tripod", initial, [step]), answer(["floor"], [[0.0, 0.0, 0.0]]), 1.0
    )
    assert [each.limb for each in found] == [0, 1, 2, 2]
    assert [each.half_size for each in found] == [(0.0, 0.0)] * 4
    assert len({tuple(limb_colour(each.limb)) for each in found}) == 3
    assert robot_to_draw([plan_clip("a", asked("tripod", initial, []), answer([], []))]).name == (
        "tripod"
    )


def test_each_effector_has_its_own_half_size(here):
    bigger = (0.11, 0.07)
    standing = {
        "LF": FootPose(np.array([0.0, 0.1, 0.0]), 0.0),
        "RH": FootPose(np.array([0.5, -0.2, 0.9]), 0.0),
    }
    found = replace(asked("leaner", standing, []), half_sizes=dict.fromkeys(standing, bigger))
    foot, palm = footholds_of(found, answer([], []), 1.0)
    assert foot.half_size == bigger  # the problem states its soles
    assert palm.half_size == leaner().effector("RH").half_size


def test_colours_go_by_the_robots_order_of_limbs(here):
    palm = {"RH": FootPose(np.array([0.5, -0.2, 0.9]), 0.0)}
    (found,) = footholds_of(asked("leaner", palm, []), answer([], []), 1.0)
    assert found.limb == 2
    assert tuple(limb_colour(len(LIMBS) + 1)) == tuple(limb_colour(1))


def test_a_foot_on_no_surface_stands_upright(here):
    floating = {"LF": FootPose(np.array([0.0, 0.0, 0.3]), 0.0)}
    (found,) = footholds_of(asked("leaner", floating, []), answer([], []), 1.0)
    np.testing.assert_allclose(found.pose.rotation, np.eye(3), atol=1e-12)


def test_an_unknown_robot_is_drawn_as_talos_and_that_is_said(here, caplog):
    standing = {"LF": FootPose(np.array([0.0, 0.1, 0.0]), 0.0)}
    clip = plan_clip("a", asked("walker_x", standing, []), answer([], []))
    assert robot_to_draw([clip]).name == "talos"
    assert caplog.messages == ["there is no robot 'walker_x' here: Talos is drawn in its place"]
    assert robot_to_draw([clip], "tripod").name == "tripod"
    with pytest.raises(InputError, match="did you mean tripod"):
        robot_to_draw([clip], "tripot")
