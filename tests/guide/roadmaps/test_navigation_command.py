import sys
from pathlib import Path

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.guide import read_guide_paths
from jaxleas.robots import load_robot
from jaxleas.terrain import HeightMap, write_height_map, write_scene
from jaxleas.terrain.scene import Scene
from jaxleas.training.policy import write_policy
from jaxleas.types import InputError, JaxleasError
from tests.guide.roadmaps.worlds import trench_map
from tests.guide.walkers import random_policy

BOX = 0.5  # height [m]: the trunk's underside is 0.95 - 0.628 above level ground


@pytest.fixture
def terrain(tmp_path):
    write_height_map(tmp_path / "trench.npz", trench_map())
    return tmp_path / "trench.npz"


def navigate(terrain, out, *more, start="-1.5,-1.5", goal="1.5,-1.5"):
    ends = ["--from", start, "--to", goal, "--terrain", str(terrain)]
    cli.run(["navigate", *ends, "--steering", "kino", "--out", str(out), *more])


@pytest.mark.parametrize("planner", ["rrt", "prm"])
def test_it_writes_the_path_its_waypoints_and_a_picture(terrain, tmp_path, capsys, planner):
    pytest.importorskip("ompl")
    out, picture = tmp_path / "guide.npz", tmp_path / "guide.png"
    navigate(terrain, out, "--planner", planner, "--picture", str(picture))
    said = capsys.readouterr().out
    assert "reached" in said
    assert "waypoint" in said
    assert said.count("\n") == 1
    kept = read_guide_paths(out)
    assert kept.reasons == ("reached",)
    assert np.linalg.norm(kept.paths[0].position[-1, :2] - [1.5, -1.5]) < 0.02
    with np.load(out) as arrays:
        np.testing.assert_allclose(arrays["waypoints"][-1], [1.5, -1.5])
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_a_policy_walks_and_the_exact_conditions_have_the_last_word(tmp_path, capsys):
    square = np.array([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], float)
    write_scene(tmp_path / "floor.json", Scene({"floor": square}))
    write_policy(tmp_path / "policy.npz", random_policy(seed=4))
    files = ["--terrain", tmp_path / "floor.json", "--policy", tmp_path / "policy.npz"]
    ends = ["--from=-1,0,0.2", "--to", "1,0", "--planner", "none"]
    cli.run(["navigate", *ends, *map(str, files), "--out", str(tmp_path / "guide.npz")])
    said = capsys.readouterr().out
    (path,) = read_guide_paths(tmp_path / "guide.npz").paths
    assert "the exact conditions" in said
    np.testing.assert_allclose(path.position[0], [-1, 0, 0.95], atol=1e-6)
    assert path.yaw[0] == pytest.approx(0.2)


def test_an_unreachable_goal_is_told(tmp_path, capsys):
    pytest.importorskip("ompl")
    write_height_map(tmp_path / "map.npz", trench_map(end=9.0))
    navigate(tmp_path / "map.npz", tmp_path / "guide.npz", "--connections", "20")
    said = capsys.readouterr().out
    assert "the goal was not reached within the limit" in said
    assert "the best partial path ends" in said
    assert read_guide_paths(tmp_path / "guide.npz").reasons == ("stopped",)
    navigate(tmp_path / "map.npz", tmp_path / "guide.npz", "--planner", "none")
    assert "the goal was not reached by walking to it" in capsys.readouterr().out


def box_map() -> HeightMap:
    """Level ground with a box of 1.1 x 1.1 m in the middle, too high for the trunk."""
    cells = np.arange(-3.0, 3.01, 0.1)
    heights = np.zeros((len(cells), len(cells)), np.float32)
    heights[np.ix_(np.abs(cells) < 0.55, np.abs(cells) < 0.55)] = BOX
    return HeightMap(heights, 0.1, (-3.0, -3.0))


def test_an_invalid_start_says_which_condition_by_how_much_and_what_would_do(tmp_path):
    write_height_map(tmp_path / "box.npz", box_map())
    with pytest.raises(InputError) as caught:
        navigate(tmp_path / "box.npz", tmp_path / "out.npz", start="-0.65,0,0", goal="2,0")
    # The trunk reaches over the box: 0.5 m high, 0.322 m fit under it.
    assert "--from -0.65,0: at yaw 0 collision C fails by 0.18 m" in str(caught.value)
    assert "the nearest valid pose is" in str(caught.value)
    assert not (tmp_path / "out.npz").exists()
    pose = str(caught.value).split("the nearest valid pose is ")[1].split(", ")[0]
    navigate(
        tmp_path / "box.npz", tmp_path / "out.npz", "--planner", "none", start=pose, goal="-2,0"
    )
    assert (tmp_path / "out.npz").exists()


