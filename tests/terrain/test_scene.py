import json

import numpy as np
import pytest

from jaxleas.terrain import Scene, rasterise, read_scene, write_scene
from jaxleas.terrain.polygons import (
    PLANARITY_TOLERANCE,
    planarity_deviation,
    polygon_area_vector,
)
from jaxleas.types import InputError


def square(height: float = 0.0, size: float = 1.0) -> list[list[float]]:
    corners = ((0.0, 0.0), (size, 0.0), (size, size), (0.0, size))
    return [[x, y, height] for x, y in corners]


@pytest.mark.parametrize("seed", range(5))
def test_a_scene_survives_its_file(tmp_path, seed, random_scene):
    scene = random_scene(seed)
    area = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]])
    scene = Scene(scene.surfaces, scene.obstacles, {"start": area})
    write_scene(tmp_path / "scene.json", scene)
    read = read_scene(tmp_path / "scene.json")
    for group in ("surfaces", "obstacles", "areas"):
        written, found = getattr(scene, group), getattr(read, group)
        assert list(written) == list(found)
        for name in written:
            np.testing.assert_allclose(found[name], written[name], atol=1e-6)


def test_only_surfaces_are_needed(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"surfaces": {"a": square()}, "author": "someone"}))
    assert read_scene(path).obstacles == {}


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ([], "needs an object with the key 'surfaces'"),
        ({"obstacles": {}}, "'surfaces'"),
        ({"surfaces": {}}, "no surfaces"),
        ({"surfaces": []}, "must be an object"),
        ({"surfaces": {"a": square()}, "obstacle": {}}, "did you mean 'obstacles'"),
        ({"surfaces": {"a": square()}, "version": 99}, "version 99"),
        ({"surfaces": {"a": 3}}, "surfaces 'a' must be a list"),
        ({"surfaces": {"a": [[0, 0], [1, 0], [1, 1]]}}, "3 numbers each"),
        ({"surfaces": {"a": [[0, 0, 0], [1, 0, 0], [1, 1]]}}, "3 numbers each"),
        ({"surfaces": {"a": [[0, 0, "0"], [1, 0, 0], [1, 1, 0]]}}, "3 numbers each"),
        ({"surfaces": {"a": [[0, 0, True], [1, 0, 0], [1, 1, 0]]}}, "3 numbers each"),
        ({"surfaces": {"a": [[0, 0, None], [1, 0, 0], [1, 1, 0]]}}, "3 numbers each"),
        ({"surfaces": {"a": square(1e9)}}, "beyond 1000 km"),
        ({"surfaces": {"a": []}}, "surface 'a' has 0 vertices"),
        ({"surfaces": {"a": square()}, "obstacles": {"b": square()[:2]}}, "obstacle 'b' has 2"),
        ({"surfaces": {"a": square()}, "areas": {"c": [[0, 0], [1, 1], [2, 2]]}}, "area 'c'"),
    ],
)
def test_refusals_name_the_file_and_the_polygon(tmp_path, content, problem):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=problem) as caught:
        read_scene(path)
    assert str(path) in str(caught.value)


def test_nan_is_refused(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text('{"surfaces": {"a": [[NaN, 0, 0], [1, 0, 0], [1, 1, 0]]}}')
    with pytest.raises(InputError, match="NaN"):
        read_scene(path)


def slope(degrees: float, size: float = 1.0) -> list[list[float]]:
    """A square that climbs along x; beyond 90 degrees it hangs over."""
    run, rise = size * np.cos(np.radians(degrees)), size * np.sin(np.radians(degrees))
    return [[0.0, 0.0, 0.0], [run, 0.0, rise], [run, size, rise], [0.0, size, 0.0]]


def ceiling(height: float = 2.0) -> list[list[float]]:
    """A square that looks down on the floor."""
    return [[x, y, height] for x, y, _ in square()[::-1]]


@pytest.mark.parametrize(
    ("degrees", "who"),
    [(0, "both"), (30, "both"), (59, "both"), (61, "palms"), (90, "palms"), (135, "palms")],
)  # fmt: skip
def test_who_touches_follows_from_the_slope(tmp_path, degrees, who):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"surfaces": {"floor": square(), "it": slope(degrees)}}))
    scene = read_scene(path)
    assert scene.who_touches("it") == who
    assert list(scene.walkable) == (["floor", "it"] if who == "both" else ["floor"])
    assert list(scene.pressable) == ["floor", "it"]


def test_a_ceiling_is_for_palms_and_a_clockwise_floor_is_turned(tmp_path, caplog):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"surfaces": {"floor": square(), "over": ceiling()}}))
    scene = read_scene(path)
    assert list(scene.walkable) == ["floor"]
    assert list(scene.pressable) == ["floor", "over"]
    assert not caplog.records
    beside = [[x + 5.0, y, z] for x, y, z in square()[::-1]]
    path.write_text(json.dumps({"surfaces": {"floor": square(), "beside": beside}}))
    assert list(read_scene(path).walkable) == ["floor", "beside"]
    assert "surface 'beside' is clockwise seen from above: turned" in caplog.text
    path.write_text(json.dumps({"surfaces": {"only": square()[::-1]}}))
    np.testing.assert_array_equal(read_scene(path).surfaces["only"], square())
    saying = {"surfaces": {"floor": square(), "beside": beside}, "touch": {"beside": "palms"}}
    path.write_text(json.dumps(saying))
    assert list(read_scene(path).walkable) == ["floor"]


