"""Layers arranged for speed compute what the plain formula computes, and so do their gradients."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.xla.dense import dense, plain_dense, product

ACTIVATIONS = pytest.mark.parametrize("activation", [jax.nn.relu, jax.nn.swish, jnp.tanh])


@pytest.fixture(scope="module")
def layers():
    keys = jax.random.split(jax.random.key(0), 6)
    sizes = [(7, 16), (16, 8), (8, 3)]
    return [
        (jax.random.normal(keys[2 * i], size) / 4, jax.random.normal(keys[2 * i + 1], size[1:]))
        for i, size in enumerate(sizes)
    ]


@pytest.fixture(scope="module")
def rows():
    return jax.random.normal(jax.random.key(9), (2, 5, 7))


def total(answer, layers, rows):
    return jnp.sum(jnp.sin(answer(layers, rows)))


@ACTIVATIONS
def test_answers_and_gradients_are_the_plain_formulas(layers, rows, activation):
    def fast(layers, rows):
        return dense(layers, rows, activation)

    def plain(layers, rows):
        return plain_dense(layers, rows, activation)

    expected = jax.jit(plain)(layers, rows)
    np.testing.assert_allclose(jax.jit(fast)(layers, rows), expected, rtol=1e-5)
    found = jax.jit(jax.grad(lambda *each: total(fast, *each), argnums=(0, 1)))(layers, rows)
    expected = jax.jit(jax.grad(lambda *each: total(plain, *each), argnums=(0, 1)))(layers, rows)
    for one, other in zip(jax.tree.leaves(found), jax.tree.leaves(expected), strict=True):
        np.testing.assert_allclose(one, other, rtol=2e-5, atol=2e-6)


@ACTIVATIONS
def test_products_in_bfloat16_come_near(layers, rows, activation):
    found = jax.jit(lambda *each: dense(*each, activation, "bfloat16"))(layers, rows)
    assert found.dtype == jnp.float32
    expected = jax.jit(lambda *each: plain_dense(*each, activation))(layers, rows)
    np.testing.assert_allclose(found, expected, atol=0.1)


def test_one_layer_has_no_activation(layers, rows):
    found = dense(layers[:1], rows, jnp.tanh)
    np.testing.assert_allclose(found, plain_dense(layers[:1], rows, jnp.tanh), rtol=1e-6)
    np.testing.assert_allclose(found, rows @ layers[0][0] + layers[0][1][None, None], rtol=1e-5)


def test_a_product_and_its_gradient(layers, rows):
    kernel = layers[0][0]
    np.testing.assert_allclose(product(rows, kernel), rows @ kernel, rtol=1e-6)
    found = jax.grad(lambda *each: jnp.sum(product(*each) ** 2), argnums=(0, 1))(rows, kernel)
    expected = jax.grad(lambda *each: jnp.sum((each[0] @ each[1]) ** 2), argnums=(0, 1))(
        rows, kernel
    )
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-5, atol=1e-6)
