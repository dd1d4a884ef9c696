"""Roll-out: a steering method walks many robots at once, from their starts to their goals."""

from dataclasses import replace
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from flax import struct
from jax import Array
from jaxtyping import Bool, Float, Int

from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.terrain.atlas import Atlas
from jaxleas.types import GuidePath, InputError, RootMotion, cut_walks


@struct.dataclass
class Trips:
    """The starts and the waypoints of N robots.

    Attributes:
        atlas: terrains to walk on.
        map_index: terrain of each robot.
        start: root motion of each robot at its start.
        waypoints: points to reach one after another, the goal last [m]: x, y in the world, and the
            root's height wanted there.
    """

    atlas: Atlas
    map_index: Int[Array, " N"]
    start: RootMotion
    waypoints: Float[Array, "N W 3"]


@struct.dataclass
class RollOut:
    """N walks of up to T steps; configurations after a walk's end repeat the last one.

    Attributes:
        position: position of the root in the world [m].
        yaw: heading [rad].
        velocity: velocity of the root in the world [m/s].
        margin: margin of the environment's condition [m].
        valid: whether margin >= 0.
        end: index of the last configuration.
        reached: whether the last waypoint was reached with every configuration valid.
        invalid: whether the last configuration violates the condition.
        refused: whether the environment's foresight refused the configuration that would have come
            next.
    """

    position: Float[Array, "N T+1 3"]
    yaw: Float[Array, "N T+1"]
    velocity: Float[Array, "N T+1 3"]
    margin: Float[Array, "N T+1"]
    valid: Bool[Array, "N T+1"]
    end: Int[Array, " N"]
    reached: Bool[Array, " N"]
    invalid: Bool[Array, " N"]
    refused: Bool[Array, " N"]

    @property
    def motion(self) -> RootMotion:
        """The root motions, [N, T+1]."""
        return RootMotion(self.position, self.velocity, self.yaw)

    @property
    def stopped(self) -> Bool[Array, " N"]:
        """Whether a walk ended valid without reaching the goal: out of time, or refused."""
        return ~(self.reached | self.invalid)


@struct.dataclass
class _Walk:
    """The robots during the walk, and the record of their configurations, time first."""

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
        return ~(self.reached | self.invalid | self.refused)


@struct.dataclass
class _Course:
    """What stays the same during a walk, and the two halves of a step: look, then move."""

    atlas: Atlas
    map_index: Int[Array, " N"]
    waypoints: Float[Array, "N W 3"]
    radius: Float[Array, ""]
    env: SteeringEnv = struct.field(pytree_node=False)
    steps: int = struct.field(pytree_node=False)

    def begin(self, start: RootMotion) -> _Walk:
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
        return _Walk(jnp.int32(0), start, zero, zero, no, no, refused, memory, record)

    def goes_on(self, walk: _Walk) -> Bool[Array, ""]:
        return (walk.step <= self.steps) & jnp.any(walk.walking)

    def look(self, walk: _Walk) -> tuple[_Walk, Float[Array, "N points"], Float[Array, "N 3"]]:
        """Record and judge the configurations; also return local heights and goals."""
        heights = self.env.local_heights(self.atlas, self.map_index, walk.motion)
        margin = self.env.condition(heights, walk.motion)
        walking, sought = walk.walking, self._seek(walk)
        invalid = walking & ~(margin >= 0.0)  # a NaN margin is not valid, either
        refused, memory = self._foresee(walk, heights)
        refused &= walking & ~invalid
        walking &= ~refused
        walk = replace(
            walk,
            waypoint=sought,
            end=jnp.where(walking, walk.step, walk.end),
            reached=walk.reached | (walking & ~invalid & (sought == self.waypoints.shape[1])),
            invalid=walk.invalid | invalid,
            refused=walk.refused | refused,
            memory=memory,
            record=jax.tree.map(
                lambda whole, now: jax.lax.dynamic_update_index_in_dim(whole, now, walk.step, 0),
                walk.record,
                (walk.motion, margin),
            ),
        )
        last = jnp.minimum(sought, self.waypoints.shape[1] - 1)
        goal = jnp.take_along_axis(self.waypoints, last[:, None, None], axis=1)[:, 0]
        return walk, heights, goal

    def _foresee(self, walk: _Walk, heights: Float[Array, "N points"]) -> tuple[Array, Any]:
        """Return whom the foresight refuses now, and its memory; `begin` asked it at step 0."""
        if self.env.foresight is None:
            return jnp.zeros_like(walk.refused), walk.memory
        foreseen, after = self.env.foresight.follow(
            walk.memory, lambda pick, points: pick(heights)[..., points], walk.motion
        )
        later = walk.step > 0
        memory = jax.tree.map(lambda new, old: jnp.where(later, new, old), after, walk.memory)
        return later & ~(foreseen >= 0.0), memory

    def move(self, walk: _Walk, proposed: RootMotion) -> _Walk:
        """Move the robots that are still walking."""
        motion = jax.tree.map(
            lambda new, old: jnp.where(_like(walk.walking, new), new, old), proposed, walk.motion
        )
        return replace(walk, step=walk.step + 1, motion=motion)

    def finish(self, walk: _Walk) -> RollOut:
        """Return the record, robot first, the last configuration repeated to the end."""
        time = jnp.minimum(jnp.arange(self.steps + 1)[:, None], walk.end[None, :])
        motion, margin = jax.tree.map(
            lambda leaf: jnp.swapaxes(jnp.take_along_axis(leaf, _like(time, leaf), axis=0), 0, 1),
            walk.record,
        )
        return RollOut(
            position=motion.position,
            yaw=motion.yaw,
            velocity=motion.velocity,
            margin=margin,
            valid=margin >= 0.0,
            end=walk.end,
            reached=walk.reached,
            invalid=walk.invalid,
            refused=walk.refused,
        )

    def _seek(self, walk: _Walk) -> Int[Array, " N"]:
        """Return the first waypoint from the current one on that is far: several may be close."""
        offset = self.waypoints[..., :2] - walk.motion.position[:, None, :2]
        far = jnp.sum(offset * offset, axis=-1) > self.radius**2
        index = jnp.arange(self.waypoints.shape[1])
        ahead = far & (index[None, :] >= walk.waypoint[:, None])
        first = jnp.where(jnp.any(ahead, axis=1), jnp.argmax(ahead, axis=1), len(index))
        return first.astype(jnp.int32)


