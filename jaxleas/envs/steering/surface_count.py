"""The number of surfaces around the robot, observed besides the heights (T 5.2.3)."""

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

WINDOW = 0.8
"""Side of the square in which a foot may land (T 5.2.3) [m]."""
STEP = 0.015
"""Height difference above which neighbouring points lie on two surfaces [m]."""


def surface_count(
    heights: Float[Array, "*batch points"],
    rows: tuple[float, ...],
    columns: tuple[float, ...],
    height_range: tuple[float, float],
) -> Float[Array, "*batch"]:
    """Return the number of surfaces within reach in a square around the root, from its heights.

    Neighbours on the grid that hardly differ in height lie on one surface. Connected regions are
    counted by Euler's formula: cells - joints + closed squares of four; so a surface that lies
    within another one is not counted (a hole takes one off).

    Args:
        heights: heights of the grid points relative to the root, row by row [m].
        rows: x coordinates of the grid's rows [m].
        columns: y coordinates of the grid's columns [m].
        height_range: range of heights that count as footholds [m].
    """
    low, high = height_range
    grid = heights.reshape(*heights.shape[:-1], len(rows), len(columns))
    grid = grid[..., _within(rows), _within(columns)]
    there = (grid > low) & (grid < high)
    along = there[..., 1:, :] & there[..., :-1, :] & _level(grid[..., 1:, :], grid[..., :-1, :])
    across = there[..., 1:] & there[..., :-1] & _level(grid[..., 1:], grid[..., :-1])
    squares = along[..., 1:] & along[..., :-1] & across[..., 1:, :] & across[..., :-1, :]
    return _total(there) - _total(along) - _total(across) + _total(squares)


def _within(places: tuple[float, ...]) -> slice:
    """Return the grid lines that lie in the window."""
    inside = np.flatnonzero(np.abs(np.asarray(places)) <= 0.5 * WINDOW)
    return slice(int(inside[0]), int(inside[-1]) + 1)


def _level(here: Array, there: Array) -> Array:
    return jnp.abs(here - there) <= STEP


def _total(flags: Array) -> Array:
    return jnp.sum(flags, axis=(-2, -1), dtype=jnp.float32)
