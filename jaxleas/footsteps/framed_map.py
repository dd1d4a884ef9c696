"""A foot cost map that can be asked at many places at once, those beyond it included."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.cost_map import FootCostMap

SWING_SAMPLES = np.arange(1, 9) / 9
"""Where along a swing the ground is looked at."""
SWING_MARGIN = 0.01
"""Height that a swinging foot keeps above the ground there [m]."""


class FramedMap:
    """A foot cost map in a frame of unsafe cells without ground, which take all that lies beyond.

    Args:
        costs: foot cost map.
    """

    def __init__(self, costs: FootCostMap) -> None:
        self.buffer = costs.buffer
        heights = costs.height_map
        self._origin, self._cell = np.array(heights.origin), heights.resolution
        self._distance = np.pad(costs.distance, 1, constant_values=0.0)
        ground = heights.heights.astype(np.float64)
        self._height = np.pad(ground, 1, constant_values=np.nan)
        self._columns = self._distance.shape[1]
        self._last = np.array(self._distance.shape)[::-1] - 1.0
        self._flat_distance, self._flat_height = self._distance.ravel(), self._height.ravel()

    def at(self, places: Float[np.ndarray, "*batch 2"]) -> tuple[np.ndarray, np.ndarray]:
        """Return the distance from unsafe cells and the height of the cells around places [m]."""
        index = self._index(places)
        return self._flat_distance[index], self._flat_height[index]

    def inside(self, places: Float[np.ndarray, "K 2"]) -> Bool[np.ndarray, " K"]:
        """Return whether places are on the map."""
        cells = np.floor((places - self._origin) / self._cell + 1.5)
        return np.all((cells >= 1) & (cells < self._last), axis=1)

    def swings_clear(
        self,
        lift_offs: Float[np.ndarray, "K S 3"],
        landings: Float[np.ndarray, "K S 3"],
        apex: float,
    ) -> Bool[np.ndarray, " K"]:
        """Return whether feet pass over the ground on the way: straight, and up a parabola.

        Where there is no ground there is nothing to hit.
        """
        along = SWING_SAMPLES[:, None]
        path = lift_offs[:, :, None] + (landings - lift_offs)[:, :, None] * along
        ground = self._flat_height[self._index(path[..., :2])]
        arc = 4 * apex * SWING_SAMPLES * (1 - SWING_SAMPLES) - SWING_MARGIN
        hit = ground > path[..., 2] + arc  # false for NaN
        return ~np.any(hit, axis=(1, 2))

    def _index(self, places: Float[np.ndarray, "*batch 2"]) -> np.ndarray:
        """Return the indices, in the flat framed map, of the cells around places."""
        cells = np.floor((places - self._origin) / self._cell + 1.5)
        cells = np.clip(cells, 0.0, self._last).astype(np.intp)
        return cells[..., 1] * self._columns + cells[..., 0]
