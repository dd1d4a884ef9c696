"""Courses have the dimensions that their sources give."""

import numpy as np
import pytest

from jaxleas import cli
from jaxleas.crossing import COURSES, make_course
from jaxleas.crossing.waypoints import read_waypoints
from jaxleas.terrain import ground_height, rasterise
from jaxleas.types import InputError


def profile(course, step=0.001):
    x = np.arange(-0.5, course.goals[-1].x, step)
    return x, ground_height(course.scene, np.column_stack([x, np.zeros(len(x))]))


@pytest.mark.parametrize(
    ("name", "riser", "tread"),
    [("stairs_1", 0.042, 1 / 3), ("stairs_2", 0.042, 0.25), ("stairs_3", 0.05, 0.2)],
)
def test_stairs_have_twelve_steps_up_and_down(name, riser, tread):
    x, heights = profile(make_course(name))
    rises = np.diff(heights)
    up, down = x[:-1][rises > 0.001], x[:-1][rises < -0.001]
    assert len(up) == len(down) == 12
    np.testing.assert_allclose(np.abs(rises[np.abs(rises) > 0.001]), riser)
    np.testing.assert_allclose(np.diff(up), tread, atol=0.0021)
    np.testing.assert_allclose(np.diff(down), tread, atol=0.0021)
    assert up[0] == pytest.approx(1.0, abs=0.002)


@pytest.mark.parametrize(("name", "width"), [("gaps_12cm", 0.12), ("gaps_16cm", 0.16)])
def test_five_gaps_between_blocks_18_cm_high(name, width):
    x, heights = profile(make_course(name))
    low = heights < -0.01
    begins, ends = x[1:][np.diff(low.astype(int)) > 0], x[1:][np.diff(low.astype(int)) < 0]
    np.testing.assert_allclose(ends - begins, [width] * 5, atol=0.0021)
    assert set(np.round(heights, 6)) == {0.0, -0.18}
    blocks = begins[1:] - ends[:-1]
    assert (blocks > 0.599).all()
    assert (blocks < 1.001).all()


@pytest.mark.parametrize("name", COURSES)
def test_a_course_has_ground_at_its_starts_and_goals(name):
    course = make_course(name)
    assert make_course(name).goals == course.goals
    places = [(x, y) for x, y, _ in course.starts(50, seed=3)]
    places.append((course.goal.x, course.goal.y))
    heights = ground_height(course.scene, np.array(places))
    np.testing.assert_allclose(heights, 0.0)
    starts = np.array(course.starts(1000, seed=1))
    limits = np.array([0.10, 0.05, np.radians(5.0)])
    assert (np.abs(starts) <= limits).all()
    assert (np.abs(starts).max(axis=0) > 0.95 * limits).all()
    assert rasterise(course.scene, 0.05).void_fraction < 0.6


def test_the_way_with_corners_leads_sideways_over_a_gap_and_a_plank():
    course = make_course("waypoints")
    path, goals = course.path, course.goals
    steps = np.diff(path.position[:, :2], axis=0)
    assert np.hypot(*steps.T).max() < 0.051
    assert (path.yaw == 0.0).all()
    sideways = np.abs(steps[:, 1]) > 1e-6
    assert path.position[:-1, :2][sideways][:, 0] == pytest.approx(3.2, abs=0.05)
    assert (goals[-1].x, goals[-1].y) == tuple(path.position[-1, :2])
    assert all(each.speed == np.inf for each in goals[:-1])
    places = np.array([(0.0, 0.0), *((each.x, each.y) for each in goals)])
    assert np.hypot(*np.diff(places, axis=0).T).max() <= 0.51
    y = np.arange(0.0, 3.2, 0.001)
    heights = ground_height(course.scene, np.column_stack([np.full(len(y), 3.2), y]))
    assert set(np.round(heights, 6)) == {0.0, -0.18, 0.042}
    assert (heights < -0.01).sum() == pytest.approx(60, abs=2)  # a gap of 6 cm


def test_a_course_without_corners_has_its_goal_alone():
    course = make_course("stairs_1")
    assert course.goals == (course.goal,)
    assert course.path.position[-1, 0] == course.goal.x


def test_course_writes_the_way_that_walk_follows(tmp_path, capsys):
    scene, path = tmp_path / "course.json", tmp_path / "way.npz"
    cli.run(["gait", "course", "waypoints", "--out", str(scene), "--path", str(path)])
    assert "walk from 0,0,0 to 5.76,3.2,0 by 3.2,0 and 3.2,3.2" in capsys.readouterr().out
    course = make_course("waypoints")
    read = [(each.x, each.y, each.yaw) for each in read_waypoints(path)]
    made = [(each.x, each.y, each.yaw) for each in course.goals[:-1]]
    np.testing.assert_allclose(read, made, atol=1e-6)
    with pytest.raises(InputError, match=r"way.json: the name of a guide path must end in .npz"):
        cli.run(["gait", "course", "stones", "--out", str(scene), "--path", "way.json"])


def test_a_wrong_name_lists_all_courses():
    with pytest.raises(InputError, match="no course 'stares', only stairs_1, stairs_2"):
        make_course("stares")
