import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering.config import MotionLimits
from jaxleas.guide import rb_lin
from jaxleas.types import InputError, RootMotion

LIMITS = MotionLimits()
SPEED = 0.1
STRIDE = SPEED * LIMITS.time_step
TURN = LIMITS.max_turn_rate * LIMITS.time_step
COUNT = 64


def angle_between(left, right):
    return (left - right + np.pi) % (2 * np.pi) - np.pi


@pytest.fixture(scope="module")
def walk():
    """RB-Lin from anywhere to anywhere: start, goal and the configurations, time first."""
    rng = np.random.default_rng(7)
    start = RootMotion(
        position=jnp.asarray(rng.uniform(-3, 3, (COUNT, 3)), jnp.float32),
        velocity=jnp.asarray(rng.uniform(-0.2, 0.2, (COUNT, 3)), jnp.float32),
        yaw=jnp.asarray(rng.uniform(-np.pi, np.pi, COUNT), jnp.float32),
    )
    goal = jnp.asarray(rng.uniform(-3, 3, (COUNT, 3)), jnp.float32)
    method = rb_lin(LIMITS, SPEED)

    def step(motion, _):
        after = method(jnp.zeros((COUNT, 1)), motion, goal)
        return after, after

    _, motions = jax.lax.scan(step, start, None, length=600)
    return start, np.asarray(goal), jax.tree.map(np.asarray, motions)


def test_it_arrives_exactly_and_stays(walk):
    _, goal, motions = walk
    np.testing.assert_allclose(motions.position[-50:], np.stack([goal] * 50), atol=1e-5)
    np.testing.assert_array_equal(motions.yaw[-1], motions.yaw[-50])


def test_it_takes_no_more_steps_than_turn_and_way_need(walk):
    start, goal, motions = walk
    offset = goal - np.asarray(start.position)
    bearing = np.arctan2(offset[:, 1], offset[:, 0])
    turns = np.ceil(np.abs(angle_between(bearing, np.asarray(start.yaw))) / TURN - 1e-3)
    strides = np.ceil(np.linalg.norm(offset, axis=1) / STRIDE - 1e-3)
    distance = np.linalg.norm(motions.position - goal, axis=-1)
    needed = 1 + np.argmax(distance < 1e-4, axis=0)
    assert np.all(np.abs(needed - (turns + strides)) <= 1)


def test_it_turns_on_the_spot_then_walks_straight_in_space(walk):
    start, goal, motions = walk
    position = np.concatenate([np.asarray(start.position)[None], motions.position])
    yaw = np.concatenate([np.asarray(start.yaw)[None], motions.yaw])
    moved = np.linalg.norm(np.diff(position, axis=0), axis=-1)
    turned = np.abs(angle_between(yaw[1:], yaw[:-1]))
    assert not np.any((moved > 1e-6) & (turned > 1e-6))

    offset = goal - position[0]
    unit = offset / np.linalg.norm(offset, axis=1, keepdims=True)
    along = np.sum((position - position[0]) * unit, axis=-1)
    beside = np.linalg.norm(position - position[0] - along[..., None] * unit, axis=-1)
    assert beside.max() < 1e-4
    assert np.all(np.diff(along, axis=0) > -1e-5)
    assert np.all(along <= np.linalg.norm(offset, axis=1) + 1e-5)  # never beyond the goal


def test_speed_and_turn_rate_are_bounded_and_velocity_is_what_moved_it(walk):
    start, _, motions = walk
    position = np.concatenate([np.asarray(start.position)[None], motions.position])
    step = np.diff(position, axis=0)
    assert np.linalg.norm(step, axis=-1).max() <= STRIDE + 1e-6
    np.testing.assert_allclose(motions.velocity * LIMITS.time_step, step, atol=2e-6)
    yaw = np.concatenate([np.asarray(start.yaw)[None], motions.yaw])
    assert np.abs(angle_between(yaw[1:], yaw[:-1])).max() <= TURN + 1e-5


def test_it_never_turns_back(walk):
    start, goal, motions = walk
    offset = goal - np.asarray(start.position)
    bearing = np.arctan2(offset[:, 1], offset[:, 0])
    error = np.abs(
        angle_between(np.concatenate([np.asarray(start.yaw)[None], motions.yaw]), bearing)
    )
    assert np.all(np.diff(error, axis=0) <= 1e-5)
    assert error[-1].max() < 1e-3


def test_it_commutes_with_rotation_and_translation():
    rng = np.random.default_rng(1)
    method = rb_lin(LIMITS, SPEED)
    position, goal = rng.uniform(-2, 2, (2, COUNT, 3)).astype(np.float32)
    yaw = rng.uniform(-3, 3, COUNT).astype(np.float32)
    angle, shift = 0.7, np.array([1.0, -2.0, 0.3], np.float32)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]],
        np.float32,
    )

    def step(position, yaw, goal):
        motion = RootMotion(jnp.asarray(position), jnp.zeros((COUNT, 3)), jnp.asarray(yaw))
        return method(jnp.zeros((COUNT, 1)), motion, jnp.asarray(goal))

    plain = step(position, yaw, goal)
    moved = step(position @ turn.T + shift, angle_between(yaw, -angle), goal @ turn.T + shift)
    np.testing.assert_allclose(
        moved.position, np.asarray(plain.position) @ turn.T + shift, atol=1e-5
    )
    np.testing.assert_allclose(
        angle_between(np.asarray(moved.yaw), np.asarray(plain.yaw) + angle), 0.0, atol=1e-5
    )


def test_one_robot_without_a_batch_axis():
    motion = RootMotion(jnp.zeros(3), jnp.zeros(3), jnp.float32(0.0))
    after = rb_lin(LIMITS, SPEED)(jnp.zeros(1), motion, jnp.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(after.position, [STRIDE, 0.0, 0.0], atol=1e-7)


def test_a_goal_straight_above_needs_no_turn():
    motion = RootMotion(jnp.zeros(3), jnp.zeros(3), jnp.float32(2.0))
    after = rb_lin(LIMITS, SPEED)(jnp.zeros(1), motion, jnp.array([0.0, 0.0, 0.005]))
    np.testing.assert_allclose(after.position, [0.0, 0.0, 0.005], atol=1e-7)
    assert float(after.yaw) == 2.0


@pytest.mark.parametrize("speed", [0.0, -0.1, 0.21, float("nan")])
def test_a_speed_out_of_bounds_is_refused(speed):
    with pytest.raises(InputError, match="max_speed"):
        rb_lin(LIMITS, speed)
