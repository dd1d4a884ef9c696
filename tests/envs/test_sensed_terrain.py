"""Robots that see maps of sensors: the policy and the guard see them, the true terrain judges."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.configuration import with_values
from jaxleas.envs.steering import SteeringConfig, SteeringEnv, TerrainConfig, integrate
from jaxleas.envs.steering.config import GuardConfig
from jaxleas.envs.steering.state import GOALS, Route
from jaxleas.envs.steering.task import Steering
from jaxleas.envs.steering.world import as_sensed
from jaxleas.guide import Trips, roll_out
from jaxleas.terrain import NoiseConfig, sense
from jaxleas.types import InputError, RootMotion
from tests.envs import compiled
from tests.envs.worlds import bumpy, flat, height_map, standing, world_of

NOTHING_KNOWN = NoiseConfig(missing=1.0)
ROBOTS, STEPS = 4, 12


def sensed_of(world, **noise):
    return sense(world.atlas, NoiseConfig(**noise), jax.random.key(0))[0]


def trips_on(env, world, sensed=None):
    motion = standing(env, [(-1.0, 0.5 * robot) for robot in range(ROBOTS)], 0.0)
    waypoints = jnp.full((ROBOTS, 1, 3), 50.0)
    return Trips(world.atlas, jnp.zeros(ROBOTS, jnp.int32), motion, waypoints, sensed)


class Ahead:
    """A method that walks ahead."""

    def __init__(self, limits, guarded):
        self.limits, self.guarded = limits, guarded

    def __call__(self, heights_in_root, motion, goal):
        command = jnp.zeros((*motion.yaw.shape, 4)).at[..., 0].set(0.08)
        return integrate(motion, command, self.limits)


def test_without_noise_the_world_is_what_it_was():
    config = with_values(TerrainConfig(), {"generator.rows": 3, "generator.columns": 3}, "here")
    world = Steering(SteeringConfig(), config).make_world([3], examined=False)
    assert world.sensed is None
    assert world.seen is world.atlas
    env = compiled.steering_env()
    assert env.start(standing(env, [(0.0, 0.0)], 0.0), _route()).past == ()


def _route(robots=1):
    return Route(
        map_index=jnp.zeros(robots, jnp.int32),
        goals=jnp.full((robots, GOALS, 2), 50.0),
        goal_steps=jnp.full((robots, GOALS), 10_000),
    )


def test_a_world_with_noise_is_the_same_but_for_what_is_seen():
    small = {"generator.rows": 3, "generator.columns": 3}
    noise = {"noise.white": 0.02, "noise.missing": 0.02}
    plain, noisy = (
        Steering(SteeringConfig(), with_values(TerrainConfig(), small | values, "here"))
        for values in ({}, noise)
    )
    one, other, again = (each.make_world([5, 6], examined=False) for each in (plain, noisy, noisy))
    assert other.sensed is not None
    assert again.sensed is not None
    np.testing.assert_array_equal(one.atlas.heights, other.atlas.heights)
    assert np.any(np.asarray(other.sensed.atlas.heights) != np.asarray(other.atlas.heights))
    np.testing.assert_array_equal(other.sensed.atlas.heights, again.sensed.atlas.heights)


@pytest.mark.slow
def test_the_guard_and_the_policy_see_the_map_and_the_true_terrain_judges():
    """A map on which nothing is known: guarded robots stand, others walk on, valid."""
    env = compiled.steering_env(guard=GuardConfig(enabled=True))
    world = world_of(height_map(flat))
    blind = trips_on(env, world, sensed_of(world, missing=1.0))
    for guarded in (True, False):
        walked = roll_out(env, Ahead(env.config.limits, guarded), blind, STEPS)
        assert not np.any(walked.invalid)
        way = np.asarray(walked.position[:, -1, 0]) + 1.0
        assert np.all(np.abs(way) < 1e-6) if guarded else np.all(way > 0.1)


class Recorder:
    """A method that walks an arc and notes in its velocity what it sees under the root."""

    def __init__(self, point):
        self.point = point

    def __call__(self, heights_in_root, motion, goal):
        step = jnp.stack([jnp.cos(motion.yaw), jnp.sin(motion.yaw), jnp.zeros_like(motion.yaw)], -1)
        seen = jnp.zeros_like(motion.velocity).at[..., 0].set(heights_in_root[..., self.point])
        return RootMotion(motion.position + 0.04 * step, seen, motion.yaw + 0.1)


def test_a_late_map_shows_in_roll_outs_what_the_root_saw_some_steps_ago():
    env = compiled.steering_env()
    world, point, delay = world_of(height_map(bumpy)), 40, 3
    sensed = sensed_of(world, delay=delay, drift=0.0, white=1e-9)
    walked = roll_out(env, Recorder(point), trips_on(env, world, sensed), STEPS)
    motion = walked.motion
    seen = np.asarray(motion.velocity[:, 1:, 0])
    index = jnp.zeros(motion.yaw.shape, jnp.int32)
    true = np.asarray(compiled.local_heights(env, world.atlas, index, motion))[..., point]
    last = int(np.min(walked.end))
    assert last > 8
    late = true[:, np.maximum(np.arange(last) - delay, 0)]
    np.testing.assert_allclose(seen[:, :last], late, atol=1e-5)
    assert np.abs(late - true[:, :last]).max() > 0.001


@pytest.mark.slow
def test_a_late_map_shows_in_training_what_the_root_saw_some_steps_ago():
    env, plain = SteeringEnv(SteeringConfig(), delay=2), compiled.steering_env()
    world = world_of(height_map(bumpy))
    world = as_sensed(world, NoiseConfig(delay=2), jax.random.key(0))
    state = env.start(standing(env, [(0.0, 0.0)], 0.3), _route())
    weights = Steering(SteeringConfig()).weights(dict.fromkeys(SteeringConfig.swept, 1.0), 0.0)
    action = jnp.asarray([[1.0, 0.0, 0.0, 1.0]])
    states, seen = [state], [compiled.look(env, world.seen, state)]
    for _ in range(5):
        state, result = compiled.step(env, world.atlas, weights, state, action, world.seen)
        states.append(state)
        seen.append(result.observation)
    for step, observation in enumerate(seen):
        then = replace(states[max(step - 2, 0)], past=())
        wanted = compiled.look(plain, world.atlas, then)
        np.testing.assert_allclose(observation[:, 4:], wanted[:, 4:], atol=1e-5)
        now = compiled.look(plain, world.atlas, replace(states[step], past=()))
        np.testing.assert_array_equal(observation[:, :4], now[:, :4])  # motion and goal are not


def test_noise_that_leaves_nothing_known_is_refused():
    with pytest.raises(InputError, match=r"terrain\.noise leaves no height known"):
        as_sensed(world_of(height_map(flat)), NOTHING_KNOWN, jax.random.key(0))


@pytest.mark.parametrize(
    ("field", "value"), [("white", 0.5), ("missing", 1.5), ("delay", -1), ("hole_width", 0.0)]
)
def test_noise_out_of_range_names_its_key(field, value):
    with pytest.raises(InputError, match=rf"here: noise\.{field} is"):
        with_values(TerrainConfig(), {f"noise.{field}": value}, "here")
