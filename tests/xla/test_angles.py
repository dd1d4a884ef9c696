"""Polynomials stand in for the C library's functions: held against NumPy's in float64."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.xla import bearing, sine_cosine

LAST_PLACE = 2.0**-23  # of a number about one


@pytest.mark.parametrize("largest", [0.1, 3.2, 7.0, 1000.0])
def test_sine_and_cosine_are_numpys(largest):
    angle = np.random.default_rng(0).uniform(-largest, largest, 100_000).astype(np.float32)
    sine, cosine = jax.jit(sine_cosine)(angle)
    np.testing.assert_allclose(sine, np.sin(angle.astype(float)), rtol=0, atol=LAST_PLACE)
    np.testing.assert_allclose(cosine, np.cos(angle.astype(float)), rtol=0, atol=LAST_PLACE)


def test_a_bearing_is_numpys_in_every_direction():
    x, y = np.random.default_rng(0).normal(size=(2, 100_000)).astype(np.float32)
    scale = np.random.default_rng(1).uniform(-12.0, 12.0, x.shape).astype(np.float32)
    x, y = x * 10.0**scale, y * 10.0**scale
    found = jax.jit(bearing)(x, y)
    exact = np.arctan2(y.astype(float), x.astype(float))
    np.testing.assert_allclose(found, exact, rtol=0, atol=3 * LAST_PLACE)


def test_along_the_axes_and_nowhere():
    x = jnp.array([1.0, -1.0, 0.0, 0.0, 0.0, 1.0])
    y = jnp.array([0.0, 0.0, 1.0, -1.0, 0.0, -1.0])
    expected = [0.0, np.pi, np.pi / 2, -np.pi / 2, 0.0, -np.pi / 4]
    np.testing.assert_allclose(bearing(x, y), expected, atol=1e-6)


def test_other_types_keep_their_precision():
    with jax.enable_x64():
        angle = jnp.linspace(-7.0, 7.0, 100, dtype=jnp.float64)
        np.testing.assert_allclose(sine_cosine(angle)[0], np.sin(np.asarray(angle)), atol=1e-15)
        exact = np.arctan2(np.sin(angle), np.cos(angle))
        np.testing.assert_allclose(bearing(jnp.cos(angle), jnp.sin(angle)), exact, atol=1e-14)
