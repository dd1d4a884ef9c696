"""Parts of the sampling planner that count feet, each against a twin written for itself."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial import Delaunay
from scipy.spatial.transform import Rotation

from jaxleas.contacts.posture_balance import two_point_margin
from jaxleas.contacts.posture_model import Stood
from jaxleas.contacts.sampling import SamplingSettings
from jaxleas.contacts.sampling.candidates import near_candidates
from jaxleas.contacts.sampling.case import make_case
from jaxleas.contacts.sampling.create import create_contacts
from jaxleas.contacts.sampling.first_stance import first_stances
from jaxleas.contacts.sampling.guides import keep_configurations
from jaxleas.contacts.sampling.leg_clearance import leg_capsules, legs_touch, segment_distance
from jaxleas.contacts.sampling.move import Move
from jaxleas.contacts.sampling.placed_legs import legs_collide, mass_moments, place_legs
from jaxleas.contacts.sampling.requirement import Requirement
from jaxleas.contacts.sampling.roots import Roots
from jaxleas.contacts.sampling.support import sides_of_hull
from jaxleas.contacts.sampling.two_point import Soles, com_exists, com_region
from jaxleas.dynamics import ContactPoints, exact_robustness
from jaxleas.geometry import Box
from jaxleas.robots import Robot, load_talos
from jaxleas.robots.legs import legs_of
from jaxleas.robots.limb_model import LinkBox
from jaxleas.terrain.scene import Scene

from .toys import HEIGHT, quadruped, tripod
from .worlds import flat, straight

GUIDE = straight(1.8, height=HEIGHT)


def test_candidates_of_legs_with_different_models_are_their_own() -> None:
    robot = tripod()
    case = make_case(robot, [flat()], SamplingSettings(samples=1500, stages=(100_000,)))
    guides = keep_configurations(case, [GUIDE], [0])
    limb = np.array([2, 0, 1, 2])
    at = np.array([3, 5, 5, 9])
    aim = guides.aim(0 * limb, at, limb)
    found = near_candidates(case, aim)
    assert (np.diff(found.row) >= 0).all()
    first = case.databases.first[1]
    for row, leg in enumerate(limb):
        samples = found.sample[found.row == row]
        number = case.legs.model_of[leg]
        soles = case.databases.each[number].soles * [1.0, case.legs.side[leg], 1.0]
        near = np.abs(soles[:, 2] + aim.roots.position[row, 2]) <= 0.02
        np.testing.assert_array_equal(np.sort(samples), np.flatnonzero(near) + number * first)
        np.testing.assert_array_equal(found.rank[found.row == row], np.arange(len(samples)))
        score = -((case.databases.soles[samples] - aim.target[row]) ** 2).sum(axis=1)
        score += 0.1 * case.databases.each[number].manipulability[samples - number * first]
        assert (np.diff(score) <= 1e-12).all()


def test_legs_of_mixed_models_are_placed_as_each_alone() -> None:
    robot = replace(tripod(), limbs=(*tripod().limbs[:2], quadruped().limbs[2]))
    legs = legs_of(robot)
    rng = np.random.default_rng(4)
    limb = rng.integers(0, 3, 40)
    roots = Roots(rng.normal(size=(40, 3)), rng.uniform(-3, 3, 40), np.zeros(40, dtype=int))
    turn = Rotation.from_euler("z", roots.yaw[:, None]).as_matrix()
    model_of = [each.model for each in robot.limbs]
    angles = [rng.uniform(model_of[n].chain.lower, model_of[n].chain.upper) for n in limb]
    angles = [0.5 * a + 0.5 * model_of[n].reference for a, n in zip(angles, limb, strict=True)]
    own = [model_of[n].posture(a) for a, n in zip(angles, limb, strict=True)]
    sole = np.array([t @ p.tip for t, p in zip(turn, own, strict=True)]) + roots.position
    rotation = np.array([t @ p.tip_rotation for t, p in zip(turn, own, strict=True)])
    placed = place_legs(legs, roots, limb, sole, rotation)
    assert placed.reachable.all()
    moments, capsules = mass_moments(legs, placed), leg_capsules(legs, placed)
    for row, number in enumerate(limb):
        model, posture = model_of[number], own[row]
        expected = turn[row] @ model.mass_moment(posture.frames, posture.origins)
        expected += model.link_mass.sum() * roots.position[row]
        if len(model.chain) == 6:  # a leg of three joints may reach with its knee elsewhere
            np.testing.assert_allclose(moments[row], expected, atol=1e-6)
        assert np.isfinite(capsules.radii[row]).sum() == len(model.capsules)
    feet = limb[::-1].copy()
    others = leg_capsules(legs, place_legs(legs, roots, feet, sole, rotation))
    touch = legs_touch(capsules, others)
    for row in range(len(limb)):  # each leg has one capsule
        distance = segment_distance(capsules.segments[row], others.segments[row])[0]
        assert touch[row] == (distance < capsules.radii[row, 0] + others.radii[row, 0])
    assert 0.1 < touch.mean() < 1.0


def test_the_hull_of_what_carries_is_the_convex_hull() -> None:
    rng = np.random.default_rng(3)
    for number in range(30):
        points = rng.normal(size=(1, 12, 3))
        carries = rng.random((1, 12)) < 0.6
        carries[0, :4] = True
        if number % 3 == 0:
            points[0, 5] = points[0, 1]  # a corner twice
            points[0, 6] = 0.5 * (points[0, 0] + points[0, 1])  # one on an edge
        sides = sides_of_hull(points, carries)
        asked = rng.normal(size=(200, 3))
        inside = (asked @ sides.normals[0].T <= sides.slack[0]).all(axis=1)
        hull = Delaunay(points[0, carries[0], :2])
        np.testing.assert_array_equal(inside, hull.find_simplex(asked[:, :2]) >= 0)


def test_a_hull_without_area_carries_nothing() -> None:
    line = np.linspace([0.0, 0.0, 0.0], [1.0, 0.5, 0.0], 8)[None]
    for points in (line, np.zeros((1, 8, 3))):
        sides = sides_of_hull(points, np.ones((1, 8), dtype=bool))
        asked = np.concatenate([points[0], points[0] + [0.1, -0.2, 0.5]])
        assert not (asked @ sides.normals[0].T <= sides.slack[0]).all(axis=1).any()


def test_two_points_of_four_feet_agree_with_a_linear_program() -> None:
    """The centre of mass is a weighted mean of what carries; written for itself."""
    robot = quadruped()
    legs = legs_of(robot)
    rng = np.random.default_rng(11)
    count, limb = 120, rng.integers(0, 4, 120)
    others = legs.others[limb]
    models = [each.model for each in robot.limbs]
    places = np.array([model.posture(model.reference).tip for model in models])
    position = places[others] + rng.normal(scale=[0.3, 0.2, 0.05], size=(count, 3, 3))
    yaw = rng.uniform(-0.4, 0.4, (count, 3))
    tilt = np.where(rng.random((count, 3)) < 0.15, 0.7, 0.1)  # [rad]; mu is 0.6
    turns = Rotation.from_euler("zx", np.stack([yaw, tilt], axis=2).reshape(-1, 2))
    rotation = turns.as_matrix().reshape(count, 3, 3, 3)
    foot = places[limb] + rng.normal(scale=[0.3, 0.2, 0.05], size=(count, 3))
    turn = Rotation.from_euler("z", rng.uniform(-0.4, 0.4, (count, 1))).as_matrix()
    standing = Soles(others, position, rotation, position[:, :, None])
    found = com_exists(legs, com_region(legs, standing), limb, foot, turn)
    expected = []
    for row in range(count):
        A, b = [], []
        feet = [*zip(others[row], position[row], rotation[row], strict=True)]
        for number, place, rotated in (*feet, (limb[row], foot[row], turn[row])):
            heading = np.arctan2(rotated[1, 0], rotated[0, 0])
            reach = robot.limbs[number].model.com_reach
            normals = reach.normals @ Rotation.from_euler("z", heading).as_matrix().T
            A.append(np.column_stack([normals, np.zeros((len(normals), 3))]))
            b.append(reach.offsets + normals @ place)
        carried = [rotated[2, 2] >= np.cos(np.arctan(0.6)) for _, _, rotated in feet]
        equal = np.zeros((3, 6))
        equal[:2, :2], equal[:2, 3:] = np.eye(2), -position[row, :, :2].T
        equal[2, 3:] = 1.0
        answer = linprog(
            np.zeros(6),
            A_ub=np.concatenate(A),
            b_ub=np.concatenate(b),
            A_eq=equal,
            b_eq=[0.0, 0.0, 1.0],
            bounds=[(None, None)] * 3 + [(0.0, 1.0 if each else 0.0) for each in carried],
        )
        expected.append(answer.status == 0 and all(carried))
    np.testing.assert_array_equal(found, expected)
    assert 0.1 < np.mean(found) < 0.9


def test_planner_and_certificate_agree_where_four_feet_carry() -> None:
    """They share no code: the planner's region and the certificate's margin, on random stances."""
    robot = quadruped()
    legs = legs_of(robot)
    rng = np.random.default_rng(12)
    places = np.array([each.model.posture(each.model.reference).tip for each in robot.limbs])
    agreed = []
    for _ in range(60):
        position = places + rng.normal(scale=[0.2, 0.2, 0.05], size=(4, 3))
        tilt = np.where(rng.random(4) < 0.1, 0.7, 0.1)
        yaw = rng.uniform(-0.4, 0.4, 4)
        rotation = Rotation.from_euler("zx", np.stack([yaw, tilt], axis=1)).as_matrix()
        moving = int(rng.integers(4))
        others = legs.others[[moving]]
        standing = Soles(others, position[others], rotation[others], position[others][:, :, None])
        here, turn = position[[moving]], rotation[[moving]]
        region = com_region(legs, standing)
        found = com_exists(legs, region, np.array([moving]), here, turn)[0]
        names = robot.foot_names
        stood = Stood(
            found=[],
            rotations=dict(zip(names, rotation, strict=True)),
            soles=dict(zip(names, position, strict=True)),
            corners=dict(zip(names, position[:, None], strict=True)),
            com=np.zeros(3),
            mass=1.0,
        )
        margin = two_point_margin(stood, names[moving], robot)
        assert found == (margin >= 0.0), margin
        agreed.append(found)
    assert 0.1 < np.mean(agreed) < 0.9


def test_no_foot_moves_while_two_standing_legs_touch() -> None:
    """The front legs of the tripod side by side, and crossed."""
    case = make_case(tripod(), [flat()], SamplingSettings(samples=2500))
    guides = keep_configurations(case, [GUIDE], [0])
    zero = np.zeros(1, dtype=int)
    first = first_stances(case, guides)
    assert first.found.all()
    for apart, touch in ((0.12, False), (-0.06, True)):
        stances = first.stances[zero]
        for foot, y in ((0, 0.5 * apart), (1, -0.5 * apart)):
            shift = np.array([0.0, y, 0.0]) - stances.sole[0, foot] * [0.0, 1.0, 0.0]
            stances.sole[0, foot] += shift
            stances.corners[0, foot] += shift
        tally = {}
        made = create_contacts(case, Move(guides.aim(zero, zero, zero + 2), stances, zero), tally)
        assert tally[Requirement.OTHERS_CLEAR] == (0 if touch else 1)
        assert made.found[0] == (not touch)


def test_each_leg_is_kept_clear_by_its_own_boxes() -> None:
    """The right shank of Talos sticks out, and beside it is a wall that the left one clears."""
    talos = load_talos()
    left, right = talos.limbs
    assert right.model
    spoke = LinkBox(3, Box((-0.02, -0.25, -0.15), (0.02, 0.25, -0.05)))
    wide = replace(right, model=replace(right.model, boxes=(*right.model.boxes, spoke)))
    y = 0.35
    barrier = np.array([[-2.0, y, 0.0], [8.0, y, 0.0], [8.0, y, 1.0], [-2.0, y, 1.0]])
    scene = Scene(flat().surfaces, {"wall": barrier})
    settings, limb = SamplingSettings(samples=2000), np.array([0, 1])
    sole = np.array([[0.0, 0.12, 0.001], [0.0, -0.12, 0.001]])
    for robot, sticks_out in ((talos, False), (replace(talos, limbs=(left, wide)), True)):
        case = make_case(robot, [scene], settings)
        for yaw, wall_is_right in ((0.0, False), (np.pi, True)):
            turn = np.tile(Rotation.from_euler("z", yaw).as_matrix(), (2, 1, 1))
            roots = Roots(np.tile([0.0, 0.0, 0.9], (2, 1)), np.full(2, yaw), np.zeros(2, dtype=int))
            placed = place_legs(case.legs, roots, limb, sole @ turn[0].T, turn)
            assert placed.reachable.all()
            hit = legs_collide(case.legs, placed, limb, case.ground, feet=True)
            np.testing.assert_array_equal(hit, [False, sticks_out and wall_is_right])


def one_foot(robot: Robot, slope: float, half_size: tuple[float, float], heading: float):
    """Return both verdicts on the right foot leaving, while the left one stands on a slope."""
    legs, names = legs_of(robot), robot.foot_names
    rotation = Rotation.from_euler("zx", [[heading, slope], [0.0, 0.0]]).as_matrix()
    position = np.stack([robot.references[index] for index in robot.feet])
    x, y = half_size
    square = np.array([[x, y, 0.0], [-x, y, 0.0], [-x, -y, 0.0], [x, -y, 0.0]])
    corners = position[:, None] + square @ rotation.transpose(0, 2, 1)
    standing = Soles(np.array([[0]]), position[None, :1], rotation[None, :1], corners[None, :1])
    region = com_region(legs, standing)
    found = com_exists(legs, region, np.array([1]), position[1:], rotation[1:])[0]
    stood = Stood(
        found=[],
        rotations=dict(zip(names, rotation, strict=True)),
        soles=dict(zip(names, position, strict=True)),
        corners=dict(zip(names, corners, strict=True)),
        com=np.zeros(3),
        mass=1.0,
    )
    return found, two_point_margin(stood, names[1], robot), (corners[0], rotation[0])


@pytest.mark.parametrize("heading", [0.0, 0.4])
def test_one_foot_stands_on_a_slope_exactly_where_its_friction_holds_it(heading) -> None:
    """A third judge, exact friction cones, decides for a centre of mass above the sole."""
    robot = load_talos()
    mu = robot.effectors[0].friction
    for slope in np.arctan(mu) * np.array([0.0, 0.5, 0.98, 1.02, 1.5, 2.0]):
        found, margin, (corners, rotation) = one_foot(robot, slope, (0.1, 0.06), heading)
        contacts = ContactPoints(corners, np.tile(rotation[:, 2], (4, 1)), mu)
        above = corners.mean(axis=0) + np.array([0.0, 0.0, 0.8])
        stands = exact_robustness(contacts, above, mass=robot.mass) >= 0.0
        assert stands == (slope < np.arctan(mu))
        assert found == stands
        assert (margin >= 0.0) == stands


def test_one_point_foot_carries_nothing() -> None:
    found, margin, _ = one_foot(load_talos(), 0.0, (0.0, 0.0), 0.0)
    assert not found
    assert margin == -np.inf