def test_closed_rings_and_clockwise_obstacles_are_mended(tmp_path):
    path = tmp_path / "scene.json"
    ring = [*square(), square()[0]]
    content = {"surfaces": {"a": ring}, "obstacles": {"b": square(0.5)[::-1]},
               "areas": {"c": [each[:2] for each in square()[::-1]]}}  # fmt: skip
    path.write_text(json.dumps(content))
    scene = read_scene(path)
    np.testing.assert_array_equal(scene.surfaces["a"], square())
    assert polygon_area_vector(scene.obstacles["b"])[2] == pytest.approx(1.0)
    assert len(scene.areas["c"]) == 4


@pytest.mark.parametrize(("off", "mended"), [(0.0005, True), (0.008, True), (0.04, False)])
def test_a_vertex_a_few_millimetres_off_its_plane_is_moved_into_it(tmp_path, caplog, off, mended):
    corners = square()
    corners[2][2] += off
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"surfaces": {"a": corners}}))
    if not mended:
        with pytest.raises(InputError, match="is not planar"):
            read_scene(path)
        return
    vertices = read_scene(path).surfaces["a"]
    assert planarity_deviation(vertices) < PLANARITY_TOLERANCE
    assert np.abs(vertices - corners).max() <= off
    assert ("off its plane" in caplog.text) == (off > 0.001)


def test_a_scene_says_who_may_touch_what(tmp_path):
    surfaces = {"floor": square(), "rail": square(0.9, 0.1), "ramp": slope(65), "wall": slope(90)}
    touch = {"floor": "feet", "rail": "palms", "ramp": "feet"}
    path, again = tmp_path / "scene.json", tmp_path / "again.json"
    path.write_text(json.dumps({"surfaces": surfaces, "touch": touch}))
    write_scene(again, read_scene(path))
    for each in (path, again):
        scene = read_scene(each)
        assert list(scene.walkable) == ["floor", "ramp"]
        assert list(scene.pressable) == ["rail", "wall"]
        assert dict(scene.touch) == touch


def test_scenes_from_before_say_nothing_of_touch(tmp_path):
    write_scene(tmp_path / "scene.json", Scene({"a": np.array(square())}))
    assert "touch" not in json.loads((tmp_path / "scene.json").read_text())


def test_height_maps_are_made_of_what_is_walkable():
    floor, ceiling = np.array(square(size=2.0)), np.array(square(2.0, 2.0))[::-1]
    table, box = np.array(square(0.8)), np.array(square(0.5)) + np.array([1.0, 1.0, 0.0])
    scene = Scene(
        {"floor": floor, "ceiling": ceiling, "wall": np.array(slope(90)), "table": table},
        {"box_top": box},
        touch={"table": "palms"},
    )
    heights = rasterise(scene).heights
    assert set(np.unique(heights[np.isfinite(heights)])) == {0.0, 0.5, 1.0}  # the wall's edge


@pytest.mark.parametrize(
    ("content", "problem"),
    [
        ({"touch": []}, "'touch' must be an object"),
        ({"touch": {"flor": "feet"}}, "'touch' names 'flor', which is no surface; perhaps you"),
        ({"touch": {"floor": "hands"}}, "'floor' is 'hands'; it must be one of feet, palms, both"),
        ({"touch": {"floor": ["feet"]}}, "it must be one of feet, palms, both"),
        ({"touch": {"wall": "both"}}, "'wall', which is vertical or looks down: feet cannot"),
        ({"touch": {"ceiling": "feet"}}, "'ceiling', which is vertical or looks down"),
        ({"touch": {"floor": "palms"}}, "no surface that feet may touch: touch says 'palms'"),
        ({"surfaces": {"wall": slope(90)}}, "surface 'wall' is vertical; list it as an obstacle"),
        ({"surfaces": {"steep": slope(70)}}, "'steep' is steeper than 60 degrees; say 'feet'"),
        ({"surfaces": {"wall": [*slope(90), [0.3, 0.5, 0.2]]}}, "surface 'wall' is not"),
    ],
)
def test_a_scene_that_contradicts_itself_is_refused(tmp_path, content, problem):
    surfaces = {"floor": square(), "wall": slope(90), "ceiling": ceiling()}
    path = tmp_path / "scene.json"
    path.write_text(json.dumps({"surfaces": surfaces, **content}))
    with pytest.raises(InputError, match=problem):
        read_scene(path)


def test_a_scene_that_could_not_be_read_again_is_not_written(tmp_path, monkeypatch):
    monkeypatch.setattr("jaxleas.terrain.scene_file.MAX_JSON_BYTES", 2**20)
    many = {f"s{k}": np.array([[k, 0, 0], [k + 1, 0, 0], [k, 1, 0.0]]) for k in range(9000)}
    with pytest.raises(InputError, match=r"9000 polygons in \d+ MiB, more than the 1 MiB"):
        write_scene(tmp_path / "scene.json", Scene(many))
    assert not list(tmp_path.iterdir())
