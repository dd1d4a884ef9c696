"""Coplanar neighbours of a mesh merged into convex polygons (Hertel and Mehlhorn)."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import area_vectors
from jaxleas.terrain.polygons import (
    CONVEXITY_TOLERANCE,
    PLANARITY_TOLERANCE,
    convexity_deviation,
    planarity_deviation,
)

COPLANAR = 1e-6
"""Neighbours are coplanar if 1 - cosine of the angle between their normals is below this."""
STRAIGHT = 1e-6
"""Sine of the angle of a corner up to which it lies on a straight side."""


def merged(
    points: Float[np.ndarray, "P 3"], triangles: Int[np.ndarray, "N 3"]
) -> list[Float[np.ndarray, "V 3"]]:
    """Return convex polygons: both sides of each shared edge are merged if the union is convex.

    Args:
        points: vertices [m].
        triangles: corners of each triangle.
    """
    faces, edges = _coplanar_pairs(points, triangles)
    loops: dict[int, list[int] | None] = {
        face: triangles[face].tolist() for face in np.unique(faces).tolist()
    }
    owner: dict[int, int] = {}
    for (face, other), (a, b) in zip(faces.tolist(), edges.tolist(), strict=True):
        left, right = _root(owner, face), _root(owner, other)
        union = None if left == right else _joined(points, loops[left], loops[right], (a, b))
        if union is not None:
            loops[left], loops[right], owner[right] = union, None, left
    alone = _has_corners(points[triangles])
    return [
        points[_without_flat_corners(points, loops[face] or [])]
        if face in loops
        else points[corners]
        for face, corners in enumerate(triangles)
        if (loops[face] is not None if face in loops else alone[face])
    ]


def _coplanar_pairs(
    points: Float[np.ndarray, "P 3"], triangles: Int[np.ndarray, "N 3"]
) -> tuple[Int[np.ndarray, "E 2"], Int[np.ndarray, "E 2"]]:
    """Return coplanar triangles on both sides of an edge, and its ends, from the smaller number.

    Of several triangles that have an edge in one direction the first counts. Edges are in the
    order in which the first triangle of each pair lists them.
    """
    area = area_vectors(points[triangles])
    normals = area / np.maximum(np.linalg.norm(area, axis=1, keepdims=True), 1e-12)
    start, end = triangles.reshape(-1), np.roll(triangles, -1, axis=1).reshape(-1)
    many = len(points)
    key, side = np.unique(start.astype(np.int64) * many + end, return_index=True)
    ahead = start[side] < end[side]
    back = end[side[ahead]].astype(np.int64) * many + start[side[ahead]]
    at = np.minimum(np.searchsorted(key, back), len(key) - 1)
    both = key[at] == back
    one, two = side[ahead][both], side[at[both]]
    flat = 1.0 - np.einsum("ek,ek->e", normals[one // 3], normals[two // 3]) <= COPLANAR
    order = np.argsort(one[flat], kind="stable")
    one, two = one[flat][order], two[flat][order]
    return np.stack([one // 3, two // 3], axis=1), np.stack([start[one], end[one]], axis=1)


def _joined(
    points: np.ndarray, left: list[int] | None, right: list[int] | None, edge: tuple[int, int]
) -> list[int] | None:
    """Return the union of two loops that share an edge, if it is planar and convex."""
    assert left is not None
    assert right is not None
    ends = _rotated_to(left, edge[1]), _rotated_to(right, edge[0])
    if ends[0] is None or ends[1] is None or ends[0][-1] != edge[0] or ends[1][-1] != edge[1]:
        return None
    loop = _without_spurs(ends[0] + ends[1][1:-1])
    if len(set(loop)) != len(loop) or len(loop) < 3:
        return None
    vertices = points[loop]
    planar = planarity_deviation(vertices) <= 0.1 * PLANARITY_TOLERANCE
    convex = planar and convexity_deviation(vertices) <= 0.1 * CONVEXITY_TOLERANCE
    return loop if convex else None


def _rotated_to(loop: list[int], first: int) -> list[int] | None:
    if first not in loop:
        return None
    start = loop.index(first)
    return loop[start:] + loop[:start]


def _without_spurs(loop: list[int]) -> list[int]:
    """Drop paths that go out along an edge and straight back: the seams of two merged loops."""
    index = 0
    while len(loop) > 2 and index < len(loop):
        if loop[index - 1] == loop[(index + 1) % len(loop)]:
            following = (index + 1) % len(loop)
            loop = [v for at, v in enumerate(loop) if at not in (index, following)]
            index = 0
        else:
            index += 1
    return loop


def _without_flat_corners(points: np.ndarray, loop: list[int]) -> list[int]:
    """Drop vertices in the middle of a straight side."""
    vertices = points[loop]
    before, after = (
        vertices - np.roll(vertices, 1, axis=0),
        np.roll(vertices, -1, axis=0) - vertices,
    )
    bend = np.linalg.norm(np.cross(before, after), axis=1)
    length = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    return [vertex for vertex, keep in zip(loop, bend > STRAIGHT * length, strict=True) if keep]


def _has_corners(triangles: Float[np.ndarray, "N 3 3"]) -> Bool[np.ndarray, " N"]:
    """Return which triangles have three corners, none of them on a straight side."""
    sides = np.roll(triangles, -1, axis=1) - triangles
    length = np.linalg.norm(sides, axis=2)
    double = 2.0 * np.linalg.norm(area_vectors(triangles), axis=1)
    return (double[:, None] > STRAIGHT * length * np.roll(length, -1, axis=1)).all(axis=1)


def _root(owner: dict[int, int], face: int) -> int:
    while face in owner:
        owner[face] = owner.get(owner[face], owner[face])
        face = owner[face]
    return face
