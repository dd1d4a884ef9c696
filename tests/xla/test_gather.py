"""Gathers without checks are plain indexing."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from jaxleas.xla.gather import take_along_inside, take_inside

ROWS = np.arange(24.0).reshape(4, 6)


@pytest.mark.parametrize(
    "index", [np.array([3, 0, 0]), np.array([[1], [2]]), (..., np.array([5, 0])), np.uint32([2, 3])]
)
def test_elements_are_those_of_plain_indexing(index):
    np.testing.assert_array_equal(jax.jit(lambda x: take_inside(x, index))(ROWS), ROWS[index])


def test_elements_along_an_axis():
    index = jnp.array([[0, 5], [1, 1], [2, 3], [5, 0]])
    found = take_along_inside(jnp.array(ROWS), index, axis=1)
    np.testing.assert_array_equal(found, np.take_along_axis(ROWS, np.array(index), axis=1))
