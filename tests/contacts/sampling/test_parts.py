import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from jaxleas.contacts.sampling.box_collision import Places, boxes_meet_ground
from jaxleas.contacts.sampling.candidates import near_candidates
from jaxleas.contacts.sampling.case import make_case
from jaxleas.contacts.sampling.database import align, leg_databases, make_database
from jaxleas.contacts.sampling.ground import ground_from
from jaxleas.contacts.sampling.guides import keep_configurations
from jaxleas.contacts.sampling.leg_clearance import segment_distance
from jaxleas.contacts.sampling.settings import SamplingSettings
from jaxleas.contacts.sampling.two_point import Soles, com_exists, com_region
from jaxleas.robots import load_talos
from jaxleas.robots.legs import legs_of
from tests.contacts.sampling.worlds import stairs, straight


def boxes_touch_by_linear_program(centre, rotation, half, polygon) -> bool:
    """Is there a convex combination of the corners inside the box?"""
    corners = (polygon - centre) @ rotation
    answer = linprog(
        np.zeros(len(polygon)),
        A_ub=np.concatenate([corners.T, -corners.T]),
        b_ub=np.concatenate([half, half]),
        A_eq=np.ones((1, len(polygon))),
        b_eq=[1.0],
        bounds=[(0, None)] * len(polygon),
    )
    return answer.status == 0


def test_boxes_touch_polygons_exactly_when_a_linear_program_says_so(random_polygons):
    rng = np.random.default_rng(0)
    count = 60
    ground = ground_from([(str(i), p) for i, p in enumerate(random_polygons)], walkable=1)
    centres = rng.uniform(-0.9, 0.9, (count, 3))
    rotations = Rotation.random(count, random_state=1).as_matrix()
    rotations[::2, :, 1] *= -1.0  # mirror images count as well
    half = rng.uniform(0.02, 0.4, (count, 3))
    found = boxes_meet_ground(centres, rotations, half, ground)
    expected = [
        any(boxes_touch_by_linear_program(c, r, h, p) for p in random_polygons)
        for c, r, h in zip(centres, rotations, half, strict=True)
    ]
    np.testing.assert_array_equal(found, expected)
    assert 0.1 < found.mean() < 0.9


def test_boxes_touch_the_polygons_of_their_own_scene_alone(random_polygons):
    rng = np.random.default_rng(2)
    count, scene = 60, np.array([1, 0, 1])
    ground = ground_from([(str(i), p) for i, p in enumerate(random_polygons)], 1, scene)
    centres = rng.uniform(-0.9, 0.9, (count, 3))
    rotations = Rotation.random(count, random_state=3).as_matrix()
    half = rng.uniform(0.02, 0.4, (count, 3))
    # Runs of two rows at one position, each with two boxes; the scenes alternate.
    position = np.repeat(rng.uniform(-0.9, 0.9, (15, 3)), 2, axis=0)
    mine = np.repeat(np.arange(15) % 2, 2)
    places = Places.of(position, mine, 2)
    np.testing.assert_array_equal(places.first, np.arange(0, 60, 4))
    found = boxes_meet_ground(centres, rotations, half, ground, places)
    expected = [
        any(
            boxes_touch_by_linear_program(centres[n], rotations[n], half[n], polygon)
            for polygon, owner in zip(random_polygons, scene, strict=True)
            if owner == mine[n // 2]
        )
        for n in range(count)
    ]
    np.testing.assert_array_equal(found, expected)
    assert 0.1 < found.mean() < 0.9


@pytest.fixture
def random_polygons() -> list[np.ndarray]:
    rng = np.random.default_rng(5)
    polygons = []
    for corners in (3, 4, 6):
        angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, corners))
        flat = 0.9 * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(corners)])
        turn = Rotation.random(random_state=corners).as_matrix()
        polygons.append(flat @ turn.T + rng.uniform(-0.5, 0.5, 3))
    return polygons


def test_the_database_begins_with_the_reference_and_grows_with_its_size():
    left = load_talos().limbs[0].model
    (database,) = leg_databases(load_talos(), 25_000, 0).each
    assert database.drawn == 25_000
    assert 5_000 < len(database) < 25_000
    assert (np.linalg.norm(database.angles - left.reference, axis=1) < 1e-9).sum() == 1
    assert (np.diff(database.heights) >= 0.0).all()
    assert (database.angles >= left.chain.lower).all()
    assert (database.angles <= left.chain.upper).all()
    assert len(make_database(left, 1000, 0)) < len(database)
    assert database.manipulability.max() == 1.0


