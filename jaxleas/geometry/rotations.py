"""Rotations of vectors about the vertical, the only ones that an upright root needs (T 3.3.1)."""

from functools import reduce

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.xla import sine_cosine


def rotate_by_yaw(vector: Float[Array, "*batch D"], yaw: Float[Array, "*batch"]) -> Array:
    """Turn one vector per robot about the vertical: x' = x cos - y sin, y' = x sin + y cos.

    Args:
        vector: vector of two or three components [any unit]; a third component is kept.
        yaw: angle of rotation, counter-clockwise seen from above [rad].

    Returns:
        The turned vector, of the same shape.
    """
    sine, cosine = sine_cosine(yaw)
    x, y = vector[..., 0], vector[..., 1]
    turned = jnp.stack([x * cosine - y * sine, x * sine + y * cosine], axis=-1)
    return jnp.concatenate([turned, vector[..., 2:]], axis=-1)


def rotate_to_world(
    vector_in_root: Float[Array, "*batch N D"], yaw: Float[Array, "*batch"]
) -> Float[Array, "*batch N D"]:
    """Turn N vectors per robot from the root's heading into the world's axes.

    Args:
        vector_in_root: N vectors of two or three components [any unit].
        yaw: heading of the root [rad].

    Returns:
        The vectors along the world's axes, of the same shape.
    """
    return rotate_by_yaw(vector_in_root, yaw[..., None])


def rotate_to_root(
    vector: Float[Array, "*batch N D"], yaw: Float[Array, "*batch"]
) -> Float[Array, "*batch N D"]:
    """Turn N vectors per robot from the world's axes into the root's heading.

    Args:
        vector: N vectors along the world's axes, of two or three components [any unit].
        yaw: heading of the root [rad].

    Returns:
        The vectors along the root's axes, of the same shape.
    """
    return rotate_by_yaw(vector, -yaw[..., None])


def squared_length(vector: Float[Array, "*batch D"]) -> Float[Array, "*batch"]:
    """Return the squared length of one vector per robot [its unit squared]."""
    # Written out, because XLA:CPU calls a library for a sum over three numbers, which is slow.
    components = [vector[..., axis] for axis in range(vector.shape[-1])]
    return reduce(lambda total, each: total + each * each, components[1:], components[0] ** 2)


def wrap_angle(angle: Float[Array, "*batch"]) -> Float[Array, "*batch"]:
    """Wrap an angle [rad] into [-pi, pi)."""
    # Not the remainder: XLA:CPU calls a function of the C library for each one.
    wrapped = angle - 2 * jnp.pi * jnp.floor((angle + jnp.pi) / (2 * jnp.pi))
    # Rounding may leave the result just outside, on either side.
    return jnp.where(wrapped >= jnp.pi, -jnp.pi, jnp.maximum(wrapped, -jnp.pi))


def bound_norm(vector: Float[Array, "*batch D"], limit: float) -> Float[Array, "*batch D"]:
    """Shorten vectors that are longer than `limit`; leave the others alone."""
    square = squared_length(vector)[..., None]
    # rsqrt of at least limit^2: no division by zero, no branch, finite derivatives at zero.
    return vector * (limit / jnp.sqrt(jnp.maximum(square, limit * limit)))


def wrap_angle_on_host(angle: Float[np.ndarray, "*batch"] | float) -> Float[np.ndarray, "*batch"]:
    """Wrap an angle [rad] into [-pi, pi), as `wrap_angle` does, in NumPy and double precision."""
    wrapped = (np.asarray(angle, np.float64) + np.pi) % (2.0 * np.pi) - np.pi
    return np.where(wrapped >= np.pi, -np.pi, wrapped)  # rounding may leave the result just outside
