from pathlib import Path

import numpy as np
import pytest
import trimesh

from jaxleas.terrain import mesh_to_scene, rasterise
from jaxleas.terrain.importers import import_mesh
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.scene_file import require_valid
from jaxleas.types import InputError

MESHES = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes"


def area(scene):
    return sum(np.linalg.norm(polygon_area_vector(v)) for v in scene.surfaces.values())


@pytest.mark.parametrize("subdivisions", [0, 1, 2])
def test_a_box_becomes_its_top_and_four_sides(tmp_path, subdivisions):
    mesh = trimesh.creation.box(extents=(2.0, 1.0, 0.5))
    for _ in range(subdivisions):
        mesh = mesh.subdivide()
    mesh.export(tmp_path / "box.stl")
    scene = mesh_to_scene(tmp_path / "box.stl")
    require_valid(scene, "box")
    assert area(scene) == pytest.approx(2.0)
    if subdivisions == 0:
        (top,) = scene.surfaces.values()
        np.testing.assert_allclose(np.ptp(top, axis=0), [2.0, 1.0, 0.0], atol=1e-7)
        assert len(scene.obstacles) == 4


def test_what_is_not_convex_stays_in_parts(tmp_path):
    vertices = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]])
    trimesh.Trimesh(vertices, faces).export(tmp_path / "corner.stl")
    scene = mesh_to_scene(tmp_path / "corner.stl")
    require_valid(scene, "corner")
    assert len(scene.surfaces) == 2
    assert area(scene) == pytest.approx(3.0)


def test_a_fold_is_not_merged(tmp_path):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0.2], [2, 1, 0.2]])
    faces = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]])
    trimesh.Trimesh(vertices, faces).export(tmp_path / "fold.stl")
    scene = mesh_to_scene(tmp_path / "fold.stl")
    assert sorted(len(vertices) for vertices in scene.surfaces.values()) == [4, 4]


def test_a_mesh_inside_out_is_refused(tmp_path):
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    trimesh.Trimesh(vertices, [[0, 2, 1]]).export(tmp_path / "down.stl")
    with pytest.raises(InputError, match="inside out"):
        mesh_to_scene(tmp_path / "down.stl")


@pytest.mark.parametrize("name", ["rubbles_stairs_1.stl", "ground_with_bridge.stl", "darpa.stl"])
def test_scene_and_map_of_a_real_mesh_agree(name):
    if not (MESHES / name).is_file():
        pytest.skip(f"needs {name} of hpp-environments in ../shared/data/meshes")
    scene, height_map = mesh_to_scene(MESHES / name), import_mesh(MESHES / name)
    require_valid(scene, name)
    x_min, x_max, y_min, y_max = height_map.extent
    points = np.random.default_rng(0).uniform((x_min, y_min), (x_max, y_max), size=(5000, 2))
    direct, through_scene = (m.height_at(points) for m in (height_map, rasterise(scene)))
    assert np.mean(np.isnan(direct) != np.isnan(through_scene)) < 0.03
    both = ~np.isnan(direct) & ~np.isnan(through_scene)
    assert np.mean(np.abs(direct - through_scene)[both] > 0.01) < 0.03


def test_what_is_stated_alone_replaces_only_that_of_the_reading(tmp_path):
    trimesh.creation.box(extents=(2000.0, 500.0, 1000.0)).export(tmp_path / "box.stl")
    scene = mesh_to_scene(tmp_path / "box.stl", up="y", reading=Reading(scale=0.001))
    (top,) = scene.surfaces.values()
    np.testing.assert_allclose(np.sort(np.ptp(top, axis=0)), [0.0, 1.0, 2.0], atol=1e-6)
    assert area(scene) == pytest.approx(2.0)
