"""Scenes as closed convex bodies, which simulators need: a polygon alone has no inside."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.polygons import STANDING_SLOPE, polygon_area_vector
from jaxleas.terrain.scene import Scene

THICKNESS = 0.2
"""Depth of the ground below the lowest point, and of what hangs over other ground [m]."""
SHEET = 0.01
"""Thickness of walls and ceilings, behind the side that is touched [m]."""
HEADROOM = 1.0
"""Height of free space under a surface from which on it is left free [m]."""
APART = 1e-4
"""Distance by which sides are moved inwards [m]: neighbours that share an edge would be one body
in files that know no bodies, and that body would not be closed."""


@dataclass(frozen=True, eq=False)
class Prism:
    """A closed convex body between two polygons.

    Attributes:
        top: corners, counter-clockwise seen from outside [m].
        bottom: corners under those of the top, in the same order [m].
    """

    top: Float[np.ndarray, "V 3"]
    bottom: Float[np.ndarray, "V 3"]

    @property
    def triangles(self) -> Float[np.ndarray, "N 3 3"]:
        """Its faces, wound outwards [m]."""
        top, bottom = self.top, self.bottom
        after_top, after_bottom = (np.roll(each, -1, axis=0) for each in (top, bottom))
        return np.concatenate(
            [
                _fan(top),
                _fan(bottom[::-1]),
                np.stack([top, bottom, after_bottom], axis=1),
                np.stack([top, after_bottom, after_top], axis=1),
            ]
        )


def prisms_of(scene: Scene) -> dict[str, Prism]:
    """Return a body for each surface and obstacle of a scene, with its face on that side.

    Ground reaches down to a common level below the scene; where something to stand on lies under
    it, with room for somebody, it is a slab. Walls and ceilings are thin.
    """
    polygons = scene.surfaces | scene.obstacles
    floors = _Floors(list(scene.walkable.values()))
    base = min(float(each[:, 2].min()) for each in polygons.values()) - THICKNESS
    return {name: _prism(vertices, floors, base) for name, vertices in polygons.items()}


class _Floors:
    """Polygons that something may hang over, with their bounds, which decide most questions."""

    def __init__(self, polygons: list[Float[np.ndarray, "V 3"]]) -> None:
        self._polygons = polygons
        self._low = np.array([each.min(axis=0) for each in polygons])
        self._high = np.array([each.max(axis=0) for each in polygons])

    def lie_under(self, vertices: Float[np.ndarray, "V 3"]) -> bool:
        """Tell whether one lies under a polygon, with room for somebody between."""
        from jaxleas.geometry import Polytope, pack_polygons, polygons_meet_polytope

        low, high = vertices.min(axis=0), vertices.max(axis=0)
        beside = (self._low[:, :2] >= high[:2]) | (self._high[:, :2] <= low[:2])
        under = np.flatnonzero(~beside.any(axis=1) & (self._low[:, 2] < high[2] - HEADROOM))
        if not len(under):
            return False
        ceiling = _inset(vertices, 0.1 * float((high - low)[:2].min())) - [0.0, 0.0, HEADROOM]
        deep = ceiling.copy()
        deep[:, 2] = min(float(self._low[under, 2].min()), float(ceiling[:, 2].min())) - HEADROOM
        space = Polytope.from_points(np.concatenate([ceiling, deep]))
        found = pack_polygons([self._polygons[each] for each in under])
        return bool(polygons_meet_polytope(found, space).any())


def _prism(vertices: Float[np.ndarray, "V 3"], floors: _Floors, base: float) -> Prism:
    top = _inset(vertices, APART)
    area = polygon_area_vector(vertices)
    normal = area / np.linalg.norm(area)
    if normal[2] < STANDING_SLOPE:
        return Prism(top, top - SHEET * normal)
    bottom = top.copy()
    if floors.lie_under(vertices):
        bottom[:, 2] -= THICKNESS
    else:
        bottom[:, 2] = base
    return Prism(top, bottom)


def _inset(vertices: Float[np.ndarray, "V 3"], by: float) -> Float[np.ndarray, "V 3"]:
    """Return a polygon with its corners moved towards its middle, by at most half of the way."""
    inwards = vertices.mean(axis=0) - vertices
    length = np.linalg.norm(inwards, axis=1, keepdims=True)
    return vertices + inwards * np.minimum(by / np.maximum(length, 1e-12), 0.5)


def _fan(ring: Float[np.ndarray, "V 3"]) -> Float[np.ndarray, "N 3 3"]:
    first = np.broadcast_to(ring[0], (len(ring) - 2, 3))
    return np.stack([first, ring[1:-1], ring[2:]], axis=1)
