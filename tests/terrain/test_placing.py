"""--origin, --crop, --fill and --smooth; options that do not apply."""

import numpy as np
import pytest
import trimesh

from jaxleas.terrain import (
    HeightMap,
    Scene,
    import_terrain,
    load_scene,
    write_height_map,
    write_scene,
)
from jaxleas.terrain.commands import convert, describe
from jaxleas.terrain.reading import Reading
from jaxleas.types import InputError

FAR = np.array([448_262.0, 5_411_932.0, 214.0])


@pytest.fixture
def plate():
    return trimesh.creation.box(
        extents=(4.0, 2.0, 0.2),
        transform=trimesh.transformations.translation_matrix((2.0, 1.0, -0.1)),
    )


@pytest.fixture
def survey(tmp_path, plate):
    plate.apply_translation(FAR)
    plate.export(tmp_path / "survey.obj", digits=6)
    return tmp_path / "survey.obj"


def test_a_terrain_far_away_is_refused_with_what_would_do(survey):
    with pytest.raises(
        InputError, match=r"5411934 m from the origin.*--origin auto, or --origin 448262,5411932"
    ):
        import_terrain(survey)
    with pytest.raises(InputError, match="--origin auto"):
        load_scene(survey)


@pytest.mark.parametrize(
    ("origin", "height"), [("auto", 214.0), ("448262,5411932", 214.0), ("448262,5411932,214", 0.0)]
)
def test_an_origin_moves_it_to_where_places_are(survey, origin, height):
    heights = import_terrain(survey, origin=origin)
    assert heights.height_at(np.array([[2.0, 1.0]]))[0] == pytest.approx(height)
    assert np.isnan(heights.height_at(np.array([[4.03, 1.0]])))[0]
    scene = load_scene(survey, Reading(origin=origin))
    (top,) = scene.surfaces.values()
    np.testing.assert_allclose(top.min(axis=0), [0.0, 0.0, height], atol=1e-4)


@pytest.mark.parametrize("origin", ["here", "1", "1,2,3,4", "nan,2", "1;2"])
def test_no_origin_is_refused(survey, origin):
    with pytest.raises(InputError, match="becomes x = y = 0 as X,Y or X,Y,Z"):
        import_terrain(survey, origin=origin)


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".glb"])
@pytest.mark.parametrize("origin", [None, "auto"])
def test_coordinates_that_32_bits_cannot_hold_are_refused(tmp_path, plate, suffix, origin):
    vertices = np.asarray(plate.vertices) + FAR
    plate = trimesh.Trimesh(vertices.astype(np.float32).astype(float), plate.faces, process=False)
    plate.export(tmp_path / f"mesh{suffix}")
    with pytest.raises(
        InputError, match=r"32-bit numbers, which lie 0\.5 m apart.*before the mesh is exported"
    ):
        import_terrain(tmp_path / f"mesh{suffix}", origin=origin)


