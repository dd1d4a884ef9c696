"""A barrier that XLA:CPU's fusion does not cross."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax import Array

Tree = TypeVar("Tree")


def compute_once(function: Callable[..., Tree], *operands: Any) -> Tree:
    """Return function(*operands), computed once and kept apart from what comes before and after.

    XLA:CPU fuses computations that it estimates as cheap into each of their users, and repeats them
    for each user and each element. It drops `optimization_barrier`, but keeps a branch on what it
    does not know. On other devices this is function(*operands).

    Args:
        function: function from arrays to a pytree of arrays.
        operands: pytrees of arrays, the function's arguments; the first array is not empty.
    """

    def apart(*operands: Any) -> Tree:
        shapes = jax.eval_shape(function, *operands)

        def nothing(*_: Any) -> Tree:
            return jax.tree.map(lambda each: jnp.zeros(each.shape, each.dtype), shapes)

        return jax.lax.cond(_true(operands), function, nothing, *operands)

    return jax.lax.platform_dependent(*operands, cpu=apart, default=function)


def _true(operands: Any) -> Array:
    """Return a value that is true, though the compiler cannot know it: no number exceeds infinity.

    It is made of the operands, so that no caller has to bring it.
    """
    first = jax.tree.leaves(operands)[0]
    return ~(first[(0,) * first.ndim].astype(jnp.float32) > jnp.inf)
