import jax
import jax.numpy as jnp
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from jaxleas.envs.steering.config import MotionLimits
from jaxleas.envs.steering.motion import bound_norm, integrate, scale_action
from jaxleas.types import RootMotion

LIMITS = MotionLimits()
numbers = st.floats(-3, 3, width=32)


def motion(position, velocity, yaw) -> RootMotion:
    return RootMotion(*(jnp.asarray(value, jnp.float32) for value in (position, velocity, yaw)))


def test_position_moves_by_the_velocity_of_before():
    before = motion([1.0, 2.0, 3.0], [0.1, -0.05, 0.02], 0.3)
    after = integrate(before, jnp.array([0.08, 0.0, 0.0, 0.1]), LIMITS)
    np.testing.assert_allclose(after.position, [1.02, 1.99, 3.004], rtol=1e-6)
    np.testing.assert_allclose(
        after.velocity,
        [0.1 + 0.016 * np.cos(0.3), -0.05 + 0.016 * np.sin(0.3), 0.02],
        rtol=1e-5,
    )
    np.testing.assert_allclose(after.yaw, 0.32, rtol=1e-6)


@settings(max_examples=60)
@given(st.lists(numbers, min_size=4, max_size=4), st.floats(-3, 3, width=32))
def test_no_action_breaks_a_bound(action, yaw):
    command = scale_action(jnp.array(action, jnp.float32), LIMITS)
    assert np.linalg.norm(command[:3]) <= LIMITS.max_acceleration * (1 + 1e-6)
    assert abs(command[3]) <= LIMITS.max_turn_rate * (1 + 1e-6)
    state = motion([0.0, 0.0, 1.0], [0.0, 0.0, 0.0], yaw)
    for _ in range(20):
        state = integrate(state, command, LIMITS)
    assert np.linalg.norm(state.velocity) <= LIMITS.max_speed * (1 + 1e-5)
    assert -np.pi <= state.yaw < np.pi


def test_a_small_action_is_scaled_and_a_large_one_keeps_its_direction():
    small = scale_action(jnp.array([0.3, -0.2, 0.1, 0.5]), LIMITS)
    np.testing.assert_allclose(small[:3], np.array([0.3, -0.2, 0.1]) * 0.08, rtol=1e-6)
    np.testing.assert_allclose(small[3], 0.5 * np.pi / 9, rtol=1e-6)
    large = np.asarray(scale_action(jnp.array([1.0, 1.0, -1.0, 0.0]), LIMITS)[:3])
    np.testing.assert_allclose(large, np.array([1, 1, -1]) * 0.08 / np.sqrt(3), rtol=1e-6)


def test_turning_the_world_turns_the_motion():
    """Commands are in the root frame, so a turned robot draws the same path, turned."""
    commands = jax.random.uniform(jax.random.key(1), (30, 4), minval=-0.1, maxval=0.1)
    angle = 1.1
    cosine, sine = np.cos(angle), np.sin(angle)
    turn = np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]])
    start = motion([0.3, -0.2, 0.9], [0.05, 0.1, 0.01], 0.4)
    turned = motion(turn @ [0.3, -0.2, 0.9], turn @ [0.05, 0.1, 0.01], 0.4 + angle)
    for command in commands:
        start, turned = integrate(start, command, LIMITS), integrate(turned, command, LIMITS)
    np.testing.assert_allclose(turned.position, turn @ np.asarray(start.position), atol=1e-5)
    np.testing.assert_allclose(turned.velocity, turn @ np.asarray(start.velocity), atol=1e-5)


def test_bounding_a_norm_has_finite_derivatives_at_rest():
    gradient = jax.grad(lambda v: jnp.sum(bound_norm(v, 0.2)))(jnp.zeros(3))
    np.testing.assert_allclose(gradient, np.ones(3))
