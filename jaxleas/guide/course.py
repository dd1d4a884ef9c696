"""The steps of a roll-out: look at where each robot is, then move those that still walk."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.envs.steering import SteeringEnv, lag_between
from jaxleas.guide.trips import RollOut
from jaxleas.terrain import Atlas, SensedAtlas, Terrains
from jaxleas.types import RootMotion


@struct.dataclass
class OnTheWay:
    """The robots during a roll-out, and the record of their configurations, time first."""

    step: Int[Array, ""]
    motion: RootMotion
    waypoint: Int[Array, " N"]
    end: Int[Array, " N"]
    reached: Bool[Array, " N"]
    invalid: Bool[Array, " N"]
    refused: Bool[Array, " N"]
    memory: Any
    record: tuple[RootMotion, Float[Array, "T+1 N"]]

    @property
    def walking(self) -> Bool[Array, " N"]:
        """Whether each robot is still walking."""
        return ~(self.reached | self.invalid | self.refused)


@struct.dataclass
class Course:
    """What stays the same during a roll-out, and the two halves of a step: look, then move."""

    atlas: Atlas
    map_index: Int[Array, " N"]
    waypoints: Float[Array, "N W 3"]
    radius: Float[Array, ""]
    env: SteeringEnv = struct.field(pytree_node=False)
    steps: int = struct.field(pytree_node=False)
    sensed: SensedAtlas | None = None

    def begin(self, start: RootMotion) -> OnTheWay:
        """Return the robots at their starts."""
        count = len(self.map_index)
        record = jax.tree.map(
            lambda leaf: jnp.zeros((self.steps + 1, *leaf.shape), leaf.dtype), (start, start.yaw)
        )
        zero, no = jnp.zeros(count, jnp.int32), jnp.zeros(count, bool)
        refused, memory = no, ()
        if self.env.foresight is not None:
            heights = self.env.local_heights(self.atlas, self.map_index, start)
            foreseen, memory = self.env.foresight.begin(heights, start, jnp.zeros(count))
            refused = ~(foreseen >= 0.0)
        return OnTheWay(jnp.int32(0), start, zero, zero, no, no, refused, memory, record)

    def goes_on(self, robots: OnTheWay) -> Bool[Array, ""]:
        """Return whether a robot is still walking and has time left."""
        return (robots.step <= self.steps) & jnp.any(robots.walking)

    def look(
        self, robots: OnTheWay
    ) -> tuple[OnTheWay, Float[Array, "N points"], Float[Array, "N 3"]]:
        """Record the configurations and their margins; also return heights seen, and goals.

        Margins are those of the true terrain.
        """
        heights = self.env.local_heights(self.atlas, self.map_index, robots.motion)
        margin = self.env.condition(heights, robots.motion)
        walking, sought = robots.walking, self._seek(robots)
        invalid = walking & ~(margin >= 0.0)  # a NaN margin is not valid, either
        refused, memory = self._foresee(robots, heights)
        refused &= walking & ~invalid
        walking &= ~refused
        robots = replace(
            robots,
            waypoint=sought,
            end=jnp.where(walking, robots.step, robots.end),
            reached=robots.reached | (walking & ~invalid & (sought == self.waypoints.shape[1])),
            invalid=robots.invalid | invalid,
            refused=robots.refused | refused,
            memory=memory,
            record=jax.tree.map(
                lambda whole, now: jax.lax.dynamic_update_index_in_dim(whole, now, robots.step, 0),
                robots.record,
                (robots.motion, margin),
            ),
        )
        last = jnp.minimum(sought, self.waypoints.shape[1] - 1)
        goal = jnp.take_along_axis(self.waypoints, last[:, None, None], axis=1)[:, 0]
        if self.sensed is not None:
            heights = self.env.local_heights(self._seen(robots), self.map_index, robots.motion)
        return robots, heights, goal

    def _seen(self, robots: OnTheWay) -> Terrains:
        """Return what the robots see of the terrain, this step's motion being recorded."""
        if self.sensed is None or not self.sensed.delay:
            return self.atlas if self.sensed is None else self.sensed
        then = jnp.maximum(robots.step - self.sensed.delay, 0)
        past = jax.tree.map(lambda whole: whole[then], robots.record[0])
        now = robots.motion
        return self.sensed.late(lag_between(now.position, now.yaw, past.position, past.yaw))

    def _foresee(self, robots: OnTheWay, heights: Float[Array, "N points"]) -> tuple[Array, Any]:
        """Return whom the foresight refuses now, and its memory; `begin` asked it at step 0."""
        if self.env.foresight is None:
            return jnp.zeros_like(robots.refused), robots.memory
        foreseen, after = self.env.foresight.follow(
            robots.memory, lambda pick, points: pick(heights)[..., points], robots.motion
        )
        later = robots.step > 0
        memory = jax.tree.map(lambda new, old: jnp.where(later, new, old), after, robots.memory)
        return later & ~(foreseen >= 0.0), memory

    def move(self, robots: OnTheWay, proposed: RootMotion, guarded: bool = False) -> OnTheWay:
        """Move the robots that are still walking.

        Args:
            robots: robots on their way.
            proposed: motion that the steering method proposes for each robot.
            guarded: whether the environment's guard, if it has one, watches over the method.
        """
        if guarded and self.env.guard is not None:
            proposed = self.env.guard(self._seen(robots), self.map_index, robots.motion, proposed)
        motion = jax.tree.map(
            lambda new, old: jnp.where(_like(robots.walking, new), new, old),
            proposed,
            robots.motion,
        )
        return replace(robots, step=robots.step + 1, motion=motion)

    def finish(self, robots: OnTheWay) -> RollOut:
        """Return the record, robot first, the last configuration repeated to the end."""
        time = jnp.minimum(jnp.arange(self.steps + 1)[:, None], robots.end[None, :])
        motion, margin = jax.tree.map(
            lambda leaf: jnp.swapaxes(jnp.take_along_axis(leaf, _like(time, leaf), axis=0), 0, 1),
            robots.record,
        )
        return RollOut(
            position=motion.position,
            yaw=motion.yaw,
            velocity=motion.velocity,
            margin=margin,
            valid=margin >= 0.0,
            end=robots.end,
            reached=robots.reached,
            invalid=robots.invalid,
            refused=robots.refused,
        )

    def _seek(self, robots: OnTheWay) -> Int[Array, " N"]:
        """Return the first waypoint from the current one on that is far: several may be close."""
        offset = self.waypoints[..., :2] - robots.motion.position[:, None, :2]
        far = jnp.sum(offset * offset, axis=-1) > self.radius**2
        index = jnp.arange(self.waypoints.shape[1])
        ahead = far & (index[None, :] >= robots.waypoint[:, None])
        first = jnp.where(jnp.any(ahead, axis=1), jnp.argmax(ahead, axis=1), len(index))
        return first.astype(jnp.int32)


def _like(flag: Array, leaf: Array) -> Array:
    """Append axes of size one until `flag` has as many as `leaf`."""
    return flag.reshape(flag.shape + (1,) * (leaf.ndim - flag.ndim))
