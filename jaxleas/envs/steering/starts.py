"""Fresh starts: terrain, position, heading, velocity and goals, drawn anew and checked."""

from typing import Any

import jax
import jax.numpy as jnp
from jax import Array
from jaxtyping import Float, Key

from jaxleas.envs import Starts, pool_of, take
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.own_terrain import OwnStarts, draw_own_starts
from jaxleas.envs.steering.standing import standing_position
from jaxleas.envs.steering.state import GOALS, Route, SteeringState
from jaxleas.envs.steering.world import World
from jaxleas.types import RootMotion, is_ground

FOREVER = 2**30  # steps


def draw_starts(
    env: SteeringEnv,
    world: World,
    key: Key[Array, ""],
    count: int,
    wander_share: float | None = None,
) -> Starts:
    """Draw candidates for starts: a random link, anywhere in its start area, any heading.

    A share of them falls on terrain files instead, if the world has any: anywhere, with goals
    within walking distance.

    Every call draws anew, so no start is ever replayed. Candidates that violate the condition, or
    whose goal is no place to stand at (inside a box, off the ground), are kept in the arrays
    (shapes are fixed) but never used.

    Args:
        env: steering environment.
        world: terrains and links.
        key: random key, consumed here.
        count: number of candidates.
        wander_share: share of the starts with a random goal; None: that of the configuration.
    """
    if wander_share is None:
        wander_share = env.config.wander_share
    # The first five keys do not depend on the number of further keys.
    needs_more = env.foresight is not None or world.own is not None
    keys = jax.random.split(key, 8 if needs_more else 5)
    link_key, place_key, motion_key, goal_key, wander_key, *further = keys
    link = jnp.searchsorted(world.cumulative_share, jax.random.uniform(link_key, (count,)))
    route = _draw_route(env, world, link, goal_key)
    motion = _draw_motion(env, world, link, place_key, motion_key)
    own = None
    if world.own is not None:
        own = draw_own_starts(world.own, further[1], count, GOALS)
        route, motion = _put_on_files(env, world, own, route, motion, further[2])
    valid = env.margin(world.atlas, route.map_index, motion) >= 0.0
    memory: Any = ()
    if env.foresight is not None:
        heights = env.local_heights(world.atlas, route.map_index, motion)
        chance = jax.random.uniform(further[0], (count,))
        foreseen, memory = env.foresight.begin(heights, motion, chance)
        valid &= foreseen >= 0.0
    state = env.start(motion, route, memory)
    wanders = jax.random.bernoulli(wander_key, wander_share, (count,))
    if own is not None:
        wanders &= ~own.chosen  # their first goal is random anyway
    state = state.replace(goal_index=wanders.astype(jnp.int32))  # type: ignore[attr-defined]
    arrival = _arrival(env, world, motion, route)
    arrives = env.margin(world.atlas, route.map_index, arrival) >= 0.0
    valid &= arrives | ~world.crossable[link]
    if world.own is not None and own is not None:
        over_ground = is_ground(world.atlas.height_at(own.map_index, own.start[:, None])[:, 0])
        valid &= (arrives & over_ground) | ~own.chosen
    return Starts(state, valid, world.kind[link])


def begin(
    env: SteeringEnv, world: World, keys: tuple[Key[Array, ""], Key[Array, ""]], count: int, of: int
) -> tuple[SteeringState, Float[Array, "count size"]]:
    """Return valid first states of episodes, and their observations.

    Args:
        env: steering environment.
        world: terrains and links.
        keys: random keys for the candidates and for the choice among them, consumed here.
        count: number of states.
        of: number of candidates from which they are chosen.
    """
    pool_key, take_key = keys
    state, _ = take(pool_of(draw_starts(env, world, pool_key, of)), take_key, count)
    return state, env.look(world.seen, state)


def _draw_motion(
    env: SteeringEnv, world: World, link: Array, place_key: Array, motion_key: Array
) -> RootMotion:
    area_key, place_key = jax.random.split(place_key)
    near = jax.random.bernoulli(area_key, env.config.near_share, link.shape)
    area = jnp.where(near[:, None], world.near_area[link], world.start_area[link])
    horizontal = _uniform_in(area, place_key)
    yaw_key, speed_key, height_key = jax.random.split(motion_key, 3)
    shape = (len(link),)
    yaw = jax.random.uniform(yaw_key, shape, minval=-jnp.pi, maxval=jnp.pi)
    # Half of the robots stand; the others walk in the direction that they face (I sec. IV-B).
    speed = jnp.maximum(jax.random.uniform(speed_key, shape, minval=-1.0), 0.0)
    speed = speed * env.config.desired_speed
    # Stairs down require a low root, which a policy that has never been low does not discover;
    # users' starts are not exact either.
    low, high = env.robot.start_heights
    spread = jax.random.uniform(height_key, (*shape, 1), minval=low, maxval=high)
    return RootMotion(
        position=standing_position(env.robot, world.atlas, world.map_index[link], horizontal)
        .at[:, 2:]
        .add(spread),
        velocity=jnp.stack(
            [speed * jnp.cos(yaw), speed * jnp.sin(yaw), jnp.zeros_like(yaw)], axis=-1
        ),
        yaw=yaw,
    )


def _put_on_files(
    env: SteeringEnv, world: World, own: OwnStarts, route: Route, motion: RootMotion, key: Array
) -> tuple[Route, RootMotion]:
    """Return routes and motions, replaced where a candidate starts on a terrain file."""
    low, high = env.robot.start_heights
    spread = jax.random.uniform(key, (len(own.chosen), 1), minval=low, maxval=high)
    position = (
        standing_position(env.robot, world.atlas, own.map_index, own.start).at[:, 2:].add(spread)
    )
    route = route.replace(  # type: ignore[attr-defined]
        map_index=jnp.where(own.chosen, own.map_index, route.map_index),
        goals=jnp.where(own.chosen[:, None, None], own.goals, route.goals),
    )
    position = jnp.where(own.chosen[:, None], position, motion.position)
    return route, motion.replace(position=position)  # type: ignore[attr-defined]


def _arrival(env: SteeringEnv, world: World, motion: RootMotion, route: Route) -> RootMotion:
    """Return the robot standing at its first goal, heading the way it came."""
    goal = route.goals[:, 0]
    offset = goal - motion.position[:, :2]
    return RootMotion(
        position=standing_position(env.robot, world.atlas, route.map_index, goal),
        velocity=jnp.zeros_like(motion.velocity),
        yaw=jnp.arctan2(offset[:, 1], offset[:, 0]),
    )


def _draw_route(env: SteeringEnv, world: World, link: Array, key: Array) -> Route:
    first_key, later_key, steps_key = jax.random.split(key, 3)
    count = len(link)
    first = _uniform_in(world.goal_area[link], first_key)
    arena = jnp.broadcast_to(world.arena_area[link][:, None], (count, GOALS - 1, 4))
    later = _uniform_in(arena, later_key)
    low, high = env.config.goal_steps
    return Route(
        map_index=world.map_index[link],
        goals=jnp.concatenate([first[:, None], later], axis=1),
        # The first goal, across the link, stays until it is reached (T sec. 3.4).
        goal_steps=jax.random.randint(steps_key, (count, GOALS), low, high + 1)
        .at[:, 0]
        .set(FOREVER),
    )


def _uniform_in(area: Float[Array, "*batch 4"], key: Array) -> Float[Array, "*batch 2"]:
    low, high = area[..., 0::2], area[..., 1::2]
    return low + (high - low) * jax.random.uniform(key, low.shape)
