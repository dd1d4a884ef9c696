"""A barrier that XLA:CPU's fusion does not cross."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax import Array

Tree = TypeVar("Tree")


def compute_once(function: Callable[..., Tree], always: Array, *operands: Any) -> Tree:
    """Return function(*operands), computed once and kept apart from what comes before and after.

    XLA:CPU fuses computations that it estimates as cheap into each of their users, and repeats them
    for each user and each element. It drops `optimization_barrier`, but keeps a branch.

    Args:
        function: function from arrays to a pytree of arrays.
        always: value that is true, which the compiler does not know.
        operands: pytrees of arrays, the function's arguments.
    """

    def apart(*operands: Any) -> Tree:
        shapes = jax.eval_shape(function, *operands)

        def nothing(*_: Any) -> Tree:
            return jax.tree.map(lambda each: jnp.zeros(each.shape, each.dtype), shapes)

        return jax.lax.cond(always, function, nothing, *operands)

    return jax.lax.platform_dependent(*operands, cpu=apart, default=function)
