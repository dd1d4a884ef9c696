"""Terrains written as files of others: read back by their own libraries, and by this package."""

from pathlib import Path

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.terrain import HeightMap, Scene, import_terrain, load_scene, write_scene
from jaxleas.terrain.commands import convert
from jaxleas.terrain.reading import Reading
from jaxleas.terrain.writers.scene_bodies import HEADROOM, THICKNESS, prisms_of
from jaxleas.types import InputError

trimesh = pytest.importorskip("trimesh", reason="needs the extra maps")


def square(x: float, y: float, z: float, side: float = 1.0, rise: float = 0.0) -> np.ndarray:
    ring = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]) * side
    return np.column_stack([ring + np.array([x, y]), z + rise * ring[:, 0]])


def stairs() -> Scene:
    """Three steps that share edges, a ramp, a box upon them and a wall without thickness."""
    steps = {f"step_{k}": square(k, 0.0, 0.2 * k) for k in range(3)}
    wall = np.array([[0.0, 1.5, 0.0], [1.0, 1.5, 0.0], [1.0, 1.5, 1.0], [0.0, 1.5, 1.0]])
    return Scene(
        {**steps, "ramp": square(3.0, 0.0, 0.4, rise=-0.3)},
        {"box_top": square(0.3, 0.3, 0.7, 0.3), "wall": wall},
    )


def bumpy(holes: bool = True) -> HeightMap:
    rng = np.random.default_rng(3)
    heights = rng.uniform(-0.3, 0.4, (30, 45)).astype(np.float32)
    if holes:
        heights[4:9, 10:20] = np.nan
        heights[20, 30] = np.nan
    return HeightMap(heights, 0.05, (-1.025, 7.025))


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    write_scene(tmp_path / "scene.json", stairs())
    return tmp_path / "scene.json"


@pytest.fixture
def map_file(tmp_path: Path) -> Path:
    from jaxleas.terrain import write_height_map

    write_height_map(tmp_path / "map.npz", bumpy())
    return tmp_path / "map.npz"


def test_an_stl_of_a_scene_is_closed_bodies_with_the_same_ground(tmp_path, scene_file, capsys):
    convert(scene_file, out=tmp_path / "scene.stl")
    assert "6 closed convex bodies" in capsys.readouterr().out
    mesh = trimesh.load(tmp_path / "scene.stl")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    bodies = mesh.split()
    assert len(bodies) == 6
    assert all(each.is_convex and each.volume > 0.0 for each in bodies)
    below = 0.4 - 0.3 - 0.1  # the lowest point of the scene is 0
    assert mesh.bounds[0][2] == pytest.approx(below - THICKNESS, abs=1e-3)
    solid = 0.2 + 0.4 + 0.6 + (0.6 - 0.15) + 0.09 * 0.9 + 0.01
    assert mesh.volume == pytest.approx(solid, rel=2e-3)
    before = import_terrain(scene_file)
    after = import_terrain(tmp_path / "scene.stl")
    points = np.random.default_rng(0).uniform([-0.2, -0.2], [4.2, 1.4], (400, 2))
    middle = points[np.abs(points - np.round(points / 0.1) * 0.1).min(axis=1) > 0.02]
    np.testing.assert_allclose(before.height_at(middle), after.height_at(middle), atol=2e-3)


def test_what_hangs_over_other_ground_leaves_the_room_under_it_free():
    low, high = 0.5 * HEADROOM, 1.5 * HEADROOM
    scene = Scene(
        {
            "floor": square(0.0, 0.0, 0.0, 4.0),
            "stage": square(0.5, 0.5, low),
            "bridge": square(2.0, 2.0, high),
            "beside": square(5.0, 0.0, high),
        }
    )
    depth = {name: np.ptp(np.concatenate([each.top, each.bottom])[:, 2]) for name, each in
             prisms_of(scene).items()}  # fmt: skip
    assert depth["bridge"] == pytest.approx(THICKNESS)
    assert depth["stage"] == pytest.approx(low + THICKNESS)
    assert depth["beside"] == pytest.approx(high + THICKNESS)


def test_a_closed_mesh_is_written_as_it_is_and_an_open_one_is_closed(tmp_path, capsys):
    box = trimesh.creation.box(extents=(2.0, 1.0, 0.3))
    turned = trimesh.Trimesh(box.vertices, box.faces[:, ::-1], process=False)
    turned.export(tmp_path / "inside_out.stl")
    convert(tmp_path / "inside_out.stl", out=tmp_path / "a.stl")
    assert "closed bodies as they are, 12 triangles" in capsys.readouterr().out
    assert trimesh.load(tmp_path / "a.stl").volume == pytest.approx(0.6)
    top = trimesh.Trimesh(box.vertices, box.faces[box.face_normals[:, 2] > 0.5])
    top.export(tmp_path / "sheet.stl")
    convert(tmp_path / "sheet.stl", out=tmp_path / "b.stl")
    mesh = trimesh.load(tmp_path / "b.stl")
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(2.0 * THICKNESS, rel=1e-3)


