"""Parts of a vector are plain slices, and their gradient is the whole vector's."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.xla.split import plain_split, split

SIZES = pytest.mark.parametrize("sizes", [(6,), (1, 5), (2, 1, 3)])
WEIGHTS = np.arange(12.0, dtype=np.float32).reshape(2, 6)


@SIZES
def test_parts_and_gradients_are_the_slices(sizes):
    vector = jnp.linspace(-1.0, 1.0, 12).reshape(2, 6)
    weights = plain_split(WEIGHTS, sizes)

    def total(cut, vector):
        parts = cut(vector, sizes)
        return sum(jnp.sum(w * jnp.sin(part)) for w, part in zip(weights, parts, strict=True))

    for one, other in zip(split(vector, sizes), plain_split(vector, sizes), strict=True):
        np.testing.assert_array_equal(one, other)
    np.testing.assert_array_equal(
        jax.grad(lambda v: total(split, v))(vector),
        jax.grad(lambda v: total(plain_split, v))(vector),
    )


def test_a_part_that_is_not_used_has_no_gradient():
    gradient = jax.grad(lambda v: jnp.sum(split(v, (2, 4))[0]))(jnp.ones(6))
    np.testing.assert_array_equal(gradient, [1, 1, 0, 0, 0, 0])
