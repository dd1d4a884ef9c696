"""Fresh starts for episodes that are over, on the device; `host_starts` is the twin in NumPy."""

from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int, Key

from jaxleas.envs.task_values import Starts, select
from jaxleas.xla import take_inside


@struct.dataclass
class StartPool:
    """Candidates for the next starts, with the valid ones listed first.

    Attributes:
        state: state of each candidate.
        group: number of the group of each candidate.
        order: indices of the candidates, the valid ones first.
        valid_count: number of valid candidates.
    """

    state: Any
    group: Int[Array, " candidates"]
    order: Int[Array, " candidates"]
    valid_count: Int[Array, ""]


def pool_of(starts: Starts) -> StartPool:
    """Return starts as a pool; invalid ones are kept (shapes are fixed) but never used."""
    count = len(starts.valid)
    return StartPool(
        # A constant of the task may be NumPy's, which no traced index can pick from.
        state=jax.tree.map(jnp.asarray, starts.state),
        group=jnp.asarray(starts.group),
        order=jnp.nonzero(starts.valid, size=count, fill_value=0)[0].astype(jnp.int32),
        valid_count=jnp.sum(starts.valid, dtype=jnp.int32),
    )


def take(pool: StartPool, key: Key[Array, ""], count: int) -> tuple[Any, Int[Array, " count"]]:
    """Return the states and groups of `count` valid starts, drawn from the pool."""
    index = draw_picks(pool, key, (count,))
    return jax.tree.map(lambda leaf: leaf[index], (pool.state, pool.group))


def draw_picks(
    pool: StartPool, key: Key[Array, ""], shape: tuple[int, ...]
) -> Int[Array, "*shape"]:
    """Return indices of valid candidates, drawn uniformly."""
    # One random number each, where `randint` takes two; the bias is at most one in 2^13.
    count = jnp.maximum(pool.valid_count, 1)
    place = jax.random.uniform(key, shape) * count.astype(jnp.float32)
    return pool.order[jnp.minimum(place.astype(jnp.int32), count - 1)]


def draw_failing_picks(
    pool: StartPool,
    key: Key[Array, ""],
    shape: tuple[int, ...],
    rate: Float[Array, " groups"],
    share: float,
) -> Int[Array, "*shape"]:
    """Return indices of valid candidates, more often of groups that fail often.

    Args:
        pool: candidates for starts.
        key: random key, consumed here.
        shape: shape of the indices.
        rate: share of each group's episodes that failed, above 0.
        share: share of the indices that is drawn in proportion to `rate`; the rest is drawn evenly.
    """
    count = jnp.maximum(pool.valid_count, 1)
    valid = jnp.arange(len(pool.order)) < count
    failing = jnp.where(valid, rate[pool.group[pool.order]], 0.0)
    even = jnp.where(valid, (1.0 - share) / count, 0.0)
    ends = jnp.cumsum(even + failing * (share / jnp.sum(failing)))
    place = jnp.searchsorted(ends, jax.random.uniform(key, shape) * ends[-1], side="right")
    return pool.order[jnp.minimum(place, count - 1)]


def restart_where(
    done: Bool[Array, " batch"], state: Any, pool: StartPool, pick: Int[Array, " batch"]
) -> Any:
    """Give a fresh start to the robots whose episode is over; leave the others alone.

    Args:
        done: whether each episode is over.
        state: state of the episodes.
        pool: fresh starts.
        pick: index of the candidate that each robot would get (`draw_picks`).
    """
    # The other robots all read candidate 0, which stays in the cache.
    pick = jnp.where(done, pick, 0)
    fresh = jax.tree.map(lambda leaf: take_inside(leaf, pick), pool.state)
    return select(done, fresh, state)
