"""Boxes and other convex solids as triangles, wound outwards."""

import numpy as np
from jaxtyping import Float

_CORNERS = np.array(
    [[x, y, z] for z in (-1.0, 1.0) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
)
_QUADS = np.array(
    [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
)
ROUND = 24
"""Number of sides that stand for a circle."""


def box_triangles(
    half_sizes: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "12 3 3"]:
    """Return the triangles of a box around the origin.

    Args:
        half_sizes: half of its edges along x, y and z [m].
    """
    corners = _CORNERS * half_sizes
    return corners[np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]])]


def hull_triangles(points: Float[np.ndarray, "P 3"]) -> Float[np.ndarray, "N 3 3"]:
    """Return the triangles of the convex hull of points."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(points)
    triangles = points[hull.simplices]
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    inward = np.einsum("nk,nk->n", normal, hull.equations[:, :3]) < 0.0
    return np.where(inward[:, None, None], triangles[:, ::-1], triangles)


def cylinder_triangles(radius: float, half_length: float) -> Float[np.ndarray, "N 3 3"]:
    """Return a prism inside an upright cylinder around the origin."""
    angle = 2.0 * np.pi * np.arange(ROUND) / ROUND
    ring = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    return hull_triangles(
        np.concatenate([np.insert(ring, 2, z, axis=1) for z in (-half_length, half_length)])
    )


def round_triangles(
    half_sizes: Float[np.ndarray, " 3"], half_length: float = 0.0
) -> Float[np.ndarray, "N 3 3"]:
    """Return a polyhedron inside an ellipsoid, or inside a capsule of some length along z."""
    azimuth = 2.0 * np.pi * np.arange(ROUND) / ROUND
    height = np.pi * (np.arange(ROUND // 2 + 1) / (ROUND // 2) - 0.5)
    across = np.cos(height)[:, None] * np.stack([np.cos(azimuth), np.sin(azimuth)])[:, None]
    up = np.broadcast_to(np.sin(height)[:, None], across[0].shape)
    ball = np.stack([*across, up], axis=-1).reshape(-1, 3) * half_sizes
    shift = np.sign(np.round(ball[:, 2:], 12)) * [0.0, 0.0, half_length]
    return hull_triangles(np.unique(np.round(ball + shift, 12), axis=0))


def placed(
    triangles: Float[np.ndarray, "N 3 3"],
    rotation: Float[np.ndarray, "3 3"],
    position: Float[np.ndarray, " 3"],
) -> Float[np.ndarray, "N 3 3"]:
    """Return triangles turned about the origin, then moved."""
    return triangles @ rotation.T + position
