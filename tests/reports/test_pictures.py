import numpy as np
import pytest

from jaxleas.evaluation.judge import CellRollOut
from jaxleas.reports.height_profile import reach_below_root
from jaxleas.reports.top_view import arrow_indices, choose_examples


def a_walk(start, reached, invalid) -> CellRollOut:
    position = np.zeros((len(start), 2, 3))
    position[:, 0, :2] = start
    flags = np.array(reached, dtype=bool), np.array(invalid, dtype=bool)
    end = np.ones(len(start), dtype=int)
    return CellRollOut(
        None, position, position[..., 0], position, position[..., 0] == 0, end, *flags
    )  # type: ignore[arg-type]


def test_examples_show_a_failure_of_each_kind_and_then_spread():
    start = [(0, 0), (0.1, 0), (0.2, 0), (5, 5), (5, 0)]
    roll_outs = a_walk(start, [1, 0, 0, 1, 1], [0, 1, 0, 0, 0])
    chosen = choose_examples(roll_outs, 4, among=5)
    assert chosen[:2] == [1, 2]
    assert set(chosen[2:]) == {3, 4}


def test_examples_are_distinct_and_of_the_first_so_many():
    start = np.random.default_rng(0).uniform(size=(30, 2))
    roll_outs = a_walk(start, [1] * 30, [0] * 30)
    chosen = choose_examples(roll_outs, 6, among=10)
    assert len(set(chosen)) == 6
    assert max(chosen) < 10
    assert sorted(choose_examples(roll_outs, 99, among=10)) == list(range(10))


def test_arrows_are_even_by_distance_and_none_is_lost_turning_on_the_spot():
    straight = np.zeros((151, 3))
    straight[:, 0] = 0.02 * np.arange(151)  # 3 m
    at = arrow_indices(straight, np.zeros(151))
    assert np.diff(straight[at, 0]) == pytest.approx(0.3, abs=0.021)
    assert len(arrow_indices(np.zeros((50, 3)), np.linspace(0.0, np.pi, 50))) == 4
    assert arrow_indices(np.zeros((1, 3)), np.zeros(1)).tolist() == [0]


def test_a_dithering_path_gets_a_bounded_number_of_arrows():
    back_and_forth = np.zeros((801, 3))
    back_and_forth[::2, 0] = 0.2
    assert len(arrow_indices(back_and_forth, np.zeros(801))) <= 26


def test_the_reach_of_the_legs_below_the_root(env):
    low, high = reach_below_root(env.robot)
    assert -1.15 < low < -1.0
    assert -0.75 < high < -0.6
    assert low < -env.robot.walking_height < high
