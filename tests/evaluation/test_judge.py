from dataclasses import replace

import numpy as np
import pytest

from jaxleas.evaluation.judge import CellRollOut, judge, path_lengths
from jaxleas.evaluation.starts import Starts
from jaxleas.guide import rb_lin
from tests.evaluation.conftest import Fly, StandStill


def test_who_stands_still_never_arrives_and_never_falls(env, flat_suite):
    for result in judge(env, {"still": StandStill()}, flat_suite):
        assert (result.reached, result.invalid, result.stopped) == (0.0, 0.0, 1.0)
        assert result.mean_time is None
        assert result.low == 0.0


def test_standing_still_is_what_a_dead_end_asks_for(env, flat_suite):
    cells = tuple(replace(cell, expectation="stop") for cell in flat_suite.cells)
    for result in judge(env, {"still": StandStill()}, replace(flat_suite, cells=cells)):
        assert result.success == 1.0
        assert result.high == 1.0
        assert result.low > 0.5


def test_an_oracle_reaches_every_goal_in_one_step(env, flat_suite):
    for result in judge(env, {"fly": Fly()}, flat_suite):
        assert result.reached == 1.0
        assert result.mean_time == pytest.approx(env.config.limits.time_step)
        assert result.detour == pytest.approx(1.0, abs=1e-5)
        assert {name: area.starts for name, area in result.areas.items()} == {"near": 4, "far": 4}


def test_rb_lin_crosses_flat_ground_always_and_straight(env, flat_suite):
    method = rb_lin(env.config.limits, env.config.desired_speed)
    toward, away = judge(env, {"rb_lin": method}, flat_suite)
    assert toward.reached == away.reached == 1.0
    assert toward.detour == pytest.approx(1.0, abs=1e-3)
    assert toward.mean_time > toward.mean_length / env.config.desired_speed - 0.2
    assert away.mean_time > toward.mean_time + 5.0  # pi at pi / 9 a second, less a small bearing


def test_methods_walk_from_the_same_starts_in_the_suites_order(env, flat_suite):
    said = []
    results = judge(env, {"a": Fly(), "b": Fly()}, flat_suite, said.append)
    assert [(each.yaw, each.method) for each in results] == [
        (0.0, "a"),
        (0.0, "b"),
        (180.0, "a"),
        (180.0, "b"),
    ]
    assert results[0].mean_length == results[1].mean_length
    assert len(said) == 4


def test_a_method_is_traced_once_for_all_cells(env, flat_suite):
    calls = []

    def still(heights_in_root, motion, goal):
        calls.append(1)
        return motion

    judge(env, {"still": still}, replace(flat_suite, cells=flat_suite.cells[:1]))
    once = len(calls)
    judge(env, {"still": still}, flat_suite)
    assert len(calls) == once > 0


def test_path_lengths_by_hand():
    position = np.zeros((2, 4, 3), dtype=np.float32)
    position[0, :, 0] = [0.0, 3.0, 3.0, 3.0]
    position[0, :, 1] = [0.0, 0.0, 4.0, 4.0]
    position[1, :, 2] = [0.0, 1.0, 2.0, 9.0]  # what follows the end does not count
    end = np.array([2, 2])
    nowhere = np.zeros(2)
    starts = Starts(None, None, np.zeros((2, 1, 3)), area=nowhere, scene=nowhere)  # type: ignore[arg-type]
    flags = np.ones(2, dtype=bool)
    roll_outs = CellRollOut(
        starts, position, position[..., 0], position, position[..., 0] == 0, end, flags, ~flags
    )
    length, straight = path_lengths(roll_outs)
    assert length == pytest.approx([7.0, 2.0])
    assert straight == pytest.approx([5.0, 2.0])
    assert roll_outs.path(1).shape == (3, 3)
    guide = roll_outs.guide_path(0, 0.5)
    assert guide.time.tolist() == [0.0, 0.5, 1.0]
    assert guide.length == pytest.approx(7.0)
