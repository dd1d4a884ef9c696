import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.envs.steering.config import MotionLimits
from jaxleas.guide import rb_kino
from jaxleas.types import InputError, RootMotion

LIMITS = MotionLimits()
SPEED = 0.1
COUNT = 64
STEPS = 500
METHOD = rb_kino(LIMITS, SPEED)
MOVE = jax.jit(METHOD.__call__)


@pytest.fixture(scope="module")
def walk():
    """RB-Kino from anywhere to anywhere: start, goal and the configurations, time first."""
    rng = np.random.default_rng(7)
    start = RootMotion(
        position=jnp.asarray(rng.uniform(-3, 3, (COUNT, 3)), jnp.float32),
        velocity=jnp.asarray(rng.uniform(-0.1, 0.1, (COUNT, 3)), jnp.float32),
        yaw=jnp.asarray(rng.uniform(-np.pi, np.pi, COUNT), jnp.float32),
    )
    goal = jnp.asarray(rng.uniform(-3, 3, (COUNT, 3)), jnp.float32)

    def step(motion, _):
        after = METHOD(jnp.zeros((COUNT, 1)), motion, goal)
        return after, after

    _, motions = jax.lax.scan(step, start, None, length=STEPS)
    return start, goal, jax.tree.map(np.asarray, motions)


def test_it_arrives_exactly_stands_and_keeps_its_heading(walk):
    _, goal, motions = walk
    np.testing.assert_allclose(motions.position[-1], goal, atol=1e-5)
    np.testing.assert_array_equal(motions.velocity[-1], 0.0)
    np.testing.assert_array_equal(motions.yaw[-1], motions.yaw[-20])


def test_step_by_step_it_follows_the_connection_of_the_start(walk):
    start, goal, motions = walk
    time = np.arange(1, STEPS + 1, dtype=np.float32)[:, None] * np.float32(LIMITS.time_step)

    @jax.jit
    def connect(start, goal, time):
        connection = METHOD.connection(start, goal)
        along = jax.vmap(METHOD.along, in_axes=(None, None, 0))
        return connection, along(connection, start, time)

    connection, whole = connect(start, goal, np.broadcast_to(time, (STEPS, COUNT)))
    np.testing.assert_allclose(motions.position, whole.position, atol=2e-3)
    np.testing.assert_allclose(motions.velocity, whole.velocity, atol=2e-3)
    arrived = 1 + np.argmax(np.all(motions.position == np.asarray(goal), axis=-1), axis=0)
    wanted = np.asarray(connection.duration) / LIMITS.time_step
    assert np.abs(arrived - wanted).max() <= 2


def test_velocity_and_acceleration_are_bounded(walk):
    start, _, motions = walk
    velocity = np.concatenate([np.asarray(start.velocity)[None], motions.velocity])
    assert np.abs(velocity).max() <= METHOD.max_velocity + 1e-6
    assert np.linalg.norm(velocity, axis=-1).max() <= LIMITS.max_speed
    acceleration = np.diff(velocity, axis=0) / LIMITS.time_step
    assert np.linalg.norm(acceleration, axis=-1).max() <= LIMITS.max_acceleration + 1e-3


def test_yaw_follows_the_velocity_from_the_first_step_on(walk):
    _, _, motions = walk
    horizontal = motions.velocity[..., :2]
    moves = np.linalg.norm(horizontal, axis=-1) > 0.02
    moves[-1] = False
    course = np.arctan2(horizontal[..., 1], horizontal[..., 0])
    off = np.abs((motions.yaw - course + np.pi) % (2 * np.pi) - np.pi)[moves]
    assert np.quantile(off, 0.99) < 1e-3
    assert moves[1].mean() > 0.9


def test_a_faster_start_keeps_its_speed_and_still_arrives():
    zeros = np.zeros(3, np.float32)
    motion = RootMotion(zeros, np.float32([0.19, 0.0, 0.0]), np.float32(0.0))
    goal, moved = np.float32([2.0, 0.0, 0.0]), []
    for _ in range(120):
        motion = MOVE(zeros[:1], motion, goal)
        moved.append(float(motion.velocity[0]))
    np.testing.assert_allclose(motion.position, goal, atol=1e-6)
    assert max(moved) <= 0.19 + 1e-6


def test_one_robot_straight_up_does_not_turn():
    zeros = np.zeros(3, np.float32)
    motion = RootMotion(zeros, zeros, np.float32(2.0))
    after = MOVE(zeros[:1], motion, np.float32([0.0, 0.0, 0.3]))
    assert float(after.yaw) == 2.0
    assert float(after.position[2]) > 0.0


@pytest.mark.parametrize("speed", [0.0, -0.1, 0.21, float("nan")])
def test_a_speed_out_of_bounds_is_refused(speed):
    with pytest.raises(InputError, match="max_speed"):
        rb_kino(LIMITS, speed)
