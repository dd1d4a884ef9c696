"""A foot cost map that can be asked at many places at once, those beyond it included."""

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxleas.footsteps.cost_map import FootCostMap

SWING_SAMPLES = np.concatenate([np.arange(2, 10, 2), np.arange(10, 18)]) / 18
"""Where along a swing the ground is looked at: twice as often once the foot falls."""
SWING_MARGIN = 0.01
"""Height that a swinging foot keeps above the ground there [m]."""


class FramedMap:
    """A foot cost map in a frame of unsafe cells without ground, which take all that lies beyond.

    Args:
        costs: foot cost map.
        foot_radius: radius of a foot, a ball [m].
    """

    def __init__(self, costs: FootCostMap, foot_radius: float) -> None:
        self.buffer = costs.buffer
        heights = costs.height_map
        self._origin, self._cell = np.array(heights.origin), heights.resolution
        self._distance = np.pad(costs.distance, 1, constant_values=0.0)
        ground = heights.heights.astype(np.float64)
        self._height = np.pad(ground, 1, constant_values=np.nan)
        self._columns = self._distance.shape[1]
        self._last = np.array(self._distance.shape)[::-1] - 1.0
        self._flat_distance, self._flat_height = self._distance.ravel(), self._height.ravel()
        self._flat_touched = ball_heights(self._height, self._cell, foot_radius).ravel()

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

        A ball that steps down over an edge must pass as a whole once it falls: it would stay where
        it touches. Else its lowest point must pass: a ball that touches while it rises goes on, and
        one that meets a riser stands before it. Where there is no ground there is nothing to hit.
        """
        along = SWING_SAMPLES[:, None]
        path = lift_offs[:, :, None] + (landings - lift_offs)[:, :, None] * along
        index = self._index(path[..., :2])
        lower = landings[..., 2] < lift_offs[..., 2]
        falls = lower[..., None] & (SWING_SAMPLES > 0.5)
        ground = np.where(falls, self._flat_touched[index], self._flat_height[index])
        arc = 4 * apex * SWING_SAMPLES * (1 - SWING_SAMPLES) - SWING_MARGIN
        hit = ground > path[..., 2] + arc  # false for NaN
        return ~np.any(hit, axis=(1, 2))

    def _index(self, places: Float[np.ndarray, "*batch 2"]) -> np.ndarray:
        """Return the indices, in the flat framed map, of the cells around places."""
        cells = np.floor((places - self._origin) / self._cell + 1.5)
        cells = np.clip(cells, 0.0, self._last).astype(np.intp)
        return cells[..., 1] * self._columns + cells[..., 0]


def ball_heights(
    heights: Float[np.ndarray, "rows columns"], cell: float, radius: float
) -> Float[np.ndarray, "rows columns"]:
    """Return how high a ball's lowest point is when the ball is lowered onto cells [m].

    Args:
        heights: heights of the ground; NaN where there is none [m].
        cell: edge of a cell [m].
        radius: radius of the ball [m]; over finer cells it is looked at in some places only.
    """
    reach = int(radius / cell)
    apart = cell * np.hypot(*np.mgrid[-reach : reach + 1, -reach : reach + 1])
    looked_at = np.arange(-reach, reach + 1) % max(1, reach // MOST_REACH) == 0
    under = (apart <= radius) & looked_at & looked_at[:, None]
    bulge = np.sqrt(np.maximum(radius**2 - apart**2, 0.0)) - radius
    known = np.where(np.isnan(heights), -np.inf, heights)
    return ndimage.grey_dilation(
        known, footprint=under, structure=bulge, mode="constant", cval=-np.inf
    )


MOST_REACH = 4
"""Places, from the middle of a ball, that are looked at along an axis; up to twice as many."""
