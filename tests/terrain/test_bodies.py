"""Bodies are wound outwards, whatever the file says."""

import numpy as np
import pytest
import trimesh

from jaxleas.terrain import load_scene, rasterise
from jaxleas.terrain.importers import import_mesh
from jaxleas.terrain.meshes.bodies import orient
from jaxleas.terrain.meshes.mesh_edges import welded
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.types import InputError


def box(size, centre):
    return trimesh.creation.box(
        extents=size, transform=trimesh.transformations.translation_matrix(centre)
    )


def stairs():
    """Five bodies side by side that touch face to face; the last two have the same height."""
    heights = (0.2, 0.3, 0.4, 0.5, 0.5)
    return trimesh.util.concatenate(
        [box((0.5, 2.0, each), (0.5 * at, 0.0, 0.5 * each)) for at, each in enumerate(heights)]
    )


def volume(triangles):
    return np.einsum("nk,nk->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6.0


def turned(mesh, which):
    faces = np.array(mesh.faces)
    faces[which] = faces[which][:, ::-1]
    return trimesh.Trimesh(mesh.vertices, faces, process=False)


def winding(kind, count):
    if kind == "inside out":
        return np.ones(count, bool)
    if kind == "one body":
        return np.arange(count) < 12
    return np.random.default_rng(0).random(count) < 0.4


@pytest.mark.parametrize("kind", ["inside out", "one body", "mixed"])
def test_bodies_that_touch_are_wound_outwards(kind):
    mesh = stairs()
    broken = turned(mesh, winding(kind, len(mesh.faces)))
    points, faces = welded(np.asarray(broken.triangles))
    oriented = orient(points, faces)
    assert volume(points[oriented.faces]) == pytest.approx(mesh.volume)
    assert oriented.turned >= 12
    right = orient(*welded(np.asarray(mesh.triangles)))
    assert right.turned == 0


@pytest.mark.parametrize("kind", ["inside out", "one body", "mixed"])
def test_scene_and_map_of_bodies_inside_out_have_the_true_floor(tmp_path, caplog, kind):
    mesh = stairs()
    turned(mesh, winding(kind, len(mesh.faces))).export(tmp_path / "stairs.stl")
    scene = load_scene(tmp_path / "stairs.stl")
    tops = sorted({round(float(each[0, 2]), 6) for each in scene.surfaces.values()})
    assert tops == [0.2, 0.3, 0.4, 0.5]
    area = sum(polygon_area_vector(each)[2] for each in scene.surfaces.values())
    assert area == pytest.approx(5.0)
    assert "were wound inside out and are turned" in caplog.text
    through, direct = rasterise(scene), import_mesh(tmp_path / "stairs.stl")
    points = np.random.default_rng(1).uniform((-0.2, -0.9), (0.2, 0.9), (500, 2))
    points[:, 0] += 0.5 * (np.arange(500) % 5)
    np.testing.assert_allclose(through.height_at(points), direct.height_at(points), atol=1e-5)


def test_a_cavity_stays_a_cavity(tmp_path):
    outer, inner = box((4, 4, 3), (0, 0, 1.5)), box((3.6, 3.6, 2.6), (0, 0, 1.5))
    inner.invert()
    hollow = trimesh.util.concatenate([outer, inner])
    oriented = orient(*welded(np.asarray(hollow.triangles)))
    assert oriented.turned == 0
    hollow.export(tmp_path / "hollow.stl")
    floors = {
        round(float(each[0, 2]), 3)
        for each in load_scene(tmp_path / "hollow.stl").surfaces.values()
    }
    assert floors == {0.2, 3.0}


def test_a_sheet_keeps_the_winding_of_its_larger_part(tmp_path):
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0), indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), 0.1 * np.sin(x.ravel())])
    index = np.arange(20).reshape(5, 4)
    a, b, c, d = (
        each.ravel() for each in (index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:])
    )
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    broken = faces.copy()
    broken[[1, 7, 12]] = broken[[1, 7, 12]][:, ::-1]
    np.testing.assert_array_equal(orient(points, broken).faces, faces)
    trimesh.Trimesh(points, broken, process=False).export(tmp_path / "sheet.obj")
    area = sum(
        polygon_area_vector(v)[2] for v in load_scene(tmp_path / "sheet.obj").surfaces.values()
    )
    assert area == pytest.approx(12.0)


def test_a_mesh_whose_scene_would_lack_ground_is_refused(tmp_path):
    room = box((4, 4, 2.5), (0, 0, 1.25))
    room.invert()
    furniture = box((0.5, 0.5, 0.5), (0, 0, 0.5))
    trimesh.util.concatenate([room, furniture]).export(tmp_path / "room.stl")
    with pytest.raises(InputError, match=r"on \d+ % of its ground, such as at .* cut off a roof"):
        load_scene(tmp_path / "room.stl")
