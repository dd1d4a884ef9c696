"""Coplanar neighbours of a mesh merged into convex polygons."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import area_vectors, lengths
from jaxleas.terrain.meshes.deviations import convexity_deviations, planarity_deviations
from jaxleas.terrain.meshes.half_edges import HalfEdges, facing_sides
from jaxleas.terrain.meshes.merging import merge
from jaxleas.terrain.polygons import CONVEXITY_TOLERANCE, PLANARITY_TOLERANCE

COPLANAR = (1e-6, 1e-8, 1e-10)
"""Neighbours are coplanar if 1 - cosine of the angle between their normals is below this.
A stricter value is tried where small angles add up, and the merged faces would lie on no plane."""
OFF_PLANE = 0.1 * PLANARITY_TOLERANCE
"""Distance from their plane up to which faces lie on it [m]."""
SLACK = 1e-5
"""Distance of a corner from the line between its neighbours up to which a side is straight [m]:
about the last digit of a 32-bit number some 100 m from the origin."""
LENGTHS = 4
"""Number of classes of edge lengths per doubling of the length."""
DIRECTIONS = 64
"""Number of steps in which a coordinate of a direction is told apart; below 128."""
SHORTEST = 63
"""Number of such lengths, above and below a metre, that are told apart."""
STRAIGHT = 1e-6
"""Sine of the angle of a corner up to which it lies on a straight side of a triangle."""


class Merged(NamedTuple):
    """Faces of a mesh.

    Attributes:
        polygons: convex polygons that stand for several triangles each [m].
        triangles: the triangles that stay alone [m].
    """

    polygons: list[Float[np.ndarray, "V 3"]]
    triangles: Float[np.ndarray, "N 3 3"]


def merged(points: Float[np.ndarray, "P 3"], triangles: Int[np.ndarray, "N 3"]) -> Merged:
    """Return convex polygons: faces on both sides of an edge are merged if the union is convex.

    Of several triangles that have an edge in one direction the first counts.

    Args:
        points: vertices [m].
        triangles: corners of each triangle.
    """
    area = area_vectors(points[triangles])
    size = lengths(area)
    normals = area / np.maximum(size, 1e-12)[:, None]
    pairs, plane = _on_planes(points, triangles, area, normals)
    alone = np.ones(len(triangles), bool)
    alone[pairs // 3] = False
    some = np.flatnonzero(~alone)
    alone &= _has_corners(points[triangles], size)
    index = np.zeros(len(triangles), np.int32)
    index[some] = np.arange(len(some))
    pairs = index[pairs // 3] * 3 + pairs % 3
    plane = plane[some]
    del area, normals  # of a large mesh much memory
    polygons, failed = _polygons(points, triangles[some], plane, pairs, size[some])
    alone[some[failed]] = True
    return Merged(polygons, points[triangles[alone]])


def _polygons(
    points: Float[np.ndarray, "P 3"],
    triangles: Int[np.ndarray, "T 3"],
    normals: Float[np.ndarray, "T 3"],
    pairs: Int[np.ndarray, "E 2"],
    size: Float[np.ndarray, " T"],
) -> tuple[list[np.ndarray], Bool[np.ndarray, " T"]]:
    """Return merged faces, and which triangles would make one that is no convex polygon.

    A polygon is convex, on a plane, and as large as its triangles together.
    """
    borders = HalfEdges(triangles, pairs)
    leader = merge(points, borders, normals, _in_order(points, borders, pairs[:, 0]), SLACK)
    borders.simplify(points, SLACK)
    sides = np.flatnonzero(borders.alive)
    face, at = np.unique(leader[sides // 3], return_index=True)
    vertices, counts = borders.loops(sides[at])
    begin = np.cumsum(counts) - counts
    good, whole = np.zeros(len(face), bool), np.bincount(leader, size)[face]
    for count in np.unique(counts[counts >= 3]):
        members = np.flatnonzero(counts == count)
        corners = points[vertices[begin[members, None] + np.arange(count)]]
        around = lengths(corners - np.roll(corners, -1, axis=1)).sum(axis=1)
        differ = np.abs(lengths(area_vectors(corners)) - whole[members])
        good[members] = (planarity_deviations(corners) <= OFF_PLANE) & (
            convexity_deviations(corners) <= 0.1 * CONVEXITY_TOLERANCE
        )
        good[members] &= differ <= OFF_PLANE * around
    corners = points[vertices]
    ends = zip(begin[good].tolist(), (begin + counts)[good].tolist(), strict=True)
    bad = np.ones(len(triangles), bool)
    bad[face[good]] = False
    return [corners[start:stop] for start, stop in ends], bad[leader]


def _in_order(
    points: Float[np.ndarray, "P 3"], borders: HalfEdges, sides: Int[np.ndarray, " E"]
) -> Int[np.ndarray, " E"]:
    """Return sides by length, the longest first, and of about the same length by direction.

    So a grid becomes rows first and then one rectangle. Among parallels the order is random: in
    their own order those of a row would be asked one after another, not many at once.
    """
    ways = points[borders.end[sides]] - points[borders.origin[sides]]
    length = np.maximum(lengths(ways), 1e-12)
    size = np.clip(np.floor(np.log2(length) * LENGTHS), -SHORTEST, SHORTEST)
    ways = np.round(ways / length[:, None] * DIRECTIONS).astype(np.int64) @ [2**16, 2**8, 1]
    chance = np.random.default_rng(0).integers(2**31, size=len(sides))
    place = np.abs(ways) + 2**24 * (SHORTEST - size).astype(np.int64)  # as digits, for one sort
    return sides[np.argsort(2**31 * place + chance)]


def _on_planes(
    points: Float[np.ndarray, "P 3"],
    triangles: Int[np.ndarray, "N 3"],
    area: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
) -> tuple[Int[np.ndarray, "E 2"], Float[np.ndarray, "N 3"]]:
    """Return facing sides of triangles that, with all that hang together, lie on a plane.

    Returns:
        Pairs of sides, and the normal of the plane of each triangle.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    plane, kept = normals.copy(), []
    pairs = facing_sides(triangles)
    for limit in COPLANAR:
        one, two = pairs.T // 3
        pairs = pairs[1.0 - np.einsum("ek,ek->e", normals[one], normals[two]) <= limit]
        if not len(pairs):
            break
        index = np.zeros(len(triangles), np.int32)
        index[pairs // 3] = 1
        some = np.flatnonzero(index)
        index[some] = np.arange(len(some))
        one, two = index[pairs.T // 3]
        graph = coo_array((np.ones(len(one), np.int8), (one, two)), shape=(len(some),) * 2)
        count, label = connected_components(graph, directed=False)
        normal, off = _plane_of(points[triangles[some]], area[some], label, count)
        good = off <= OFF_PLANE
        plane[some] = normal[label]
        kept.append(pairs[good[label[one]]])
        pairs = pairs[~good[label[one]]]
    return (np.concatenate(kept) if kept else pairs[:0]), plane


def _plane_of(
    corners: Float[np.ndarray, "T 3 3"],
    area: Float[np.ndarray, "T 3"],
    label: Int[np.ndarray, " T"],
    count: int,
) -> tuple[Float[np.ndarray, "L 3"], Float[np.ndarray, " L"]]:
    """Return the unit normal of sets of triangles, and their largest distance from a plane [m]."""
    normal = np.stack([np.bincount(label, each, count) for each in area.T], axis=1)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    upward = normal[label]
    low, high = np.full(count, np.inf), np.full(count, -np.inf)
    for corner in range(3):
        height = np.einsum("tk,tk->t", corners[:, corner], upward)
        np.minimum.at(low, label, height)
        np.maximum.at(high, label, height)
    return normal, 0.5 * (high - low)


def _has_corners(
    triangles: Float[np.ndarray, "N 3 3"], size: Float[np.ndarray, " N"]
) -> Bool[np.ndarray, " N"]:
    """Return which triangles have three corners, none of them on a straight side."""
    length = [lengths(triangles[:, k - 2] - triangles[:, k]) for k in range(3)]
    straight = np.zeros(len(triangles), bool)
    for one, other in ((0, 1), (1, 2), (2, 0)):
        straight |= 2.0 * size <= STRAIGHT * length[one] * length[other]
    return ~straight
