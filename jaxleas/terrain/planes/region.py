"""A region of cells on one plane, and the ground that regions grow on."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.terrain.planes.plane import Box, Plane, inner

CORE = 0.25
"""Part of the cells of the smallest surface that its core has at least."""


@dataclass(frozen=True)
class Region:
    """Cells of one plane.

    Attributes:
        plane: the plane that fits them.
        box: part of the map that holds them.
        cells: which cells of the part they are.
    """

    plane: Plane
    box: Box
    cells: Bool[np.ndarray, "r c"]

    @property
    def size(self) -> int:
        """Number of cells."""
        return int(self.cells.sum())

    def trimmed(self) -> "Region":
        """Return the region in the smallest part of the map that holds its cells."""
        rows, columns = (np.flatnonzero(self.cells.any(axis=axis)) for axis in (1, 0))
        if not rows.size:
            return self
        part = slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)
        return replace(self, box=inner(self.box, part), cells=self.cells[part])

    def lifted(self, height: float) -> "Region":
        """Return the region higher by a number of metres."""
        plane = self.plane._replace(height=self.plane.height + height)
        return replace(self, plane=plane)

    def within(self, box: Box) -> Bool[np.ndarray, "R C"]:
        """Return the cells in a part of the map that holds the region's own part."""
        wider = np.zeros([side.stop - side.start for side in box], bool)
        first = [own.start - side.start for own, side in zip(self.box, box, strict=True)]
        rows, columns = self.cells.shape
        wider[first[0] : first[0] + rows, first[1] : first[1] + columns] = self.cells
        return wider


@dataclass(frozen=True)
class Growth:
    """What regions grow on.

    Attributes:
        heights: heights [m]; zero where unknown.
        known: which cells have a height.
        noise: standard deviation of the heights [m].
        resolution: edge of a cell [m].
        least: number of cells below which a region is no surface.
    """

    heights: Float[np.ndarray, "R C"]
    known: Bool[np.ndarray, "R C"]
    noise: float
    resolution: float
    least: int

    @property
    def least_core(self) -> int:
        """Number of cells below which what has grown is no core of a region."""
        return max(3, int(CORE * self.least))
