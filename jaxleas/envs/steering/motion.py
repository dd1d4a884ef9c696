"""Motion of the root under an action (T eq. 3.2, 3.3)."""

import jax.numpy as jnp
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering.config import MotionLimits
from jaxleas.geometry import bound_norm, rotate_by_yaw, wrap_angle
from jaxleas.types import RootMotion


def scale_action(
    action: Float[Array, "*batch 4"], limits: MotionLimits
) -> Float[Array, "*batch 4"]:
    """Turn a network's action into acceleration in the root frame [m/s^2] and turn rate [rad/s].

    The network answers in [-1, 1]^4; the acceleration's norm is bounded by a_max (T sec. 3.2.3).
    """
    acceleration = bound_norm(jnp.clip(action[..., :3], -1.0, 1.0), 1.0) * limits.max_acceleration
    turn_rate = jnp.clip(action[..., 3:], -1.0, 1.0) * limits.max_turn_rate
    return jnp.concatenate([acceleration, turn_rate], axis=-1)


def integrate(
    motion: RootMotion, command: Float[Array, "*batch 4"], limits: MotionLimits
) -> RootMotion:
    """Move the root for one time step, in the order of T eq. 3.3.

    (a) position += velocity T, with the previous velocity; (b) velocity += acceleration T, its
    norm bounded by v_max; (c) yaw += omega T.

    Args:
        motion: motion of the root.
        command: acceleration in the root frame [m/s^2] and turn rate [rad/s].
        limits: limits of the motion, and the time step.
    """
    step = limits.time_step
    acceleration_in_world = rotate_by_yaw(command[..., :3], motion.yaw)
    return RootMotion(
        position=motion.position + motion.velocity * step,
        velocity=bound_norm(motion.velocity + acceleration_in_world * step, limits.max_speed),
        yaw=wrap_angle(motion.yaw + command[..., 3] * step),
    )
