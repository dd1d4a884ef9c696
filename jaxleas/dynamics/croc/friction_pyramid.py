"""Faces of friction pyramids and of the largest normal force, as limits on one point's force."""

import math

from jaxtyping import Float

from jaxleas.dynamics.croc.curves import cross_product, namespace
from jaxleas.dynamics.croc.transitions import Numbers, Supports

_DEGENERATE = 1e-4  # a tangent shorter than this has no direction


def force_faces(
    supports: Supports, friction: Float[Numbers, "*batch"], generators: int
) -> Float[Numbers, "*batch S P F 3"]:
    """Return inward unit normals of each point's limits: face . force >= 0, and the last, -normal.

    The pyramid has its edges at (2 k + 1) pi / K from the contact's first axis, on the cone, like
    `friction_generators`; its faces lie at 2 k pi / K, with the friction mu cos(pi / K).

    Args:
        supports: contact points.
        friction: friction coefficient mu [1].
        generators: number K of edges and of faces.
    """
    xp = namespace(supports.normals)
    normals = supports.normals
    first = _first_tangent(normals, supports.ahead)
    second = cross_product(normals, first)
    mu = (friction * math.cos(math.pi / generators))[..., None, None, None]
    length = xp.sqrt(1.0 + mu * mu)
    faces = []
    for k in range(generators):
        angle = 2.0 * math.pi * k / generators
        faces.append((mu * normals - math.cos(angle) * first - math.sin(angle) * second) / length)
    return xp.stack([*faces, -normals], axis=-2)


def _first_tangent(normals: Numbers, ahead: Numbers) -> Numbers:
    """Return the first axis along the surface: of the contact, or n x e_y, or n x e_x."""
    xp = namespace(normals)
    x, y, z = normals[..., 0], normals[..., 1], normals[..., 2]
    zero = xp.zeros_like(x)
    tangent = xp.stack([zero, z, -y], axis=-1)  # n x e_x
    for better in (
        xp.stack([-z, zero, x], axis=-1),  # n x e_y
        ahead - (ahead * normals).sum(axis=-1)[..., None] * normals,
    ):
        is_usable = (better * better).sum(axis=-1) >= _DEGENERATE**2
        tangent = xp.where(is_usable[..., None], better, tangent)
    length = xp.sqrt((tangent * tangent).sum(axis=-1))
    return tangent / xp.where(length > 0.0, length, 1.0)[..., None]  # padding has no normal