def roll_out(
    env: SteeringEnv, method: SteeringMethod, trips: Trips, steps: int, radius: float = 0.2
) -> RollOut:
    """Walk N robots with a steering method until each has arrived, failed, or used up its time.

    A walk ends where its last waypoint is reached (all of them within `radius`, horizontally, one
    after another), at its first invalid configuration (which belongs to it), before the first that
    the environment's foresight refuses (asked with chance 0: by its threshold alone), or after
    `steps` steps. The computation ends when every walk has ended. It is compiled once for each
    environment, kind of method and shapes.

    Args:
        env: steering task that observes, and whose condition judges each configuration.
        method: steering method; one that `runs_on_host` is called from a Python loop.
        trips: starts and waypoints of the robots.
        steps: maximum number of time steps of a walk.
        radius: distance within which a waypoint is reached [m] (T sec. 3.4.2).

    Raises:
        InputError: there is no robot to walk, no waypoint, or no step.
    """
    waypoints = jnp.asarray(trips.waypoints, jnp.float32)
    if steps < 1 or waypoints.ndim != 3 or 0 in waypoints.shape or waypoints.shape[-1] != 3:
        raise InputError(
            f"a roll-out needs robots, waypoints [robots, waypoints, 3] and steps: got waypoints"
            f" of shape {waypoints.shape} and {steps} steps"
        )
    map_index = jnp.asarray(trips.map_index, jnp.int32)
    course = _Course(trips.atlas, map_index, waypoints, jnp.float32(radius), env, steps)
    start = jax.tree.map(lambda leaf: jnp.asarray(leaf, jnp.float32), trips.start)
    if getattr(method, "runs_on_host", False):
        return _walk_on_host(course, method, start)
    if jax.tree_util.treedef_is_leaf(jax.tree.structure(method)):
        method = jax.tree_util.Partial(method)  # a plain callable, distinguished by identity
    return _walk_on_device(course, method, start)


@jax.jit
def _walk_on_device(course: _Course, method: SteeringMethod, start: RootMotion) -> RollOut:
    def step(walk: _Walk) -> _Walk:
        walk, heights, goal = course.look(walk)
        return course.move(walk, method(heights, walk.motion, goal))

    return course.finish(jax.lax.while_loop(course.goes_on, step, course.begin(start)))


def _walk_on_host(course: _Course, method: SteeringMethod, start: RootMotion) -> RollOut:
    # Copies: the arrays donated below must be neither the caller's start nor one array twice.
    walk = jax.tree.map(jnp.copy, course.begin(start))
    while course.goes_on(walk):
        walk, heights, goal = _look(course, walk)
        walk = _move(walk, method(heights, walk.motion, goal), course)
    return _finish(course, walk)


_look = jax.jit(_Course.look, donate_argnums=1)  # the record is changed in place
_finish = jax.jit(_Course.finish)
_move = jax.jit(lambda walk, proposed, course: course.move(walk, proposed), donate_argnums=0)


def paths(rollout: RollOut, time_step: float) -> list[GuidePath]:
    """Return each walk as a guide path, cut after its last configuration.

    Args:
        rollout: roll-out of N robots.
        time_step: time between two configurations [s].
    """
    host = jax.tree.map(np.asarray, rollout)
    return cut_walks(host, host.valid, host.end + 1, time_step)


def _like(flag: Array, leaf: Array) -> Array:
    """Append axes of size one until `flag` has as many as `leaf`."""
    return flag.reshape(flag.shape + (1,) * (leaf.ndim - flag.ndim))
