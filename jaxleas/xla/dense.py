"""Dense layers with hand-written gradients; `plain_dense` is their twin.

XLA:CPU uses a processor's matrix units only on request, transposes whole gradients if a product has
an unlucky order, and sums rows once more in float32. Here each product is written in the order that
XLA:CPU computes fastest.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.xla.compute_once import compute_once

Activation = Callable[[Array], Array]
Layers = Sequence[tuple[Array, Array]]
"""Kernel [inputs, outputs] and bias [outputs] of each layer."""


def plain_dense(
    layers: Layers, rows: Float[Array, "*batch inputs"], activation: Activation
) -> Float[Array, "*batch outputs"]:
    """Return the output of dense layers, in the number type of the weights, by the plain formula.

    Args:
        layers: kernel and bias of each layer.
        rows: inputs of the first layer.
        activation: function between two layers.
    """
    for index, (kernel, bias) in enumerate(layers):
        rows = rows @ kernel + _as_row(bias, rows)
        if index < len(layers) - 1:
            rows = activation(rows)
    return rows


def dense(
    layers: Layers,
    rows: Float[Array, "*batch inputs"],
    activation: Activation,
    numbers: str = "float32",
) -> Float[Array, "*batch outputs"]:
    """Return the output of dense layers, float32.

    Args:
        layers: kernel and bias of each layer.
        rows: inputs of the first layer.
        activation: function between two layers.
        numbers: number type in which products are computed; those of the last layer are float32.
    """
    *inner, (kernel, bias) = layers
    types = [numbers] * (len(inner) - 1) + ["float32"]
    rows = rows.astype(numbers if inner else "float32")
    for (inner_kernel, inner_bias), kind in zip(inner, types, strict=False):
        rows = _layer(activation, kind, rows, inner_kernel, inner_bias)
    return product(rows, kernel) + _as_row(bias, rows)


def _as_row(bias: Array, rows: Array) -> Array:
    return bias.reshape((1,) * (rows.ndim - 1) + bias.shape)


@partial(jax.custom_vjp, nondiff_argnums=(0, 1))
def _layer(activation: Activation, numbers: str, rows: Array, kernel: Array, bias: Array) -> Array:
    """Return activation(rows @ kernel + bias), in the number type of the next product."""
    return _answer(activation, numbers, rows, kernel, bias, _plainly)[0]


def _plainly(function: Callable[..., Array], *operands: Array) -> Array:
    return function(*operands)


def _answer(
    activation: Activation,
    numbers: str,
    rows: Array,
    kernel: Array,
    bias: Array,
    compute: Callable[..., Array],
) -> tuple[Array, Array]:
    """Return a layer's output, and what its gradient needs: that or the activation's input."""

    def activate(before: Array, bias: Array) -> Array:
        return activation(before + _as_row(bias, before)).astype(numbers)

    def answer(sums: str, rows: Array, kernel: Array, bias: Array) -> tuple[Array, Array]:
        before = jnp.matmul(rows, kernel.astype(rows.dtype), preferred_element_type=sums)
        after = compute(activate, before, bias)
        return after, after if _is_relu(activation) else before.astype(rows.dtype)

    return _by_platform(answer, rows, kernel, bias)


def _is_relu(activation: Activation) -> bool:
    return activation is jax.nn.relu


def _layer_forward(activation: Activation, numbers: str, rows: Array, kernel: Array, bias: Array):
    # Activations apart: the gradient's products need them as they are and transposed.
    after, kept = _answer(activation, numbers, rows, kernel, bias, compute_once)
    return after, (rows, kernel, bias, kept)


def _layer_backward(activation: Activation, numbers: str, kept: tuple[Array, ...], gradient: Array):
    rows, kernel, bias, activated = kept
    if _is_relu(activation):
        slope = jnp.where(activated > 0, gradient, 0).astype(rows.dtype)
    else:
        before = activated + _as_row(bias, activated)
        (slope,) = jax.vjp(activation, before)[1](gradient.astype(before.dtype))
        slope = slope.astype(rows.dtype)
    return *_product_backward((rows, kernel), slope), _sum_of_rows(slope)


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
    # In this order: JAX computes the transpose, for which XLA:CPU transposes the whole gradient.
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
    """Return the sum over all axes except the last, float32."""

    def as_product(rows: Array) -> Array:
        # A product, of the same rows as other products: a sum would copy them again, in float32.
        flat = rows.reshape(-1, rows.shape[-1])
        ones = jnp.ones((1, len(flat)), rows.dtype)
        return jnp.matmul(ones, flat, preferred_element_type=jnp.float32)[0]

    def plainly(rows: Array) -> Array:
        return jnp.sum(rows.astype(jnp.float32), axis=tuple(range(rows.ndim - 1)))

    return jax.lax.platform_dependent(rows, cpu=as_product, default=plainly)


def _by_platform(function: Callable[..., Any], rows: Array, *others: Array) -> Any:
    """Return function(type of sums, rows, *others).

    A processor's matrix units sum bfloat16 in float32, and XLA:CPU uses them only if that type is
    requested; on other devices stored sums take less memory in the rows' type.
    """
    return jax.lax.platform_dependent(
        rows,
        *others,
        cpu=partial(function, "float32"),
        default=partial(function, rows.dtype.name),
    )
