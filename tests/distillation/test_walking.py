"""Walks from fresh starts, against an episode walked step by step."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.distillation.walking import before_first, walk_from_starts
from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.reward import RewardParams
from jaxleas.envs.steering.starts import begin
from jaxleas.envs.steering.world import make_world
from jaxleas.terrain.config import GeneratorConfig
from jaxleas.terrain.generator import generate_arena

ENV = SteeringEnv(SteeringConfig(episode_steps=12))
WEIGHTS = RewardParams.of(ENV.config.reward)


def test_steps_before_the_first_flag_and_this_one_are_before_it():
    flag = np.array([[0, 0, 1, 0, 1], [0, 0, 0, 0, 0], [1, 0, 0, 0, 0]], bool)
    slow = [[not any(row[:step]) for step in range(5)] for row in flag.tolist()]
    np.testing.assert_array_equal(before_first(jnp.asarray(flag)), slow)


@pytest.mark.slow
def test_a_walk_is_what_the_task_does_step_by_step():
    world = make_world([generate_arena(GeneratorConfig(rows=3, columns=3), 0)], resolution=0.05)
    draw_key, take_key, noise_key = jax.random.split(jax.random.key(3), 3)
    noise = jax.random.normal(noise_key, (20, 16, 4))

    def act(observation, noise_now):
        return jnp.tanh(noise_now), observation[:, :4]

    walked = jax.jit(
        lambda: walk_from_starts(ENV, world, (draw_key, take_key), WEIGHTS, act, noise)
    )()
    episode, observation = begin(ENV, world, (draw_key, take_key), 16, of=32)
    going = np.ones(16, bool)
    for step, noise_now in enumerate(noise):
        np.testing.assert_allclose(walked.motion.yaw[:, step], episode.motion.yaw, atol=1e-5)
        np.testing.assert_allclose(walked.choice[:, step], observation[:, :4], atol=1e-5)
        np.testing.assert_array_equal(walked.walking[:, step], going)
        episode, result = ENV.step(world.atlas, WEIGHTS, episode, jnp.tanh(noise_now))
        observation = result.observation
        np.testing.assert_allclose(walked.reward[:, step], result.reward, atol=1e-4)
        going &= ~np.asarray(result.terminated | result.truncated)
    assert not going.any()  # 20 steps are more than an episode
