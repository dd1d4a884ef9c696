"""The soles of a posture computed the slow way: one corner, one edge after the other."""

import math

import numpy as np
from jaxtyping import Float


def foot_rotation(normal: Float[np.ndarray, " 3"], yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation with the normal as third column, whose first column heads along yaw."""
    ahead = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    ahead[2] = -(normal[:2] @ ahead[:2]) / normal[2]
    ahead /= math.sqrt(float(ahead @ ahead))
    return np.column_stack([ahead, np.cross(normal, ahead), normal])


def normal_of(polygon: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, " 3"]:
    """Return the unit normal, which points upwards."""
    arms = polygon[1:] - polygon[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(axis=0)
    return normal * math.copysign(1.0, normal[2]) / math.sqrt(float(normal @ normal))


def beyond_edges(polygon: np.ndarray, normal: np.ndarray, point: np.ndarray) -> float:
    """Return how far a point is outside the polygon's worst edge [m]; negative inside."""
    outward = np.cross(np.roll(polygon, -1, axis=0) - polygon, normal)
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    return float(((point - polygon) * outward).sum(axis=1).max())


def over_surface(
    polygon: np.ndarray,
    normal: np.ndarray,
    sole: np.ndarray,
    rotation: np.ndarray,
    arms: np.ndarray,
) -> np.ndarray:
    """Return the sole's corners, each moved towards the middle until it is over the surface."""
    corners = []
    for arm in arms:
        reach, share = rotation @ arm, 1.0
        for here, there in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
            outward = np.cross(there - here, normal)
            room, speed = float(outward @ (here - sole)), float(outward @ reach)
            if speed > 1e-12 * np.linalg.norm(outward):
                share = min(share, max(room, 0.0) / speed)
        corners.append(sole + share * reach)
    return np.array(corners)
