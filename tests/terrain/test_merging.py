"""Which faces of a mesh are merged: many at once, and by a twin that asks edge after edge."""

import mapbox_earcut
import numpy as np
import pytest

from jaxleas.terrain.meshes.coplanar import merged
from jaxleas.terrain.meshes.deviations import convexity_deviations, planarity_deviations
from jaxleas.terrain.meshes.half_edges import HalfEdges, facing_sides
from jaxleas.terrain.meshes.merging import merge
from jaxleas.terrain.polygons import (
    convexity_deviation,
    planarity_deviation,
    polygon_area_vector,
)


def first_facing(triangles: np.ndarray) -> set[tuple[int, int]]:
    """Walk along all edges; of several faces with an edge the first counts."""
    first: dict[tuple[int, int], int] = {}
    for face, corners in enumerate(triangles.tolist()):
        for k in range(3):
            first.setdefault((corners[k], corners[(k + 1) % 3]), 3 * face + k)
    return {(side, first[b, a]) for (a, b), side in first.items() if a < b and (b, a) in first}


def grid(rng: np.random.Generator, flat: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the triangles of a grid in any order; this share of its columns is level."""
    rows, columns = 6, 9
    x, y = np.meshgrid(np.arange(columns, dtype=float), np.arange(rows, dtype=float))
    z = np.where(rng.random(columns) < flat, 0.0, rng.normal(0.0, 0.3, (rows, columns)))
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]
    faces = [np.stack(each, axis=-1).reshape(-1, 3) for each in ((a, b, c), (a, c, d))]
    triangles = rng.permutation(np.concatenate(faces))
    turned = np.array([np.roll(face, rng.integers(3)) for face in triangles])
    return np.stack([x, y, z], axis=-1).reshape(-1, 3), turned


def star(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """Return a polygon with corners in and out, and the triangles that ear clipping makes of it."""
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, 24))
    radius = rng.uniform(1.0, 3.0, len(angle))
    corners = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    found = mapbox_earcut.triangulate_float64(corners, np.array([len(corners)], np.uint32))
    triangles = np.asarray(found, np.int64).reshape(-1, 3)
    return corners, np.array(
        [each if turn(corners, *each) > 0 else each[::-1] for each in triangles]
    )


def turn(at: np.ndarray, a: int, b: int, c: int) -> float:
    (ax, ay), (bx, by) = at[b] - at[a], at[c] - at[b]
    return float(ax * by - ay * bx)


def twin(at: np.ndarray, triangles: np.ndarray, order: list[tuple[int, int]]) -> list[list[int]]:
    """Ask edge after edge whether the faces on both sides make one convex face."""
    loops = [list(each) for each in triangles.tolist()]
    for a, b in order:
        left = next(loop for loop in loops if (a, b) in sides_of(loop))
        right = next(loop for loop in loops if (b, a) in sides_of(loop))
        i, j = left.index(b), right.index(a)
        union = left[i:] + left[:i] + (right[j:] + right[:j])[1:-1]
        corners = [union.index(a), union.index(b)]
        if all(turn(at, union[k - 1], union[k], union[(k + 1) % len(union)]) >= 0 for k in corners):
            loops = [loop for loop in loops if loop not in (left, right)] + [union]
    return loops


def sides_of(loop: list[int]) -> list[tuple[int, int]]:
    return list(zip(loop, loop[1:] + loop[:1], strict=True))


@pytest.mark.parametrize("seed", range(6))
def test_faces_are_those_of_the_twin(seed) -> None:
    rng = np.random.default_rng(seed)
    corners, triangles = star(rng)
    points = np.column_stack([corners, np.zeros(len(corners))])
    pairs = facing_sides(triangles)
    borders = HalfEdges(triangles, pairs)
    order = rng.permutation(pairs[:, 0])
    edges = [(int(borders.origin[side]), int(borders.end[side])) for side in order]
    leader = merge(points, borders, np.tile([0.0, 0.0, 1.0], (len(triangles), 1)), order, 0.0)
    sides = np.flatnonzero(borders.alive)
    _, first = np.unique(leader[sides // 3], return_index=True)
    vertices, counts = borders.loops(sides[first])
    found = [each.tolist() for each in np.split(vertices, np.cumsum(counts)[:-1])]
    wanted = twin(corners, triangles, edges)
    assert 1 < len(wanted) < len(triangles)
    assert sorted(map(from_least, found)) == sorted(map(from_least, wanted))


def from_least(loop: list[int]) -> list[int]:
    at = loop.index(min(loop))
    return loop[at:] + loop[:at]


@pytest.mark.parametrize("seed", range(6))
def test_facing_sides_are_those_of_the_twin(seed) -> None:
    _, triangles = grid(np.random.default_rng(seed), 0.7)
    if seed % 2:  # faces that the mesh has twice, and some wound the other way
        triangles = np.concatenate([triangles, triangles[::7], triangles[::5, ::-1]])
    start = triangles.reshape(-1)
    found = [
        sorted(pair, key=lambda side: start[side]) for pair in facing_sides(triangles).tolist()
    ]
    assert {(one, other) for one, other in found} == first_facing(triangles)


@pytest.mark.parametrize("seed", range(4))
def test_merging_keeps_the_area_and_makes_fewer_polygons(seed) -> None:
    points, triangles = grid(np.random.default_rng(seed), 0.8)
    found = merged(points, triangles)
    polygons = [*found.polygons, *found.triangles]
    before = sum(np.linalg.norm(polygon_area_vector(points[each])) for each in triangles)
    after = sum(np.linalg.norm(polygon_area_vector(each)) for each in polygons)
    assert after == pytest.approx(before)
    assert len(polygons) < len(triangles)
    assert max(map(convexity_deviation, polygons)) < 1e-9
    assert max(map(planarity_deviation, polygons)) < 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_a_level_grid_becomes_one_rectangle(seed) -> None:
    points, triangles = grid(np.random.default_rng(seed), 1.1)
    assert [len(each) for each in merged(points, triangles).polygons] == [4]


def test_a_gentle_dome_is_no_plane() -> None:
    rng = np.random.default_rng(0)
    points, triangles = grid(rng, 1.1)
    points = points * [0.01, 0.01, 0.0]
    points[:, 2] = -((points[:, 0] - 0.04) ** 2 + (points[:, 1] - 0.025) ** 2) / 0.02
    found = merged(points, triangles)
    assert all(planarity_deviation(each) <= 1e-4 for each in found.polygons)
    fine = merged(points * [100.0, 100.0, 1.0], triangles)  # neighbours look alike, the whole not
    assert all(planarity_deviation(each) <= 1e-4 for each in fine.polygons)
    assert len(fine.polygons) + len(fine.triangles) > 1


def test_a_side_of_many_small_bends_inwards_is_cut() -> None:
    angle = np.linspace(0.0, 0.3, 400)  # an arc of 10 m radius, seen from outside
    arc = np.column_stack([10.0 * np.sin(angle), 10.0 * np.cos(angle) - 10.0])
    points = np.column_stack([np.concatenate([arc, [[3.0, 1.0], [0.0, 1.0]]]), np.zeros(402)])
    points[:400, 1] *= -1.0
    found = mapbox_earcut.triangulate_float64(
        np.ascontiguousarray(points[:, :2]), np.array([402], np.uint32)
    )
    triangles = np.asarray(found, np.int64).reshape(-1, 3)
    area = [polygon_area_vector(points[each])[2] for each in triangles]
    triangles[np.array(area) < 0.0] = triangles[np.array(area) < 0.0, ::-1]
    merged_ = merged(points, triangles)
    assert all(convexity_deviation(each) <= 1e-4 for each in merged_.polygons)


def test_a_triangle_with_a_corner_on_a_side_goes() -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 0], [1, 0, 0], [0, 5, 1]])
    found = merged(points, np.array([[0, 1, 2], [0, 1, 3]]))
    assert len(found.polygons) + len(found.triangles) == 1


def test_deviations_of_many_are_those_of_each() -> None:
    polygons = np.random.default_rng(0).normal(size=(20, 7, 3))
    np.testing.assert_allclose(
        planarity_deviations(polygons), [planarity_deviation(each) for each in polygons]
    )
    np.testing.assert_allclose(
        convexity_deviations(polygons), [convexity_deviation(each) for each in polygons]
    )
