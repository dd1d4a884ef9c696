"""Who takes over from whom, and with which numbers: laws, without training anybody."""

import math

import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.sweeps.config import Dimension
from jaxleas.sweeps.evolution import EvolutionConfig, draw_values, evolve, perturbed
from jaxleas.sweeps.history import History, read_history
from jaxleas.sweeps.takeover import taken_over
from jaxleas.training import TrainState
from jaxleas.training.failures import Failures

SPACE = {
    "ppo.learning_rate": Dimension(low=1e-4, high=1e-2, log=True),
    "ppo.discount": Dimension(low=0.9, high=0.99),
    "ppo.clip": Dimension(choices=(0.1, 0.2, 0.3)),
}


def stream(*seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


def everybody(count: int) -> list[dict]:
    return [draw_values(SPACE, stream(0, member)) for member in range(count)]


def test_the_worst_take_over_from_the_best_and_the_others_stay():
    scores = [0.5, 0.9, 0.1, 0.7, 0.3, 0.8, float("nan"), 0.6]
    values = everybody(8)
    round_ = evolve(EvolutionConfig(share=0.25), SPACE, scores, values, stream(1))
    assert [each.member for each in round_] == list(range(8))
    for each in round_:
        if each.member in (2, 6):
            assert each.parent in (1, 5)
            assert each.values != values[each.member]
        else:
            assert each.parent == each.member
            assert each.values == values[each.member]


def test_nobody_is_both_best_and_worst():
    round_ = evolve(EvolutionConfig(share=0.5), SPACE, [0.1, 0.2, 0.3], everybody(3), stream(1))
    assert [each.parent for each in round_] == [2, 1, 2]


def test_the_same_stream_gives_the_same_round():
    config, scores, values = EvolutionConfig(share=0.5), [0.1, 0.2, 0.3, 0.4], everybody(4)
    one, same, other = (evolve(config, SPACE, scores, values, stream(seed)) for seed in (5, 5, 6))
    assert one == same
    assert one != other


@pytest.mark.parametrize("name", SPACE)
def test_perturbed_values_stay_in_the_space_one_step_away(name):
    dimension, draws = SPACE[name], stream(2)
    for member in range(50):
        value = draw_values(SPACE, stream(3, member))[name]
        near = perturbed(dimension, value, 0.2, draws)
        if dimension.choices is not None:
            assert abs(dimension.choices.index(near) - dimension.choices.index(value)) <= 1
            continue
        low, high = dimension.ends
        assert low <= near <= high
        scale = math.log if dimension.log else float
        step = abs(scale(near) - scale(value)) / (scale(high) - scale(low))
        assert step == pytest.approx(0.2) or near in (low, high)


def test_draws_cover_a_logarithmic_range_evenly_by_decade():
    draws = stream(4)
    rates = [draw_values(SPACE, draws)["ppo.learning_rate"] for _ in range(2000)]
    assert np.mean(np.array(rates) < 1e-3) == pytest.approx(0.5, abs=0.04)


def test_a_step_keeps_values_on_its_grid():
    dimension = Dimension(low=0.0, high=1.0, step=0.3)
    draws = stream(5)
    seen = {round(perturbed(dimension, 0.6, 0.4, draws), 6) for _ in range(20)}
    assert seen <= {0.0, 0.3, 0.6, 0.9}


def test_history_forgets_a_future_that_was_abandoned(tmp_path):
    path = tmp_path / "history.jsonl"
    round_ = evolve(EvolutionConfig(share=0.5), SPACE, [0.1, 0.2], everybody(2), stream(1))
    history = History(path, 0)
    for step in (10, 20, 30):
        history.append(step, [0.1, float("nan")], round_)
    assert [row.step for row in read_history(path)] == [10, 20, 30]
    assert read_history(path)[0].scores == [0.1, None]
    History(path, 20)
    assert [row.step for row in read_history(path)] == [10, 20]


def test_robots_stay_with_their_groups_and_failures_unless_their_policy_failed():
    members = jnp.arange(3.0)
    per_robot = members[:, None] * jnp.ones((3, 4))
    states = TrainState(
        params=members,
        averaged=members,
        optimiser=members,
        normaliser=members,
        episode=per_robot,
        observation=per_robot,
        key=members,
        update=members,
        failures=Failures(group=per_robot, ended=members[:, None], failed=members[:, None]),
    )
    after = taken_over(states, np.array([1, 1, 1]), np.array([True, False, False]))
    for learned in (after.params, after.averaged, after.optimiser, after.normaliser):
        assert learned.tolist() == [1.0, 1.0, 1.0]
    for robots in (after.episode, after.observation, after.failures.group):
        assert robots[:, 0].tolist() == [1.0, 1.0, 2.0]
    assert after.failures.ended[:, 0].tolist() == [1.0, 1.0, 2.0]
    assert after.key.tolist() == [0.0, 1.0, 2.0]
    ignored = taken_over(states.replace(failures=None), np.array([1, 1, 1]), np.zeros(3, bool))
    assert ignored.failures is None
