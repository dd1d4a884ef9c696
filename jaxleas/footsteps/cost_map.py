"""The foot cost map: where feet may land, and what landing near an edge costs.

Taouil's thesis, section 4.2.1; here in metres, and with a buffer that is measured: what
counts as unsafe, and the error of the prediction.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.model import MotionModel
from jaxleas.terrain import Edges, EdgeSearch, HeightMap, find_edges
from jaxleas.types import InputError

UNSAFE = 0.015
"""Distance from an edge below which a landing of a foot's middle is unsafe [m] (thesis, 5.2)."""
FAR_ENOUGH = 0.07
"""Distance from unsafe cells above which a landing costs nothing [m] (thesis, section 4.2.3)."""


@dataclass(frozen=True, eq=False)
class FootCostMap:
    """Where feet may land.

    Attributes:
        height_map: filtered heights.
        distance: distance from each cell to the nearest unsafe one [m].
        buffer: distance that a foot's centre must keep from unsafe cells [m].
    """

    height_map: HeightMap
    distance: Float[np.ndarray, "rows columns"]
    buffer: float

    @classmethod
    def of(cls, height_map: HeightMap, buffer: float, search: EdgeSearch | None = None) -> Self:
        """Return the foot cost map of a height map.

        Args:
            height_map: map, noisy or not, with holes or without.
            buffer: distance that a foot's centre must keep from unsafe cells [m]; see `buffer_of`.
            search: what counts as an edge.

        Raises:
            InputError: no cell is safe.
        """
        return cls.from_edges(find_edges(height_map, search), buffer)

    @classmethod
    def from_edges(cls, edges: Edges, buffer: float) -> Self:
        """Return the foot cost map of edges that are known; see `of`."""
        if not buffer >= 0:
            raise InputError(f"the buffer of a foot must be at least 0 m, not {buffer:g} m")
        found = cls(edges.filtered, edges.distance, buffer)
        if not found.safe.any():
            raise InputError(
                "the map has no safe cell: its widest patch of ground reaches"
                f" {100 * edges.distance.max():.1f} cm from the nearest edge or hole, and a foot"
                f" must keep {100 * buffer:.1f} cm"
            )
        return found

    @property
    def safe(self) -> Bool[np.ndarray, "rows columns"]:
        """Whether a foot may land on a cell."""
        return self.distance > self.buffer

    @property
    def cost(self) -> Float[np.ndarray, "rows columns"]:
        """How much nearer than `FAR_ENOUGH` a cell is to an unsafe one [m]."""
        return np.maximum(FAR_ENOUGH - self.distance, 0.0)

    def nearest_safe(self, point: Float[np.ndarray, "2"]) -> Float[np.ndarray, "2"]:
        """Return the middle of the safe cell that is nearest to a point [m]."""
        origin = np.array(self.height_map.origin)
        rows, columns = np.nonzero(self.safe)
        middles = np.column_stack([columns, rows]) * self.height_map.resolution + origin
        return middles[np.argmin(((middles - point) ** 2).sum(axis=1))]


def buffer_of(model: MotionModel, share: str = "0.95") -> float:
    """Return the distance that feet must keep from edges [m]: `UNSAFE` and the prediction's error.

    The error is of either sign, so that of landings at this distance fewer are unsafe than the
    share that is left, and of those farther away fewer still.

    Args:
        model: motion models of the controller.
        share: share of the landings that are nearer to their prediction; see `Errors`.
    """
    return UNSAFE + model.errors.landing[share]
