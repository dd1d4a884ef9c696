from dataclasses import replace

import numpy as np
import pytest

from jaxleas.evaluation.starts import crossing_direction, draw_starts, make_grounds
from jaxleas.evaluation.suites import SUITES, Cell, make_suite
from jaxleas.terrain.polygons import box_faces
from jaxleas.types import InputError
from tests.envs.compiled import condition, local_heights
from tests.evaluation.conftest import flat_scene


@pytest.mark.parametrize("name", SUITES)
def test_starts_are_valid_at_walking_height_and_speed_in_their_area(env, name):
    suite = make_suite(name, 24)
    grounds = make_grounds(suite.cells)
    for cell in suite.cells:
        starts = draw_starts(env, grounds, cell, suite.seed)
        motion = starts.motion
        heights = local_heights(env, grounds.atlas, starts.map_index, motion)
        assert np.all(np.asarray(condition(env, heights, motion)) >= 0.0)
        position = np.asarray(motion.position, dtype=np.float64)
        map_index = np.asarray(starts.map_index)
        speed = np.linalg.norm(np.asarray(motion.velocity), axis=-1)
        assert speed == pytest.approx(np.full(cell.starts, cell.speed), abs=1e-6)
        for index in range(cell.starts):
            each = len(cell.scenarios[0].start_areas)
            scenario = cell.scenarios[index // each % len(cell.scenarios)]
            x_min, x_max, y_min, y_max = scenario.start_areas[starts.area[index]]
            x, y, z = position[index]
            assert x_min - 1e-6 <= x <= x_max + 1e-6
            assert y_min - 1e-6 <= y <= y_max + 1e-6
            ground = grounds.maps[map_index[index]].height_at(np.array([[x, y]]))[0]
            assert z == pytest.approx(ground + env.robot.walking_height, abs=1e-5)


def test_every_heading_is_exactly_the_cells(env):
    suite = make_suite("transitions", 24)
    grounds = make_grounds(suite.cells)
    for cell in suite.cells:
        yaw = np.asarray(draw_starts(env, grounds, cell, 0).motion.yaw)
        wanted = crossing_direction(cell.scenarios[0]) + np.deg2rad(cell.yaw)
        assert np.cos(yaw) == pytest.approx(np.full(24, np.cos(wanted)), abs=1e-6)
        assert np.sin(yaw) == pytest.approx(np.full(24, np.sin(wanted)), abs=1e-6)


def test_headings_towards_the_goal_are_spread_to_both_sides_and_speeds_go_along_them(env):
    suite = make_suite("thesis", 60)
    cell = next(each for each in suite.cells if each.key == ("rotation", 90.0, 30.0, 0.07))
    starts = draw_starts(env, make_grounds([cell]), cell, 0)
    yaw = np.asarray(starts.motion.yaw, dtype=np.float64)
    way = np.asarray(starts.waypoints)[:, 0] - np.asarray(starts.motion.position, np.float64)
    aside = np.angle(np.exp(1j * (yaw - np.arctan2(way[:, 1], way[:, 0]))), deg=True)
    assert np.abs(aside).min() >= 60.0 - 1e-3
    assert np.abs(aside).max() <= 120.0 + 1e-3
    assert np.ptp(np.abs(aside)) > 45.0
    assert 15 < (aside > 0.0).sum() < 45
    assert np.asarray(starts.motion.velocity) == pytest.approx(
        0.07 * np.stack([np.cos(yaw), np.sin(yaw), 0.0 * yaw], axis=-1), abs=1e-6
    )


def test_near_and_far_in_equal_parts_over_all_scenes(env):
    suite = make_suite("transitions", 80)
    cell = suite.cells[0]
    starts = draw_starts(env, make_grounds(suite.cells), cell, 0)
    assert np.bincount(starts.area).tolist() == [40, 40]
    assert np.bincount(starts.map_index).tolist() == [20] * 4


def test_the_goal_of_a_scene_is_fixed_in_its_goal_area(env):
    suite = make_suite("transitions", 40)
    cell = suite.cells[2]
    starts = draw_starts(env, make_grounds(suite.cells), cell, 0)
    goals = np.asarray(starts.waypoints)[:, -1]
    for scene in set(np.asarray(starts.map_index).tolist()):
        of_scene = goals[np.asarray(starts.map_index) == scene]
        assert np.all(of_scene == of_scene[0])
        x_min, x_max, y_min, y_max = cell.scenarios[0].goal_area
        assert x_min <= of_scene[0, 0] <= x_max
        assert y_min <= of_scene[0, 1] <= y_max


def test_draws_are_the_cells_own(env):
    suite = make_suite("hole", 24)
    grounds, cell = make_grounds(suite.cells), suite.cells[0]
    one, again = (draw_starts(env, grounds, cell, 0).motion.position for _ in range(2))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, draw_starts(env, grounds, cell, 1).motion.position)


def test_an_area_without_a_valid_start_is_refused(env):
    scene = replace(flat_scene(), start_areas=((20.0, 21.0, 0.0, 1.0),))  # in the void
    cell = Cell("nowhere", 0.0, (scene,), 3)
    with pytest.raises(InputError, match=r"no valid start in the area .*'nowhere'"):
        draw_starts(env, make_grounds([cell]), cell, 0)


def test_starts_that_would_be_invalid_at_once_are_drawn_again(env):
    """A wall stands in the start area: beside it the trunk would touch it."""
    flat = flat_scene()
    corners = np.array([[1.4, -0.7], [1.5, -0.7], [1.5, 0.7], [1.4, 0.7]])
    wall = replace(flat.scene, obstacles=box_faces(corners, 0.0, 1.5))
    cell = Cell("wall", 0.0, (replace(flat, scene=wall),), 100)
    grounds = make_grounds([cell])
    starts = draw_starts(env, grounds, cell, 0)
    heights = local_heights(env, grounds.atlas, starts.map_index, starts.motion)
    assert np.all(np.asarray(condition(env, heights, starts.motion)) >= 0.0)
