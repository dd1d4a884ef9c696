"""Vectors cut into parts, with a gradient that joins them again."""

from collections.abc import Sequence
from functools import partial

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Float


def split(vector: Float[Array, "*batch size"], sizes: Sequence[int]) -> tuple[Array, ...]:
    """Return consecutive parts of the last axis; `plain_split` is its twin.

    Args:
        vector: vector whose length is the sum of the sizes.
        sizes: length of each part.
    """
    return (vector,) if len(sizes) == 1 else _split(tuple(sizes), vector)


def plain_split(vector: Float[Array, "*batch size"], sizes: Sequence[int]) -> tuple[Array, ...]:
    """Return consecutive parts of the last axis, by plain slicing."""
    ends = [sum(sizes[: index + 1]) for index in range(len(sizes))]
    return tuple(vector[..., end - size : end] for end, size in zip(ends, sizes, strict=True))


@partial(jax.custom_vjp, nondiff_argnums=(0,))
def _split(sizes: tuple[int, ...], vector: Array) -> tuple[Array, ...]:
    return plain_split(vector, sizes)


# The gradients of the parts are concatenated. JAX would pad and add them, and XLA computes both
# over all elements, including the padding.
_split.defvjp(
    lambda sizes, vector: (_split(sizes, vector), None),
    lambda sizes, _, gradients: (jnp.concatenate(gradients, axis=-1),),
)
