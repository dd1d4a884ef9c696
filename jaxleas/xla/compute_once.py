"""A border that XLA:CPU's fusion does not cross."""

from collections.abc import Callable
from typing import Any, TypeVar

import jax
import jax.numpy as jnp
from jax import Array

Tree = TypeVar("Tree")


def compute_once(function: Callable[..., Tree], always: Array, *operands: Any) -> Tree:
    """Return function(*operands), computed once and kept apart from what comes before and after.

    XLA:CPU fuses what is cheap by its count into each of its users, and computes it again for each
    and for each of its elements; it drops `optimization_barrier`, and keeps a branch.

    Args:
        function: of arrays, to a pytree of arrays.
        always: true, and not known to the compiler.
        operands: pytrees of arrays.
    """

    def apart(*operands: Any) -> Tree:
        shapes = jax.eval_shape(function, *operands)

        def nothing(*_: Any) -> Tree:
            return jax.tree.map(lambda each: jnp.zeros(each.shape, each.dtype), shapes)

        return jax.lax.cond(always, function, nothing, *operands)

    return jax.lax.platform_dependent(*operands, cpu=apart, default=function)
