"""PPO meets worlds whose answers are known."""

import jax
import jax.numpy as jnp
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

pytestmark = pytest.mark.usefixtures("brax_ranks")

FREE = {"reward": {"final_failure": 0.0}}  # failing costs nothing but the end
ALIVE_ONLY = {"direction": 0.0, "orientation": 0.0, "turn": 0.0, "acceleration": 0.0, "alive": 1.0}
ALIVE_ONLY |= FREE["reward"]
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


def always(heights, motion):
    return jnp.ones_like(motion.yaw)


def run(condition=None, env=None, **ppo):
    """Train on flat ground and return the final state, its metrics, and the networks."""
    config = SteeringRun.model_validate(
        {"network": {"hidden": [32, 32]}, "env": env or FREE, "ppo": SMALL | ppo}
    )
    steering = Steering(config.env, condition=condition)
    networks = make_networks(config.network, steering.signature)
    world = world_of(height_map(flat), height_map(flat, half_size=4.0))
    state = initial_state(config, steering, world, networks)
    step = jax.jit(make_train_step(config, steering, networks), donate_argnums=1)
    history = []
    for _ in range(config.ppo.updates):
        state, metrics = step(world, state)
        history.append({name: float(value) for name, value in metrics.items()})
    return state, history, networks


@pytest.mark.slow
def test_the_cost_of_failing_grows_from_the_environments_to_the_final_one():
    """Nobody survives a step: the mean reward is the cost of failing, update by update."""

    def fails_once_moved(heights, motion):
        return 1.0 - 2.0 * (jnp.abs(motion.velocity[..., 2]) > 0.0)

    env = {"reward": ALIVE_ONLY | {"failure": 1.0, "final_failure": 5.0}}
    _, history, _ = run(fails_once_moved, env, steps=64 * 10 * 4)
    cost = [-row["walk/reward"] for row in history]
    np.testing.assert_allclose(cost, [1.0, 2.0, 3.0, 4.0], atol=0.05)


def mean_value(state, networks) -> float:
    seen = normalise(state.observation, state.normaliser)
    return float(jnp.mean(networks.values(state.params.value, seen)))


def test_the_value_of_staying_alive_is_the_geometric_sum():
    """Reward 1 a step for ever: V = scale / (1 - discount)."""
    state, _, networks = run(always, {"reward": ALIVE_ONLY}, discount=0.8, reward_scale=0.5)
    assert mean_value(state, networks) == pytest.approx(0.5 / (1 - 0.8), rel=0.03)


@pytest.mark.slow
def test_nothing_follows_a_termination():
    """Every first step fails, so V is the reward of that one step: what the failure costs."""

    def fails_once_moved(heights, motion):
        # Starts have no vertical velocity; after one step of a noisy policy everybody has.
        return 1.0 - 2.0 * (jnp.abs(motion.velocity[..., 2]) > 0.0)

    env = {"reward": ALIVE_ONLY | {"failure": 0.7, "final_failure": 0.7}}
    state, history, networks = run(fails_once_moved, env, discount=0.9, reward_scale=1.0)
    assert history[-1]["walk/failures_per_1000_steps"] > 990.0
    assert mean_value(state, networks) == pytest.approx(-0.7, abs=0.03)


def test_it_learns_to_walk_to_goals_on_flat_ground():
    _, history, _ = run(
        environments=256, steps=256 * 20 * 30, unroll=20, minibatches=4, candidates=256
    )
    reward = [row["walk/reward"] for row in history]
    assert np.mean(reward[-3:]) > np.mean(reward[:3]) + 0.25


@pytest.mark.slow
def test_running_statistics_learn_the_observation():
    config = SteeringRun.model_validate(
        {"network": {"hidden": [8], "normaliser": "running"}, "ppo": SMALL | {"steps": 640 * 3}}
    )
    steering = Steering(config.env)
    networks = make_networks(config.network, steering.signature)
    world = world_of(height_map(flat))
    state = initial_state(config, steering, world, networks)
    step = jax.jit(make_train_step(config, steering, networks))
    for _ in range(3):
        state, metrics = step(world, state)
    assert all(bool(value) for name, value in metrics.items() if "finite/" in name)
    heights = np.asarray(state.normaliser.mean)[4:]
    assert np.all((heights < -0.5) & (heights > -1.4))
    assert np.all(np.asarray(state.normaliser.std) >= 1e-2)  # constant inputs keep a floor


def test_mirroring_flips_whole_robots_and_twice_is_none():
    signature = SteeringConfig().signature()
    key = jax.random.key(0)
    shape = (5, 32)
    batch = Experience(
        observation=jax.random.normal(key, (*shape, signature.size)),
        raw_action=jax.random.normal(key, (*shape, 4)),
        distributions=(
            NormalDistribution(jax.random.normal(key, (*shape, 4)), jnp.ones((*shape, 4))),
        ),
        reward=jnp.zeros(shape),
        terminated=jnp.zeros(shape),
        truncated=jnp.zeros(shape),
    )
    last = jax.random.normal(key, (1, 32, signature.size))
    flip = jax.random.bernoulli(jax.random.key(3), 0.5, (32,))
    everybody = jnp.arange(32)
    images = mirror_images(signature, batch, last[0])
    once = take_robots(*images, everybody, flip)
    twice = take_robots(*mirror_images(signature, once[0], once[1][0]), everybody, flip)
    jax.tree.map(np.testing.assert_array_equal, twice, (batch, last))
    some = jnp.array([7, 3, 30])
    few = take_robots(*images, some, flip[some])
    jax.tree.map(
        lambda of_few, of_all: np.testing.assert_array_equal(of_few, of_all[:, some]), few, once
    )
    for before, after in ((batch.observation, once[0].observation), (last, once[1])):
        np.testing.assert_array_equal(np.any(np.asarray(after != before), axis=(0, 2)), flip)
        heights = np.asarray(before)[:, :, 4:].reshape(-1, 32, 10, 14)[..., ::-1]
        expected = heights.reshape(-1, 32, 140)[:, flip]
        np.testing.assert_array_equal(np.asarray(after)[:, flip, 4:], expected)
    sideways = np.asarray(once[0].raw_action[..., 1])
    original = np.asarray(batch.raw_action[..., 1])
    np.testing.assert_array_equal(sideways, np.where(flip[None], -original, original))


def test_the_train_step_compiles_once():
    config = SteeringRun.model_validate(
        {"network": {"hidden": [8]}, "ppo": SMALL | {"steps": 640 * 3}}
    )
    steering = Steering(config.env)
    networks = make_networks(config.network, steering.signature)
    world = world_of(height_map(flat))
    step = make_train_step(config, steering, networks)
    traces = 0

    def counted(world, state):
        nonlocal traces
        traces += 1
        return step(world, state)

    compiled = jax.jit(counted, donate_argnums=1)
    state = jax.jit(lambda: initial_state(config, steering, world, networks))()
    for _ in range(3):
        state, _ = compiled(world, state)
    assert traces == 1
