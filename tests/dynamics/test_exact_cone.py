import math

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from jaxleas.dynamics import ContactPoints, exact_robustness, robustness_of
from jaxleas.types import InputError
from tests.dynamics.test_equilibrium import FEET, UP, random_stances

FINE = 720


def bound(contacts: ContactPoints, com: np.ndarray, mass: float, outside: bool) -> float:
    """The slow twin: very many generators, of a cone inside or outside of the exact one [N].

    Torques about the world's origin; forces f_i - (r / sin a_i) n_i are in the cone of point i.
    """
    columns, reserve = [], np.zeros(6)
    friction = np.broadcast_to(contacts.friction, len(contacts.points))
    for point, normal, mu in zip(contacts.points, contacts.normals, friction, strict=True):
        turn, _ = Rotation.align_vectors([normal], [[0.0, 0.0, 1.0]])
        slope = mu / math.cos(math.pi / FINE) if outside else mu
        angles = np.arange(FINE) * 2.0 * np.pi / FINE
        local = np.column_stack([slope * np.cos(angles), slope * np.sin(angles), np.ones(FINE)])
        forces = turn.apply(local)
        columns.append(np.column_stack([forces, np.cross(point, forces)]))
        held = normal * math.sqrt(1.0 + mu * mu) / mu
        reserve += np.concatenate([held, np.cross(point, held)])
    A = np.column_stack([np.concatenate(columns).T, reserve])
    lift = np.array([0.0, 0.0, 1.0])
    answer = linprog(
        np.append(np.zeros(A.shape[1] - 1), -1.0),
        A_eq=A,
        b_eq=np.concatenate([lift, np.cross(com, lift)]),
        bounds=[(0, None)] * (A.shape[1] - 1) + [(None, None)],
    )
    assert answer.status == 0
    return float(answer.x[-1]) * mass * 9.81


def test_lies_between_cones_inside_and_outside() -> None:
    points, normals, coms = random_stances(12, seed=3)
    friction = np.random.default_rng(0).uniform(0.3, 0.9, points.shape[1])
    for index, (place, normal, com) in enumerate(zip(points, normals, coms, strict=True)):
        contacts = ContactPoints(place, normal, 0.5 if index % 2 else friction)
        found = exact_robustness(contacts, com, mass=60.0)
        low, high = (bound(contacts, com, 60.0, outside) for outside in (False, True))
        assert high - low < 1e-2
        assert low - 1e-6 <= found <= high + 1e-6


@pytest.mark.parametrize("count", [3, 4, 6, 16])
def test_is_never_less_than_with_generators(count: int) -> None:
    points, normals, coms = random_stances(30, seed=4)
    inside = robustness_of(ContactPoints(points, normals, 0.6, None, count), coms, mass=60.0)
    exact = np.array(
        [
            exact_robustness(ContactPoints(*each[:2], 0.6), each[2], mass=60.0)
            for each in zip(points, normals, coms, strict=True)
        ]
    )
    assert (exact >= inside - 1e-8).all()
    assert (exact > inside + 0.1).any() or count == 16


def test_does_not_depend_on_frames_or_on_where_the_world_begins() -> None:
    points, normals, coms = random_stances(5, seed=5)
    turn, there = Rotation.random(random_state=1), np.array([5.0, -2.0, 1.0])
    about = Rotation.from_euler("z", 1.1)
    for place, normal, com in zip(points, normals, coms, strict=True):
        here = exact_robustness(ContactPoints(place, normal, 0.5), com, mass=60.0)
        ahead = np.cross(normal, turn.apply(normal))
        framed = ContactPoints(place, normal, 0.5, ahead / np.linalg.norm(ahead, axis=1)[:, None])
        moved = ContactPoints(about.apply(place) + there, about.apply(normal), 0.5)
        assert exact_robustness(framed, com, mass=60.0) == pytest.approx(here, abs=1e-5)
        away = about.apply(com) + there
        assert exact_robustness(moved, away, mass=60.0) == pytest.approx(here, abs=1e-5)


@pytest.mark.parametrize(("degrees", "stands"), [(20.0, True), (26.0, True), (27.1, False)])
@pytest.mark.parametrize("way", [0.0, 0.3, 0.8, 1.2])
def test_a_robot_slides_down_a_plane_at_the_friction_angle(
    degrees: float, stands: bool, way: float
) -> None:
    """tan a = 0.5 at 26.57 degrees, whichever way the plane falls; four generators differ."""
    tilt = Rotation.from_rotvec(np.radians(degrees) * np.array([np.cos(way), np.sin(way), 0.0]))
    place, normal = tilt.apply(FEET), tilt.apply(UP)
    com = place.mean(axis=0) + np.array([0.0, 0.0, 0.5])
    found = exact_robustness(ContactPoints(place, normal, 0.5), com, mass=60.0)
    assert (found >= 0.0) == stands


def test_a_lower_bound_suffices_where_it_is_enough() -> None:
    points, normals, coms = random_stances(1, seed=3)
    contacts = ContactPoints(points[0], normals[0], 0.5)
    exact = exact_robustness(contacts, coms[0], mass=60.0)
    some = exact_robustness(contacts, coms[0], mass=60.0, enough=exact - 5.0)
    assert exact - 5.0 <= some <= exact + 1e-9


def test_a_chimney_holds_and_a_point_does_not() -> None:
    chimney = np.array([[x, y, z] for x in (0.1, -0.1) for y in (0.5, -0.5) for z in (0.9, 1.1)])
    inwards = np.array([[0.0, -np.sign(y), 0.0] for _, y, _ in chimney])
    com = np.array([0.0, 0.0, 0.9])
    assert exact_robustness(ContactPoints(chimney, inwards, 0.8), com, mass=50.0) == math.inf
    alone = ContactPoints(np.zeros((1, 3)), UP[:1], 0.5)
    assert exact_robustness(alone, np.array([0.1, 0.0, 1.0]), mass=50.0) == -math.inf


@pytest.mark.parametrize(
    ("contacts", "com", "mass", "said"),
    [
        (ContactPoints(FEET[None], UP[None], 0.5), np.zeros(3), 1.0, "points of one robot"),
        (ContactPoints(FEET, UP, 0.5), np.zeros(2), 1.0, "points of one robot"),
        (ContactPoints(FEET, UP, 0.5), np.full(3, np.nan), 1.0, "finite"),
        (ContactPoints(FEET, UP, 0.5), np.zeros(3), 0.0, "positive number"),
        (ContactPoints(FEET, UP, 0.5, UP), np.zeros(3), 1.0, "along its normal"),
    ],
)
def test_bad_input_is_one_sentence(contacts, com, mass, said) -> None:
    with pytest.raises(InputError, match=said):
        exact_robustness(contacts, com, mass=mass)
