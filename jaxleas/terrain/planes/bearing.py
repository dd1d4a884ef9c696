"""Polygons without the corners that the heights under them do not bear.

Outlines are straight lines through ragged cells. Where planes cross at a small angle the lines meet
in a sharp corner beyond the plane, and a planner that seeks the farthest foothold steps just there.
"""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.terrain.height_map import HeightMap
from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.types import is_ground

CERTAIN = 2.0
"""Standard deviations of a height from which on its distance from the plane is no noise."""
FARTHEST = 6
"""Number of cells along both sides by which a corner is cut off at most."""
_AROUND = np.array([(0, 0), (0, 1), (1, 0), (1, 1)])  # columns and rows of the four cells


def without_corners_in_the_air(
    polygons: Sequence[Float[np.ndarray, "V 3"]], height_map: HeightMap, noise: float
) -> list[Float[np.ndarray, "W 3"]]:
    """Return convex polygons whose corners the heights of a map bear.

    A corner is borne if the plane lies no farther from the height there, interpolated between the
    middles of four cells, than noise explains. One that is not is cut off, at the same distance
    along both of its sides: the smallest number of cells at which the two new corners are borne.

    Args:
        polygons: corners on a plane each, counter-clockwise [m].
        height_map: map in which they were found.
        noise: standard deviation of its heights [m].
    """
    if not polygons:
        return []
    upward = [polygon_area_vector(each) for each in polygons]
    count = [len(each) for each in polygons]
    normals = np.repeat(np.array(upward), count, axis=0)
    good = are_borne(np.concatenate(polygons), normals, height_map, noise)
    parts = np.split(good, np.cumsum(count)[:-1])
    return [
        each if part.all() else _cut(each, normal, part, height_map, noise)
        for each, normal, part in zip(polygons, upward, parts, strict=True)
    ]


def are_borne(
    points: Float[np.ndarray, "N 3"],
    normals: Float[np.ndarray, "N 3"],
    height_map: HeightMap,
    noise: float,
) -> Bool[np.ndarray, " N"]:
    """Return which points lie as near to the heights of a map as noise explains.

    Where none of the four cells around a point has a height, nothing speaks against it.

    Args:
        points: points on planes [m].
        normals: normal of the plane of each point, of any length, upwards.
        height_map: heights with white noise.
        noise: standard deviation of the noise [m].
    """
    at = (points[:, :2] - height_map.origin) / height_map.resolution
    cells = np.floor(at)[:, None].astype(np.int64) + _AROUND
    share = 1.0 - np.abs(cells - at[:, None])
    column, row = np.moveaxis(np.clip(cells, 0, np.array(height_map.shape[::-1]) - 1), -1, 0)
    heights = height_map.heights[row, column]
    known = is_ground(heights)
    weight = np.where(known, share.prod(axis=-1), 0.0)
    slope = -normals[:, :2] / normals[:, 2:]
    away = (np.stack([column, row], axis=-1) - at[:, None]) * height_map.resolution
    plane = points[:, None, 2] + np.einsum("nck,nk->nc", away, slope)
    gap = (weight * np.where(known, heights - plane, 0.0)).sum(axis=1)
    return np.abs(gap) <= CERTAIN * noise * np.linalg.norm(weight, axis=1)


def _cut(
    polygon: Float[np.ndarray, "V 3"],
    normal: Float[np.ndarray, " 3"],
    good: Bool[np.ndarray, " V"],
    height_map: HeightMap,
    noise: float,
) -> Float[np.ndarray, "W 3"]:
    """Return a polygon in which two corners stand for each that is not borne."""
    found: list[np.ndarray] = []
    lengths = height_map.resolution * np.arange(1, FARTHEST + 1)
    for index, corner in enumerate(polygon):
        if good[index]:
            found.append(corner)
            continue
        ways = np.stack([polygon[index - 1], polygon[(index + 1) % len(polygon)]]) - corner
        sides = np.linalg.norm(ways, axis=1)
        share = np.minimum(lengths[:, None] / sides, 0.5)  # the rest is the next corner's
        ends = corner + share[..., None] * ways
        normals = np.tile(normal, (ends[..., 0].size, 1))
        borne = are_borne(ends.reshape(-1, 3), normals, height_map, noise).reshape(-1, 2)
        both = borne.all(axis=1)
        found.extend(ends[int(np.argmax(both)) if both.any() else -1])
    return _distinct(np.array(found), height_map.resolution)


def _distinct(polygon: Float[np.ndarray, "V 3"], cell: float) -> Float[np.ndarray, "W 3"]:
    """Return a polygon without corners at the place of the one before: two cuts met there."""
    apart = np.linalg.norm(polygon - np.roll(polygon, 1, axis=0), axis=1) > 1e-3 * cell
    return polygon[apart]
