from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image

from jaxleas.terrain import (
    HeightMap,
    Scene,
    import_mesh,
    import_png,
    import_terrain,
    rasterise,
    write_height_map,
    write_scene,
)
from jaxleas.terrain.meshes.triangles import AXES
from jaxleas.types import InputError

MESHES = Path(__file__).resolve().parents[3] / "shared" / "data" / "meshes"


def box(size, centre):
    return trimesh.creation.box(
        extents=size, transform=trimesh.transformations.translation_matrix(centre)
    )


@pytest.fixture
def terrace():
    """Two closed boxes: a floor of 2 x 2 m at 0 m, and 1 x 2 m of it at 0.3 m."""
    return trimesh.util.concatenate(
        [box((2.0, 2.0, 0.1), (0.0, 0.0, -0.05)), box((1.0, 2.0, 0.4), (0.5, 0.0, 0.1))]
    )


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".STL"])
def test_tops_of_closed_bodies_are_the_ground(tmp_path, terrace, suffix):
    path = tmp_path / f"terrace{suffix}"
    terrace.export(path, file_type=suffix[1:].lower())
    height_map = import_terrain(path)
    points = np.array([[-0.5, 0.0], [0.5, 0.5], [0.97, -0.97], [1.05, 0.0]])
    np.testing.assert_allclose(height_map.height_at(points), [0.0, 0.3, 0.3, np.nan], atol=1e-6)


def test_text_stl_is_read(tmp_path, terrace):
    terrace.export(tmp_path / "text.stl", file_type="stl_ascii")
    terrace.export(tmp_path / "binary.stl")
    text, binary = import_mesh(tmp_path / "text.stl"), import_mesh(tmp_path / "binary.stl")
    np.testing.assert_allclose(text.heights, binary.heights, atol=1e-6)


@pytest.mark.parametrize("up", ["x", "y", "z"])
def test_up_is_a_rotation_and_never_a_mirror(tmp_path, terrace, up):
    terrace.export(tmp_path / "z.stl")
    axes = np.eye(3)[list(AXES[up])]
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert axes[2].tolist() == [float(up == axis) for axis in "xyz"]
    terrace.vertices = terrace.vertices @ axes
    terrace.export(tmp_path / "turned.stl")
    upright, turned = import_mesh(tmp_path / "z.stl"), import_mesh(tmp_path / "turned.stl", up=up)
    np.testing.assert_allclose(turned.heights, upright.heights, atol=1e-6)


def test_scale_is_metres_a_unit(tmp_path, terrace):
    terrace.export(tmp_path / "metres.stl")
    terrace.apply_scale(1000.0)
    terrace.export(tmp_path / "millimetres.stl")
    metres = import_mesh(tmp_path / "metres.stl")
    scaled = import_mesh(tmp_path / "millimetres.stl", scale=0.001)
    np.testing.assert_allclose(scaled.heights, metres.heights, atol=1e-5)
    with pytest.raises(InputError, match="are its units metres"):
        import_mesh(tmp_path / "millimetres.stl")


def stl(path, triangles):
    triangles = np.asarray(triangles, dtype=float)
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    trimesh.Trimesh(triangles.reshape(-1, 3), faces, process=False).export(path)
    return path


FLAT = [[[0, 0, 0], [2, 0, 0], [0, 2, 0]]]


@pytest.mark.parametrize(
    ("triangles", "problem"),
    [
        (np.array(FLAT) * [0.1, 0.1, 1.0], "0.2 x 0.2 m; a terrain is"),
        (np.array(FLAT) * [600.0, 1.0, 1.0], "1200 x 2 m; a terrain is"),
        (np.array(FLAT) * [1.0, 0.0, 0.0], "zero area"),
        ([[[0, 0, 0], [2, 0, 0], [0, 0, 2]]], "only vertical faces"),
        (np.where(np.array(FLAT) == 2, np.inf, 0.0), "not a finite number"),
        (np.where(np.array(FLAT) == 2, np.nan, 0.0), "not a finite number"),
        ([[[0, 0, 2e4], [2, 0, 2e4], [0, 2, 2e4]]], "are these metres"),
    ],
)
def test_a_mesh_that_is_no_terrain_is_refused(tmp_path, triangles, problem):
    path = stl(tmp_path / "mesh.stl", triangles)
    with pytest.raises(InputError, match=problem) as caught:
        import_mesh(path)
    assert str(path) in str(caught.value)


