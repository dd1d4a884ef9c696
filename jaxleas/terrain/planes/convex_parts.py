"""Polygons with holes cut into few convex parts, in plan."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.meshes.half_edges import HalfEdges, facing_sides
from jaxleas.terrain.meshes.merging import merge

WORTH = 0.85
"""Part of a polygon that a single convex one must cover to stand for it."""
FLAT = 1e-9
"""Twice the area of a triangle [cells^2] and the distance of a corner from a line [cells] that are
none."""
NEAR = 0.02
"""Distance below which two corners are one [cells]."""


def convex_parts(
    outer: Float[np.ndarray, "V 2"], holes: Sequence[Float[np.ndarray, "H 2"]]
) -> list[Float[np.ndarray, "W 2"]]:
    """Return convex polygons inside a polygon and outside its holes.

    They fill it, unless a single one fills nearly all: what wiggles of an outline are worth.

    Args:
        outer: corners, counter-clockwise [cells].
        holes: corners of holes inside, clockwise [cells].
    """
    if not holes:
        core = kernel(outer)
        if area(core) >= WORTH * area(outer):
            return [core]
    import mapbox_earcut

    points = np.ascontiguousarray(np.concatenate([outer, *holes]), np.float64)
    ends = np.cumsum([len(outer), *map(len, holes)]).astype(np.uint32)
    triangles = mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3)
    return _merged(points, triangles.astype(np.int64))


def area(corners: Float[np.ndarray, "V 2"]) -> float:
    """Return the area of a polygon, positive if its corners run counter-clockwise."""
    if len(corners) < 3:
        return 0.0
    x, y = (corners[1:] - corners[0]).T
    return 0.5 * float(x[:-1] @ y[1:] - y[:-1] @ x[1:])


def kernel(corners: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "W 2"]:
    """Return the part of a polygon that lies to the left of all its edges, which is convex."""
    kept = [tuple(each) for each in corners.tolist()]
    ahead = np.roll(corners, -1, axis=0)
    for (ax, ay), (bx, by) in zip(corners.tolist(), ahead.tolist(), strict=True):
        if len(kept) < 3:
            break
        side = [(bx - ax) * (y - ay) - (by - ay) * (x - ax) for x, y in kept]
        if min(side) >= -FLAT:
            continue
        cut = []
        for index, (x, y) in enumerate(kept):
            before, (u, v) = side[index - 1], kept[index - 1]
            if (before < 0.0) != (side[index] < 0.0):
                share = before / (before - side[index])
                cut.append((u + share * (x - u), v + share * (y - v)))
            if side[index] >= 0.0:
                cut.append((x, y))
        kept = cut
    return distinct(np.array(kept).reshape(-1, 2))


def distinct(corners: Float[np.ndarray, "V 2"]) -> Float[np.ndarray, "W 2"]:
    """Return the corners of a polygon without those that nearly are the one before."""
    if len(corners) < 2:
        return corners
    apart = np.abs(corners - np.roll(corners, 1, axis=0)).max(axis=1) > NEAR
    return corners[apart]


def _merged(
    points: Float[np.ndarray, "P 2"], triangles: Int[np.ndarray, "T 3"]
) -> list[Float[np.ndarray, "W 2"]]:
    """Return triangles merged over the sides that no corner needs, asked from the longest on."""
    turn = _turns(points[triangles])
    triangles = triangles[np.abs(turn) > FLAT]
    clockwise = turn[np.abs(turn) > FLAT] < 0.0
    triangles[clockwise] = triangles[clockwise, ::-1]
    pairs = facing_sides(triangles)
    at = np.column_stack([points, np.zeros(len(points))])
    borders = HalfEdges(triangles, pairs)
    length = np.linalg.norm(at[borders.end] - at[borders.origin], axis=1)
    order = pairs[np.argsort(-length[pairs[:, 0]], kind="stable"), 0]
    leader = merge(at, borders, np.tile([0.0, 0.0, 1.0], (len(triangles), 1)), order, FLAT)
    borders.simplify(at, FLAT)
    sides = np.flatnonzero(borders.alive)
    _, first = np.unique(leader[sides // 3], return_index=True)
    vertices, counts = borders.loops(sides[first])
    loops = np.split(points[vertices], np.cumsum(counts)[:-1])
    return [each for each in loops if len(each) >= 3]


def _turns(corners: Float[np.ndarray, "T 3 2"]) -> Float[np.ndarray, " T"]:
    """Return twice the areas of triangles, positive for a turn to the left."""
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 1]).T
    return ax * by - ay * bx
