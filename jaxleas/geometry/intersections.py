"""Exact intersection tests of convex polygons with a convex polytope, for many polygons at once."""

from collections.abc import Iterable

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.geometry.polytopes import Polytope
from jaxleas.types import InputError

TOUCHING = 1e-9
"""Distance below which sets meet [m]: touching counts."""


def pack_polygons(polygons: Iterable[Float[np.ndarray, "V 3"]]) -> Float[np.ndarray, "N W 3"]:
    """Stack polygons of different sizes into one array by repeating their last vertex.

    Args:
        polygons: convex planar polygons [m]; a packed array is returned as it is.

    Raises:
        InputError: a polygon has fewer than three vertices of three numbers.
    """
    if isinstance(polygons, np.ndarray) and polygons.ndim == 3:
        return polygons
    listed = [np.asarray(polygon, dtype=np.float64) for polygon in polygons]
    for index, polygon in enumerate(listed):
        if polygon.ndim != 2 or polygon.shape[1] != 3 or len(polygon) < 3:
            raise InputError(
                f"polygon {index} has shape {polygon.shape}; it needs 3 or more vertices x, y, z"
            )
    if not listed:
        return np.zeros((0, 3, 3))
    widest = max(len(polygon) for polygon in listed)
    return np.stack([np.pad(p, ((0, widest - len(p)), (0, 0)), mode="edge") for p in listed])


def polygons_meet_polytope(
    vertices: Float[np.ndarray, "N W 3"], polytope: Polytope
) -> Bool[np.ndarray, " N"]:
    """Return which polygons have a point in common with the polytope.

    Two convex sets of this kind meet in one of two ways: an edge of the polygon enters the
    polytope, or the polytope cuts the polygon's plane wholly inside the polygon; then any point of
    the cut decides.

    Args:
        vertices: corners of convex planar polygons, packed, in the polytope's frame [m].
        polytope: bounded polytope.
    """
    meets = _edges_enter(vertices, polytope)
    rest = np.flatnonzero(~meets)
    meets[rest] = _cut_lies_inside(vertices[rest], polytope)
    return meets


def _edges_enter(vertices: np.ndarray, polytope: Polytope) -> Bool[np.ndarray, " N"]:
    # Cyrus-Beck: each face limits the edge start + t (end - start) to an interval of t.
    start = polytope.offsets + TOUCHING - vertices @ polytope.normals.T  # slack, [N, W, F]
    end = np.roll(start, -1, axis=1)
    descent = start - end
    with np.errstate(divide="ignore", invalid="ignore"):
        crossing = start / descent
    enter = np.max(np.where(descent < 0, crossing, 0.0), axis=-1, initial=0.0)
    leave = np.min(np.where(descent > 0, crossing, 1.0), axis=-1, initial=1.0)
    outside = np.any((start < 0) & (end < 0), axis=-1)
    return np.any((enter <= leave) & ~outside, axis=-1)


def _cut_lies_inside(vertices: np.ndarray, polytope: Polytope) -> Bool[np.ndarray, " N"]:
    ahead = np.roll(vertices, -1, axis=1)
    # Newell's vector about the first vertex is normal to the polygon, whatever the padding.
    origin = vertices[:, :1]
    normal = np.cross(vertices - origin, ahead - origin).sum(axis=1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    ends = polytope.edges - origin[:, None]  # [N, E, 2, 3]
    distance = np.einsum("nesk,nk->nes", ends, normal)
    crosses = distance[..., 0] * distance[..., 1] <= 0
    first = np.argmax(crosses, axis=1)
    each = np.arange(len(vertices))
    below, above = distance[each, first, 0], distance[each, first, 1]
    span = np.where(below == above, 1.0, below - above)
    share = (below / span)[:, None]
    point = origin[:, 0] + (1 - share) * ends[each, first, 0] + share * ends[each, first, 1]
    inward = np.cross(normal[:, None], ahead - vertices)
    inside = np.einsum("nwk,nwk->nw", inward, point[:, None] - vertices) >= -TOUCHING
    return crosses.any(axis=1) & inside.all(axis=1)
