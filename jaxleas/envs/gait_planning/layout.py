"""Where heights are seen, in the base's frame, and how they change places in a mirror."""

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float

from jaxleas.envs import Mirror

AROUND_X = (-0.16, -0.08, 0.0, 0.08, 0.16, 0.24, 0.32)
AROUND_Y = (-0.12, -0.04, 0.04, 0.12)
"""Points around the nominal place of each foot: most of the next footholds lie ahead [m]."""
UNDER_X, UNDER_Y = (-0.2, 0.0, 0.2), (-0.07, 0.07)
AHEAD_X, AHEAD_Y = (0.8, 0.95, 1.1, 1.3, 1.5), (-0.35, -0.12, 0.12, 0.35)
MAP_SIDE, MAP_CELL = 32, 0.04
"""The published map: cells along a side, and their size [m]."""


class HeightPoints(NamedTuple):
    """Points at which heights are seen.

    Attributes:
        points: places in the base's frame [m].
        mirror: change of the heights when left and right are swapped.
    """

    points: Float[np.ndarray, "points 2"]
    mirror: Mirror


@cache
def light_points(ahead: float, aside: float) -> HeightPoints:
    """Return the points of the light observation.

    Args:
        ahead: distance of nominal footholds ahead of the base [m].
        aside: distance of nominal footholds to its left [m].
    """
    around = _grid(AROUND_X, AROUND_Y)
    feet = [around + np.array([x, y]) for x in (ahead, -ahead) for y in (aside, -aside)]
    points = np.concatenate([*feet, _grid(UNDER_X, UNDER_Y), _grid(AHEAD_X, AHEAD_Y)])
    return HeightPoints(points, _mirror_of(points))


@cache
def map_points() -> HeightPoints:
    """Return the middles of the published map's cells: rows ahead, columns to the left."""
    middles = MAP_CELL * (np.arange(MAP_SIDE) - 0.5 * (MAP_SIDE - 1))
    points = _grid(middles, middles)
    return HeightPoints(points, _mirror_of(points))


def _grid(x: Any, y: Any) -> Float[np.ndarray, "points 2"]:
    return np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)


def _mirror_of(points: Float[np.ndarray, "points 2"]) -> Mirror:
    """Return which point lies where each point's image lies."""
    image = points * [1.0, -1.0]
    apart = np.abs(points[None] - image[:, None]).sum(axis=-1)
    order = apart.argmin(axis=1)
    assert (apart.min(axis=1) < 1e-9).all(), "the points are not symmetric"
    return Mirror(tuple(map(int, order)), (1.0,) * len(order))
