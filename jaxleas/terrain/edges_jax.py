"""Edges of many height maps at once, in JAX; `edges.find_edges` is the same for one, in SciPy."""

from functools import partial

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float

from jaxleas.terrain.edges import WINDOW, EdgeSearch
from jaxleas.types import NO_GROUND, is_ground

_FAR = 1e9
"""Squared distance from a row without unsafe cells [cells^2]; larger than any in a map."""


@partial(jax.jit, static_argnames="search")
def edge_distances(
    heights: Float[Array, "maps rows columns"], resolution: float, search: EdgeSearch
) -> tuple[
    Float[Array, "maps rows columns"],
    Bool[Array, "maps rows columns"],
    Float[Array, "maps rows columns"],
]:
    """Return filtered heights, unsafe cells and distances to them of each map of a batch.

    Args:
        heights: heights [m]; `NO_GROUND` where there is none.
        resolution: edge of a cell [m].
        search: what counts as an edge.

    Returns:
        What `Edges` holds of one map, with `NO_GROUND` instead of NaN.
    """
    filtered = jax.vmap(partial(_filtered, search=search))(heights)
    unsafe = jax.vmap(partial(_edge_cells, rise=search.rise))(filtered)
    return filtered, unsafe, resolution * jax.vmap(_distance_in_cells)(unsafe)


def _windows(heights: Float[Array, "rows columns"]) -> Float[Array, "9 rows columns"]:
    """Return the nine cells around each cell; the border continues beyond the map."""
    rows, columns = heights.shape
    framed = jnp.pad(heights, 1, mode="edge")
    return jnp.stack(
        [framed[i : i + rows, j : j + columns] for i in range(WINDOW) for j in range(WINDOW)]
    )


def _filtered(
    heights: Float[Array, "rows columns"], search: EdgeSearch
) -> Float[Array, "rows columns"]:
    closed = heights
    if search.closes:
        closed = _windows(_windows(heights).max(axis=0)).min(axis=0)
    for _ in range(search.medians):
        windows = _windows(closed)
        known = is_ground(windows)
        ordered = jnp.sort(jnp.where(known, windows, -NO_GROUND), axis=0)
        middle = jnp.maximum(known.sum(axis=0) - 1, 0) // 2
        median = jnp.take_along_axis(ordered, middle[None], axis=0)[0]
        closed = jnp.where(is_ground(closed), median, NO_GROUND)
    return closed


def _edge_cells(heights: Float[Array, "rows columns"], rise: float) -> Bool[Array, "rows columns"]:
    windows = _windows(heights)
    return ~is_ground(heights) | (windows.max(axis=0) - windows.min(axis=0) > rise)


def _distance_in_cells(unsafe: Bool[Array, "rows columns"]) -> Float[Array, "rows columns"]:
    """Return the exact Euclidean distance to the nearest unsafe cell, by rows, then by columns."""
    framed = jnp.pad(unsafe, 1, constant_values=True)
    squared = jnp.where(framed, 0.0, _FAR)
    squared = _lower_envelope(_lower_envelope(squared).T).T
    return jnp.sqrt(squared)[1:-1, 1:-1]


def _lower_envelope(squared: Float[Array, "rows columns"]) -> Float[Array, "rows columns"]:
    """Return, for each cell, the least of what its row holds plus the squared distance along it."""
    place = jnp.arange(squared.shape[1], dtype=squared.dtype)

    def nearer(index, least):
        column = jax.lax.dynamic_index_in_dim(squared, index, axis=1)
        return jnp.minimum(least, column + ((place - place[index]) ** 2)[None])

    return jax.lax.fori_loop(0, squared.shape[1], nearer, squared)
