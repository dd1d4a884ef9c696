"""Friction cones, linearised from inside by a few generators per contact point."""

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics.contact_points import ContactPoints
from jaxleas.dynamics.vectors import cross

GENERATORS = 4


def friction_generators(
    normals: Float[np.ndarray, "*batch P 3"],
    friction: float | Float[np.ndarray, "*#batch P"],
    ahead: Float[np.ndarray, "*batch P 3"] | None = None,
    count: int = GENERATORS,
) -> Float[np.ndarray, "*batch P K 3"]:
    """Return unit generators of each point's friction cone, linearised from inside.

    g_k = (n + mu (cos a_k t1 + sin a_k t2)) / sqrt(1 + mu^2), a_k = (2 k + 1) pi / K, where t1 is
    `ahead` made perpendicular to n, or n x e_y without it (n x e_x where that vanishes), and
    t2 = n x t1.

    Args:
        normals: unit contact normals, pointing away from the surface.
        friction: friction coefficient mu [1].
        ahead: first axis of each point's contact, with which the generators turn.
        count: number K of generators per point.
    """
    first = _tangents(normals, ahead)
    second = cross(normals, first)
    angles = np.pi / count + np.arange(count) * (2.0 * np.pi / count)
    tangent = (
        np.cos(angles)[:, None] * first[..., None, :]
        + np.sin(angles)[:, None] * second[..., None, :]
    )
    mu = np.asarray(friction, dtype=np.float64)[..., None, None]
    return (normals[..., None, :] + mu * tangent) / np.sqrt(1.0 + mu * mu)


def margin_of_generator(contacts: ContactPoints) -> float | Float[np.ndarray, "*batch"]:
    """Return the force [N] by which the cone's faces recede for each newton on its generators.

    |(sum_j g_j) x g_1| = K mu / (1 + mu^2) over the K generators of one contact point; the smallest
    value if friction differs between points.
    """
    mu = np.asarray(contacts.friction, dtype=np.float64)
    margin = contacts.generators * mu / (1.0 + mu * mu)
    return float(margin) if not margin.ndim else margin.min(axis=-1)


def _tangents(normals: np.ndarray, ahead: np.ndarray | None) -> np.ndarray:
    if ahead is not None:
        across = ahead - (ahead * normals).sum(axis=-1, keepdims=True) * normals
        length = np.linalg.norm(across, axis=-1)
        if (length >= 1e-4).all():
            return across / length[..., None]
        # Headings along the normal have no tangent part: there the world's axes are used.
        safe = np.where(length[..., None] >= 1e-4, across, _tangents(normals, None))
        return safe / np.linalg.norm(safe, axis=-1, keepdims=True)
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    zero = np.zeros_like(x)
    across = np.stack([-z, zero, x], axis=-1)  # n x e_y
    length = np.sqrt(x * x + z * z)
    degenerate = length < 1e-4
    if degenerate.any():
        other = np.stack([zero, z, -y], axis=-1)  # n x e_x
        across = np.where(degenerate[..., None], other, across)
        length = np.where(degenerate, np.sqrt(y * y + z * z), length)
    return across / length[..., None]
