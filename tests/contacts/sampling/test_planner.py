from dataclasses import replace

import numpy as np
import pytest

from jaxleas.contacts.sampling import SamplingSettings, plan_contacts, plan_many, plan_over
from jaxleas.contacts.sampling.heuristics import HEURISTICS
from jaxleas.dynamics import ContactPoints, robustness_of
from jaxleas.robots import load_robot, load_talos
from jaxleas.robots.legs import legs_of
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.generator import generate_arena
from jaxleas.terrain.scene import Scene
from jaxleas.types import InputError
from tests.contacts.sampling.worlds import flat, floor, hole, stairs, straight, wall

TALOS = load_robot("talos")


@pytest.fixture(scope="module")
def climb():
    scene, path = stairs(), straight(4.0, climbing=True)
    return scene, path, plan_contacts(scene, path, robot=TALOS)


def test_four_metres_of_stairs_are_climbed(climb):
    _, path, plan = climb
    assert plan.success
    assert plan.reason == ""
    assert plan.last_index == len(path) - 1
    assert plan.reached == 1.0
    assert plan.soles[-1, :, 2].min() > 0.7
    assert 10 <= plan.steps <= 40


def test_every_posture_stands_on_its_surfaces_within_the_joint_limits(climb):
    scene, path, plan = climb
    left = load_talos().limbs[0].model
    for index, soles, rotations, names in zip(
        plan.index, plan.soles, plan.rotations, plan.surfaces, strict=True
    ):
        for side, sole, rotation, name in zip((1.0, -1.0), soles, rotations, names, strict=True):
            surface = scene.surfaces[name]
            assert abs(sole[2] - surface[0, 2] - 0.001) < 1e-9
            assert (sole[:2] >= surface[:, :2].min(axis=0) - 1e-9).all()
            assert (sole[:2] <= surface[:, :2].max(axis=0) + 1e-9).all()
            np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-9)
            assert np.linalg.det(rotation) > 0.0
            np.testing.assert_allclose(rotation[:, 2], [0.0, 0.0, 1.0], atol=1e-9)
            mirror = np.diag([1.0, side, 1.0])
            local = mirror @ (sole - path.position[index])  # the yaw is zero
            assert left.inverse(local, mirror @ rotation @ mirror)[1]


def test_robustness_is_that_of_the_linear_program(climb):
    scene, _, plan = climb
    assert plan.robustness.min() >= 2.0
    half = np.array(load_talos().foot_half_size)
    corners = np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * half
    for which in range(0, len(plan), 5):
        points = []
        for sole, rotation, name in zip(
            plan.soles[which], plan.rotations[which], plan.surfaces[which], strict=True
        ):
            low = scene.surfaces[name].min(axis=0)[:2]
            high = scene.surfaces[name].max(axis=0)[:2]
            for corner in corners:
                reach = rotation[:, :2] @ corner
                share = 1.0
                for axis in range(2):
                    room = (high if reach[axis] > 0 else low)[axis] - sole[axis]
                    if abs(reach[axis]) > 1e-12:
                        share = min(share, room / reach[axis])
                points.append(sole + share * reach)
        axes = np.repeat(plan.rotations[which], 4, axis=0)
        contacts = ContactPoints(
            np.array(points),
            axes[:, :, 2],
            friction=0.5,
            ahead=axes[:, :, 0],
            generators=SamplingSettings().friction_generators,
        )
        expected = robustness_of(contacts, plan.com[which], mass=legs_of(load_talos()).mass)
        np.testing.assert_allclose(plan.robustness[which], expected, rtol=1e-6)


def test_one_contact_at_most_changes_from_posture_to_posture(climb):
    _, _, plan = climb
    for before in range(len(plan) - 1):
        after = before + 1
        moved = np.linalg.norm(plan.soles[after] - plan.soles[before], axis=1) > 1e-12
        expected = np.zeros(2, dtype=bool)
        if plan.moved[after] >= 0:
            expected[plan.moved[after]] = True
        np.testing.assert_array_equal(moved, expected)
        step = plan.index[after] - plan.index[before]
        assert step == (0 if plan.how[after] == "repositioned" else 5)


def test_many_together_are_planned_like_each_alone():
    paths = [straight(1.0 + 0.3 * n, height=0.88 + 0.02 * n, climbing=True) for n in range(4)]
    scene = stairs()
    for path, plan in zip(paths, plan_many(scene, paths, robot=TALOS), strict=True):
        alone = plan_contacts(scene, path, robot=TALOS)
        assert plan.how == alone.how
        np.testing.assert_allclose(plan.soles, alone.soles, atol=1e-12)
        np.testing.assert_allclose(plan.robustness, alone.robustness, rtol=1e-6)


def test_over_many_scenes_each_is_planned_like_alone():
    """Scenes that overlap in space, and one so large that most of it is out of reach."""
    arena = generate_arena(GeneratorConfig(rows=2, columns=8), 3).scene
    shift = np.array([40.0, 0.0, 0.0])
    far = {f"far_{name}": polygon + shift for name, polygon in arena.surfaces.items()}
    boxes = {f"far_{name}": polygon + shift for name, polygon in arena.obstacles.items()}
    scenes = [wall(), stairs(), Scene({**far, **flat().surfaces}, boxes), hole()]
    paths = [straight(1.5 + 0.1 * n, y=0.05 * n, climbing=n % 4 == 1) for n in range(8)]
    index = [n % 4 for n in range(8)]
    assert any("obstacle" in name for name in boxes)
    plans = plan_over(scenes, paths, index, robot=TALOS)
    for path, number, plan in zip(paths, index, plans, strict=True):
        alone = plan_contacts(scenes[number], path, robot=TALOS)
        assert (plan.how, plan.surfaces, plan.reason) == (alone.how, alone.surfaces, alone.reason)
        np.testing.assert_allclose(plan.soles, alone.soles, atol=1e-12)
    assert {plan.success for plan in plans} == {True, False}


