"""The part of a convex polygon that lies inside a convex polytope."""

import numpy as np
from jaxtyping import Float

from jaxleas.geometry.polytopes import Polytope

_CUTS = 1e-9  # a face that cuts away less than this [m] cuts nothing
_SAME_POINT = 1e-6  # corners closer than this [m] are merged


def clip_polygon(
    vertices: Float[np.ndarray, "V 3"], polytope: Polytope
) -> Float[np.ndarray, "W 3"]:
    """Return the corners of the part inside, in the same winding (Sutherland and Hodgman 1974).

    Args:
        vertices: corners of a convex planar polygon, in the polytope's frame [m].
        polytope: convex polytope.

    Returns:
        `vertices` itself if the whole polygon is inside; fewer than three rows if almost nothing
        is.
    """
    excess = vertices @ polytope.normals.T - polytope.offsets
    cutting = np.flatnonzero((excess > _CUTS).any(axis=0))
    if not len(cutting):
        return vertices
    clipped = vertices
    for face in cutting:
        clipped = _clip(clipped, polytope.normals[face], float(polytope.offsets[face]))
        if not len(clipped):
            return clipped
    apart = np.linalg.norm(clipped - np.roll(clipped, 1, axis=0), axis=1) > _SAME_POINT
    return clipped[apart]


def _clip(vertices: np.ndarray, normal: np.ndarray, offset: float) -> np.ndarray:
    """Return the part of a polygon on the inner side of one face."""
    excess = vertices @ normal - offset
    kept = []
    for index, here in enumerate(excess):
        before = excess[index - 1]
        if (before > 0.0) != (here > 0.0):
            share = before / (before - here)
            kept.append((1.0 - share) * vertices[index - 1] + share * vertices[index])
        if here <= 0.0:
            kept.append(vertices[index])
    return np.array(kept).reshape(-1, 3)
