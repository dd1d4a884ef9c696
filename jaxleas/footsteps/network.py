"""A small network as a motion model: what linear models would gain by curvature."""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxtyping import Array, Float, Int, PRNGKeyArray

from jaxleas.footsteps.regression import Predict

HIDDEN, BATCH, UPDATES, RATE = 32, 256, 2000, 3e-3
ROWS = 4096
"""Rows are filled up to a multiple of this, so that folds of nearly one size share a program."""
Layers = list[tuple[Float[Array, "inputs outputs"], Float[Array, " outputs"]]]


def fit_network(
    predictors: Float[np.ndarray, "N P"], labels: Float[np.ndarray, "N L"], seed: int = 0
) -> Predict:
    """Return the prediction of a network of two hidden layers.

    Args:
        predictors: predictors of footsteps.
        labels: displacements.
        seed: seed of the first weights and of the order of the footsteps.
    """
    shift, scale = predictors.mean(axis=0), predictors.std(axis=0)
    mean, spread = labels.mean(axis=0), labels.std(axis=0)
    scale, spread = np.where(scale > 0, scale, 1.0), np.where(spread > 0, spread, 1.0)
    inputs, targets = _filled((predictors - shift) / scale), _filled((labels - mean) / spread)
    layers = _train(jax.random.key(seed), inputs, targets, jnp.asarray(len(predictors)))

    def predict(given: Float[np.ndarray, "M P"]) -> Float[np.ndarray, "M L"]:
        answer = np.asarray(_answer(layers, _filled((given - shift) / scale)), np.float64)
        return answer[: len(given)] * spread + mean

    return predict


def _filled(rows: Float[np.ndarray, "N K"]) -> Float[Array, "M K"]:
    """Return rows followed by zeros, up to a multiple of `ROWS`."""
    return jnp.asarray(np.pad(rows, ((0, -len(rows) % ROWS), (0, 0))), jnp.float32)


@jax.jit
def _train(
    key: PRNGKeyArray,
    inputs: Float[Array, "M P"],
    targets: Float[Array, "M L"],
    count: Int[Array, ""],
) -> Layers:
    """Return the layers of a network that was trained on the first `count` rows."""
    key_weights, key_batches = jax.random.split(key)
    optimiser = optax.adam(optax.cosine_decay_schedule(RATE, UPDATES))
    sizes = (inputs.shape[1], HIDDEN, HIDDEN, targets.shape[1])
    layers = [
        (jax.random.normal(each, pair) / jnp.sqrt(pair[0]), jnp.zeros(pair[1]))
        for each, pair in zip(jax.random.split(key_weights, 3), pairwise(sizes), strict=True)
    ]

    def loss(layers: Layers, chosen: Array) -> Array:
        return jnp.mean((_answer(layers, inputs[chosen]) - targets[chosen]) ** 2)

    def update(carry, key):
        layers, state = carry
        chosen = jax.random.randint(key, (BATCH,), 0, count)
        changes, state = optimiser.update(jax.grad(loss)(layers, chosen), state)
        moved = jax.tree.map(jnp.add, layers, changes)
        return (moved, state), None

    carry = (layers, optimiser.init(layers))
    (layers, _), _ = jax.lax.scan(update, carry, jax.random.split(key_batches, UPDATES))
    return layers


def _answer(layers: Layers, inputs: Float[Array, "N P"]) -> Float[Array, "N L"]:
    *hidden, (last, bias) = layers
    for weights, shift in hidden:
        inputs = jnp.tanh(inputs @ weights + shift[None])
    return inputs @ last + bias[None]
