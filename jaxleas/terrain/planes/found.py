"""What was found in a height map."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from jaxtyping import Float, Int

from jaxleas.terrain.polygons import polygon_area_vector
from jaxleas.terrain.scene import Polygons


class Cell(IntEnum):
    """What became of a cell."""

    SURFACE = 0
    VOID = 1
    STEEP = 2
    ROUGH = 3
    SMALL = 4


@dataclass(frozen=True)
class FoundSurfaces:
    """Planar surfaces of a height map.

    Attributes:
        polygons: convex polygons by name: "surface_3", or "surface_3_0", "surface_3_1" and so on
            where a surface was cut into convex parts [m].
        surface: number of each cell's surface; -1 for none.
        cells: what became of each cell, a `Cell`.
        fit: root mean square distance of each surface's cells from its plane [m].
        noise: standard deviation of the heights that was reckoned with [m].
        inset: length by which the polygons are drawn in from the surfaces' edges [m].
        resolution: edge of a cell [m].
        obstacles: upright faces where the map rises by half a metre from a cell to the next [m].
    """

    polygons: Polygons
    surface: Int[np.ndarray, "R C"]
    cells: Int[np.ndarray, "R C"]
    fit: Float[np.ndarray, " S"]
    noise: float
    inset: float
    resolution: float
    obstacles: Polygons

    @property
    def area(self) -> float:
        """Area of all surfaces together [m^2]."""
        return float(
            sum(np.linalg.norm(polygon_area_vector(each)) for each in self.polygons.values())
        )

    @property
    def root_mean_square(self) -> float:
        """Root mean square distance of all cells from their surfaces [m]; 0 without any."""
        count = np.bincount(self.surface[self.surface >= 0], minlength=len(self.fit))
        return float(np.sqrt((self.fit**2 * count).sum() / max(count.sum(), 1)))

    @property
    def shares(self) -> dict[Cell, float]:
        """Share of the cells of each kind."""
        return {kind: float((self.cells == kind).mean()) for kind in Cell}

    def surface_of(self, polygon: str) -> int:
        """Return the number of the surface that a polygon is a part of."""
        return int(polygon.split("_")[1])
