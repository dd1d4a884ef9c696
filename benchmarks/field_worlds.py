"""Fields as worlds for physics: boxes under their level parts, many fields side by side."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.terrain import HeightMap, Scene

APART = 6.0
"""Distance from one field to the next, across [m]: wider than a field."""
LEVEL = 1e-6
"""Difference of heights up to which cells are level [m]."""


def place_of(number: int) -> Float[np.ndarray, "3"]:
    """Return where a field's corner lies among others [m].

    Args:
        number: number of the field.
    """
    return np.array([0.0, APART * number, 0.0])


def world_of(fields: Mapping[int, HeightMap]) -> Scene:
    """Return fields of level parts as one scene, side by side.

    Args:
        fields: fields in frames of their own, by their numbers.
    """
    return Scene(
        {
            f"field_{number}_{index}": rectangle + place_of(number)
            for number, field in fields.items()
            for index, rectangle in enumerate(level_rectangles(field))
        }
    )


def level_rectangles(field: HeightMap) -> list[Float[np.ndarray, "4 3"]]:
    """Return rectangles of cells of one height that cover a field, each cell once.

    Args:
        field: height map; every level part becomes few rectangles, a slope one for each cell.
    """
    heights, cell = field.heights, field.resolution
    free, found = np.isfinite(heights), []
    for row, column in np.argwhere(free):
        if not free[row, column]:
            continue
        level: np.ndarray = free & (np.abs(heights - heights[row, column]) < LEVEL)
        right = column + _beginning(level[row][column:])
        top = row + _beginning(np.all(level[row:, column:right], axis=1))
        free[row:top, column:right] = False
        x, y = (
            field.origin[axis] + cell * (np.array(ends) - 0.5)
            for axis, ends in enumerate(((column, right), (row, top)))
        )
        corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
        found.append(np.array([(*corner, heights[row, column]) for corner in corners], float))
    return found


def _beginning(flags: Bool[np.ndarray, " N"]) -> int:
    """Return how many flags are true before the first that is not."""
    return int(flags.size if flags.all() else np.argmin(flags))