def test_align_turns_the_normal_by_the_smallest_angle():
    rotations = Rotation.random(100, random_state=7).as_matrix()
    normals = Rotation.random(100, random_state=8).as_matrix()[:, :, 0]
    aligned = align(rotations, normals)
    np.testing.assert_allclose(aligned[:, :, 2], normals, atol=1e-9)
    np.testing.assert_allclose(
        aligned @ aligned.transpose(0, 2, 1), np.tile(np.eye(3), (100, 1, 1)), atol=1e-9
    )
    turned = Rotation.from_matrix(aligned @ rotations.transpose(0, 2, 1)).magnitude()
    least = np.arccos(np.clip((rotations[:, :, 2] * normals).sum(axis=1), -1.0, 1.0))
    np.testing.assert_allclose(turned, least, atol=1e-6)


def test_candidates_are_all_samples_near_a_surface_best_first():
    settings = SamplingSettings(samples=4000, stages=(100_000,))
    case = make_case(load_talos(), [stairs()], settings)
    guides = keep_configurations(case, [straight(2.0, climbing=True)], [0])
    guide, at, limb = np.array([0, 0]), np.array([8, 12]), np.array([0, 1])
    aim = guides.aim(guide, at, limb)
    found = near_candidates(case, aim)
    for row in range(2):
        mine = {*zip(found.sample[found.row == row], found.surface[found.row == row], strict=True)}
        expected = set()
        mirror = np.array([1.0, (1.0, -1.0)[limb[row]], 1.0])
        soles = case.databases.soles * mirror + aim.roots.position[row]  # the yaw is zero
        for index, (name, polygon) in enumerate(stairs().surfaces.items()):
            del name
            low, high = polygon.min(axis=0), polygon.max(axis=0)
            inside = (soles[:, :2] >= low[:2]) & (soles[:, :2] <= high[:2])
            near = inside.all(axis=1) & (np.abs(soles[:, 2] - low[2]) <= 0.02)
            expected |= {(sample, index) for sample in np.flatnonzero(near)}
        assert mine == expected
        assert len(mine) > 50
        samples = found.sample[found.row == row]
        score = 0.1 * case.databases.each[0].manipulability[samples] - (
            (case.databases.soles[samples] - aim.target[row]) ** 2
        ).sum(axis=1)
        assert (np.diff(score) <= 1e-12).all()
        np.testing.assert_array_equal(found.rank[found.row == row], np.arange(len(samples)))


def test_segment_distance_is_the_least_over_a_grid():
    rng = np.random.default_rng(9)
    first, second = rng.normal(size=(50, 2, 3)), rng.normal(size=(50, 2, 3))
    second[0] = first[0] + 1.0  # parallel
    share = np.linspace(0.0, 1.0, 101)
    along = first[:, :1] + share[:, None] * (first[:, 1:] - first[:, :1])
    other = second[:, :1] + share[:, None] * (second[:, 1:] - second[:, :1])
    grid = np.linalg.norm(along[:, :, None] - other[:, None], axis=-1).min(axis=(1, 2))
    found = segment_distance(first, second)
    assert (found <= grid + 1e-9).all()
    np.testing.assert_allclose(found, grid, atol=0.05)


def test_two_points_agree_with_a_linear_program():
    rng = np.random.default_rng(10)
    polytope = load_talos().limbs[0].model.com_reach
    count = 80
    yaw = rng.uniform(-0.5, 0.5, (count, 2))
    turns = Rotation.from_euler("z", yaw.reshape(-1, 1)).as_matrix().reshape(count, 2, 3, 3)
    side = np.where(rng.random(count) < 0.5, 1.0, -1.0)
    apart = np.column_stack(
        [
            rng.uniform(-0.9, 0.9, count),
            -side * rng.uniform(0.0, 0.7, count),
            rng.uniform(-0.5, 0.5, count),
        ]
    )
    half = np.array([[0.1, 0.06], [-0.1, 0.06], [-0.1, -0.06], [0.1, -0.06]])
    corners = half @ turns[:, 0, :, :2].transpose(0, 2, 1)
    legs, origin = legs_of(load_talos()), np.zeros((count, 3))
    limb = np.where(side > 0.0, 0, 1)
    standing = Soles(limb[:, None], origin[:, None], turns[:, :1], corners[:, None])
    found = com_exists(legs, com_region(legs, standing), 1 - limb, apart, turns[:, 1])
    expected = []
    for index in range(count):
        A, b = [], []
        for foot, where, s in ((0, np.zeros(3), side[index]), (1, apart[index], -side[index])):
            seen = np.diag([1.0, s, 1.0]) @ turns[index, foot].T
            A.append(polytope.normals @ seen)
            b.append(polytope.offsets + polytope.normals @ seen @ where)
        local = turns[index, 0].T[:2]
        A += [local, -local]
        b += [np.array([0.1, 0.06]), np.array([0.1, 0.06])]
        answer = linprog(
            np.zeros(3), A_ub=np.concatenate(A), b_ub=np.concatenate(b), bounds=[(None, None)] * 3
        )
        expected.append(answer.status == 0)
    np.testing.assert_array_equal(found, expected)
    assert 0.1 < found.mean() < 0.9
