"""A root at walking height over the ground."""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float, Int

from jaxleas.robots import Robot
from jaxleas.terrain import Atlas
from jaxleas.types import is_ground


def standing_position(
    robot: Robot, atlas: Atlas, map_index: Int[Array, " N"], horizontal: Float[Array, "N 2"]
) -> Float[Array, "N 3"]:
    """Return root positions at walking height over the ground; over the void, above z = 0.

    Args:
        robot: robot that stands.
        atlas: height maps of the terrains.
        map_index: terrain of each root.
        horizontal: x, y of each root [m].
    """
    ground = atlas.height_at(map_index, horizontal[:, None, :])
    # A root at walking height over the void would see the void as ground and count as valid.
    ground = jnp.where(is_ground(ground), ground, 0.0)
    return jnp.concatenate([horizontal, ground + robot.walking_height], axis=-1)
