"""Laws of sums, displacements and regions."""

import json

import numpy as np
import pytest
from scipy.optimize import linprog

from jaxleas.contacts import parse_problem
from jaxleas.contacts.search.bodies import Body, body_of, faces_of_sum, hull_of
from jaxleas.contacts.search.displacements import SLACK, Displacements
from jaxleas.contacts.search.regions import Plane, Region, sum_rows
from tests.contacts.search.worlds import tilted_world, turn


def random_body(rng: np.random.Generator, count: int = 9) -> Body:
    return hull_of(rng.normal(size=(count, 3)))


def directions(rng: np.random.Generator, count: int = 300) -> np.ndarray:
    found = rng.normal(size=(count, 3))
    return found / np.linalg.norm(found, axis=1, keepdims=True)


def test_a_sum_has_these_faces_and_no_others() -> None:
    """Cut out by them, it reaches as far as both bodies together, whatever the direction."""
    rng = np.random.default_rng(0)
    for _ in range(20):
        one, other = random_body(rng), random_body(rng, 6)
        faces = faces_of_sum(one, other)
        whole = body_of(faces, one.support(faces) + other.support(faces))
        assert whole is not None
        asked = directions(rng)
        together = one.support(asked) + other.support(asked)
        assert np.allclose(whole.support(asked), together, atol=1e-12)


def test_empty_and_flat_bodies_are_none() -> None:
    normals = np.concatenate([np.eye(3), -np.eye(3)])
    assert body_of(normals, np.array([1.0, 1, 1, 1, 1, 1])) is not None
    assert body_of(normals, np.array([1.0, 1, 1, 1, 1, -1])) is None
    assert body_of(normals, np.array([1.0, 1, 1, 1, 1, -1.5])) is None


@pytest.mark.parametrize("half_size", [[0.1, 0.06], [0.0, 0.0]])
@pytest.mark.parametrize("model", ["two_com", "feet"])
def test_displacements_are_those_that_a_program_allows(model: str, half_size: list) -> None:
    rng = np.random.default_rng(1)
    described = {**tilted_world(3, model), "foot_half_size": half_size}
    problem = parse_problem("p.json", json.loads(json.dumps(described)))
    made = Displacements(problem)
    for yaw, standing_yaw in rng.uniform(-1, 1, size=(3, 2)):
        body = made.of("LF", "RF", float(yaw), float(standing_yaw))
        assert body is not None
        for asked in directions(rng, 12):
            far = furthest(described, asked, yaw, standing_yaw)
            assert far - 1e-9 <= body.support(asked[None])[0] <= far + 40 * max(SLACK, 1e-6)


def furthest(described: dict, asked: np.ndarray, yaw: float, standing_yaw: float) -> float:
    """Return how far the left foot's landing may be in a direction from the right one [m]."""
    sets, A, b = described["polytopes"], [], []

    def require(rows, bounds, frame, columns) -> None:
        for row, bound in zip(np.array(rows, float) @ frame.T, bounds, strict=True):
            full = np.zeros(9)
            for begin, sign in columns:
                full[begin : begin + 3] += sign * row
            A.append(full)
            b.append(bound)

    if described["model"] == "feet":
        reach = sets["RF_in_LF"]
        require(reach["A"], reach["b"], turn(yaw), [(0, -1.0)])
    else:
        reach = sets["LF_in_RF"]
        require(reach["A"], reach["b"], turn(standing_yaw), [(0, 1.0)])
        sole = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]]
        half = np.repeat(described["foot_half_size"], 2)
        for number, begin in ((0, 3), (1, 6)):
            here, there = sets["COM_in_RF"], sets["COM_in_LF"]
            require(here["A"], here["b"], turn(standing_yaw), [(begin, 1.0)])
            require(there["A"], there["b"], turn(yaw), [(begin, 1.0), (0, -1.0)])
            over = [(begin, 1.0)] if number == 0 else [(begin, 1.0), (0, -1.0)]
            require(sole, half, turn(standing_yaw if number == 0 else yaw), over)
    cost = np.concatenate([-asked, np.zeros(6)])
    answer = linprog(cost, np.array(A), np.array(b), bounds=(None, None))
    assert answer.status == 0
    return -float(answer.fun)


def plane(rng: np.random.Generator) -> Plane:
    frame, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Plane(0.3 * rng.normal(size=3), frame[:2], np.cross(frame[0], frame[1]))


@pytest.mark.parametrize("corners", [1, 2, 3, 7])
def test_the_reached_part_of_a_region_is_exact(corners: int) -> None:
    """Against a program for the furthest place in directions of the plane."""
    rng, met = np.random.default_rng(corners), 0
    for _ in range(12):
        body = random_body(rng)
        held = Region(plane(rng), ring(rng, corners))
        ahead = Region(plane(rng), ring(rng, 5))
        part = ahead.clipped(*sum_rows(held, body))
        for angle in rng.uniform(0, 2 * np.pi, size=6):
            asked = np.array([np.cos(angle), np.sin(angle)])
            far = furthest_reached(held, body, ahead, asked @ ahead.plane.axes)
            if part is None:
                assert far is None
            else:
                assert far is not None
                local = far - ahead.plane.origin @ (asked @ ahead.plane.axes)
                assert (part.corners @ asked).max() == pytest.approx(local, abs=1e-7)
                met += 1
    assert met > 10


def ring(rng: np.random.Generator, count: int) -> np.ndarray:
    """Return corners of a convex polygon, clockwise or not."""
    angles = np.sort(rng.uniform(0, 2 * np.pi, size=count))[:: rng.choice([1, -1])]
    return np.stack([np.cos(angles), 0.6 * np.sin(angles)], axis=1)


def furthest_reached(held: Region, body: Body, ahead: Region, asked: np.ndarray) -> float | None:
    """Return how far a place of `ahead` that is held plus a displacement lies in a direction."""
    sets = (held.vertices, body.vertices, ahead.vertices)
    sizes = [len(each) for each in sets]
    width = sum(sizes)
    equal, right = np.zeros((6, width)), np.array([0, 0, 0, 1, 1, 1.0])
    begins = np.cumsum([0, *sizes])
    for row, (points, sign) in enumerate(zip(sets, (1.0, 1.0, -1.0), strict=True)):
        columns = slice(begins[row], begins[row + 1])
        equal[:3, columns] = sign * points.T
        equal[3 + row, columns] = 1.0
    cost = np.zeros(width)
    cost[begins[2] :] = -ahead.vertices @ asked
    answer = linprog(cost, A_eq=equal, b_eq=right)
    return -float(answer.fun) if answer.status == 0 else None


def test_inside_is_inside() -> None:
    rng = np.random.default_rng(5)
    for _ in range(30):
        corners = ring(rng, 6)
        region = Region(Plane.level(np.zeros(3)), corners)
        middle = corners.mean(axis=0)
        smaller = Region(region.plane, middle + 0.9 * (corners[::-1] - middle))
        assert region.contains(region)
        assert region.contains(smaller)
        assert not smaller.contains(region)
        point = Region(region.plane, middle[None])
        assert region.contains(point)
        assert point.contains(point)
        assert not point.contains(smaller)
