"""Maps that are wrong on purpose, waypoints, and what is counted."""

import numpy as np
import pytest

from jaxleas.crossing import Crossing, MapErrors, WalkedFootstep, tally, together
from jaxleas.crossing.waypoints import read_waypoints, waypoints_along
from jaxleas.footsteps import PlannedFootstep
from jaxleas.guide import write_guide_paths
from jaxleas.terrain import HeightMap, Scene, SceneEdges
from jaxleas.types import GuidePath, InputError
from tests.footsteps.made import IDENTITY
from tests.terrain.test_scene_edges import rectangle


def test_a_map_with_errors_is_noisy_and_shifted_by_that_much():
    true = HeightMap(np.zeros((200, 200), np.float32), 0.02, (-2.0, -2.0))
    seen = MapErrors(noise=0.01, shift=0.02, seed=4).of(true)
    assert np.std(seen.heights) == pytest.approx(0.01, rel=0.03)
    moved = np.array(seen.origin) - true.origin
    assert np.hypot(*moved) == pytest.approx(0.02)
    again = MapErrors(noise=0.01, shift=0.02, seed=4).of(true)
    np.testing.assert_array_equal(again.heights, seen.heights)
    other = MapErrors(noise=0.01, shift=0.02, seed=5).of(true)
    assert other.origin != seen.origin
    np.testing.assert_array_equal(MapErrors().of(true).heights, true.heights)


def path(length=2.2):
    count = 45
    x = np.linspace(0.0, length, count)
    position = np.column_stack([x, 0.5 * x, np.full(count, 0.9)])
    yaw = np.full(count, 0.3)
    return GuidePath(np.arange(count) * 0.1, position, yaw, np.zeros((count, 3)), yaw > 0)


def test_waypoints_are_half_a_metre_apart_along_the_path():
    goals = waypoints_along(path())
    places = np.array([(each.x, each.y) for each in goals])
    assert len(goals) == 4  # 2.46 m of way
    gone = np.hypot(*places.T)
    assert (np.diff(gone) < 0.56).all()
    assert gone[0] > 0.4
    assert all(each.yaw == pytest.approx(0.3) for each in goals)


def test_waypoints_need_one_guide_path(tmp_path):
    write_guide_paths(tmp_path / "two.npz", [path(), path()], ["reached", "reached"])
    with pytest.raises(InputError, match=r"two.npz holds 2 guide paths; waypoints are taken from"):
        read_waypoints(tmp_path / "two.npz")
    write_guide_paths(tmp_path / "one.npz", [path()], ["reached"])
    assert len(read_waypoints(tmp_path / "one.npz")) == 4


def footstep(pair, expected, x, planned_x=None):
    feet = np.array([[x, 0.2, 0.0], [0.3, -0.2, 0.0], [-0.3, 0.2, 0.0], [-0.3, -0.2, 0.0]])
    planned = None
    if planned_x is not None:
        moved = feet.copy()
        moved[0, 0] = planned_x
        pose = np.array([0.01, -0.02]), 2.0 * np.pi - 0.03
        planned = PlannedFootstep(expected, np.zeros(3), *pose, moved)
    return WalkedFootstep(1.0, pair, expected, np.zeros(3), feet, np.zeros(3), 0.0, planned)


def test_landings_wrong_pairs_and_errors_are_counted():
    edges = SceneEdges.of(Scene({"floor": rectangle(-1.0, 1.0, -1.0, 1.0)}))
    steps = (
        footstep(0, 0, 0.99, planned_x=0.95),
        footstep(1, 0, 0.5, planned_x=0.5),
        footstep(None, 0, 0.98),
    )
    crossing = Crossing("reached", 3.0, "", np.zeros(3), 0.0, steps, (0.002, 0.004), None)
    counts = tally(crossing, edges, IDENTITY)
    np.testing.assert_array_equal(counts.landings, [2, 1, 1, 2])
    np.testing.assert_array_equal(counts.unsafe, [1, 0, 0, 0])
    assert counts.nearest[0] == pytest.approx(0.01, abs=1e-3)
    assert (counts.wrong_pairs, counts.unclear, counts.footsteps) == (1, 1, 3)
    np.testing.assert_allclose(counts.errors, [0.04, 0.0], atol=1e-9)
    np.testing.assert_allclose(counts.landing_errors, [[0.04, 0.0], [0.0, 0.0]], atol=1e-9)
    np.testing.assert_allclose(counts.pose_errors, [[0.01, 0.02, 0.03]], atol=1e-9)
    words = counts.in_words()
    assert "LF 1 of 2" in words
    assert "wrong pair expected: 33.3 %" in words
    assert "1.00 cm in x, 2.00 cm in y, heading 30.0 mrad; landings 2.00 cm in x, 0.00 cm" in words
    both = together([counts, counts])
    assert both.footsteps == 6
    assert len(both.errors) == 4
    np.testing.assert_array_equal(both.landings, 2 * counts.landings)
    np.testing.assert_array_equal(both.unsafe_share, counts.unsafe_share)
