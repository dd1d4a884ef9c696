"""The valid place nearest to a point."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import wrap_angle_on_host
from jaxleas.guide.places import HEADINGS, Places

NEARBY = 0.1
"""Spacing of the grid on which the nearest valid pose is sought [m]."""
MOST_TRIED = 1_000_000
"""Maximum number of points of that grid; on larger terrain the grid is coarser."""


def nearest_place(
    places: Places, here: Float[np.ndarray, " 2"], yaw: float | None
) -> tuple[tuple[float, float], float] | None:
    """Return the valid place nearest to a point, on a grid of 0.1 m, and a heading there.

    Of several headings the one nearest to `yaw` is taken.
    """
    x_min, x_max, y_min, y_max = places.terrain.extent
    spacing = max(NEARBY, math.sqrt((x_max - x_min) * (y_max - y_min) / MOST_TRIED))
    x, y = np.arange(x_min, x_max, spacing), np.arange(y_min, y_max, spacing)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    grid = np.vstack([here[None], np.round(grid, 2)])
    order = np.argsort(np.linalg.norm(grid - here, axis=1), kind="stable")
    wanted = 0.0 if yaw is None else yaw
    turn = np.concatenate([[0.0], sorted(HEADINGS, key=abs)])
    for first in range(0, len(grid), 256):
        some = grid[order[first : first + 256]]
        headings = np.tile(wanted + turn, len(some))
        valid = places.valid(np.repeat(some, len(turn), axis=0), headings)
        if valid.any():
            index = int(np.argmax(valid))
            heading = wrap_angle_on_host(headings[index])
            at = some[index // len(turn)]
            return (float(at[0]), float(at[1])), float(heading)
    return None
