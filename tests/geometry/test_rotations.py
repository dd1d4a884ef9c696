import math

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jaxleas import geometry
from jaxleas.geometry import wrap_angle_on_host

rotate_by_yaw, rotate_to_root, rotate_to_world, wrap_angle = map(
    jax.jit,
    (
        geometry.rotate_by_yaw,
        geometry.rotate_to_root,
        geometry.rotate_to_world,
        geometry.wrap_angle,
    ),
)


@pytest.fixture(autouse=True)
def _strict_ranks():
    with jax.numpy_rank_promotion("raise"):
        yield


def normal(seed, *shape):
    return np.random.default_rng(seed).normal(size=shape).astype(np.float32)


@pytest.fixture
def yaws():
    return np.random.default_rng(0).uniform(-7.0, 7.0, 64).astype(np.float32)


@pytest.mark.parametrize("dimensions", [2, 3])
def test_turning_there_and_back_is_nothing(yaws, dimensions):
    vectors = normal(1, 64, 5, dimensions)
    back = rotate_to_root(rotate_to_world(vectors, yaws), yaws)
    np.testing.assert_allclose(back, vectors, atol=1e-5)


def test_turns_add_up(yaws):
    vectors = normal(2, 64, 3)
    twice = rotate_by_yaw(rotate_by_yaw(vectors, yaws), yaws)
    np.testing.assert_allclose(twice, rotate_by_yaw(vectors, 2 * yaws), atol=1e-5)


def test_lengths_and_heights_are_kept(yaws):
    vectors = normal(3, 64, 3)
    turned = np.asarray(rotate_by_yaw(vectors, yaws))
    np.testing.assert_allclose(
        np.linalg.norm(turned, axis=-1), np.linalg.norm(vectors, axis=-1), rtol=1e-5
    )
    np.testing.assert_array_equal(turned[:, 2], vectors[:, 2])


def test_a_quarter_turn_takes_x_to_y():
    turned = rotate_by_yaw(jnp.array([1.0, 0.0]), jnp.array(np.pi / 2))
    np.testing.assert_allclose(turned, [0.0, 1.0], atol=1e-6)


def test_one_robot_is_a_batch_of_one(yaws):
    vectors = normal(4, 64, 7, 2)
    alone = rotate_to_world(vectors[3], yaws[3])
    np.testing.assert_allclose(alone, rotate_to_world(vectors, yaws)[3], atol=1e-6)


def test_wrapped_angles_point_the_same_way_and_stay_in_range(yaws):
    for angle in (yaws, 1000 * yaws, yaws * 1e-8 - jnp.pi, yaws * 1e-8 + jnp.pi):
        wrapped = wrap_angle(angle)
        assert jnp.all((wrapped >= -jnp.pi) & (wrapped < jnp.pi))
        np.testing.assert_allclose(jnp.cos(wrapped), jnp.cos(angle), atol=1e-3)
        np.testing.assert_allclose(jnp.sin(wrapped), jnp.sin(angle), atol=1e-3)


def test_half_a_turn_is_minus_pi():
    np.testing.assert_allclose(wrap_angle(jnp.array([np.pi, -np.pi])), -np.pi, atol=1e-6)


WRAPS = pytest.mark.parametrize(
    ("wrap", "digits"), [(wrap_angle, 1e-4), (wrap_angle_on_host, 1e-9)]
)
ANGLES = st.floats(-100.0, 100.0)


def apart(left, right):
    """Return how far apart two headings are, the shorter way round."""
    return abs(math.remainder(float(left) - float(right), 2 * math.pi))


@WRAPS
@given(angle=ANGLES, turns=st.integers(-20, 20))
def test_wrapping_is_periodic(wrap, digits, angle, turns):
    assert apart(wrap(angle + 2 * np.pi * turns), wrap(angle)) < digits


@WRAPS
@given(angle=ANGLES)
def test_wrapping_is_odd_except_at_half_a_turn(wrap, digits, angle):
    wrapped = float(wrap(angle))
    if abs(abs(wrapped) - np.pi) > digits:
        assert float(wrap(-angle)) == pytest.approx(-wrapped, abs=digits)
    assert wrap(np.pi) == pytest.approx(-np.pi, abs=1e-6)
    assert wrap(-np.pi) == pytest.approx(-np.pi, abs=1e-6)


@WRAPS
@given(angle=ANGLES)
def test_wrapping_keeps_the_heading_and_stays_in_range(wrap, digits, angle):
    assert -np.pi - 1e-6 <= float(wrap(angle)) < np.pi
    assert apart(wrap(angle), angle) < digits


@given(st.floats(-1e-14, 1e-14))
def test_rounding_does_not_lead_out_of_range_on_the_host(little):
    for angle in (np.pi + little, -np.pi + little, np.nextafter(-np.pi, -4.0)):
        assert -np.pi <= wrap_angle_on_host(angle) < np.pi
