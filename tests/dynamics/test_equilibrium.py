import gzip
import itertools
import json

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from jaxleas.dynamics import (
    ContactPoints,
    equilibrium_robustness,
    friction_generators,
    robustness_of,
)
from jaxleas.dynamics.equilibrium import _solve, contact_wrenches
from jaxleas.types import InputError

GRAVITY = 9.81
FEET = np.array(
    [
        [x + s * 0.1, y + t * 0.06, 0.0]
        for x, y in ((0.1, 0.1), (-0.1, -0.1))
        for s in (1, -1)
        for t in (1, -1)
    ]
)
UP = np.tile([0.0, 0.0, 1.0], (len(FEET), 1))


def twin(points, normals, com, mass, friction, acceleration) -> float:
    """The definition, with torques about the world's origin and its own generators."""
    columns, first = [], None
    for point, normal in zip(points, normals, strict=True):
        t1 = np.cross(normal, [0.0, 1.0, 0.0])
        t1 = t1 / np.linalg.norm(t1)
        t2 = np.cross(normal, t1)
        cone = []
        for k in range(4):
            angle = np.pi / 4 + k * np.pi / 2
            g = normal + friction * (np.cos(angle) * t1 + np.sin(angle) * t2)
            cone.append(g / np.linalg.norm(g))
        first = cone if first is None else first
        columns += [np.concatenate([g, np.cross(point, g)]) for g in cone]
    lift = mass * (np.array([0.0, 0.0, GRAVITY]) + acceleration)
    G = np.column_stack(columns)
    count = G.shape[1]
    # Unknowns b and b0: G b = w, b0 - b_i <= 0.
    answer = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.column_stack([-np.eye(count), np.ones(count)]),
        b_ub=np.zeros(count),
        A_eq=np.column_stack([G, np.zeros(6)]),
        b_eq=np.concatenate([lift, np.cross(com, lift)]),
        bounds=[(None, None)] * (count + 1),
    )
    assert answer.status == 0
    return float(answer.x[-1] * np.linalg.norm(np.cross(np.sum(first, axis=0), first[0])))


@pytest.fixture
def reference(shared) -> list[dict]:
    with gzip.open(shared / "reference/equilibrium.json.gz") as stream:
        return json.load(stream)


def test_every_reference_case_within_1e_6(reference):
    assert len(reference) == 150
    for case in reference:
        found = equilibrium_robustness(
            np.array(case["contact_points"]),
            np.array(case["contact_normals"]),
            np.array(case["com"]),
            mass=case["mass"],
            friction=case["mu"],
            acceleration=np.array(case["acc"]),
        )
        expected = case["robustness"]["robustness"]
        assert abs(found - expected) <= 1e-6 * abs(expected), case["id"]
        assert (found >= 0.0) == case["in_equilibrium"], case["id"]


def test_the_reference_cases_need_no_general_solver(reference):
    for case in reference:
        contacts = ContactPoints(
            np.array(case["contact_points"])[None],
            np.array(case["contact_normals"])[None],
            case["mu"],
        )
        wrenches = contact_wrenches(contacts, np.array(case["com"])[None])
        force = case["mass"] * (np.array([[0.0, 0.0, GRAVITY]]) + np.array(case["acc"]))
        assert _solve(wrenches, force)[1].all(), case["id"]


def random_stances(count: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    points = FEET + rng.normal(scale=0.05, size=(count, *FEET.shape))
    normals = UP + rng.normal(scale=0.2, size=(count, *FEET.shape))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    com = np.array([0.0, 0.0, 0.8]) + rng.normal(scale=0.08, size=(count, 3))
    return points, normals, com


def test_agrees_with_the_definition_on_random_stances():
    points, normals, com = random_stances(40, seed=3)
    acceleration = np.random.default_rng(4).normal(size=com.shape)
    found = equilibrium_robustness(
        points, normals, com, mass=60.0, friction=0.6, acceleration=acceleration
    )
    expected = [
        twin(*row, 60.0, 0.6, a) for *row, a in zip(points, normals, com, acceleration, strict=True)
    ]
    assert (found > 0).any()
    assert (found < 0).any()
    np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7)


def test_walls_on_both_sides_go_to_the_general_solver_and_agree():
    # A chimney: hands push outwards, and the generators have no common half-space along their sum.
    points = np.array([[0.0, s * 0.5, 1.0 + dz] for s in (1, -1) for dz in (0.1, -0.1)])
    points = np.concatenate(
        [points + np.array([0.1, 0.0, 0.0]), points - np.array([0.1, 0.0, 0.0])]
    )
    normals = np.array([[0.0, -np.sign(p[1]), 0.0] for p in points])
    com = np.array([0.0, 0.0, 0.9])
    # n x e_y vanishes here: the other basis.
    found = equilibrium_robustness(points, normals, com, mass=50.0, friction=0.8)
    assert found == np.inf  # squeezing harder always helps


def test_more_robust_in_the_middle_and_unstable_outside():
    places = np.array([[x, 0.0, 0.8] for x in (0.0, 0.1, 0.15, 0.19, 0.21, 0.3)])
    found = equilibrium_robustness(
        np.tile(FEET, (6, 1, 1)), np.tile(UP, (6, 1, 1)), places, mass=90.0, friction=0.5
    )
    assert (np.diff(found) < 0).all()
    assert found[2] > 0.0 > found[4]


