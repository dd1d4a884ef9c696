"""Actor and critic: Brax's PPO networks over one of two normalisers."""

from collections.abc import Callable
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
from jaxleas.xla.compute_once import compute_once

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
    types = [config.product_type] * (len(inner) - 1) + ["float32"]
    hidden = hidden.astype(config.product_type if inner else "float32")
    for (inner_kernel, inner_bias), numbers in zip(inner, types, strict=False):
        hidden = _layer(config.activation, numbers, hidden, inner_kernel, inner_bias, always)
    return product(hidden, kernel) + _as_row(bias, hidden)


def _as_row(bias: Array, rows: Array) -> Array:
    return bias.reshape((1,) * (rows.ndim - 1) + bias.shape)


@partial(jax.custom_vjp, nondiff_argnums=(0, 1))
def _layer(
    name: str, numbers: str, rows: Array, kernel: Array, bias: Array, always: Array | None
) -> Array:
    """Return activation(rows @ kernel + bias), in the numbers that the next product takes."""
    return _answer(name, numbers, rows, kernel, bias, always)[0]


def _answer(
    name: str, numbers: str, rows: Array, kernel: Array, bias: Array, always: Array | None
) -> tuple[Array, Array]:
    """Return a layer's answer, and what its gradient needs of it: itself, or what was activated."""

    def activate(before: Array, bias: Array) -> Array:
        return ACTIVATION[name](before + _as_row(bias, before)).astype(numbers)

    def answer(sums: str, rows: Array, kernel: Array, bias: Array) -> tuple[Array, Array]:
        before = jnp.matmul(rows, kernel.astype(rows.dtype), preferred_element_type=sums)
        after = (
            activate(before, bias)
            if always is None
            else compute_once(activate, always, before, bias)
        )
        return after, after if name == "relu" else before.astype(rows.dtype)

    return _by_platform(answer, rows, kernel, bias)


def _layer_forward(
    name: str, numbers: str, rows: Array, kernel: Array, bias: Array, always: Array | None
):
    after, kept = _answer(name, numbers, rows, kernel, bias, always)
    return after, (rows, kernel, bias, kept)


def _layer_backward(name: str, numbers: str, kept: tuple[Array, ...], gradient: Array):
    rows, kernel, bias, activated = kept
    if name == "relu":
        slope = jnp.where(activated > 0, gradient, 0).astype(rows.dtype)
    else:
        before = activated + _as_row(bias, activated)
        (slope,) = jax.vjp(ACTIVATION[name], before)[1](gradient.astype(before.dtype))
        slope = slope.astype(rows.dtype)
    return *_product_backward((rows, kernel), slope), _sum_of_rows(slope), None


_layer.defvjp(_layer_forward, _layer_backward)


@jax.custom_vjp
def product(
    rows: Float[Array, "*batch inputs"], kernel: Float[Array, "inputs outputs"]
) -> Float[Array, "*batch outputs"]:
    """Return rows @ kernel, in the rows' type."""
    return _rows_by(rows, kernel)


def _product_backward(kept: tuple[Array, Array], gradient: Array) -> tuple[Array, Array]:
    rows, kernel = kept
    batch = tuple(range(rows.ndim - 1))
    # In this order: JAX's own is its transpose, for which XLA:CPU turns the whole gradient round.
    of_kernel = jax.lax.dot_general(
        rows, gradient, ((batch, batch), ((), ())), preferred_element_type=kernel.dtype
    )
    return _rows_by(gradient, kernel.T), of_kernel


product.defvjp(lambda rows, kernel: (product(rows, kernel), (rows, kernel)), _product_backward)


def _rows_by(rows: Array, kernel: Array) -> Array:
    def by(sums: str, rows: Array, kernel: Array) -> Array:
        answer = jnp.matmul(rows, kernel.astype(rows.dtype), preferred_element_type=sums)
        return answer.astype(rows.dtype)

    return _by_platform(by, rows, kernel)


def _sum_of_rows(rows: Array) -> Array:
    """Return the sum over all but the last axis, float32."""

    def as_product(rows: Array) -> Array:
        # Of the same rows as the products beside it: a sum would have them once more, in float32.
        flat = rows.reshape(-1, rows.shape[-1])
        ones = jnp.ones((1, len(flat)), rows.dtype)
        return jnp.matmul(ones, flat, preferred_element_type=jnp.float32)[0]

    def plainly(rows: Array) -> Array:
        return jnp.sum(rows.astype(jnp.float32), axis=tuple(range(rows.ndim - 1)))

    return jax.lax.platform_dependent(rows, cpu=as_product, default=plainly)


def _by_platform(function: Callable[..., Any], rows: Array, *others: Array) -> Any:
    """Return function(type of sums, rows, *others).

    A processor's units for matrices sum bfloat16 in float32, and XLA:CPU uses them only where
    that is asked for; elsewhere sums that are kept are smaller in the rows' type.
    """
    return jax.lax.platform_dependent(
        rows,
        *others,
        cpu=partial(function, "float32"),
        default=partial(function, rows.dtype.name),
    )
