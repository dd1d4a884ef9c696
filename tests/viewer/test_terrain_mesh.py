import numpy as np
import pytest

from jaxleas.terrain import HeightMap, rasterise, transition
from jaxleas.viewer import terrain_mesh
from jaxleas.viewer.terrain_mesh import (
    LIFT,
    Mesh,
    meet,
    mesh_of_edges,
    mesh_of_map,
    mesh_of_polygons,
)
from tests.guide.walkers import flat_map


def triangle_vectors(mesh: Mesh) -> np.ndarray:
    """Half the cross product of two sides: as long as the area, along the normal."""
    first, second, third = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return 0.5 * np.cross(second - first, third - first)


def test_polygons_keep_their_area_and_face_up():
    scene = transition("rubble", 7).scene
    vectors = triangle_vectors(mesh_of_polygons(scene.surfaces.values()))
    expected = 0.0
    for corners in scene.surfaces.values():
        x, y = corners[:, 0], corners[:, 1]
        expected += 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))  # the shoelace formula
    assert vectors[:, 2].min() > 0.0
    assert vectors[:, 2].sum() == pytest.approx(expected)


def test_a_map_becomes_level_cells_and_the_walls_between_them():
    heights = np.array([[0.0, 0.0, 0.5], [0.0, np.nan, 0.5]], np.float32)
    mesh = mesh_of_map(HeightMap(heights, 0.2, (1.0, 2.0)))
    vectors = triangle_vectors(mesh)
    upward = vectors[:, 2] > 1e-9
    assert vectors[upward].sum(axis=0) == pytest.approx([0.0, 0.0, 5 * 0.04])
    # One wall: 0.2 m long, 0.5 m high, at x = 1.3; none beside the void.
    walls = vectors[~upward]
    assert np.linalg.norm(walls, axis=1).sum() == pytest.approx(0.2 * 0.5)
    corners = mesh.vertices[mesh.faces[~upward]].reshape(-1, 3)
    assert corners[:, 0] == pytest.approx(1.3)
    assert mesh.vertices.min(axis=0) == pytest.approx([0.9, 1.9, 0.0])


def test_a_large_map_is_thinned_by_its_highest_cells(monkeypatch):
    monkeypatch.setattr(terrain_mesh, "MOST_CELLS", 100)
    level = flat_map(half_size=2.0, resolution=0.1)
    level.heights[20, 20] = 0.7
    mesh = mesh_of_map(level)
    assert len(mesh.faces) < 400
    assert mesh.vertices[:, 2].max() == pytest.approx(0.7)
    x_min, x_max, _, _ = level.extent
    assert mesh.vertices[:, 0].min() == pytest.approx(x_min)
    assert mesh.vertices[:, 0].max() >= x_max - 1e-6


def test_a_ray_meets_the_ground_where_a_line_meets_a_plane():
    terrain = flat_map()
    rng = np.random.default_rng(1)
    for _ in range(20):
        target = np.append(rng.uniform(-3.0, 3.0, 2), 0.0)
        eye = np.append(rng.uniform(-9.0, 9.0, 2), rng.uniform(1.0, 8.0))
        point = meet(terrain, eye, 3.0 * (target - eye))
        assert point == pytest.approx(target, abs=0.1)


def test_a_ray_meets_what_stands_in_the_way_and_the_void_is_no_hole_in_the_world():
    terrain = rasterise(transition("stairs_up", 3).scene)
    middle = float(terrain.height_at(np.array([[5.0, 0.0]]))[0])
    assert middle > 0.1
    upstairs = meet(terrain, np.array([5.0, 0.0, 9.0]), np.array([0.0, 0.0, -1.0]))
    assert upstairs == pytest.approx([5.0, 0.0, middle])
    beside = meet(terrain, np.array([3.0, -5.0, 9.0]), np.array([0.0, 0.0, -1.0]))
    assert beside == pytest.approx([3.0, -5.0, np.nanmin(terrain.heights)])
    assert meet(terrain, np.array([0.0, 0.0, 3.0]), np.array([1.0, 0.0, 0.2])) is None


def test_rims_lie_within_their_polygons_and_just_above():
    scene = transition("rubble", 7).scene
    width = 0.012
    mesh = mesh_of_edges(scene.polygons, width)
    assert len(mesh.faces) == 2 * sum(map(len, scene.polygons))
    vectors = triangle_vectors(mesh)
    assert vectors[:, 2].min() > 0.0
    area = np.linalg.norm(vectors, axis=1).sum()
    around = sum(
        np.linalg.norm(np.roll(each, -1, axis=0) - each, axis=1).sum() for each in scene.polygons
    )
    # A strip along each side, less the square that two of them share at each corner.
    assert 0.97 * width * around < area < width * around
    square = np.array([[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1]], float)
    strips = mesh_of_edges([square], 0.1)
    assert np.unique(strips.vertices[:, 0].round(6)).tolist() == [0.0, 0.1, 1.9, 2.0]
    assert strips.vertices[:, 2] == pytest.approx(1.0 + LIFT)
    line = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0]], float)
    assert not len(mesh_of_edges([line], 0.1).faces)