def test_the_same_walk_elsewhere():
    path = straight(1.5)
    here = plan_contacts(flat(), path, robot=TALOS)
    shift = np.array([3.0, -1.0, 0.5])
    moved = Scene({"floor": flat().surfaces["floor"] + shift})
    there = plan_contacts(moved, replace(path, position=path.position + shift), robot=TALOS)
    np.testing.assert_allclose(there.soles, here.soles + shift, atol=1e-9)


def test_a_hole_too_wide_stops_the_plan_before_it():
    plan = plan_contacts(hole(), straight(4.0), robot=TALOS)
    assert not plan.success
    assert "configuration" in plan.reason
    assert 1.0 < 0.5 + 0.02 * plan.last_index < 2.0
    assert plan.soles[:, :, 0].max() <= 1.5


def test_a_wall_stops_the_trunk():
    plan = plan_contacts(wall(), straight(4.0), robot=TALOS)
    assert not plan.success
    assert "trunk" in plan.reason
    assert 0.5 + 0.02 * plan.last_index < 2.0 - 0.1


def test_nothing_to_stand_on_at_the_start():
    plan = plan_contacts(flat(), straight(0.5, height=1.6), robot=TALOS)
    assert not plan.success
    assert plan.last_index == -1
    assert len(plan) == 0
    assert "first configuration" in plan.reason


@pytest.mark.parametrize("heuristic", sorted(HEURISTICS))
def test_every_heuristic_walks_on_flat_ground(heuristic):
    plan = plan_contacts(flat(), straight(0.8), SamplingSettings(heuristic=heuristic), robot=TALOS)
    assert plan.last_index > 0
    assert plan.robustness.min() >= 2.0


def test_fixed_step_steps_ahead_and_manipulability_does_not_care():
    places = {}
    for heuristic in ("fixed_step", "reference"):
        plan = plan_contacts(
            flat(), straight(2.0), SamplingSettings(heuristic=heuristic), robot=TALOS
        )
        rows = np.flatnonzero(plan.moved >= 0)
        root = 0.5 + 0.02 * plan.index[rows]
        places[heuristic] = (plan.soles[rows, plan.moved[rows], 0] - root).mean()
    assert abs(places["fixed_step"] - 0.06) < 0.05  # 0.6 s at 0.1 m/s


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"position": np.full((51, 3), np.nan)}, "position holds numbers that are not finite"),
        ({"yaw": np.zeros(3)}, "do not fit"),
        ({"time": -np.arange(51.0)}, "time runs backwards"),
        (
            {"time": np.zeros(0), "position": np.zeros((0, 3)), "yaw": np.zeros(0)},
            "has no configuration",
        ),
    ],
)
def test_a_bad_guide_path_is_refused(change, sentence):
    with pytest.raises(InputError, match=sentence):
        plan_contacts(flat(), replace(straight(1.0), **change), robot=TALOS)


def test_a_scene_without_surfaces_is_refused():
    with pytest.raises(InputError, match="no surfaces"):
        plan_contacts(Scene({}), straight(1.0), robot=TALOS)


def test_feet_stand_on_what_feet_may_touch_and_legs_stay_clear_of_the_rest():
    floor_alone, path = flat(), straight(2.0)
    middle = dict(floor_alone.surfaces)
    ceiling = floor(-1.0, 9.0, -3.0, 3.0, 2.5)[::-1]
    railing = floor(-1.0, 9.0, 1.0, 1.1, 0.9)
    touch = {"railing": "palms"}
    more = Scene({**middle, "ceiling": ceiling, "railing": railing}, touch=touch)
    plain, furnished = (
        plan_contacts(floor_alone, path, robot=TALOS),
        plan_contacts(more, path, robot=TALOS),
    )
    assert plain.success
    assert furnished.success
    np.testing.assert_allclose(furnished.soles, plain.soles)
    low = Scene({**middle, "beam": floor(0.8, 1.2, -3.0, 3.0, 0.3)}, touch={"beam": "palms"})
    blocked = plan_contacts(low, path, robot=TALOS)
    assert not blocked.success, "the shins would go through the beam"


@pytest.mark.parametrize(
    ("scene", "path", "settings", "ending"),
    [
        (flat(), straight(1.0), {}, "reached"),
        (hole(), straight(4.0), {}, "no_contact"),
        (wall(), straight(4.0), {}, "trunk"),
        (hole(), straight(4.0, y=2.9), {}, "no_start"),
        (hole(), straight(4.0), {"max_repositions": 0}, "repositions"),
    ],
)
def test_how_a_plan_ends_is_a_value(scene, path, settings, ending):
    plan = plan_contacts(scene, path, SamplingSettings(samples=2000, **settings), robot=TALOS)
    assert (plan.ending, plan.success) == (ending, ending == "reached")
    assert bool(plan.reason) != plan.success