def test_proportional_to_mass_and_blind_to_where_the_world_begins():
    points, normals, com = random_stances(10, seed=5)
    here = equilibrium_robustness(points, normals, com, mass=50.0, friction=0.5)
    heavy = equilibrium_robustness(points, normals, com, mass=100.0, friction=0.5)
    there = np.array([100.0, -20.0, 3.0])
    moved = equilibrium_robustness(points + there, normals, com + there, mass=50.0, friction=0.5)
    np.testing.assert_allclose(heavy, 2.0 * here, rtol=1e-9)
    np.testing.assert_allclose(moved, here, rtol=1e-7)


def test_any_batch_shape_gives_the_same_answers():
    points, normals, com = random_stances(6, seed=6)
    flat = equilibrium_robustness(points, normals, com, mass=50.0, friction=0.5)
    shaped = equilibrium_robustness(
        points.reshape(2, 3, 8, 3),
        normals.reshape(2, 3, 8, 3),
        com.reshape(2, 3, 3),
        mass=50.0,
        friction=0.5,
    )
    np.testing.assert_allclose(shaped.reshape(-1), flat, rtol=1e-12)


def test_generators_are_unit_and_on_the_cone():
    normals = np.random.default_rng(7).normal(size=(50, 3))
    normals[0] = [0.0, 1.0, 0.0]  # where the first choice of tangent vanishes
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    generators = friction_generators(normals, 0.5)
    np.testing.assert_allclose(np.linalg.norm(generators, axis=-1), 1.0)
    along = (generators * normals[:, None]).sum(axis=-1)
    np.testing.assert_allclose(along, 1.0 / np.sqrt(1.25))


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"com": np.zeros(2)}, "do not belong together"),
        ({"com": np.array([np.nan, 0.0, 0.0])}, "finite"),
        ({"normals": 2.0 * UP}, "length 1"),
        ({"friction": 0.0}, "positive"),
        ({"mass": -1.0}, "positive"),
        ({"acceleration": np.zeros(4)}, "acceleration"),
    ],
)
def test_bad_input_is_one_sentence(change, sentence):
    good = {"points": FEET, "normals": UP, "com": np.zeros(3), "mass": 1.0, "friction": 0.5}
    with pytest.raises(InputError, match=sentence):
        equilibrium_robustness(**{**good, **change})


@pytest.mark.parametrize("count", [3, 4, 6, 9])
def test_generators_turn_with_the_contact(count):
    rng = np.random.default_rng(8)
    turns = Rotation.random(20, random_state=8).as_matrix()
    local = np.array([[0.0, 0.0, 1.0]]), np.array([[1.0, 0.0, 0.0]])
    level = friction_generators(local[0], 0.5, local[1], count)[0]
    for turn in turns:
        made = friction_generators(local[0] @ turn.T, 0.5, local[1] @ turn.T, count)[0]
        np.testing.assert_allclose(made, level @ turn.T, atol=1e-12)
    mirrored = level * [1.0, -1.0, 1.0]  # left and right feet have mirrored cones
    apart = np.linalg.norm(mirrored[:, None] - level, axis=-1).min(axis=1)
    np.testing.assert_allclose(apart, 0.0, atol=1e-12)
    several = friction_generators(np.tile(local[0], (3, 1)), rng.uniform(0.2, 0.9, 3), None, count)
    assert several.shape == (3, count, 3)


@pytest.mark.parametrize("count", [4, 6])
def test_robustness_turns_with_the_robot(count):
    points, normals, com = random_stances(20, seed=9)
    ahead = np.broadcast_to([1.0, 0.0, 0.0], normals.shape)
    turn = Rotation.from_euler("z", 0.7).as_matrix()
    here = robustness_of(ContactPoints(points, normals, 0.5, ahead, count), com, mass=50.0)
    turned = [each @ turn.T for each in (points, normals, ahead)]
    contacts = ContactPoints(turned[0], turned[1], 0.5, turned[2], count)
    there = robustness_of(contacts, com @ turn.T, mass=50.0)
    np.testing.assert_allclose(there, here, rtol=1e-7, atol=1e-7)


def test_more_generators_find_more_robustness():
    points, normals, com = random_stances(40, seed=10)
    found = [
        robustness_of(ContactPoints(points, normals, 0.5, None, count), com, mass=50.0)
        for count in (
            4,
            8,
            16,
            32,
        )  # each cone holds generators of the one before, or lies around it
    ]
    for fewer, more in itertools.pairwise(found):
        assert (more >= fewer - 1e-9).mean() > 0.9
    assert (found[-1] > found[0] + 0.1).any()


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"generators": 2}, "needs 3 generators or more, not 2"),
        ({"friction": np.array([0.5, -0.5])}, "positive"),
        ({"ahead": np.zeros((1, 3))}, "shape of the points"),
        ({"normals": np.zeros((8, 2))}, "do not belong together"),
    ],
)
def test_contacts_that_are_none_are_refused(change, sentence):
    with pytest.raises(InputError, match=sentence):
        ContactPoints(**{"points": FEET, "normals": UP, "friction": 0.5, **change})