def test_maps_and_scenes_move_too(tmp_path):
    write_height_map(
        tmp_path / "map.npz", HeightMap(np.full((9, 9), 5.0, np.float32), 0.1, (30_000.05, 0.05))
    )
    with pytest.raises(InputError, match="--origin 30000,0"):
        import_terrain(tmp_path / "map.npz")
    moved = import_terrain(tmp_path / "map.npz", origin="30000,0,5")
    assert moved.origin == pytest.approx((0.05, 0.05))
    assert (moved.heights == 0.0).all()
    square = np.add([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [2e4, 0.0, 1.0])
    write_scene(tmp_path / "scene.json", Scene({"a": square}, areas={"b": square[:, :2]}))
    scene = load_scene(tmp_path / "scene.json", Reading(origin="auto"))
    np.testing.assert_allclose(scene.surfaces["a"][0], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(scene.areas["b"][0], [0.0, 0.0])


def test_crop_keeps_a_part_as_a_map_and_as_a_scene(tmp_path, plate):
    plate.export(tmp_path / "plate.stl")
    heights = import_terrain(tmp_path / "plate.stl", crop=(1.0, 2.0, 0.5, 1.5))
    assert heights.extent == pytest.approx((1.0, 2.0, 0.5, 1.5), abs=0.021)
    assert (heights.heights == 0.0).all()
    (top,) = load_scene(
        tmp_path / "plate.stl", Reading(crop=(1.0, 9.0, -9.0, 0.5))
    ).surfaces.values()
    np.testing.assert_allclose(top.min(axis=0), [1.0, 0.0, 0.0], atol=1e-6)
    np.testing.assert_allclose(top.max(axis=0), [4.0, 0.5, 0.0], atol=1e-6)
    for crop, problem in (
        ((8.0, 9.0, 0.0, 1.0), "leaves nothing"),
        ((1.0, 0.0, 0.0, 1.0), "smaller one first"),
    ):
        with pytest.raises(InputError, match=problem):
            import_terrain(tmp_path / "plate.stl", crop=crop)


@pytest.fixture
def holed(tmp_path):
    """A slope with a hole of 3 x 3 cells, one of 2 x 10, and void that reaches the rim."""
    heights = np.tile(0.1 * np.arange(30, dtype=np.float32), (20, 1))
    heights[3:6, 3:6] = np.nan
    heights[10:12, 10:20] = np.nan
    heights[0:2, 25:] = np.nan
    write_height_map(tmp_path / "map.npz", HeightMap(heights, 0.1, (0.0, 0.0)))
    return tmp_path / "map.npz", heights


def test_holes_up_to_a_width_are_filled_from_their_rims(holed, caplog):
    path, before = holed
    after = import_terrain(path, fill=0.3).heights
    np.testing.assert_allclose(after[3:6, 3:6], 0.1 * np.tile([3, 4, 5], (3, 1)), atol=1e-3)
    same = np.ones(before.shape, bool)
    same[3:6, 3:6] = False
    np.testing.assert_array_equal(after[same], before[same])
    assert "1 holes, 0.09 m2 in all, are filled from their rims; 1 wider ones stay" in caplog.text
    assert np.isnan(import_terrain(path, fill=2.0).heights).sum() == 10
    assert "2 holes of up to 0.2 m2" in describe(import_terrain(path))


def test_smoothing_keeps_slopes_and_void(holed, caplog):
    path, before = holed
    after = import_terrain(path, smooth=0.1).heights
    np.testing.assert_array_equal(np.isnan(after), np.isnan(before))
    inside = (slice(16, 17), slice(5, 25))
    np.testing.assert_allclose(after[inside], before[inside], atol=1e-5)
    assert "smoothing changes heights by up to" in caplog.text
    rng = np.random.default_rng(0)
    write_height_map(
        path, HeightMap(rng.normal(0, 0.01, (50, 50)).astype(np.float32), 0.02, (0, 0))
    )
    assert import_terrain(path, smooth=0.04).heights.std() < 0.002


@pytest.mark.parametrize("stated", [{"fill": -1.0}, {"smooth": 0.0}, {"smooth": float("nan")}])
def test_impossible_lengths_are_refused(holed, stated):
    with pytest.raises(InputError, match="must be a length"):
        import_terrain(holed[0], **stated)


@pytest.mark.parametrize(
    ("name", "stated", "problem"),
    [
        ("map.npz", {"up": "y"}, "--up does not apply to .*map.npz, a height map"),
        ("map.npz", {"scale": 2.0, "z_min": 0.0}, "--scale and --z-min do not apply"),
        ("mesh.stl", {"z_max": 1.0}, "--z-max does not apply .* what applies is --resolution"),
        ("scene.json", {"zero_is_void": True}, "--zero-is-void does not apply .* a scene"),
        ("image.png", {"topic": "/map"}, "--topic does not apply .* an image"),
        ("model.xml", {"scale": 2.0}, "--scale does not apply"),
        ("map.bag", {"up": "x"}, "--up does not apply .* a bag"),
    ],
)
def test_options_that_do_not_apply_are_named(tmp_path, name, stated, problem):
    with pytest.raises(InputError, match=problem):
        import_terrain(tmp_path / name, **stated)


def test_what_is_done_with_maps_does_not_apply_to_scenes(tmp_path, plate):
    plate.export(tmp_path / "plate.stl")
    with pytest.raises(InputError, match=r"--resolution and --fill do not apply .* made a scene"):
        convert(
            tmp_path / "plate.stl",
            out=tmp_path / "a.json",
            reading=Reading(resolution=0.1, fill=0.2),
        )
    convert(
        tmp_path / "plate.stl",
        out=tmp_path / "a.json",
        reading=Reading(scale=2.0, crop=(0.0, 4.0, 0.0, 4.0)),
    )
