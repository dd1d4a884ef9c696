"""Triangles on a plane merged into few convex polygons (Hertel and Mehlhorn 1983)."""

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.terrain.areas import lengths
from jaxleas.terrain.meshes.half_edges import HalfEdges, once


def merge(
    points: Float[np.ndarray, "P 3"],
    borders: HalfEdges,
    normals: Float[np.ndarray, "T 3"],
    order: Int[np.ndarray, " E"],
    slack: float,
) -> Int[np.ndarray, " T"]:
    """Take away each edge without which the faces on both sides are one convex face.

    The result is that of asking edge after edge: those that come before all others of both of
    their faces are asked at once. An edge that grows, as a vertex on it goes, is asked again.

    Args:
        points: vertices [m].
        borders: borders of the triangles, changed in place.
        normals: unit normal of the plane of each triangle, the same on both sides of an edge.
        order: half-edges with a twin, one of each edge that may go, in the order of asking.
        slack: distance by which a corner may bend outwards [m].

    Returns:
        Number of the triangle that stands for the face of each.
    """
    leader = np.arange(len(normals), dtype=np.int32)
    rank = np.full(len(borders.twin), len(order), np.int32)
    rank[order] = rank[borders.twin[order]] = np.arange(len(order))
    best = np.empty(len(normals), np.int32)
    asked = np.sort(np.minimum(order, borders.twin[order]))  # as in memory, which is faster
    waits = np.zeros(len(rank), bool)
    waits[asked] = True
    left, right = asked // 3, borders.twin[asked] // 3
    while len(asked):
        left, right = leaders(leader, left), leaders(leader, right)
        mine = rank[asked]
        best[left] = best[right] = len(order)
        np.minimum.at(best, left, mine)
        np.minimum.at(best, right, mine)
        turn = (best[left] == mine) & (best[right] == mine)
        chosen, face, other = asked[turn], left[turn], right[turn]
        fits = (face != other) & _stays_convex(points, borders, normals[face], chosen, slack)
        waits[chosen] = False
        leader[other[fits]] = face[fits]
        longer = borders.straighten(points, borders.join(chosen[fits]), slack)
        again = once(np.minimum(longer, borders.twin[longer]))
        again = again[(rank[again] < len(order)) & ~waits[again]]
        waits[again] = True
        asked = np.concatenate([asked[~turn], again])
        left = np.concatenate([left[~turn], again // 3])
        right = np.concatenate([right[~turn], borders.twin[again] // 3])
        still = borders.alive[asked]
        asked, left, right = asked[still], left[still], right[still]
    return leaders(leader, leader)


def leaders(leader: Int[np.ndarray, " T"], faces: Int[np.ndarray, " N"]) -> Int[np.ndarray, " N"]:
    """Return the triangles that stand for the faces of triangles."""
    while True:
        above = leader[faces]
        if np.array_equal(above, faces):
            return faces
        faces = above


def _stays_convex(
    points: Float[np.ndarray, "P 3"],
    borders: HalfEdges,
    normals: Float[np.ndarray, "E 3"],
    sides: Int[np.ndarray, " E"],
    slack: float,
) -> Bool[np.ndarray, " E"]:
    """Return which edges no corner needs; of faces that share more than one, none."""
    twin = borders.twin[sides]
    good = np.ones(len(sides), bool)
    for one, other in ((sides, twin), (twin, sides)):
        here, on = borders.before[one], borders.following[other]
        corner = [points[borders.origin[each]] for each in (here, on, borders.following[on])]
        good &= (borders.twin[here] != on) & (_bend(corner, normals) >= -slack)
    return good


def _bend(corner: list[Float[np.ndarray, "E 3"]], normals: Float[np.ndarray, "E 3"]) -> np.ndarray:
    """Return the distances of corners from the line between their neighbours, outwards > 0 [m]."""
    (ax, ay, az), (bx, by, bz) = (corner[1] - corner[0]).T, (corner[2] - corner[1]).T
    nx, ny, nz = normals.T
    turn = nx * (ay * bz - az * by) + ny * (az * bx - ax * bz) + nz * (ax * by - ay * bx)
    return turn / np.maximum(lengths(corner[2] - corner[0]), 1e-12)
