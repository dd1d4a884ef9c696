"""Vertical faces in height maps, and what a map cannot hold."""

import numpy as np
import pytest
import trimesh

from jaxleas.terrain import Scene, import_mesh, import_terrain, rasterise, write_scene
from jaxleas.terrain.losses import losses
from jaxleas.terrain.meshes.triangles import read_triangles
from jaxleas.terrain.rasterise import rasterise_polygons

FLOOR = np.array([[-2.0, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]])


def box(size, centre, turn=0.0):
    place = trimesh.transformations.rotation_matrix(turn, [0, 0, 1])
    place[:3, 3] = centre
    return trimesh.creation.box(extents=size, transform=place)


def wall(start, end, bottom=0.0, top=1.0):
    (x, y), (u, v) = start, end
    return np.array([[x, y, bottom], [u, v, bottom], [u, v, top], [x, y, top]])


def along(start, end, count=500):
    return np.linspace(start, end, count)


@pytest.mark.parametrize("resolution", [0.02, 0.04, 0.1])
@pytest.mark.parametrize(("start", "end"), [((-1, 0.013), (1, 0.013)), ((-1, -0.9), (0.7, 1.1))])
def test_a_wall_without_thickness_reaches_the_map(resolution, start, end):
    heights = rasterise(Scene({"floor": FLOOR}, {"wall": wall(start, end)}), resolution)
    np.testing.assert_allclose(heights.height_at(along(start, end)), 1.0)
    aside = np.array([end[1] - start[1], start[0] - end[0]], float)
    aside *= 2.0 * resolution / np.linalg.norm(aside)
    for side in (1.0, -1.0):
        np.testing.assert_allclose(heights.height_at(along(start, end) + side * aside), 0.0)


def test_the_upper_edge_may_slope():
    sloped = wall((-1, 0.3), (1, 0.3))
    sloped[2:, 2] = [1.5, 0.5]
    heights = rasterise(Scene({"floor": FLOOR}, {"wall": sloped}), 0.04)
    points = along((-1, 0.3), (1, 0.3))
    np.testing.assert_allclose(heights.height_at(points), 1.0 + 0.5 * points[:, 0], atol=0.02)


def test_walls_for_palms_stand_in_the_way_and_ceilings_do_not():
    ceiling = np.add(FLOOR[::-1], [0.0, 0.0, 2.0])
    leaning = wall((-1, 0.3), (0.5, 0.3))
    leaning[2:, 1] += 0.2  # from the wall's foot back: it looks up
    scene = Scene({"floor": FLOOR, "wall": wall((1, -1), (1, 1)), "lean": leaning, "over": ceiling})
    assert list(scene.walkable) == ["floor"]
    heights = rasterise(scene, 0.04)
    np.testing.assert_allclose(heights.height_at(along((1, -1), (1, 1))), 1.0)
    assert heights.height_at(np.array([[0.0, 0.49]]))[0] == pytest.approx(0.95, abs=0.11)
    assert np.nanmax(heights.heights) < 1.1


@pytest.mark.parametrize("thickness", [0.3, 0.05])
@pytest.mark.parametrize("turn", [0.0, 0.3])
def test_sides_of_bodies_change_nothing(thickness, turn):
    triangles = np.asarray(box((1.0, thickness, 0.5), (0.1, 0.2, 0.25), turn).triangles)
    level = np.abs(np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]))
    tops = triangles[level[:, 2] > 1e-9]
    floor = FLOOR[[[0, 1, 2], [0, 2, 3]]]
    whole, without = (
        rasterise_polygons(np.concatenate([floor, each]), 0.04, 0.1) for each in (triangles, tops)
    )
    np.testing.assert_array_equal(whole.heights, without.heights)


def test_a_body_between_two_cell_centres_is_one_cell_wide(tmp_path):
    floor = box((4.0, 4.0, 0.1), (0.0, 0.0, -0.05))
    trimesh.util.concatenate([floor, box((1.0, 0.004, 0.6), (0.0, 0.1, 0.3), 0.2)]).export(
        tmp_path / "thin.stl"
    )
    heights = import_mesh(tmp_path / "thin.stl")
    points = along((-0.4, 0.1), (0.4, 0.1)) - [0.0, 0.1]
    turned = points @ np.array([[np.cos(0.2), np.sin(0.2)], [-np.sin(0.2), np.cos(0.2)]])
    np.testing.assert_allclose(heights.height_at(np.add(turned, [0.0, 0.1])), 0.6, atol=1e-6)


def test_overhangs_are_measured(tmp_path, caplog):
    parts = [box((4, 4, 0.2), (0, 0, -0.1)), box((1, 1, 0.5), (0, 0, 0.25))]
    parts += [box((1, 1, 0.5), (0, 0, 0.75)), box((1, 0.5, 0.1), (1.5, 0, 1.5))]
    trimesh.util.concatenate(parts).export(tmp_path / "roof.stl")
    heights = import_mesh(tmp_path / "roof.stl")
    found = losses([read_triangles(tmp_path / "roof.stl")], heights)
    assert found.covered == pytest.approx(0.5, rel=0.1)
    assert found.headroom == pytest.approx(1.45)
    assert found.thin == 0
    assert "m2 of ground lie under overhangs, with up to 1.45 m of space" in caplog.text


def test_what_is_too_thin_is_counted(tmp_path, caplog):
    spikes = [
        trimesh.creation.cone(radius=0.006, height=height, transform=np.array(
            [[1, 0, 0, x], [0, 1, 0, 0.5], [0, 0, 1, 0], [0, 0, 0, 1.0]]
        )) for x, height in ((-1.01, 0.4), (0.51, 0.9))
    ]  # fmt: skip
    trimesh.util.concatenate([box((4, 4, 0.2), (0, 0, -0.1)), *spikes]).export(tmp_path / "a.stl")
    found = losses([read_triangles(tmp_path / "a.stl")], import_mesh(tmp_path / "a.stl", 0.1))
    assert found.thin == 2
    assert found.thin_height == pytest.approx(0.9, abs=0.01)
    assert "lacks 2 things thinner than a cell, up to 0.90 m high" in caplog.text


def test_nothing_is_said_of_an_arena(tmp_path, caplog):
    from jaxleas.terrain import GeneratorConfig, generate_arena

    write_scene(tmp_path / "arena.json", generate_arena(GeneratorConfig(), 3).scene)
    import_terrain(tmp_path / "arena.json")
    assert not caplog.records
