"""The Brax face: the same task, and starts that are drawn anew where Brax would replay them."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering import SteeringConfig, SteeringEnv

from .worlds import flat, height_map, world_of


@pytest.fixture(scope="module")
def face():
    from jaxleas.envs.steering.brax_face import BraxSteering

    world = world_of(height_map(flat), height_map(flat, half_size=3.0))
    return BraxSteering(SteeringEnv(SteeringConfig(episode_steps=7)), world)


def test_sizes(face):
    state = jax.eval_shape(face.reset, jax.random.key(0))
    assert state.obs.shape == (face.observation_size,) == (144,)
    assert face.action_size == 4


@pytest.mark.slow
def test_a_wrapped_batch_restarts_with_new_starts_and_tells_cuts_from_failures(face):
    from jaxleas.envs.steering.brax_face import wrap_for_training

    env = wrap_for_training(face)
    step = jax.jit(env.step)
    state = jax.jit(env.reset)(jax.random.split(jax.random.key(1), 16))
    starts = [np.asarray(state.pipeline_state.motion.position)]
    for number in range(1, 22):
        before = state
        state = step(state, jnp.zeros((16, 4)))
        cut = number % 7 == 0
        np.testing.assert_array_equal(state.done, float(cut))
        np.testing.assert_array_equal(state.info["truncation"], float(cut))
        if np.all(before.done == 1):
            starts.append(np.asarray(state.pipeline_state.motion.position))
            np.testing.assert_array_equal(state.info["steps"], 1)
    assert len(starts) == 3
    for index in range(16):
        assert len({tuple(each[index, :2]) for each in starts}) == 3


def test_what_the_task_has_of_its_own_is_refused(face):
    from jaxleas.envs.steering.brax_face import wrap_for_training

    with pytest.raises(ValueError, match="repeats no action"):
        wrap_for_training(face, action_repeat=2)