@pytest.mark.parametrize(
    ("start", "goal", "complaint"),
    [
        ("0,-1", "1,1", r"--from 0,-1: there is no ground; the nearest valid pose is .*0\.\d\d m"),
        ("-1,-1", "0,-2", r"--to 0,-2: there is no ground"),
        ("-1,-1", "9,0", r"--to 9,0: off the map, which spans x -3\.05 to 3\.05"),
        ("-1", "1,1", "--from '-1' is not x,y or x,y,yaw"),
        ("1,a", "1,1", "--from '1,a' is not"),
        ("-1,-1", "1,1,0", "--to '1,1,0' is not x,y"),
        ("1,nan", "1,1", "finite"),
        ("1e300,0", "1,1", "--from '1e300,0' is more than 1000 km away"),
        ("-1,-1,90", "1,1", "--from '-1,-1,90': the yaw is in radians"),
    ],
)
def test_ends_that_cannot_be_used_are_refused(terrain, tmp_path, start, goal, complaint):
    with pytest.raises(InputError, match=complaint):
        navigate(terrain, tmp_path / "out.npz", start=start, goal=goal)
    assert not (tmp_path / "out.npz").exists()


def test_what_is_missing_is_told(terrain, tmp_path, monkeypatch):
    with pytest.raises(InputError, match="--steering leas needs --policy"):
        navigate(terrain, tmp_path / "out.npz", "--steering", "leas", "--planner", "none")
    with pytest.raises(InputError, match="seconds"):
        navigate(terrain, tmp_path / "out.npz", "--limit", "0")
    with pytest.raises(InputError, match="--seed -1 must not be negative"):
        navigate(terrain, tmp_path / "out.npz", "--seed", "-1")
    monkeypatch.setitem(sys.modules, "ompl", None)
    with pytest.raises(JaxleasError, match="extra 'roadmaps'"):
        navigate(terrain, tmp_path / "out.npz")


def test_a_start_inside_what_no_height_map_shows_is_refused(tmp_path):
    """An upright sheet has no height of its own; the polygons know it."""
    floor = np.array([[-3, -2, 0], [3, -2, 0], [3, 2, 0], [-3, 2, 0]], float)
    sheet = np.array([[0, -1, 0.5], [0, 1, 0.5], [0, 1, 1.5], [0, -1, 1.5]], float)
    write_scene(tmp_path / "sheet.json", Scene({"floor": floor}, {"sheet": sheet}))
    ends = {"start": "0.05,0,0", "goal": "-2,0"}
    with pytest.raises(InputError) as caught:
        navigate(tmp_path / "sheet.json", tmp_path / "out.npz", "--planner", "none", **ends)
    said = str(caught.value)
    assert "--from 0.05,0 at yaw 0.00: on the terrain's polygons collision C fails" in said
    assert not (tmp_path / "out.npz").exists()
    there = said.split("the nearest valid pose is ")[1]
    navigate(
        *(tmp_path / "sheet.json", tmp_path / "out.npz", "--planner", "none"),
        **ends | {"start": there},
    )
    (path,) = read_guide_paths(tmp_path / "out.npz").paths
    assert path.valid[0]


def test_another_robot_walks_at_its_own_height(terrain, tmp_path):
    out = tmp_path / "guide.npz"
    navigate(terrain, out, "--planner", "none", "--robot", "g1", goal="-1.5,1.5")
    (path,) = read_guide_paths(out).paths
    np.testing.assert_allclose(path.position[0, 2], load_robot("g1").walking_height, atol=1e-5)
    policy = Path(__file__).parents[3] / "pretrained" / "leas_p1.npz"
    with pytest.raises(InputError, match=r"leas_p1\.npz is for talos; leave --robot out"):
        navigate(terrain, out, "--robot", "g1", "--policy", str(policy))
    with pytest.raises(InputError, match="there is no robot 'g2'"):
        navigate(terrain, out, "--robot", "g2")
