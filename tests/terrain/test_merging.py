"""Which faces of a mesh may be merged: found with arrays, and by a twin that looks at each edge."""

import numpy as np
import pytest

from jaxleas.terrain.merging import COPLANAR, _coplanar_pairs, merged
from jaxleas.terrain.polygons import polygon_area_vector


def twin(points: np.ndarray, triangles: np.ndarray) -> list[tuple]:
    """Walk along all edges; of several faces with an edge the first counts."""
    normals = [polygon_area_vector(points[face]) for face in triangles]
    normals = [each / max(np.linalg.norm(each), 1e-12) for each in normals]
    first: dict[tuple[int, int], int] = {}
    for face, (a, b, c) in enumerate(triangles.tolist()):
        for edge in ((a, b), (b, c), (c, a)):
            first.setdefault(edge, face)
    return [
        (face, first[b, a], a, b)
        for (a, b), face in first.items()
        if a < b and (b, a) in first
        and 1.0 - normals[face] @ normals[first[b, a]] <= COPLANAR
    ]  # fmt: skip


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


@pytest.mark.parametrize("seed", range(6))
def test_pairs_are_those_of_the_twin_in_its_order(seed) -> None:
    rng = np.random.default_rng(seed)
    points, triangles = grid(rng, 0.7)
    if seed % 2:  # faces that the mesh has twice, and some wound the other way
        triangles = np.concatenate([triangles, triangles[::7], triangles[::5, ::-1]])
    faces, edges = _coplanar_pairs(points, triangles)
    found = [tuple(row) for row in np.column_stack([faces, edges]).tolist()]
    wanted = twin(points, triangles)
    assert wanted
    assert found == wanted


@pytest.mark.parametrize("seed", range(4))
def test_merging_keeps_the_area_and_makes_fewer_polygons(seed) -> None:
    points, triangles = grid(np.random.default_rng(seed), 0.8)
    polygons = merged(points, triangles)
    before = sum(np.linalg.norm(polygon_area_vector(points[each])) for each in triangles)
    after = sum(np.linalg.norm(polygon_area_vector(each)) for each in polygons)
    assert after == pytest.approx(before)
    assert len(polygons) < len(triangles)


def test_a_triangle_with_a_corner_on_a_side_goes() -> None:
    points = np.array([[0.0, 0, 0], [2, 0, 0], [1, 0, 0], [0, 5, 1]])
    polygons = merged(points, np.array([[0, 1, 2], [0, 1, 3]]))
    assert len(polygons) == 1