def test_an_stl_of_a_map_is_closed_and_reads_back_as_the_map(tmp_path, map_file):
    convert(map_file, out=tmp_path / "map.stl")
    mesh = trimesh.load(tmp_path / "map.stl")
    assert mesh.is_watertight
    assert mesh.is_winding_consistent
    assert mesh.volume > 0.0
    again = import_terrain(tmp_path / "map.stl", resolution=0.05)
    rows, columns = bumpy().shape
    x, y = np.meshgrid(np.arange(columns), np.arange(rows))
    middles = np.array([-1.025, 7.025]) + 0.05 * np.stack([x, y], axis=-1).reshape(-1, 2)
    found = again.height_at(middles).reshape(rows, columns)
    np.testing.assert_allclose(found, bumpy().heights, atol=1e-5)


@pytest.mark.parametrize("suffix", [".tif", ".asc", ".bag", ".mcap", ""])
def test_a_map_comes_back_in_its_place(tmp_path, map_file, suffix):
    pytest.importorskip("rosbags", reason="needs the extra maps")
    pytest.importorskip("tifffile", reason="needs the extra maps")
    written = convert(map_file, out=tmp_path / "new" / f"other{suffix}")
    again = import_terrain(written)
    assert again.resolution == pytest.approx(0.05)
    assert again.origin == pytest.approx((-1.025, 7.025))
    np.testing.assert_allclose(again.heights, bumpy().heights, rtol=1e-5)
    assert [each.name for each in (tmp_path / "new").iterdir()] == [f"other{suffix}"]


def test_a_png_comes_back_to_half_a_grey_level_where_it_says(tmp_path, map_file, capsys):
    from PIL import Image

    convert(map_file, out=tmp_path / "map.png")
    words = capsys.readouterr().out.split()
    stated = {name: float(words[words.index(f"--{name}") + 1].rstrip(",")) for name in
              ("resolution", "z-min", "z-max")}  # fmt: skip
    again = import_terrain(tmp_path / "map.png", resolution=stated["resolution"],
                           z_min=stated["z-min"], z_max=stated["z-max"])  # fmt: skip
    half_level = 0.5 * (stated["z-max"] - stated["z-min"]) / 65535
    np.testing.assert_allclose(again.heights, bumpy().heights, atol=1.1 * half_level)
    with Image.open(tmp_path / "map.png") as image:
        assert image.mode.startswith("I")
        assert image.size == (45, 30)


def test_a_geotiff_is_read_by_its_own_library(tmp_path, map_file):
    tifffile = pytest.importorskip("tifffile", reason="needs the extra maps")
    convert(map_file, out=tmp_path / "map.tif")
    with tifffile.TiffFile(tmp_path / "map.tif") as file:
        page = file.pages[0]
        np.testing.assert_array_equal(page.asarray()[::-1], bumpy().heights)
        tags = page.geotiff_tags
    assert tags["ModelPixelScale"] == [0.05, 0.05, 0.0]
    assert tags["ModelTiepoint"][3:5] == pytest.approx([-1.05, 7.0 + 30 * 0.05])
    assert tags["GTModelTypeGeoKey"] == 1


@pytest.mark.parametrize("suffix", [".bag", ".mcap", ""])
def test_a_grid_map_is_read_by_its_own_library(tmp_path, map_file, suffix):
    """Of the message itself: cell (0, 0) is the one with the largest x and y."""
    highlevel = pytest.importorskip("rosbags.highlevel", reason="needs the extra maps")
    path = convert(map_file, out=tmp_path / f"b{suffix}")
    with highlevel.AnyReader([path]) as reader:
        (connection,) = reader.connections
        assert (connection.topic, connection.msgtype) == ("/grid_map", "grid_map_msgs/msg/GridMap")
        _, _, raw = next(reader.messages())
        message = reader.deserialize(raw, connection.msgtype)
    layout = message.data[0].layout.dim
    assert [(each.label, each.size, each.stride) for each in layout] == [
        ("column_index", 30, 1350),
        ("row_index", 45, 45),
    ]
    assert message.layers == ["elevation"]
    assert message.info.length_x == pytest.approx(45 * 0.05)
    assert message.info.pose.position.x == pytest.approx(-1.05 + 0.5 * 45 * 0.05)
    columns = message.data[0].data.reshape(30, 45)  # [along -y, along -x]
    np.testing.assert_array_equal(columns[0, 0], bumpy().heights[-1, -1])
    np.testing.assert_array_equal(columns[0, 7], bumpy().heights[-1, -8])


