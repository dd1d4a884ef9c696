"""PPO meets worlds whose answers are known."""

import jax
import numpy as np
import pytest

from jaxleas.envs.heads.normal import NormalDistribution
from jaxleas.envs.steering import Steering, SteeringConfig
from jaxleas.training.first_states import initial_state
from jaxleas.training.loss import Experience
from jaxleas.training.minibatches import mirror_images, take_robots
from jaxleas.training.networks import make_networks
from jaxleas.training.normaliser import normalise
from jaxleas.training.ppo import make_train_step

from ..envs.worlds import flat, height_map, world_of
from .runs import SteeringRun
from .waiting import HIGHEST, LOWEST, SAME, Waiting, WaitingRun

pytestmark = pytest.mark.usefixtures("brax_ranks")

SMALL = {
    "environments": 64,
    "unroll": 10,
    "minibatches": 2,
    "epochs": 4,
    "candidates": 64,
    "steps": 64 * 10 * 60,
    "learning_rate": 3e-3,
    "final_learning_rate": 1e-4,
}


def learn(config, task, world):
    """Train, and return the final state, its metrics, and the networks."""
    networks = make_networks(config.network, task.signature)
    state = jax.jit(lambda world: initial_state(config, task, world, networks))(world)
    train_step, history, traces = make_train_step(config, task, networks), [], 0

    def counted(world, state):
        nonlocal traces
        traces += 1
        return train_step(world, state)

    step = jax.jit(counted, donate_argnums=1)
    for _ in range(config.ppo.updates):
        state, metrics = step(world, state)
        history.append({name: float(value) for name, value in metrics.items()})
    assert traces == 1  # one program serves all updates
    assert all(value for row in history for name, value in row.items() if "finite/" in name)
    return state, history, networks


def wait(env, network=None, **ppo):
    """Train robots that wait."""
    network = {"hidden": [32, 32]} | (network or {})
    config = WaitingRun.model_validate({"network": network, "env": env, "ppo": SMALL | ppo})
    task = Waiting(config.env, config.terrain)
    return learn(config, task, task.make_world((0,), False))


def test_the_reward_is_weighed_by_the_progress_of_the_training():
    """Update by update: four of them see 0, 1/4, 2/4 and 3/4 of it done."""
    _, history, _ = wait({"pay": -1.0, "final_pay": -5.0}, steps=64 * 10 * 4)
    np.testing.assert_allclose([row["walk/reward"] for row in history], [-1, -2, -3, -4], atol=1e-5)


def mean_value(state, networks) -> float:
    seen = jax.jit(normalise)(state.observation, state.normaliser)
    return float(np.mean(np.asarray(jax.jit(networks.values)(state.params.value, seen))))


def test_the_value_of_staying_alive_is_the_geometric_sum():
    """Reward 1 a step for ever: V = scale / (1 - discount)."""
    state, _, networks = wait({}, discount=0.8, reward_scale=0.5)
    assert mean_value(state, networks) == pytest.approx(0.5 / (1 - 0.8), rel=0.03)


def test_nothing_follows_a_termination():
    """Every step ends an episode, so V is the reward of that one step."""
    env = {"pay": -0.7, "final_pay": -0.7, "ends": True}
    state, history, networks = wait(env, discount=0.9, reward_scale=1.0)
    assert history[-1]["walk/failures_per_1000_steps"] == 1000.0
    assert mean_value(state, networks) == pytest.approx(-0.7, abs=0.03)


@pytest.mark.slow
def test_it_learns_to_walk_to_goals_on_flat_ground():
    small = {"environments": 256, "unroll": 20, "minibatches": 4, "candidates": 256}
    config = SteeringRun.model_validate(
        {
            "network": {"hidden": [32, 32]},
            "env": {"reward": {"final_failure": 0.0}},  # failing costs nothing but the end
            "ppo": SMALL | small | {"steps": 256 * 20 * 30},
        }
    )
    world = world_of(height_map(flat), height_map(flat, half_size=4.0))
    _, history, _ = learn(config, Steering(config.env), world)
    reward = [row["walk/reward"] for row in history]
    assert np.mean(reward[-3:]) > np.mean(reward[:3]) + 0.25


def test_running_statistics_learn_the_observation():
    state, _, _ = wait({}, {"normaliser": "running"}, steps=640 * 3)
    level, same = np.asarray(state.normaliser.mean)
    middle, spread = (LOWEST + HIGHEST) / 2, (HIGHEST - LOWEST) / 12**0.5
    assert level == pytest.approx(middle, abs=3 * spread / 64**0.5)
    assert same == pytest.approx(SAME, abs=1e-3)
    deviations = np.asarray(state.normaliser.std)
    assert deviations[0] == pytest.approx(spread, rel=0.3)
    assert deviations[1] == pytest.approx(1e-2)  # constant inputs keep a floor


def test_mirroring_flips_whole_robots_and_twice_is_none():
    signature = SteeringConfig().signature()
    generator, shape = np.random.default_rng(0), (5, 32)
    nothing = np.zeros(shape, np.float32)

    def normal(*shape):
        return np.float32(generator.normal(size=shape))

    batch = Experience(
        observation=normal(*shape, signature.size),
        raw_action=normal(*shape, 4),
        distributions=(NormalDistribution(normal(*shape, 4), np.ones((*shape, 4), np.float32)),),
        reward=nothing,
        terminated=nothing,
        truncated=nothing,
    )
    last = normal(1, 32, signature.size)
    flip = generator.random(32) < 0.5
    assert 0 < flip.sum() < 32
    everybody = np.arange(32)
    mirror = jax.jit(lambda batch, last: mirror_images(signature, batch, last[0]))
    take = jax.jit(take_robots)
    images = mirror(batch, last)
    once = take(*images, everybody, flip)
    twice = take(*mirror(*once), everybody, flip)
    jax.tree.map(np.testing.assert_array_equal, twice, (batch, last))
    some = np.array([7, 3, 30])
    few = take(*images, some, flip[some])
    once = jax.tree.map(np.asarray, once)
    jax.tree.map(
        lambda of_few, of_all: np.testing.assert_array_equal(of_few, of_all[:, some]), few, once
    )
    for before, after in ((batch.observation, once[0].observation), (last, once[1])):
        np.testing.assert_array_equal(np.any(after != before, axis=(0, 2)), flip)
        heights = before[:, :, 4:].reshape(-1, 32, 10, 14)[..., ::-1]
        expected = heights.reshape(-1, 32, 140)[:, flip]
        np.testing.assert_array_equal(after[:, flip, 4:], expected)
    sideways, original = once[0].raw_action[..., 1], batch.raw_action[..., 1]
    np.testing.assert_array_equal(sideways, np.where(flip[None], -original, original))