def test_broken_mesh_files_are_refused(tmp_path, terrace):
    path = tmp_path / "mesh.stl"
    terrace.export(path)
    whole = path.read_bytes()
    for broken in (b"", b"solid nothing\nendsolid\n", whole[:100], whole[:-30], b"\x00" * 90):
        path.write_bytes(broken)
        with pytest.raises(InputError, match=r"mesh\.stl"):
            import_mesh(path)
    (tmp_path / "points.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\n")
    with pytest.raises(InputError, match=r"points\.obj"):
        import_mesh(tmp_path / "points.obj")
    with pytest.raises(InputError, match="does not exist"):
        import_mesh(tmp_path / "none.stl")
    with pytest.raises(InputError, match="folder"):
        import_terrain(tmp_path.rename(tmp_path.with_suffix(".stl")))


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"resolution": 0.001}, "resolution"),
        ({"resolution": 0.0}, "resolution"),
        ({"resolution": float("nan")}, "resolution"),
        ({"up": "w"}, "up is 'w'"),
        ({"scale": 0.0}, "scale"),
        ({"scale": float("nan")}, "scale"),
    ],
)
def test_bad_mesh_options_are_refused(tmp_path, options, problem):
    with pytest.raises(InputError, match=problem):
        import_terrain(stl(tmp_path / "mesh.stl", FLAT), **options)


def test_a_mesh_of_too_many_cells_is_refused(tmp_path):
    path = stl(tmp_path / "mesh.stl", np.array(FLAT) * 400.0)
    with pytest.raises(InputError, match="coarser resolution"):
        import_mesh(path, 0.01)


@pytest.fixture
def grey(tmp_path):
    values = np.random.default_rng(0).integers(0, 65536, size=(20, 30)).astype(np.uint16)
    values[0, 0] = 0
    path = tmp_path / "grey.png"
    Image.fromarray(values).save(path)
    return path, values


def test_a_grey_image_is_a_map_with_north_up(grey):
    path, values = grey
    height_map = import_png(path, 0.1, -1.0, 2.0)
    expected = -1.0 + 3.0 * values[::-1] / 65535.0
    np.testing.assert_allclose(height_map.heights, expected, atol=1e-6)
    assert height_map.extent == pytest.approx((0.0, 3.0, 0.0, 2.0))
    marked = import_png(path, 0.1, -1.0, 2.0, zero_is_void=True)
    assert np.isnan(marked.heights[-1, 0])
    np.testing.assert_array_equal(np.isnan(marked.heights), values[::-1] == 0)


def test_broken_images_are_refused(grey, tmp_path):
    path, _ = grey
    whole = path.read_bytes()
    for broken in (b"", b"not an image", whole[:60], whole[: len(whole) // 2]):
        path.write_bytes(broken)
        with pytest.raises(InputError, match="not a readable PNG"):
            import_png(path, 0.04, 0.0, 1.0)
    with pytest.raises(InputError, match="does not exist"):
        import_png(tmp_path / "none.png", 0.04, 0.0, 1.0)


@pytest.mark.parametrize("span", [(1.0, 1.0), (2.0, 1.0), (0.0, float("nan"))])
def test_black_must_be_below_white(grey, span):
    with pytest.raises(InputError, match="must be below"):
        import_png(grey[0], 0.04, *span)


def test_an_image_needs_its_scales(grey):
    with pytest.raises(InputError, match="resolution, z_min and z_max"):
        import_terrain(grey[0], resolution=0.04)


def test_maps_and_scenes_come_through_the_same_door(tmp_path):
    square = np.array([[0.0, 0, 0.5], [1, 0, 0.5], [1, 1, 0.5], [0, 1, 0.5]])
    write_scene(tmp_path / "scene.json", Scene({"a": square}))
    from_scene = import_terrain(tmp_path / "scene.json", resolution=0.05)
    np.testing.assert_array_equal(from_scene.heights, rasterise(Scene({"a": square}), 0.05).heights)
    write_height_map(tmp_path / "map.npz", from_scene)
    assert isinstance(import_terrain(tmp_path / "map.npz"), HeightMap)
    with pytest.raises(InputError, match=r"0\.05 m cells"):
        import_terrain(tmp_path / "map.npz", resolution=0.04)


def test_unknown_kinds_of_file_are_answered_with_the_known(tmp_path):
    with pytest.raises(InputError, match=r"'\.foo'; known are \.json, \.stl, \.obj, \.ply, "):
        import_terrain(tmp_path / "cloud.foo")


@pytest.mark.parametrize(
    ("name", "highest", "void"),
    [
        ("bauzil_stairs.stl", 1.25, 0.1),  # the rail beside the stairs, 15 mm thick
        ("darpa.stl", 0.3, 0.2),
        ("flat_hole.stl", 0.08, 0.35),
        ("ground_with_bridge.stl", 0.04, 0.12),
        ("random_scene_10x10_V3.stl", 1.9, 0.15),
        ("rubbles_stairs_1.stl", 0.7, 0.35),
    ],
)
def test_real_meshes_import(name, highest, void):
    if not (MESHES / name).is_file():
        pytest.skip(f"needs {name} of hpp-environments in ../shared/data/meshes")
    height_map = import_mesh(MESHES / name)
    assert np.nanmax(height_map.heights) == pytest.approx(highest, abs=0.02)
    assert 0.02 < height_map.void_fraction < void
