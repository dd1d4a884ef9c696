"""Features and network against slow twins, and the mirror law."""

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.envs.steering import MotionLimits, SteeringConfig
from jaxleas.surrogates.features import MOTION_FEATURES, Pace, mirrored, path_features
from jaxleas.surrogates.network import initial_weights, recur
from jaxleas.surrogates.surrogate import Identity
from jaxleas.types import RootMotion

from .walkers import env


def motion(generator, count=6):
    return RootMotion(
        position=jnp.asarray(generator.normal(size=(count, 3)), jnp.float32),
        velocity=jnp.asarray(0.1 * generator.normal(size=(count, 3)), jnp.float32),
        yaw=jnp.asarray(generator.uniform(-3, 3, count), jnp.float32),
    )


def test_features_equal_the_slow_twin():
    generator = np.random.default_rng(0)
    now, last = motion(generator), motion(generator)
    heights = generator.uniform(-3.0, 1.0, (6, 9)).astype(np.float32)
    found = path_features(jnp.asarray(heights), now, last, 5, (-1.4, -0.2))
    for row in range(6):
        yaw = float(now.yaw[row])
        into_root = np.array(
            [[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
        )
        step = into_root @ np.asarray(now.position[row] - last.position[row])
        turn = yaw - float(last.yaw[row])
        turn = (turn + np.pi) % (2 * np.pi) - np.pi
        expected = [
            *((np.clip(heights[row], -1.4, -0.2) + 0.8) / 0.6),
            *(step / 0.1),
            turn / 0.35,
            *(into_root @ np.asarray(now.velocity[row]) / 0.1),
        ]
        np.testing.assert_allclose(found[row], expected, atol=2e-5)


def test_a_faster_walk_has_the_same_features_in_its_own_pace():
    """Lengths and speeds of a walk are multiplied, and its pace with them."""
    generator = np.random.default_rng(2)
    now, last = motion(generator), motion(generator)
    now, last = (each.replace(yaw=0.2 * each.yaw) for each in (now, last))
    heights = jnp.asarray(generator.uniform(-1.4, -0.2, (6, 9)), jnp.float32)
    plain = path_features(heights, now, last, 5, (-1.4, -0.2))
    fast = Pace(speed=0.4, time_step=0.1, turn=0.07)  # twice as far in a step, four times as fast
    quick = [
        each.replace(position=2.0 * each.position, velocity=4.0 * each.velocity)
        for each in (now, last)
    ]
    found = path_features(heights, *quick, 5, (-1.4, -0.2), fast)
    np.testing.assert_allclose(found, plain, atol=2e-5)


def test_the_pace_is_the_tasks_and_files_that_record_none_have_the_default():
    assert Pace.of(SteeringConfig()) == Pace()
    limits = MotionLimits(time_step=0.1, max_turn_rate=1.0)
    config = SteeringConfig(desired_speed=0.84, limits=limits)
    assert Pace.of(config) == Pace(speed=0.8, time_step=0.1, turn=0.1)
    written = Identity.of("mip", {"keep_every": 14}, config).model_dump(mode="json")
    assert Identity.model_validate(written).pace == Pace.of(config)
    del written["pace"]
    assert Identity.model_validate(written).pace == Pace()


def test_features_of_a_mirrored_walk_are_the_mirrored_features():
    generator = np.random.default_rng(1)
    points = env().points_in_root
    now, last = motion(generator), motion(generator)
    heights = generator.uniform(-1.4, -0.2, (6, len(points))).astype(np.float32)
    order, sign = mirrored(points)

    def image(one: RootMotion) -> RootMotion:
        flip = jnp.array([[1.0, -1.0, 1.0]])
        return RootMotion(one.position * flip, one.velocity * flip, -one.yaw)

    swapped = heights[:, order[: len(points)]]  # what lay to the left now lies to the right
    np.testing.assert_allclose(points[order[: len(points)]], points * [1, -1], atol=1e-9)
    direct = path_features(jnp.asarray(swapped), image(now), image(last), 5, (-1.4, -0.2))
    plain = path_features(jnp.asarray(heights), now, last, 5, (-1.4, -0.2))
    np.testing.assert_allclose(direct, np.asarray(plain)[:, order] * sign, atol=2e-5)


def test_the_network_equals_the_slow_twin():
    weights = initial_weights(jax.random.key(0), 5 + MOTION_FEATURES, code=7, hidden=4)
    weights = jax.tree.map(
        lambda leaf: leaf + 0.1 * jax.random.normal(jax.random.key(leaf.size), leaf.shape), weights
    )
    features = np.random.default_rng(2).normal(size=(3, 5 + MOTION_FEATURES)).astype(np.float32)
    hidden = np.random.default_rng(3).normal(size=(3, 4)).astype(np.float32)
    after, logit = recur(weights, jnp.asarray(hidden), jnp.asarray(features))

    def sigmoid(x):
        return 1.0 / (1.0 + np.exp(-x))

    for row in range(3):
        code = np.maximum(features[row] @ weights.encoder + weights.encoder_bias, 0.0)
        gates = sigmoid(np.concatenate([code, hidden[row]]) @ weights.gates + weights.gates_bias)
        reset, update = gates[:4], gates[4:]
        mixed = np.concatenate([code, reset * hidden[row]])
        candidate = np.tanh(mixed @ weights.candidate + weights.candidate_bias)
        expected = update * hidden[row] + (1 - update) * candidate
        np.testing.assert_allclose(after[row], expected, atol=1e-5)
        np.testing.assert_allclose(
            logit[row], expected @ weights.head + weights.head_bias, atol=1e-5
        )