def touched(model, x: float, y: float) -> float:
    """Return the height at which a ray from above meets a model."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    down, geom = np.array([0.0, 0.0, -1.0]), np.zeros(1, np.int32)
    away = mujoco.mj_ray(model, data, np.array([x, y, 9.0]), down, None, 1, -1, geom)
    return 9.0 - away


def test_an_mjcf_of_a_scene_is_loaded_by_mujoco_with_the_same_ground(tmp_path, scene_file, capsys):
    mujoco = pytest.importorskip("mujoco", reason="needs the extra maps")
    convert(scene_file, out=tmp_path / "scene.xml")
    assert "5 boxes and 1 convex meshes" in capsys.readouterr().out
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "scene.xml"))
    for x, y, z in ((0.1, 0.5, 0.0), (0.45, 0.45, 0.7), (1.5, 0.5, 0.2), (3.5, 0.5, 0.25)):
        assert touched(model, x, y) == pytest.approx(z, abs=1e-6)
    again = import_terrain(tmp_path / "scene.xml")
    assert again.height_at(np.array([[2.5, 0.5]]))[0] == pytest.approx(0.4)


def test_a_format_names_the_file(tmp_path, scene_file, monkeypatch):
    monkeypatch.chdir(tmp_path)
    cli.run(["terrain", "export", str(scene_file), "--format", "mjcf"])
    assert f"{scene_file.stem}.xml" in [each.name for each in tmp_path.iterdir()]
    assert convert(scene_file, out=Path("a.json"), format="scene") == Path("a.json")
    with pytest.raises(InputError, match="say what to write: --out FILE, or --format such as mjcf"):
        convert(scene_file)
    with pytest.raises(InputError, match=r"--out a.stl is no name of the format mjcf: let it end"):
        convert(scene_file, out=Path("a.stl"), format="mjcf")
    with pytest.raises(InputError, match="is the terrain itself"):
        convert(Path("a.json"), format="scene")


def test_an_mjcf_of_a_map_is_a_height_field_with_pits(tmp_path, map_file, capsys):
    mujoco = pytest.importorskip("mujoco", reason="needs the extra maps")
    convert(map_file, out=tmp_path / "map.xml")
    assert "cells without ground are 1 m deep" in capsys.readouterr().out
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "map.xml"))
    found = bumpy()
    for row, column in ((1, 1), (17, 23), (28, 43)):
        x, y = (found.origin[k] + 0.05 * cell for k, cell in enumerate((column, row)))
        assert touched(model, x, y) == pytest.approx(found.heights[row, column], abs=1e-5)
    x, y = found.origin[0] + 0.05 * 15, found.origin[1] + 0.05 * 6
    assert touched(model, x, y) == pytest.approx(np.nanmin(found.heights) - 1.0, abs=1e-5)


def test_a_scene_becomes_a_map_where_a_map_is_asked_for(tmp_path, scene_file, capsys):
    convert(scene_file, out=tmp_path / "cells.stl", reading=Reading(resolution=0.1))
    assert "through the middles of the cells" in capsys.readouterr().out
    convert(scene_file, out=tmp_path / "cropped.json", reading=Reading(crop=(0.0, 1.5, 0.0, 1.0)))
    assert load_scene(tmp_path / "cropped.json").surfaces.keys() == {"step_0", "step_1"}


def test_what_cannot_be_written_is_refused_before_anything_is(tmp_path, scene_file, map_file):
    listed = sorted(each.name for each in tmp_path.iterdir())
    for out, reason in (
        ("a.usd", r"not written as '\.usd' files; the name must end in one of \.npz, \.json"),
        ("a.db3", "a ROS 2 bag is a folder"),
    ):
        with pytest.raises(InputError, match=reason):
            convert(tmp_path / "missing.stl", out=tmp_path / out)
    (tmp_path / "bag").mkdir()
    with pytest.raises(InputError, match="bag exists: a ROS 2 bag is a folder of its own"):
        convert(scene_file, out=tmp_path / "bag")
    with pytest.raises(InputError, match=r"--resolution does not apply to .*scene\.json"):
        convert(scene_file, out=tmp_path / "a.json", reading=Reading(resolution=0.1))
    with pytest.raises(InputError, match="no surface was found in the map"):
        convert(map_file, out=tmp_path / "a.json")
    for name in ("x.bag", "x.mcap", "x", "x.tif", "x.stl", "x.xml"):
        with pytest.raises(InputError, match=r"cannot write .*map\.npz/x"):
            convert(map_file, out=map_file / name)
    assert sorted(each.name for each in tmp_path.iterdir()) == sorted([*listed, "bag"])


def test_a_map_of_single_cells_makes_no_body(tmp_path):
    from jaxleas.terrain import write_height_map

    heights = np.full((5, 5), np.nan, np.float32)
    heights[2, 2] = 1.0
    write_height_map(tmp_path / "lonely.npz", HeightMap(heights, 0.05, (0.0, 0.0)))
    with pytest.raises(InputError, match=r"a\.stl: no three cells of ground"):
        convert(tmp_path / "lonely.npz", out=tmp_path / "a.stl")
