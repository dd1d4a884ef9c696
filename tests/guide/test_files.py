import json

import numpy as np
import pytest

from jaxleas.files import write_npz
from jaxleas.guide import (
    read_guide_paths,
    read_queries,
    require_on_terrain,
    write_guide_paths,
)
from jaxleas.terrain import HeightMap
from jaxleas.types import GuidePath, InputError, Query
from tests.guide.walkers import flat_map

GOOD = {"position": [0, 0.5, 0.95], "yaw": 1, "velocity": [0, 0, 0], "goal": [2.0, 0]}


def changed(**entries):
    return {key: value for key, value in {**GOOD, **entries}.items() if value is not None}


def random_path(rng, length):
    return GuidePath(
        time=np.arange(length) * 0.2,
        position=rng.normal(size=(length, 3)).astype(np.float32),
        yaw=rng.normal(size=length).astype(np.float32),
        velocity=rng.normal(size=(length, 3)).astype(np.float32),
        valid=rng.uniform(size=length) < 0.5,
    )


def test_queries_are_read(tmp_path):
    file = tmp_path / "queries.json"
    file.write_text(json.dumps([GOOD, changed(yaw=-2.5)]))
    first, second = read_queries(file)
    assert first == Query((0.0, 0.5, 0.95), 1.0, (0.0, 0.0, 0.0), (2.0, 0.0))
    assert second.yaw == -2.5


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{}", "a list"),
        ("[]", "empty list"),
        ("[1]", "query 0 is no object"),
        (json.dumps([GOOD, changed(goal=None)]), "query 1 lacks goal"),
        (json.dumps([changed(gaol=[1, 2])]), "unknown key 'gaol'"),
        (json.dumps([changed(position=[0, 1])]), "position must be a list of 3"),
        (json.dumps([changed(goal=[0, 1, 2])]), "goal must be a list of 2"),
        (json.dumps([changed(velocity="fast")]), "velocity must be a list of 3"),
        (json.dumps([changed(yaw=[1])]), "yaw must be a number"),
        (json.dumps([changed(yaw=True)]), "yaw must be a number"),
        (json.dumps([changed(yaw="1")]), "yaw must be a number"),
        (json.dumps([changed(position=[0, None, 1])]), "position must be"),
        (json.dumps([changed(position=[1e300, 0, 1])]), "not within"),
        (json.dumps([changed(velocity=[1e9, 0, 0])]), "not within"),
        (
            '[{"position": [0, 0, 1e999], "yaw": 0, "velocity": [0,0,0], "goal": [0,0]}]',
            "usable number",
        ),
        ('[{"position": [0, 0, NaN], "yaw": 0, "velocity": [0,0,0], "goal": [0,0]}]', "NaN"),
        ("[", "not valid JSON"),
    ],
)
def test_unusable_queries_are_refused(tmp_path, content, says):
    file = tmp_path / "queries.json"
    file.write_text(content)
    with pytest.raises(InputError, match=says) as refusal:
        read_queries(file)
    assert str(file) in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_missing_queries_are_refused(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        read_queries(tmp_path / "none.json")


@pytest.mark.parametrize(
    ("position", "says"),
    [
        ((4.2, 0, 0.95), "off the map"),
        ((0, -9, 0.95), "off the map"),
        ((0, 0, -0.1), "under the ground"),
        ((0, 0, 0.0), "under the ground"),
        ((0, 0, 2.1), "above the ground"),
    ],
)
def test_starts_away_from_the_ground_are_refused(position, says):
    good, bad = (Query(each, 0.0, (0, 0, 0), (1, 0)) for each in ((0, 0, 0.95), position))
    with pytest.raises(InputError, match=f"query 1 starts .*{says}"):
        require_on_terrain("q.json", [good, bad], flat_map())


def test_starts_over_a_hole_and_goals_anywhere_are_no_mistake():
    terrain = flat_map()
    heights = terrain.heights.copy()
    heights[:, :20] = np.nan
    terrain = HeightMap(heights, terrain.resolution, terrain.origin)
    queries = [
        Query((-2.5, 0, 0.95), 0.0, (0, 0, 0), (1, 0)),
        Query((3.9, 3.9, 1.9), 0.0, (0, 0, 0), (100, 0)),
    ]
    require_on_terrain("q.json", queries, terrain)


@pytest.mark.parametrize(("missing", "refused"), [(1.05, True), (0.9, False)])
def test_starts_with_all_cells_missing_around_them_are_refused(missing, refused):
    terrain = flat_map()
    heights = terrain.heights.copy()
    x, y = (
        terrain.origin[axis] + terrain.resolution * np.arange(heights.shape[1]) for axis in (0, 1)
    )
    heights[np.ix_(np.abs(y - 1.0) < missing, np.abs(x) < missing)] = np.nan
    terrain = HeightMap(heights, terrain.resolution, terrain.origin)
    query = Query((0.0, 1.0, 0.95), 0.0, (0, 0, 0), (1, 0))
    if refused:
        with pytest.raises(InputError, match=r"query 0 starts .* all cells of the map within 1 m"):
            require_on_terrain("q.json", [query], terrain)
    else:
        require_on_terrain("q.json", [query], terrain)


def test_guide_paths_survive_a_file(tmp_path):
    rng = np.random.default_rng(0)
    written = [random_path(rng, length) for length in (1, 5, 3)]
    reasons = ["invalid", "reached", "stopped"]
    file = tmp_path / "paths.npz"
    write_guide_paths(file, written, reasons)
    read = read_guide_paths(file)
    assert list(read.reasons) == reasons
    for left, right in zip(written, read.paths, strict=True):
        for name in ("time", "position", "yaw", "velocity", "valid"):
            np.testing.assert_array_equal(getattr(left, name), getattr(right, name))
    with np.load(file, allow_pickle=False) as arrays:
        assert arrays["query"].tolist() == [0, 1, 1, 1, 1, 1, 2, 2, 2]
        assert arrays["reached"].tolist() == [False, True, False]


def plain(length=4):
    path = random_path(np.random.default_rng(1), length)
    return {name: getattr(path, name) for name in ("time", "position", "yaw", "velocity", "valid")}


def test_a_file_of_the_five_arrays_is_one_path(tmp_path):
    file = tmp_path / "path.npz"
    write_npz(file, **plain())
    read = read_guide_paths(file)
    assert len(read.paths) == 1
    assert len(read.paths[0]) == 4
    assert read.reasons == ()


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"position": np.zeros((4, 2))}, "position"),
        ({"yaw": np.zeros(3)}, "yaw"),
        ({"valid": np.zeros(4)}, "valid"),
        ({"velocity": np.full((4, 3), np.nan)}, "velocity holds"),
        ({"query": np.array([0, 0, 2, 2])}, "query must count"),
        ({"query": np.array([0, 1, 0, 1])}, "query must count"),
        ({"reason": np.array(["tired"])}, "reason must say"),
        ({"reason": np.array(["reached", "reached"])}, "reason must say"),
    ],
)
def test_unusable_guide_paths_are_refused(tmp_path, change, says):
    file = tmp_path / "path.npz"
    write_npz(file, **{**plain(), **change})
    with pytest.raises(InputError, match=says):
        read_guide_paths(file)


def test_a_file_without_positions_is_refused(tmp_path):
    file = tmp_path / "path.npz"
    arrays = plain()
    del arrays["position"]
    write_npz(file, **arrays)
    with pytest.raises(InputError, match="lacks the array position"):
        read_guide_paths(file)
