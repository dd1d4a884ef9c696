"""Edges of a scene's polygons themselves: the truth that a foot's distance is measured by."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.terrain.polygons import is_vertical
from jaxleas.terrain.rasterise import blocking
from jaxleas.terrain.scene import Scene

RISE = 0.02
"""Difference of heights on both sides of a line from which on it is an edge [m]."""
CRACK = 0.015
"""Width up to which space between polygons of one height is no edge: a foot does not notice [m]."""
SPACING = 0.005
"""Distance between points along a side [m]. A point 1.5 cm from an edge is measured 0.2 mm too far
at most."""
_BESIDE = 0.001
"""How far inside and outside of a side heights are looked at [m]."""


@dataclass(frozen=True, eq=False)
class SceneEdges:
    """Where the ground of a scene ends, rises or drops, as seen from above.

    Attributes:
        points: points on the edges, a few millimetres apart; x and y [m].
    """

    points: Float[np.ndarray, "N 2"]

    @classmethod
    def of(cls, scene: Scene) -> Self:
        """Return the edges of a scene: sides of polygons beside which the height differs by more
        than `RISE`, or there is no ground."""
        polygons = _seen_from_above(scene)
        found = [np.empty((0, 2))]
        for polygon in polygons:
            points, outward = _sides(polygon)
            inside = _highest(polygons, points - _BESIDE * outward)
            # A crack is crossed if the ground on its other side is at the same height.
            beyond = np.stack(
                [
                    _highest(polygons, points + away * outward)
                    for away in np.arange(_BESIDE, CRACK + SPACING, SPACING)
                ]
            )
            level = np.abs(beyond - inside) <= RISE  # false where there is no ground
            found.append(points[~level.any(axis=0)])
        return cls(np.concatenate(found))

    def distance(self, places: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, " N"]:
        """Return the horizontal distance from places to the nearest edge [m]; infinity if the
        scene has none.

        Args:
            places: x and y, such as the middles of feet [m].
        """
        if not len(self.points):
            return np.full(len(places), np.inf)
        found, _ = self._tree.query(places)
        return np.asarray(found)

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import KDTree

        return KDTree(self.points)


def ground_height(scene: Scene, places: Float[np.ndarray, "N 2"]) -> Float[np.ndarray, " N"]:
    """Return the height of the highest polygon at each place [m]; NaN where there is none.

    Args:
        scene: terrain.
        places: x and y [m].
    """
    return _highest(_seen_from_above(scene), np.asarray(places, dtype=np.float64))


def _seen_from_above(scene: Scene) -> list[Float[np.ndarray, "V 3"]]:
    return [each for each in blocking(scene) if not is_vertical(each)]


def _sides(polygon: Float[np.ndarray, "V 3"]) -> tuple[np.ndarray, np.ndarray]:
    """Return points along the sides of a polygon, and the horizontal directions out of it."""
    corners = polygon[:, :2]
    ways = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*ways.T)
    points, outward = [], []
    for corner, way, length in zip(corners, ways, lengths, strict=True):
        if length < _BESIDE:
            continue
        count = int(np.ceil(length / SPACING)) + 1
        points.append(corner + np.linspace(0.0, 1.0, count)[:, None] * way)
        outward.append(np.tile(np.array([way[1], -way[0]]) / length, (count, 1)))
    return np.concatenate(points), np.concatenate(outward)


def _highest(
    polygons: Sequence[Float[np.ndarray, "V 3"]], places: Float[np.ndarray, "N 2"]
) -> Float[np.ndarray, " N"]:
    """Return the height of the highest polygon at each place [m]; NaN where there is none."""
    highest = np.full(len(places), -np.inf)
    low, high = places.min(axis=0), places.max(axis=0)
    for polygon in polygons:
        if (polygon[:, :2].min(axis=0) > high).any() or (polygon[:, :2].max(axis=0) < low).any():
            continue
        heights = np.where(_within(polygon, places), _plane_height(polygon, places), -np.inf)
        highest = np.maximum(highest, heights)
    return np.where(np.isfinite(highest), highest, np.nan)


def _within(
    polygon: Float[np.ndarray, "V 3"], places: Float[np.ndarray, "N 2"]
) -> Bool[np.ndarray, " N"]:
    """Return whether places are in a convex polygon that is counter-clockwise from above."""
    corners = polygon[:, :2]
    ways = np.roll(corners, -1, axis=0) - corners
    away = places[:, None] - corners
    return np.all(ways[:, 0] * away[..., 1] - ways[:, 1] * away[..., 0] >= 0.0, axis=1)


def _plane_height(
    polygon: Float[np.ndarray, "V 3"], places: Float[np.ndarray, "N 2"]
) -> Float[np.ndarray, " N"]:
    """Return the height at each place of the plane that a polygon lies in."""
    middle = polygon.mean(axis=0)
    normal = np.linalg.svd(polygon - middle)[2][2]
    return middle[2] - (places - middle[:2]) @ normal[:2] / normal[2]
