"""RB-Lin: turn to the goal, then walk straight (T sec. 3.1.1); it knows no terrain."""

import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering import MotionLimits
from jaxleas.geometry import wrap_angle
from jaxleas.types import InputError, RootMotion

# A heading counts as facing the goal if walking along it would miss the goal by less than this [m].
# A bound on the angle would not suffice: close to the goal the bearing is mostly rounding.
FACING = 1e-4


@struct.dataclass
class RbLin:
    """Turn on the spot at omega_max, then move in a straight line in space at v_desired.

    The method has no state and is exact: the last turn and the last step are shortened to end on
    the goal.

    Attributes:
        time_step: time between two configurations [s].
        max_turn_rate: omega_max [rad/s].
        desired_speed: v_desired [m/s].
    """

    time_step: float = struct.field(pytree_node=False)
    max_turn_rate: float = struct.field(pytree_node=False)
    desired_speed: float = struct.field(pytree_node=False)

    def __call__(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 3"],
    ) -> RootMotion:
        """Return the root motion one time step later.

        Its velocity is that of the step just made: zero while turning.
        """
        del heights_in_root
        offset = goal - motion.position
        horizontal = _norm(offset[..., :2])
        bearing = jnp.arctan2(offset[..., 1], offset[..., 0])
        error = wrap_angle(bearing - motion.yaw)
        facing = jnp.abs(error) * horizontal <= FACING

        most = self.max_turn_rate * self.time_step
        turned = jnp.where(
            jnp.abs(error) <= most, bearing, motion.yaw + jnp.clip(error, -most, most)
        )
        distance = _norm(offset)
        stride = self.desired_speed * self.time_step
        share = stride / jnp.maximum(distance, stride)  # 1 within a stride: land on the goal
        step = jnp.where(facing[..., None], share[..., None] * offset, jnp.zeros_like(offset))
        return RootMotion(
            position=motion.position + step,
            velocity=step / self.time_step,
            yaw=jnp.where(facing, motion.yaw, wrap_angle(turned)),
        )


def rb_lin(limits: MotionLimits, desired_speed: float) -> RbLin:
    """Return RB-Lin (T sec. 3.1.1, 3.4.1).

    Args:
        limits: motion limits: time step and turn rate.
        desired_speed: v_desired [m/s].

    Raises:
        InputError: the speed is not in (0, v_max].
    """
    if not 0.0 < desired_speed <= limits.max_speed:
        raise InputError(
            f"RB-Lin cannot walk at {desired_speed} m/s: give a speed above 0 and at most"
            f" max_speed = {limits.max_speed} m/s"
        )
    return RbLin(limits.time_step, limits.max_turn_rate, desired_speed)


def _norm(vector: Float[Array, "*batch D"]) -> Float[Array, "*batch"]:
    return jnp.sqrt(jnp.sum(vector * vector, axis=-1))
