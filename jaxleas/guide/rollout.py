"""Roll-out: a steering method walks many robots at once, from their starts to their goals."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np

from jaxleas.envs.steering import SteeringEnv
from jaxleas.guide.course import Course, OnTheWay
from jaxleas.guide.steering_method import SteeringMethod
from jaxleas.guide.trips import RollOut, Trips
from jaxleas.types import GuidePath, InputError, RootMotion, cut_walks

__all__ = ["RollOut", "Trips", "paths", "roll_out"]


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
    course = Course(
        trips.atlas, map_index, waypoints, jnp.float32(radius), env, steps, trips.sensed
    )
    start = jax.tree.map(lambda leaf: jnp.asarray(leaf, jnp.float32), trips.start)
    guarded = getattr(method, "guarded", False)
    if getattr(method, "runs_on_host", False):
        return _walk_on_host(course, method, start, guarded)
    if jax.tree_util.treedef_is_leaf(jax.tree.structure(method)):
        method = jax.tree_util.Partial(method)  # a plain callable, distinguished by identity
    return _walk_on_device(course, method, start, guarded)


@partial(jax.jit, static_argnames="guarded")
def _walk_on_device(
    course: Course, method: SteeringMethod, start: RootMotion, guarded: bool
) -> RollOut:
    def step(robots: OnTheWay) -> OnTheWay:
        robots, heights, goal = course.look(robots)
        return course.move(robots, method(heights, robots.motion, goal), guarded)

    return course.finish(jax.lax.while_loop(course.goes_on, step, course.begin(start)))


def _walk_on_host(
    course: Course, method: SteeringMethod, start: RootMotion, guarded: bool
) -> RollOut:
    # Copies: the arrays donated below must be neither the caller's start nor one array twice.
    robots = jax.tree.map(jnp.copy, course.begin(start))
    while course.goes_on(robots):
        robots, heights, goal = _look(course, robots)
        proposed = method(heights, robots.motion, goal)
        robots = _move(robots, proposed, course, guarded=guarded)
    return _finish(course, robots)


_look = jax.jit(Course.look, donate_argnums=1)  # the record is changed in place
_finish = jax.jit(Course.finish)
_move = jax.jit(
    lambda robots, proposed, course, guarded: course.move(robots, proposed, guarded),
    donate_argnums=0,
    static_argnames="guarded",
)


def paths(rollout: RollOut, time_step: float) -> list[GuidePath]:
    """Return each walk as a guide path, cut after its last configuration.

    Args:
        rollout: roll-out of N robots.
        time_step: time between two configurations [s].
    """
    host = jax.tree.map(np.asarray, rollout)
    return cut_walks(host, host.valid, host.end + 1, time_step)
