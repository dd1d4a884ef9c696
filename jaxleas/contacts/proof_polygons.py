"""Arithmetic on convex polygons in space, to verify proofs; shares no code with the planners."""

import numpy as np
from jaxtyping import Float

_APART = 1e-6  # boxes further apart than a step by this are out of reach [m]
_SAME = 1e-12  # corners nearer than this are one [m]


def half_spaces(
    vertices: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, " 3"]
) -> tuple[Float[np.ndarray, "m 3"], Float[np.ndarray, " m"]]:
    """Return half-spaces whose intersection with the polygon's plane is the polygon.

    Args:
        vertices: corners of a convex polygon, a segment or a point, in order [m].
        normal: unit normal of its plane.
    """
    along = np.roll(vertices, -1, axis=0) - vertices
    length = np.sqrt((along * along).sum(axis=1))
    along = along[length > _SAME] / length[length > _SAME, None]
    if len(along) < 3:  # a segment or a point: no edges to speak of
        first = along[0] if len(along) else _across(normal)
        axes = np.stack([first, np.cross(normal, first)])
        outward = np.concatenate([axes, -axes])
    else:
        outward = np.cross(along, normal)
        if _is_clockwise(vertices, normal):
            outward = -outward
    return outward, (vertices @ outward.T).max(axis=0)


def stick_out(
    points: Float[np.ndarray, "n 3"],
    normals: Float[np.ndarray, "m 3"],
    bounds: Float[np.ndarray, " m"],
) -> float:
    """Return how far the furthest of some points is beyond half-spaces [m]."""
    return float((points @ normals.T - bounds).max())


def dent(vertices: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, " 3"]) -> float:
    """Return how far corners in order are from being those of a convex polygon [m]."""
    if len(vertices) < 3:
        return 0.0
    along = np.roll(vertices, -1, axis=0) - vertices
    length = np.sqrt((along * along).sum(axis=1))
    outward = np.cross(along, normal) / np.maximum(length, _SAME)[:, None]
    if _is_clockwise(vertices, normal):
        outward = -outward
    beyond = (vertices[:, None] - vertices[None]) @ outward.T
    return float(np.einsum("vee->ve", beyond).max())


def off_plane(corners: Float[np.ndarray, "n 3"], points: Float[np.ndarray, "m 3"]) -> float:
    """Return how far the furthest of some points is from the plane of a polygon [m]."""
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normal = normal / np.sqrt(normal @ normal)
    return float(np.abs((points - corners.mean(axis=0)) @ normal).max())


def far_apart(
    standing: Float[np.ndarray, "n 3"],
    landing: Float[np.ndarray, "m 3"],
    reach: Float[np.ndarray, "2 3"],
) -> bool:
    """Return whether no displacement of a box leads from one polygon to another.

    Args:
        standing: corners of the one [m].
        landing: corners of the other [m].
        reach: least and greatest coordinates of the displacements [m].
    """
    low = standing.min(axis=0) + reach[0] - _APART
    high = standing.max(axis=0) + reach[1] + _APART
    return bool((landing.min(axis=0) > high).any() or (landing.max(axis=0) < low).any())


def _is_clockwise(vertices: np.ndarray, normal: np.ndarray) -> bool:
    arms = vertices[1:] - vertices[0]
    return bool(np.cross(arms[:-1], arms[1:]).sum(axis=0) @ normal < 0.0)


def _across(normal: np.ndarray) -> np.ndarray:
    """Return a unit vector in the plane."""
    axis = np.eye(3)[int(np.abs(normal).argmin())]
    across = axis - (axis @ normal) * normal
    return across / np.sqrt(across @ across)
