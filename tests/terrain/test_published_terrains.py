"""Terrains made by others, and small files that were once misread: each with its true value."""

from pathlib import Path

import numpy as np
import pytest

from jaxleas.terrain import import_terrain, load_scene
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.reading import Reading
from jaxleas.types import InputError

SHARED = Path(__file__).resolve().parents[3] / "shared"
TERRAINS, CASES = SHARED / "data" / "terrains", SHARED / "cases"


def needed(path: Path) -> Path:
    if not path.exists():
        pytest.skip(f"needs {path.name} of ../shared")
    return path


def area_of(heights) -> float:
    return np.isfinite(heights.heights).sum() * heights.resolution**2


def levels_of(heights, digits=4) -> list[float]:
    values = heights.heights[np.isfinite(heights.heights)]
    return sorted({round(float(each), digits) for each in values})


@pytest.mark.parametrize(
    ("name", "extent", "levels", "mean"),
    [
        ("ocs2_gaps.png", (4.0, 16.0), 2, None),
        ("ocs2_stepping_stones.png", (2.0, 16.0), 8, None),
        ("ocs2_demo_terrain.png", (8.0, 8.0), 254, None),
    ],
)
def test_grey_of_the_perceptive_anymal_demo(name, extent, levels, mean):
    found = import_terrain(needed(TERRAINS / name), resolution=0.04, z_min=0.0, z_max=0.35)
    assert found.extent == pytest.approx((0.0, extent[0], 0.0, extent[1]))
    heights = levels_of(found, 6)
    assert len(heights) == levels
    assert (heights[0], heights[-1]) == pytest.approx((0.0, 0.35))
    assert found.void_fraction == 0.0
    np.testing.assert_allclose(
        np.array(heights) * 255 / 0.35, np.round(np.array(heights) * 255 / 0.35), atol=0.01
    )


def test_stairs_and_holes_of_the_plane_decomposition():
    stairs = needed(TERRAINS / "cpd_straight_stairs_1m_1m_60cm.png")
    found = import_terrain(stairs, resolution=0.02, z_min=0.0, z_max=0.6)
    assert found.extent == pytest.approx((0.0, 1.0, 0.0, 1.0))
    assert levels_of(found, 2) == pytest.approx([0.0, 0.2, 0.4, 0.6], abs=0.02)
    holes = import_terrain(
        needed(TERRAINS / "cpd_holes.png"), resolution=0.02, z_min=0.0, z_max=0.6
    )
    assert len(levels_of(holes)) == 3
    terrain = import_terrain(
        needed(TERRAINS / "cpd_terrain.png"), resolution=0.02, z_min=0.0, z_max=0.6
    )
    assert 0.03 < terrain.void_fraction < 0.035  # alpha below one half


def test_the_height_field_of_the_playground_as_image_and_as_model(tmp_path):
    image = needed(TERRAINS / "playground_hfield.png")
    found = import_terrain(image, resolution=20.0 / 255, z_min=0.0, z_max=0.05)
    assert found.shape == (256, 256)
    assert np.nanmax(found.heights) == pytest.approx(0.05 * 254 / 255)
    pytest.importorskip("mujoco", reason="needs the extra maps")
    (tmp_path / "hfield.png").write_bytes(image.read_bytes())
    (tmp_path / "scene.xml").write_text(
        '<mujoco><asset><hfield name="h" file="hfield.png" size="10 10 .05 1"/></asset>'
        '<worldbody><geom type="hfield" hfield="h"/></worldbody></mujoco>'
    )
    model = import_terrain(tmp_path / "scene.xml", resolution=0.1)
    assert model.extent == pytest.approx((-10.1, 10.1, -10.1, 10.1), abs=0.01)
    assert np.nanmax(model.heights) == pytest.approx(0.05, abs=0.002)
    # the middle of a pixel of the image is a vertex of the field, and both have north up
    index = np.random.default_rng(0).integers(5, 250, (50, 2))
    vertex = -10.0 + 20.0 * index / 255
    fine = import_terrain(tmp_path / "scene.xml", resolution=0.02, crop=(-9.9, 9.9, -9.9, 9.9))
    wanted = found.heights[index[:, 1], index[:, 0]] * 255 / 254
    off = np.abs(fine.height_at(vertex) - wanted)  # up to a centimetre beside the vertex
    assert off.max() < 0.01
    assert off.mean() < 0.003


