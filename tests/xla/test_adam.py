"""Adam written out is optax's."""

import jax
import jax.numpy as jnp
import numpy as np
import optax
import pytest
from jax.flatten_util import ravel_pytree

from jaxleas.training.config import PpoConfig
from jaxleas.training.optimiser import learning_rate, make_optimiser
from jaxleas.training.ppo_params import PpoParams
from jaxleas.xla.adam import descend

from ..training.runs import SteeringRun

WEIGHTS = {"kernel": jnp.ones((5, 3)), "bias": jnp.zeros(3)}


@pytest.mark.parametrize("longest", [0.5, 100.0])  # shortened always, never
def test_steps_are_those_of_optax(longest):
    config = PpoConfig(steps=128, environments=16, unroll=1, minibatches=2, epochs=1)
    numbers = PpoParams.of(SteeringRun(ppo=config)).replace(max_gradient_norm=longest)
    optimiser = make_optimiser(config, numbers)
    state = expected_state = optimiser.init(WEIGHTS)
    weights = expected = WEIGHTS
    rate = learning_rate(config, numbers)
    step = jax.jit(lambda vector, state: descend(vector, state, rate, longest))
    for key in jax.random.split(jax.random.key(0), 20):  # 16 fall, then the rate stays
        gradient = {"kernel": jax.random.normal(key, (5, 3)), "bias": jnp.arange(3.0)}
        updates, expected_state = optimiser.update(gradient, expected_state, expected)
        expected = optax.apply_updates(expected, updates)
        vector, as_weights = ravel_pytree(gradient)
        change, state, norm = step(vector, state)
        weights = optax.apply_updates(weights, as_weights(change))
        np.testing.assert_allclose(norm, optax.global_norm(gradient), rtol=1e-6)
        for found, wanted in zip(
            jax.tree.leaves((weights, state)),
            jax.tree.leaves((expected, expected_state)),
            strict=True,
        ):
            np.testing.assert_allclose(found, wanted, rtol=1e-4, atol=1e-8)
    assert jax.tree.structure(state) == jax.tree.structure(expected_state)
