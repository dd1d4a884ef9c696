"""Courses have the dimensions that their sources give."""

import numpy as np
import pytest

from jaxleas.crossing import COURSES, make_course
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
    places += [(goal.x, goal.y) for goal in course.goals]
    heights = ground_height(course.scene, np.array(places))
    np.testing.assert_allclose(heights, 0.0)
    starts = np.array(course.starts(1000, seed=1))
    limits = np.array([0.10, 0.05, np.radians(5.0)])
    assert (np.abs(starts) <= limits).all()
    assert (np.abs(starts).max(axis=0) > 0.95 * limits).all()
    assert rasterise(course.scene, 0.05).void_fraction < 0.6


def test_a_wrong_name_lists_all_courses():
    with pytest.raises(InputError, match="no course 'stares', only stairs_1, stairs_2"):
        make_course("stares")
