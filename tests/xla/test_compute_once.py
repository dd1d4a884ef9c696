"""What is kept apart is what would be computed anyway, and XLA cannot look through it."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.xla.compute_once import compute_once


def squares(numbers, pair):
    return {"sum": numbers**2 + pair[0], "last": pair[1]}


@pytest.mark.parametrize("first", [-jnp.inf, -1.0, 0.0, 3e38, jnp.inf])
def test_the_result_is_the_functions_whatever_the_operands(first):
    numbers, pair = jnp.array([first, 2.0]), (jnp.float32(3.0), jnp.arange(3))
    found = jax.jit(lambda *each: compute_once(squares, *each))(numbers, pair)
    expected = squares(numbers, pair)
    np.testing.assert_array_equal(found["sum"], expected["sum"])
    np.testing.assert_array_equal(found["last"], expected["last"])


def test_even_where_the_operand_is_not_a_number():
    with jax.debug_nans(False):
        found = jax.jit(lambda x: compute_once(jnp.isnan, x))(jnp.array([jnp.nan, 1.0]))
    np.testing.assert_array_equal(found, [True, False])


@pytest.mark.parametrize("kind", [jnp.uint32, jnp.int8, jnp.bfloat16, jnp.bool_])
def test_operands_of_any_type(kind):
    numbers = jnp.ones((2, 3), kind)
    np.testing.assert_array_equal(jax.jit(lambda x: compute_once(jnp.flip, x))(numbers), numbers)


def test_it_has_derivatives_and_can_be_vectorised():
    numbers = jnp.linspace(0.1, 1.0, 6).reshape(2, 3)
    total = jax.vmap(jax.grad(lambda row: compute_once(jnp.sin, row).sum()))
    np.testing.assert_allclose(jax.jit(total)(numbers), np.cos(numbers), rtol=1e-6)


def test_the_compiler_keeps_it_apart():
    def compiled(once):
        def function(x):
            middle = compute_once(jnp.sin, x) if once else jnp.sin(x)
            return middle[:, None] * jnp.arange(4.0)[None]

        return jax.jit(function).lower(jnp.ones(5)).compile().as_text()

    if jax.default_backend() != "cpu":
        pytest.skip("only XLA:CPU needs it")
    assert "conditional" in compiled(once=True)
    assert "conditional" not in compiled(once=False)
