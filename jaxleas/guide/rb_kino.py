"""RB-Kino: double integrators in minimum time (T sec. 3.1.1, 3.4.1); it knows no terrain."""

import math

import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Float

from jaxleas.envs.steering import MotionLimits
from jaxleas.geometry import wrap_angle
from jaxleas.guide.double_integrator import Connection, connect
from jaxleas.types import InputError, RootMotion

STANDING = 1e-4  # [m/s]: slower than this along the ground, a velocity shows no heading


@struct.dataclass
class RbKino:
    """Move to rest at the goal as fast as bounded velocities and accelerations allow.

    The slowest axis sets the time, and the others take as long (`double_integrator.connect`); yaw
    follows the horizontal velocity and therefore jumps at the start. The method has no state: the
    rest of a connection is itself the connection from there to the goal, so that solving it again
    at each step gives the motion that was solved at the start.

    Attributes:
        time_step: time between two configurations [s].
        max_velocity: bound on each axis's velocity [m/s]; a robot that starts faster along an
            axis may keep that speed.
        max_acceleration: bound on each axis's acceleration [m/s^2].
    """

    time_step: float = struct.field(pytree_node=False)
    max_velocity: float = struct.field(pytree_node=False)
    max_acceleration: float = struct.field(pytree_node=False)

    def __call__(
        self,
        heights_in_root: Float[Array, "*batch points"],
        motion: RootMotion,
        goal: Float[Array, "*batch 3"],
    ) -> RootMotion:
        """Return the root motion one time step later."""
        del heights_in_root
        connection = self.connection(motion, goal)
        return self.along(connection, motion, jnp.full_like(motion.yaw, self.time_step))

    def connection(self, motion: RootMotion, goal: Float[Array, "*batch 3"]) -> Connection:
        """Return the whole connection to rest at a goal.

        Args:
            motion: root motion at the start.
            goal: root position in the world [m].
        """
        limit = jnp.maximum(jnp.abs(motion.velocity), self.max_velocity)
        return connect(
            goal - motion.position,
            motion.velocity,
            jnp.zeros_like(motion.velocity),
            limit,
            jnp.full_like(limit, self.max_acceleration),
        )

    def along(
        self, connection: Connection, motion: RootMotion, time: Float[Array, "*batch"]
    ) -> RootMotion:
        """Return the root motion on the way.

        Args:
            connection: connection that begins with `motion`.
            motion: root motion at the start.
            time: time since the start [s].
        """
        covered, velocity = connection.at(time)
        # At the end the robot stands, with the heading of its last movement.
        last = jnp.maximum(connection.duration - 0.5 * self.time_step, 0.0)
        _, heading = connection.at(jnp.minimum(time, last))
        speed = jnp.sqrt(jnp.sum(heading[..., :2] ** 2, axis=-1))
        moves = speed > STANDING
        x = jnp.where(moves, heading[..., 0], 1.0)
        course = wrap_angle(jnp.arctan2(jnp.where(moves, heading[..., 1], 0.0), x))
        return RootMotion(
            position=motion.position + covered,
            velocity=velocity,
            yaw=jnp.where(moves, course, motion.yaw),
        )


def rb_kino(limits: MotionLimits, desired_speed: float) -> RbKino:
    """Return RB-Kino, tuned to walk at v_desired (T sec. 4.3, 5.4).

    Each axis is bounded by v_desired and a_max / sqrt(3), and by v_max / sqrt(3): whatever the
    direction, the norms stay within v_max and a_max.

    Args:
        limits: motion limits: time step, v_max and a_max.
        desired_speed: v_desired [m/s].

    Raises:
        InputError: the speed is not in (0, v_max].
    """
    if not 0.0 < desired_speed <= limits.max_speed:
        raise InputError(
            f"RB-Kino cannot walk at {desired_speed} m/s: give a speed above 0 and at most"
            f" max_speed = {limits.max_speed} m/s"
        )
    share = 1.0 / math.sqrt(3.0)
    return RbKino(
        limits.time_step,
        min(desired_speed, share * limits.max_speed),
        share * limits.max_acceleration,
    )
