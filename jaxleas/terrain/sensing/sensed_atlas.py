"""The maps that robots see: an atlas with its errors, placed where the robot believes it lies."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Float, Int, Key

from jaxleas.terrain.atlas import Atlas
from jaxleas.terrain.sensing.config import NoiseConfig
from jaxleas.terrain.sensing.noise import sensed_map
from jaxleas.types import is_ground


@struct.dataclass
class Lag:
    """Where each root was when its map was placed, from where it is now.

    Attributes:
        shift: position then minus position now [m].
        turn: heading then minus heading now [rad].
    """

    shift: Float[Array, "*batch 3"]
    turn: Float[Array, "*batch"]


@struct.dataclass
class SensedAtlas:
    """Height maps as robots see them; it answers `heights_around` as an `Atlas` does.

    Attributes:
        atlas: seen heights; unknown cells have no ground.
        tilt: slopes by which each map is tilted about the root, ahead and to the left [1].
        is_tilted: whether any is.
        delay: number of time steps by which the maps are late.
        lag: lag of each robot's map; None: there is none.
    """

    atlas: Atlas
    tilt: Float[Array, "maps 2"]
    is_tilted: bool = struct.field(pytree_node=False)
    delay: int = struct.field(pytree_node=False)
    lag: Lag | None = None

    def late(self, lag: Lag) -> "SensedAtlas":
        """Return the same maps, each as late as its robot's lag says."""
        return replace(self, lag=lag)

    def heights_around(
        self,
        map_index: Int[Array, "*batch"],
        position: Float[Array, "*batch 3"],
        yaw: Float[Array, "*batch"],
        points_in_root: Float[np.ndarray, "points 2"],
        then: Callable[..., Array] = lambda heights: heights,
        *numbers: Float[Array, "*batch"],
    ) -> Float[Array, "*batch points"]:
        """Return seen heights under points fixed to the root, relative to the root [m].

        Args: those of `Atlas.heights_around`.
        """
        if self.lag is not None:
            position, yaw = position + self.lag.shift, yaw + self.lag.turn
        if not self.is_tilted:
            return self.atlas.heights_around(
                map_index, position, yaw, points_in_root, then, *numbers
            )
        ahead, left = (
            jnp.asarray(points_in_root[:, axis], jnp.float32).reshape((1,) * yaw.ndim + (-1,))
            for axis in (0, 1)
        )

        def tilted(heights: Array, along: Array, across: Array, *rest: Array) -> Array:
            return then(heights + along[..., None] * ahead + across[..., None] * left, *rest)

        slopes = self.tilt[map_index, 0], self.tilt[map_index, 1]
        where = map_index, position, yaw, points_in_root
        return self.atlas.heights_around(*where, tilted, *slopes, *numbers)


Terrains = Atlas | SensedAtlas
"""What can be asked for the heights around a robot."""


@struct.dataclass
class CellCount:
    """What became of the true ground's cells, as shares of them.

    Attributes:
        missing: share whose height was missing.
        filled: share that was filled from the rims of its gap.
        unknown: share whose height stayed unknown, and is seen as no ground.
    """

    missing: Array
    filled: Array
    unknown: Array


def sense(atlas: Atlas, noise: NoiseConfig, key: Key[Array, ""]) -> tuple[SensedAtlas, CellCount]:
    """Return the maps of an atlas as sensors give them, and what became of their cells.

    Args:
        atlas: true terrain.
        noise: what is wrong with the maps.
        key: random key, consumed here: each map has errors of its own.
    """
    heights, tilt, count = _sensed(atlas.heights, atlas.resolution, noise, key)
    seen = replace(atlas, heights=heights)
    return SensedAtlas(seen, tilt, bool(noise.drift), noise.delay), count


@partial(jax.jit, static_argnums=(1, 2))
def _sensed(
    heights: Array, resolution: float, noise: NoiseConfig, key: Array
) -> tuple[Array, Array, CellCount]:
    keys = jax.random.split(key, len(heights))

    def one(given: tuple[Array, Array]) -> tuple[Array, Array, Array]:
        true, its_key = given
        found = sensed_map(true, resolution, noise, its_key)
        # Not sums of all maps, which float32 would round.
        counts = (jnp.sum(each) for each in (is_ground(true), found.missing, found.unknown))
        return found.heights, found.tilt, jnp.stack([each.astype(jnp.float32) for each in counts])

    seen, tilt, counts = jax.lax.map(one, (heights, keys))  # one after another, to save memory
    ground, missing, unknown = jnp.sum(counts, axis=0)
    share = 1.0 / jnp.maximum(ground, 1.0)
    return seen, tilt, CellCount(missing * share, (missing - unknown) * share, unknown * share)