@pytest.mark.parametrize(
    ("name", "floors", "area", "extent"),
    [
        ("qs_gap_20cm", {0.0}, 35.2, (-2.0, 7.0, -2.0, 2.0)),
        ("qs_gap_40cm_local_min", {0.0, 1.0}, 35.24, (-2.0, 7.0, -2.0, 2.0)),
        ("qs_step_20cm", {0.0, 0.2}, 36.0, (-2.0, 7.0, -2.0, 2.0)),
    ],
)
def test_worlds_for_quadrupeds(name, floors, area, extent):
    path = needed(TERRAINS / f"{name}.ply")
    scene = load_scene(path)
    levels = {abs(round(float(each[:, 2].mean()), 3)) for each in scene.surfaces.values()}
    assert levels == floors
    flat = sum(polygon_area_vector(each)[2] for each in scene.surfaces.values())
    assert flat == pytest.approx(area, abs=0.01)
    heights = import_terrain(path)
    assert area_of(heights) == pytest.approx(area, rel=0.005)
    assert heights.extent == pytest.approx(np.add(extent, [-0.1, 0.1, -0.1, 0.1]), abs=0.03)
    if (twin := path.with_suffix(".stl")).exists():  # the same, from another corner
        assert area_of(import_terrain(twin)) == pytest.approx(area, rel=0.005)


def test_a_rough_world_for_quadrupeds():
    heights = import_terrain(needed(TERRAINS / "qs_rough_25cm.ply"))
    assert area_of(heights) == pytest.approx(80.0, rel=0.01)
    assert 0.2 < np.nanmax(heights.heights) <= 0.25
    assert np.nanmin(heights.heights) == pytest.approx(0.0, abs=1e-6)


def test_the_grid_map_of_a_bag():
    pytest.importorskip("rosbags", reason="needs the extra maps")
    found = import_terrain(needed(TERRAINS / "grid_map.bag"))
    assert found.resolution == pytest.approx(0.03)
    assert found.extent == pytest.approx((-0.6, 0.6, -1.8, 1.8))
    assert found.shape == (120, 40)
    assert np.isfinite(found.heights).sum() == 906


def test_a_wall_without_thickness_stands_in_the_map():
    heights = import_terrain(needed(CASES / "sheet_wall.stl"))
    scene = load_scene(CASES / "sheet_wall.stl")
    wall = max(scene.obstacles.values(), key=lambda each: each[:, 2].max())
    ends = wall[wall[:, 2] > 1.4][:, :2]
    points = np.linspace(ends.min(axis=0), ends.max(axis=0), 200)[2:-2]
    np.testing.assert_allclose(heights.height_at(points), 1.5)


def test_a_concave_face_keeps_its_hole():
    heights = import_terrain(needed(CASES / "concave.obj"))
    assert area_of(heights) == pytest.approx(10.0, rel=0.005)
    flat = sum(
        polygon_area_vector(v)[2] for v in load_scene(CASES / "concave.obj").surfaces.values()
    )
    assert flat == pytest.approx(10.0)


@pytest.mark.parametrize(
    "name", ["base.stl", "inverted.stl", "ascii_bom.stl", "bom.obj", "contin.obj", "quads.obj"]
)
def test_the_stairs_are_the_same_however_they_are_written(name):
    heights = import_terrain(needed(CASES / name))
    points = np.array([[1, 1], [2.2, 1], [2.5, 1], [2.9, 1], [3.2, 1], [3.6, 1], [5, 1]])
    wanted = [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.5]
    np.testing.assert_allclose(heights.height_at(points), wanted, atol=1e-6)
    scene = load_scene(CASES / name)
    assert sorted({round(float(v[0, 2]), 3) for v in scene.surfaces.values()}) == pytest.approx(
        [0, 0.1, 0.2, 0.3, 0.4, 0.5]
    )
    assert sum(polygon_area_vector(v)[2] for v in scene.surfaces.values()) == pytest.approx(
        11.5, abs=1e-3
    )


def test_a_survey_in_utm_is_refused_or_moved():
    with pytest.raises(InputError, match="say --origin auto"):
        import_terrain(needed(CASES / "utm.obj"))
    heights = import_terrain(CASES / "utm.obj", origin="auto")
    assert heights.height_at(np.array([[1.0, 1.0], [5.0, 1.0]])) == pytest.approx([215.0, 215.5])
    scene = load_scene(CASES / "utm.obj", Reading(origin="448262,5411932,215"))
    assert sorted({round(float(v[0, 2]), 2) for v in scene.surfaces.values()})[0] == 0.0


def test_eight_bits_say_their_step(caplog):
    grey, colour = (
        import_terrain(
            needed(CASES / f"stairs_8bit_{kind}.png"), resolution=0.04, z_min=0.0, z_max=0.6
        )
        for kind in ("grey", "rgb")
    )
    np.testing.assert_array_equal(grey.heights, colour.heights)
    assert len(levels_of(grey)) == 7
    assert np.diff(levels_of(grey)) == pytest.approx(0.6 * 40 / 255, abs=1e-3)
    assert "256 grey levels, 2.4 mm apart" in caplog.text


def test_heights_of_64_bits_and_a_clockwise_floor_are_read():
    heights = import_terrain(needed(CASES / "float64_heights.npz"))
    assert heights.shape == (50, 50)
    assert area_of(import_terrain(needed(CASES / "scene_clockwise.json"))) == pytest.approx(
        8.0, rel=0.03
    )
    assert list(load_scene(CASES / "scene_clockwise.json").walkable) == ["floor"]
