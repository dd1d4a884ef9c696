"""Elements of an array at indices that are known to lie inside it."""

from typing import Any

import jax.numpy as jnp
from jax import Array


def take_inside(array: Array, index: Any) -> Array:
    """Return array[index], without XLA's checks of each index; plain indexing is its twin.

    Args:
        array: array to take from.
        index: index, or tuple of indices, none of which is negative or beyond the end: elsewhere
            the result is undefined.
    """
    return array.at[index].get(mode="promise_in_bounds", wrap_negative_indices=False)


def take_along_inside(array: Array, index: Array, axis: int) -> Array:
    """Return what `jnp.take_along_axis` returns, without checks, under the same condition."""
    return jnp.take_along_axis(array, index, axis=axis, mode="promise_in_bounds")
