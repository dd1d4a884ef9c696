"""Narrow gaps of missing cells are filled from their rims."""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Bool, Float

from jaxleas.types import NO_GROUND, is_ground


def cells_across(width: float, resolution: float) -> int:
    """Return how many whole cells fit into a width."""
    return int(width / resolution + 1e-6)


def filled_gaps(
    heights: Float[Array, "rows columns"], missing: Bool[Array, "rows columns"], widest: int
) -> tuple[Float[Array, "rows columns"], Bool[Array, "rows columns"]]:
    """Return heights with narrow gaps filled, and which cells are still missing.

    A missing cell is filled if along its row or its column the gap in which it lies is at most
    `widest` cells across. Its height lies on the line between the two ends of that gap; with both
    gaps narrow it is the mean of the two. Where an end has no ground, neither has the cell: a map
    must not promise ground. What is off the map counts as known, without ground.

    Args:
        heights: heights [m]; those of missing cells do not matter.
        missing: cells whose height is missing.
        widest: width of the widest gap that is filled [cells].
    """
    if widest < 1:
        return jnp.where(missing, NO_GROUND, heights), missing
    total, count = jnp.zeros_like(heights), jnp.zeros_like(heights)
    grounded = jnp.ones_like(missing)
    for axis in (0, 1):
        before, to_before = _nearest_known(heights, missing, widest, axis, 1)
        after, to_after = _nearest_known(heights, missing, widest, axis, -1)
        narrow = missing & (to_before + to_after <= widest + 1)
        on_line = before + (after - before) * (to_before / (to_before + to_after))
        total += jnp.where(narrow, on_line, 0.0)
        count += narrow
        grounded &= ~narrow | (is_ground(before) & is_ground(after))
    left = missing & (count == 0)
    inside = jnp.where(grounded, total / jnp.maximum(count, 1.0), NO_GROUND)
    return jnp.where(missing, jnp.where(left, NO_GROUND, inside), heights), left


def _nearest_known(
    heights: Array, missing: Array, widest: int, axis: int, direction: int
) -> tuple[Array, Array]:
    """Return the height of the nearest known cell on one side, and how many cells it is away.

    None within `widest` cells: the distance is too long for any gap that is filled.
    """
    height = jnp.full_like(heights, NO_GROUND)
    distance = jnp.full_like(heights, widest + 1.0)
    for step in range(widest, 0, -1):
        there = _shifted(heights, direction * step, axis, NO_GROUND)
        known = ~_shifted(missing, direction * step, axis, False)
        height = jnp.where(known, there, height)
        distance = jnp.where(known, float(step), distance)
    return height, distance


def _shifted(values: Array, by: int, axis: int, outside: float | bool) -> Array:
    """Return values moved along an axis; what comes from outside has one value."""
    count = values.shape[axis]
    index = jnp.arange(count) - by
    inside = (index >= 0) & (index < count)
    moved = jnp.take(values, jnp.clip(index, 0, count - 1), axis=axis)
    return jnp.where(inside.reshape((-1, 1) if axis == 0 else (1, -1)), moved, outside)
