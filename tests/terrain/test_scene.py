import json

import numpy as np
import pytest

from jaxleas.terrain import Scene, read_scene, write_scene
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
        ({"surfaces": {"a": square()[::-1]}}, "surface 'a' is clockwise"),
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
