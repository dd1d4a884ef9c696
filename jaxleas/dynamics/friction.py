"""Friction cones as four generators a contact point."""

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics.vectors import cross

GENERATORS = 4
_ANGLES = np.pi / 4 + np.arange(GENERATORS) * np.pi / 2


def friction_generators(
    normals: Float[np.ndarray, "*batch P 3"], friction: float
) -> Float[np.ndarray, "*batch P 4 3"]:
    """Return unit generators of each point's friction cone, linearised from inside.

    g_k = (n + mu (cos a_k t1 + sin a_k t2)) / sqrt(1 + mu^2), a_k = pi/4 + k pi/2, with
    t1 = n x e_y (n x e_x where that vanishes), t2 = n x t1.

    Args:
        normals: unit contact normals, pointing away from the ground.
        friction: mu [1].
    """
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    zero = np.zeros_like(x)
    across = np.stack([-z, zero, x], axis=-1)  # n x e_y
    length = np.sqrt(x * x + z * z)
    degenerate = length < 1e-4
    if degenerate.any():
        other = np.stack([zero, z, -y], axis=-1)  # n x e_x
        across = np.where(degenerate[..., None], other, across)
        length = np.where(degenerate, np.sqrt(y * y + z * z), length)
    first = across / length[..., None]
    second = cross(normals, first)
    tangent = (
        np.cos(_ANGLES)[:, None] * first[..., None, :]
        + np.sin(_ANGLES)[:, None] * second[..., None, :]
    )
    return (normals[..., None, :] + friction * tangent) / np.sqrt(1.0 + friction * friction)


def margin_of_generator(friction: float) -> float:
    """Return the force [N] by which the cone's faces recede for each newton on its generators.

    |(sum_j g_j) x g_1| = 4 mu / (1 + mu^2) over the four generators of one contact point.
    """
    return 4.0 * friction / (1.0 + friction * friction)
