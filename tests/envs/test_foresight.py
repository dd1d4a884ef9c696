"""A condition with memory in the environment: it begins, follows, ends episodes, begins anew."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering import RewardParams, SteeringConfig, SteeringEnv
from jaxleas.runs.checkpoints import Checkpoints

from . import compiled
from .compiled import draw_picks, draw_pool, restart_where, take
from .worlds import flat, height_map, world_of

LIFE = 3
REST = np.zeros((8, 4), np.float32)
"""Eight robots' action that changes nothing."""


class Patience:
    """Lets every walk go on for LIFE steps; refuses starts with a chance below `least`."""

    def __init__(self, least=0.0):
        self.least = least

    def begin(self, heights_in_root, motion, chance):
        memory = {"steps": jnp.zeros_like(chance), "from": motion.position, "chance": chance}
        return chance - self.least, memory

    def follow(self, memory, heights_in_root, motion):
        memory = memory | {"steps": memory["steps"] + 1.0}
        return LIFE - memory["steps"], memory


@pytest.fixture(scope="module")
def world():
    return world_of(height_map(flat, half_size=3.0))


@functools.cache
def make(least=0.0):
    return SteeringEnv(SteeringConfig(), foresight=Patience(least))


def test_an_episode_ends_where_foresight_fails_though_the_configuration_is_valid(world):
    env = make()
    weights = RewardParams.of(env.config.reward)
    state, _ = take(draw_pool(env, world, jax.random.key(0), 256), jax.random.key(1), 8)
    for step in range(1, LIFE + 2):
        state, outcome = compiled.step(env, world.atlas, weights, state, REST)
        assert np.all(np.asarray(outcome.terminated) == (step > LIFE))
        assert np.all(np.asarray(state.memory["steps"]) == step)


def test_a_fresh_start_brings_a_fresh_memory(world):
    env = make()
    pool = draw_pool(env, world, jax.random.key(0), 256)
    state, _observation = take(pool, jax.random.key(1), 8)
    weights = RewardParams.of(env.config.reward)
    state, _ = compiled.step(env, world.atlas, weights, state, REST)
    done = np.arange(8) % 2 == 0
    pick = draw_picks(pool, jax.random.key(2), done.shape)
    state = restart_where(done, state, pool, pick)
    np.testing.assert_array_equal(state.memory["steps"], np.where(done, 0.0, 1.0))
    begun, position = np.asarray(state.memory["from"]), np.asarray(state.motion.position)
    np.testing.assert_array_equal(begun[::2], position[::2])


def test_starts_that_foresight_refuses_are_never_taken(world):
    pool = draw_pool(make(least=0.5), world, jax.random.key(0), 256)
    everything = draw_pool(make(), world, jax.random.key(0), 256)
    state, _ = take(pool, jax.random.key(1), 200)
    assert np.all(np.asarray(state.memory["chance"]) >= 0.5)
    assert 0.35 < int(pool.valid_count) / int(everything.valid_count) < 0.65


def test_without_foresight_the_same_starts_are_drawn(world):
    seeing = draw_pool(make(), world, jax.random.key(0), 256).state
    blind = draw_pool(compiled.steering_env(), world, jax.random.key(0), 256).state
    np.testing.assert_array_equal(seeing.motion.position, blind.motion.position)
    np.testing.assert_array_equal(seeing.plan.goals, blind.plan.goals)
    assert blind.memory == ()


def test_memory_is_saved_with_the_episode(world, tmp_path):
    state, _ = take(draw_pool(make(), world, jax.random.key(0), 256), jax.random.key(1), 8)
    checkpoints = Checkpoints(tmp_path)
    checkpoints.save(1, state, {})
    _, restored, _ = checkpoints.latest(state)
    np.testing.assert_array_equal(restored.memory["chance"], state.memory["chance"])
