"""The guard: a command is obeyed only where the robot could still brake to rest, valid all the way.

A robot that can brake to rest along valid configurations has a way to stay valid whatever it is
asked to do next: braking. The guard obeys a command if that is still so afterwards, and otherwise
leaves out the turn; or stands, but rises or sinks as asked, so that a step that seems too high
can be met higher up; or, at last, brakes. By induction a robot that could brake at its start stays
valid on any map, whatever its policy has learned; where it goes is the policy's business alone.

Besides, it leaves some room, because a map has cells. A robot that begins with less may go wherever
it is valid and the margin of that room gets no worse, so that it can leave.
"""

from collections.abc import Callable
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.conditions import (
    Collision,
    StrictReachability,
    all_of,
    footprint_points,
    read_from,
    union_of_points,
)
from jaxleas.envs.steering.config import MotionLimits, SteeringConfig
from jaxleas.envs.steering.spare import points_with_spare, with_larger_trunk
from jaxleas.geometry import bound_norm, squared_length
from jaxleas.robots import Robot
from jaxleas.terrain import Terrains
from jaxleas.types import RootMotion

MarginsOnMap = Callable[[Terrains, Array, RootMotion], Array]
"""A function from terrains, the index of each robot's terrain and motions to two margins each [m]:
of the conditions, and of the conditions with room to spare."""

Points = Float[np.ndarray, "points 2"]

SPACING = 0.04
"""Largest distance of the points along the trunk's outline that are judged [m], where the
configuration states none (`env.outline_spacing`)."""


@dataclass(frozen=True, eq=False)
class Guard:
    """Braking in time; holds constants only.

    Attributes:
        limits: limits of the root's motion.
        margins: margins of a configuration.
    """

    limits: MotionLimits
    margins: MarginsOnMap

    def __call__(
        self,
        atlas: Terrains,
        map_index: Int[Array, "*batch"],
        motion: RootMotion,
        asked: RootMotion,
    ) -> RootMotion:
        """Return the motion that is asked for, or one that stays valid.

        Args:
            atlas: height maps of the terrains, as the robots see them.
            map_index: index of each robot's terrain.
            motion: motion of the root now.
            asked: motion one time step later, if the command is obeyed.
        """
        straight = RootMotion(asked.position, asked.velocity, motion.yaw)
        upright = RootMotion(asked.position, self.upright(motion, asked), motion.yaw)
        stopping = RootMotion(asked.position, self.slower(motion.velocity), motion.yaw)
        room = jnp.minimum(self.margins(atlas, map_index, motion)[..., 1], 0.0)
        tried = jax.tree.map(lambda *each: jnp.stack(each), asked, straight, upright)
        shape = tried.yaw.shape
        maps, rooms = (jnp.broadcast_to(each[None], shape) for each in (map_index, room))
        fine = self.can_stop(atlas, maps, rooms, tried)
        standing = _chosen(fine[2], upright, stopping)
        return _chosen(fine[0], asked, _chosen(fine[1], straight, standing))

    def can_stop(
        self,
        atlas: Terrains,
        map_index: Int[Array, "*batch"],
        room: Float[Array, "*batch"],
        motion: RootMotion,
    ) -> Bool[Array, "*batch"]:
        """Return whether every configuration is valid in which braking robots would be.

        Args:
            atlas: height maps of the terrains.
            map_index: index of each robot's terrain.
            room: least margin that the conditions with room to spare must have [m].
            motion: motion from which the robots brake, itself included.
        """

        def goes_on(carry: tuple[RootMotion, Array, Array]) -> Array:
            _, fine, at_rest = carry
            return jnp.any(fine & ~at_rest)

        def step(carry: tuple[RootMotion, Array, Array]) -> tuple[RootMotion, Array, Array]:
            motion, fine, _ = carry
            margins = self.margins(atlas, map_index, motion)
            fine &= (margins[..., 0] >= 0.0) & (margins[..., 1] >= room)
            after = RootMotion(
                position=motion.position + motion.velocity * self.limits.time_step,
                velocity=self.slower(motion.velocity),
                yaw=motion.yaw,
            )
            return after, fine, squared_length(motion.velocity) == 0.0

        none = jnp.zeros(motion.yaw.shape, bool)
        return jax.lax.while_loop(goes_on, step, (motion, ~none, none))[1]

    def upright(self, motion: RootMotion, asked: RootMotion) -> Float[Array, "*batch 3"]:
        """Return the velocity one time step later, towards the asked one's vertical part [m/s]."""
        wanted = asked.velocity * jnp.asarray([0.0, 0.0, 1.0]).reshape(
            (1,) * (asked.velocity.ndim - 1) + (3,)
        )
        return motion.velocity + bound_norm(wanted - motion.velocity, self._loss)

    def slower(self, velocity: Float[Array, "*batch 3"]) -> Float[Array, "*batch 3"]:
        """Return the velocity one time step later, braking as hard as possible [m/s]."""
        speed = _speed(velocity)
        return velocity * jnp.maximum(1.0 - self._loss / speed, 0.0)[..., None]

    @property
    def _loss(self) -> float:
        """Speed that braking takes off in one time step [m/s]."""
        return self.limits.max_acceleration * self.limits.time_step


def guard_of(config: SteeringConfig, robot: Robot, sampled: Points) -> Guard:
    """Return the guard of a configuration.

    Args:
        config: configuration of the task.
        robot: robot that walks.
        sampled: points whose heights the environment samples, in the root frame [m].
    """
    both = [all_of(*terms) for terms in guard_terms(config, robot, sampled)]
    points = union_of_points([each.points_in_root for each in both])
    valid, spared = (read_from(points, each) for each in both)

    def margins(atlas: Terrains, map_index: Array, motion: RootMotion) -> Array:
        def judge(heights: Array) -> Array:
            return jnp.stack([valid(heights, motion), spared(heights, motion)], axis=-1)

        return atlas.heights_around(map_index, motion.position, motion.yaw, points, judge)

    return Guard(config.limits, margins)


def guard_terms(
    config: SteeringConfig, robot: Robot, sampled: Points
) -> tuple[tuple[StrictReachability, Collision], tuple[StrictReachability, Collision]]:
    """Return what a guard keeps: R* and C as the environment judges them, and with room to spare.

    Args:
        config: configuration of the task.
        robot: robot that walks.
        sampled: points whose heights the environment samples, in the root frame [m].
    """
    spare, spacing = config.guard.spare, config.outline_spacing or SPACING
    larger = with_larger_trunk(robot, spare)
    points = points_with_spare(footprint_points(robot), larger, spacing, spare)
    return (
        (StrictReachability(robot, sampled), Collision(robot, sampled)),
        (StrictReachability(robot, points), Collision(larger, points)),
    )


def _speed(velocity: Float[Array, "*batch 3"]) -> Float[Array, "*batch"]:
    return jnp.sqrt(squared_length(velocity) + 1e-12)  # so that it can be divided by


def _chosen(flag: Bool[Array, "*batch"], yes: RootMotion, no: RootMotion) -> RootMotion:
    def choose(yes: Array, no: Array) -> Array:
        return jnp.where(flag.reshape(flag.shape + (1,) * (yes.ndim - flag.ndim)), yes, no)

    return jax.tree.map(choose, yes, no)
