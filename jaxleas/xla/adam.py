"""Adam over one vector, in which each number per step is computed only once.

State and result are those of the optimiser that `optimiser.make_optimiser` returns. It is written
out because XLA:CPU recomputes a number in a formula over the weights for each of them.
"""

from typing import Any

import jax.numpy as jnp
import optax
from jax import Array
from jaxtyping import Float

from jaxleas.xla.compute_once import compute_once

BETA_1, BETA_2, EPSILON = 0.9, 0.999, 1e-5


def descend(
    gradient: Float[Array, " weights"],
    state: Any,
    learning_rate: optax.Schedule,
    max_norm: Any,
) -> tuple[Float[Array, " weights"], Any, Float[Array, ""]]:
    """Return what to add to the weights, the optimiser's next state and the gradient's norm.

    Args:
        gradient: gradient with respect to all weights, as one vector.
        state: state of the optimiser.
        learning_rate: function from the number of steps done to the learning rate.
        max_norm: norm to which longer gradients are shortened.
    """
    clipping, (moments, schedule) = state
    count = optax.safe_increment(moments.count)

    def numbers(squares: Array, count: Array, done: Array):
        norm = jnp.sqrt(squares)
        shortened = jnp.where(norm < max_norm, 1.0, max_norm / norm)
        root = jnp.sqrt(1.0 - BETA_2**count)
        rate = learning_rate(done) * root / (1.0 - BETA_1**count)
        second = (1.0 - BETA_2) * shortened * shortened
        return norm, (1.0 - BETA_1) * shortened, second, rate, EPSILON * root

    squares = jnp.sum(gradient * gradient)
    norm, first, second, rate, epsilon = compute_once(numbers, squares, count, schedule.count)
    mu = BETA_1 * moments.mu + first * gradient
    nu = BETA_2 * moments.nu + second * (gradient * gradient)
    change = -rate * mu / (jnp.sqrt(nu) + epsilon)
    after = moments._replace(count=count, mu=mu, nu=nu)
    schedule = schedule._replace(count=optax.safe_increment(schedule.count))
    return change, (clipping, (after, schedule)), norm
