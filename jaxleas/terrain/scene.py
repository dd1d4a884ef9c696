"""Scenes: convex contact surfaces, obstacles and named areas, from which height maps are made."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.terrain.polygons import STANDING_SLOPE, upwardness

Touch = Literal["feet", "palms", "both"]
"""Kinds of effectors that may touch a surface."""
Polygons = dict[str, Float[np.ndarray, "V 3"]]


@dataclass(frozen=True)
class Scene:
    """A terrain as polygons.

    Attributes:
        surfaces: convex planar polygons that may be touched, of any orientation: floors, slopes,
            walls, ceilings; counter-clockwise seen from where they are touched [m].
        obstacles: convex planar polygons that must not be touched: tops as above, side faces
            vertical and wound outwards; box "obstacle_7" has the faces "obstacle_7_top" and
            "obstacle_7_side_0" to "obstacle_7_side_3" [m].
        areas: named polygons for starts and goals, with 2 or 3 coordinates per vertex [m].
        touch: kind of effector that may touch a surface, by the surface's name; unnamed surfaces
            are for both if they are flat enough for feet, else for palms.
    """

    surfaces: Polygons
    obstacles: Polygons = field(default_factory=dict)
    areas: dict[str, Float[np.ndarray, "V 2|3"]] = field(default_factory=dict)
    touch: Mapping[str, Touch] = field(default_factory=dict)

    def who_touches(self, surface: str) -> Touch:
        """Return the kind of effector that may touch a surface."""
        if surface in self.touch:
            return self.touch[surface]
        return "both" if upwardness(self.surfaces[surface]) >= STANDING_SLOPE else "palms"

    @cached_property
    def walkable(self) -> Polygons:
        """The surfaces that feet may touch."""
        return self._touched_by("feet")

    @cached_property
    def pressable(self) -> Polygons:
        """The surfaces that palms may touch."""
        return self._touched_by("palms")

    def _touched_by(self, who: Touch) -> Polygons:
        return {
            name: vertices
            for name, vertices in self.surfaces.items()
            if self.who_touches(name) in (who, "both")
        }

    @cached_property
    def blocking(self) -> Polygons:
        """The polygons that feet may not touch: walls, ceilings and obstacles."""
        others = {name: each for name, each in self.surfaces.items() if name not in self.walkable}
        for name, each in self.obstacles.items():
            others[f"obstacle {name}" if name in self.surfaces else name] = each
        return others

    @cached_property
    def blocking_bounds(self) -> Float[np.ndarray, "P 2 3"]:
        """Lowest and highest corner of the box around each blocking polygon [m]."""
        boxes = [(each.min(axis=0), each.max(axis=0)) for each in self.blocking.values()]
        return np.array(boxes, np.float64).reshape(-1, 2, 3)

    @property
    def polygons(self) -> list[Float[np.ndarray, "V 3"]]:
        """All polygons that can carry or block, surfaces first."""
        return [*self.surfaces.values(), *self.obstacles.values()]
