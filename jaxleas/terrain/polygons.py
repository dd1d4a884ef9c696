"""Checks on a polygon: whether it is convex and planar, its winding, and its plane."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.types import InputError

PLANARITY_TOLERANCE = 1e-3
"""Largest accepted distance of a vertex from the polygon's plane [m]."""
CONVEXITY_TOLERANCE = 1e-3
"""Largest accepted distance by which a vertex may lie on the wrong side of an edge [m]."""
VERTICAL_SLOPE = 1e-3
"""|z| of the unit normal below which a polygon is vertical, without a height above a point."""
STANDING_SLOPE = 0.5
"""Smallest z of a unit normal with which feet can stand on a polygon."""
MAX_VERTICES = 1000
"""Largest number of vertices of a polygon: checks compare each vertex with each edge."""
MIN_AREA = 1e-6
"""Area below which a polygon is degenerate [m^2]."""


def polygon_area_vector(vertices: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, " 3"]:
    """Return Newell's vector: along the right-hand normal, as long as the area [m^2]."""
    centred = vertices - vertices.mean(axis=0)
    return 0.5 * np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)


def is_vertical(vertices: Float[np.ndarray, "V 3"]) -> bool:
    """Return whether the polygon is a wall, without a height above any point of the plane."""
    area = polygon_area_vector(vertices)
    return bool(abs(area[2]) <= VERTICAL_SLOPE * np.linalg.norm(area))


def upwardness(vertices: Float[np.ndarray, "V 3"]) -> float:
    """Return the z of the unit normal: 1 for a floor, 0 for a wall, -1 for a ceiling."""
    x, y, z = (vertices - vertices.mean(axis=0)).T  # written out, because `np.cross` is slow
    u, v, w = np.roll(x, -1), np.roll(y, -1), np.roll(z, -1)
    area = y @ w - z @ v, z @ u - x @ w, x @ v - y @ u
    return float(area[2] / math.sqrt(area[0] ** 2 + area[1] ** 2 + area[2] ** 2))


def planarity_deviation(vertices: Float[np.ndarray, "V 3"]) -> float:
    """Return the largest distance of a vertex from the plane through the centroid [m]."""
    area = polygon_area_vector(vertices)
    normal = area / np.linalg.norm(area)
    return float(np.abs((vertices - vertices.mean(axis=0)) @ normal).max())


def convexity_deviation(vertices: Float[np.ndarray, "V 3"]) -> float:
    """Return the largest distance of a vertex outside an edge's half-plane [m]; 0 if convex."""
    area = polygon_area_vector(vertices)
    normal = area / np.linalg.norm(area)
    edges = np.roll(vertices, -1, axis=0) - vertices
    inward = np.cross(normal, edges)
    inward /= np.linalg.norm(inward, axis=1, keepdims=True)
    distance = np.einsum("ek,evk->ev", inward, vertices[None, :, :] - vertices[:, None, :])
    return float(max(0.0, -distance.min()))


def require_convex_polygon(vertices: Float[np.ndarray, "V 3"], where: str, wall: bool) -> None:
    """Refuse a polygon that is not planar, convex, and counter-clockwise seen from above.

    Args:
        vertices: corners in order [m].
        where: name of file and polygon, for the message.
        wall: whether a vertical polygon is accepted (a side face of an obstacle).

    Raises:
        InputError: the polygon fails a check; the message says which, and by how many metres.
    """
    require_any_orientation(vertices, where)
    if is_vertical(vertices):
        if not wall:
            raise InputError(
                f"{where} is vertical: nothing can stand on it; list it as an obstacle"
            )
    elif polygon_area_vector(vertices)[2] < 0.0:
        raise InputError(f"{where} is clockwise seen from above; reverse its vertices")


def require_any_orientation(vertices: Float[np.ndarray, "V 3"], where: str) -> None:
    """Refuse a polygon that is not planar and convex; it may have any orientation.

    Args:
        vertices: corners in order [m].
        where: name of file and polygon, for the message.

    Raises:
        InputError: the polygon fails a check; the message says which, and by how many metres.
    """
    if len(vertices) < 3:
        raise InputError(f"{where} has {len(vertices)} vertices; a polygon needs at least 3")
    require_few(vertices, where)
    if not np.isfinite(vertices).all():
        raise InputError(f"{where} has a coordinate that is not a finite number")
    gaps = np.linalg.norm(vertices[:, None, :] - vertices[None, :, :], axis=-1)
    if (gaps[np.triu_indices(len(vertices), 1)] < 1e-6).any():
        raise InputError(f"{where} repeats a vertex; list each corner once")
    if np.linalg.norm(polygon_area_vector(vertices)) < MIN_AREA:
        raise InputError(f"{where} is degenerate: its area is below {MIN_AREA:g} m^2")
    require_planar_and_convex(vertices, where)


def require_few(vertices: Float[np.ndarray, "V 3"], where: str) -> None:
    """Refuse a polygon with too many vertices to check against each other."""
    if len(vertices) > MAX_VERTICES:
        raise InputError(f"{where} has {len(vertices)} vertices, more than {MAX_VERTICES}")


def require_planar_and_convex(vertices: Float[np.ndarray, "V 3"], where: str) -> None:
    """Refuse a polygon that is not planar or not convex within the tolerances.

    Args:
        vertices: corners in order: at least three, finite, not all on one line [m].
        where: name of file and polygon, for the message.

    Raises:
        InputError: the polygon fails a check; the message says which, and by how many metres.
    """
    deviation = planarity_deviation(vertices)
    if deviation > PLANARITY_TOLERANCE:
        raise InputError(
            f"{where} is not planar: a vertex lies {deviation:.4g} m off its plane "
            f"(at most {PLANARITY_TOLERANCE:g} m is accepted)"
        )
    deviation = convexity_deviation(vertices)
    if deviation > CONVEXITY_TOLERANCE:
        raise InputError(
            f"{where} is not convex: a vertex lies {deviation:.4g} m outside an edge "
            f"(at most {CONVEXITY_TOLERANCE:g} m is accepted); cut it into convex parts"
        )


def box_faces(
    corners: Float[np.ndarray, "4 2"], bottom: float, top: float
) -> dict[str, Float[np.ndarray, "4 3"]]:
    """Return the top and the four side faces of an upright box, wound outwards.

    Args:
        corners: corners of the footprint, counter-clockwise seen from above [m].
        bottom: height of the box's foot [m].
        top: height of its top face [m].

    Returns:
        `{"top": ..., "side_0": ..., ..., "side_3": ...}`.
    """
    lift = lambda points, z: np.column_stack([points, np.full(len(points), z)])  # noqa: E731
    faces = {"top": lift(corners, top)}
    for side in range(4):
        edge = corners[[side, (side + 1) % 4]]
        faces[f"side_{side}"] = np.vstack([lift(edge, bottom), lift(edge[::-1], top)])
    return faces
