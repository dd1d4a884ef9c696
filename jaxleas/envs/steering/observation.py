"""The observation of the policy (T eq. 3.1)."""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering.layout import MOTION_SIZE
from jaxleas.geometry import rotate_by_yaw, squared_length
from jaxleas.types import RootMotion
from jaxleas.xla import bearing


def direction_to_goal(
    motion: RootMotion, goal: Float[Array, "*batch 2"]
) -> tuple[Float[Array, "*batch 2"], Float[Array, "*batch"]]:
    """Return the horizontal unit vector to the goal (zero at the goal) and its distance [m]."""
    offset = goal - motion.position[..., :2]
    distance = jnp.sqrt(squared_length(offset))
    return offset / jnp.maximum(distance, 1e-6)[..., None], distance


def seen_motion(motion: RootMotion, goal: Float[Array, "*batch 2"]) -> tuple[Array, ...]:
    """Return the part of an observation about motion and goal: `MOTION_SIZE` numbers per robot.

    They are the velocity in the root frame [m/s] and the angle to the goal [rad].

    Args:
        motion: motion of the root.
        goal: position of the goal in the world frame [m].
    """
    toward, _ = direction_to_goal(motion, goal)
    toward_in_root = rotate_by_yaw(toward, -motion.yaw)
    angle = bearing(toward_in_root[..., 0], toward_in_root[..., 1])
    velocity_in_root = rotate_by_yaw(motion.velocity, -motion.yaw)
    return velocity_in_root[..., 0], velocity_in_root[..., 1], velocity_in_root[..., 2], angle


def write_observation(
    columns: Float[Array, "*batch size"],
    *seen: Float[Array, "*batch"],
    height_range: tuple[float, float],
) -> Float[Array, "*batch size"]:
    """Assemble an observation, in physical units: s = [v, angle to the goal, heights] (T eq. 3.1).

    Args:
        columns: `MOTION_SIZE` values that are overwritten, then the heights of the layout's grid
            points relative to the root [m]; joining arrays would cost a copy.
        seen: values about motion and goal, from `seen_motion`.
        height_range: bounds z_min and z_max to which heights are clipped [m].
    """
    low, high = height_range
    # `where`, not `clip`: heights are finite, and `clip` also handles NaN at twice the cost.
    observation = jnp.where(columns > low, columns, low)
    observation = jnp.where(observation < high, observation, high)
    return observation.at[..., :MOTION_SIZE].set(jnp.stack(seen, axis=-1))
