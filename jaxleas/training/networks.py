"""Actor and critic: Brax's PPO networks over one of two normalisers."""

from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Bool, Float

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.observation import affine_scaling
from jaxleas.training.brax_blocks import (
    ACTIVATION,
    PPONetworks,
    make_ppo_networks,
    running_statistics,
    specs,
)
from jaxleas.training.config import NetworkConfig
from jaxleas.types.compute_once import compute_once

# A constant input has no deviation: without floor and clip it explodes when it first moves.
MIN_DEVIATION = 1e-2
MAX_NORMALISED = 10.0

Normaliser = running_statistics.NestedMeanStd


def normalise(observation: Float[Array, "*batch size"], normaliser: Normaliser) -> Array:
    """Return (observation - mean) / deviation, clipped to [-10, 10]."""
    return running_statistics.normalize(observation, normaliser, max_abs_value=MAX_NORMALISED)


def make_networks(config: NetworkConfig, env: SteeringEnv) -> PPONetworks:
    """Return actor and critic for the task; their actions lie in [-1, 1]^4 by a tanh."""
    return make_ppo_networks(
        observation_size=env.layout.size,
        action_size=env.action_size,
        preprocess_observations_fn=normalise,
        policy_hidden_layer_sizes=config.hidden,
        value_hidden_layer_sizes=config.hidden,
        activation=ACTIVATION[config.activation],
    )


def initial_normaliser(config: NetworkConfig, env: SteeringEnv) -> Normaliser:
    """Return the normaliser before any data."""
    if config.normaliser == "running":
        return running_statistics.init_state(specs.Array((env.layout.size,), jnp.dtype("float32")))
    mean, deviation = scaling_of(env)
    return running_statistics.NestedMeanStd(mean=mean, std=deviation)


def scaling_of(env: SteeringEnv) -> tuple[Float[Array, " size"], Float[Array, " size"]]:
    """Return mean and deviation of the affine normaliser of a task's observations."""
    layout, max_speed = env.layout, env.config.limits.max_speed
    mean, deviation = affine_scaling(
        layout.size, env.height_range, max_speed, layout.counts_surfaces
    )
    return jnp.asarray(mean), jnp.asarray(deviation)


def update_normaliser(
    normaliser: Normaliser, observation: Float[Array, "*batch size"]
) -> Normaliser:
    """Return the normaliser after seeing a batch: only running statistics change."""
    if isinstance(normaliser, running_statistics.RunningStatisticsState):
        return running_statistics.update(
            normaliser, observation, std_min_value=MIN_DEVIATION, std_max_value=1e6
        )
    return normaliser


def layers_of(params: Any) -> list[tuple[Array, Array]]:
    """Return kernel and bias of each layer of a network of Brax's, from the first to the last."""
    layers = params["params"]
    names = sorted(layers, key=lambda name: int(name.removeprefix("hidden_")))
    return [(layers[name]["kernel"], layers[name]["bias"]) for name in names]


def dense(
    params: Any,
    hidden: Float[Array, "*batch size"],
    config: NetworkConfig,
    always: Bool[Array, ""] | None = None,
) -> Array:
    """Return what a network of Brax's answers to normalised observations, float32.

    Args:
        params: of the network.
        hidden: observations, normalised.
        config: activation, and in what numbers products are taken: the last layer's are float32.
        always: true, and not known to the compiler: keeps the activations apart (`compute_once`)
            for a gradient, whose products want them turned round.
    """
    *inner, (kernel, bias) = layers_of(params)
    types = [config.products] * (len(inner) - 1) + ["float32"]
    hidden = hidden.astype(config.products if inner else "float32")
    for (inner_kernel, inner_bias), numbers in zip(inner, types, strict=False):
        rows = product(hidden, inner_kernel)
        hidden = _activated(config.activation, numbers, rows, inner_bias, always)
    return product(hidden, kernel) + _as_row(bias, hidden)


def _as_row(bias: Array, rows: Array) -> Array:
    return bias.reshape((1,) * (rows.ndim - 1) + bias.shape)


@partial(jax.custom_vjp, nondiff_argnums=(0, 1))
def _activated(name: str, numbers: str, rows: Array, bias: Array, always: Array | None) -> Array:
    """Return the activation of rows + bias, in the numbers that the next product takes."""

    def activate(rows: Array, bias: Array) -> Array:
        return ACTIVATION[name](rows + _as_row(bias, rows)).astype(numbers)

    return activate(rows, bias) if always is None else compute_once(activate, always, rows, bias)


def _activated_backward(name: str, numbers: str, kept: tuple[Array, Array], gradient: Array):
    rows, bias = kept
    before = rows + _as_row(bias, rows)
    _, pull = jax.vjp(ACTIVATION[name], before)
    (slope,) = pull(gradient.astype(before.dtype))
    return slope.astype(rows.dtype), jnp.sum(slope, axis=tuple(range(rows.ndim - 1))), None


_activated.defvjp(
    lambda name, numbers, rows, bias, always: (
        _activated(name, numbers, rows, bias, always),
        (rows, bias),
    ),
    _activated_backward,
)


@jax.custom_vjp
def product(
    rows: Float[Array, "*batch inputs"], kernel: Float[Array, "inputs outputs"]
) -> Float[Array, "*batch outputs"]:
    """Return rows @ kernel, in the rows' type."""
    return _rows_by(rows, kernel.astype(rows.dtype))


def _product_backward(kept: tuple[Array, Array], gradient: Array) -> tuple[Array, Array]:
    rows, kernel = kept
    batch = tuple(range(rows.ndim - 1))
    # In this order: JAX's own is its transpose, for which XLA:CPU turns the whole gradient round.
    of_kernel = jax.lax.dot_general(
        rows, gradient, ((batch, batch), ((), ())), preferred_element_type=kernel.dtype
    )
    return _rows_by(gradient, kernel.T.astype(rows.dtype)), of_kernel


product.defvjp(lambda rows, kernel: (product(rows, kernel), (rows, kernel)), _product_backward)


def _rows_by(rows: Array, kernel: Array) -> Array:
    def summed_in_float32(rows: Array, kernel: Array) -> Array:
        return jnp.matmul(rows, kernel, preferred_element_type=jnp.float32).astype(rows.dtype)

    # A processor's units for matrices answer in float32, and XLA:CPU uses them only if asked to.
    return jax.lax.platform_dependent(rows, kernel, cpu=summed_in_float32, default=jnp.matmul)
