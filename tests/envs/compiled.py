"""What tests ask of environments, compiled once for all tests that ask with equal shapes.

Asked for one operation at a time, JAX compiles every operation for every shape. Tests that use the
same environment (`steering_env`), maps of one size and equal numbers of robots share a program.
"""

from functools import cache, partial
from typing import Any

import jax

from jaxleas.envs import starts
from jaxleas.envs.steering import SteeringConfig, SteeringEnv, draw_starts


@cache
def steering_env(**changes: Any) -> SteeringEnv:
    """Return the one environment of this configuration: another would be compiled for again."""
    return SteeringEnv(SteeringConfig(**changes))


@partial(jax.jit, static_argnums=(0, 3))
def draw_pool(env, world, key, count):
    """Return candidates for starts, as a pool."""
    return starts.pool_of(draw_starts(env, world, key, count))


take = jax.jit(starts.take, static_argnums=2)
draw_picks = jax.jit(starts.draw_picks, static_argnums=2)
restart_where = jax.jit(starts.restart_where)
start = jax.jit(SteeringEnv.start, static_argnums=0)
step = jax.jit(SteeringEnv.step, static_argnums=0)
look = jax.jit(SteeringEnv.look, static_argnums=0)
goal = jax.jit(SteeringEnv.goal, static_argnums=0)
observe = jax.jit(SteeringEnv.observe, static_argnums=0)
local_heights = jax.jit(SteeringEnv.local_heights, static_argnums=0)
margin = jax.jit(SteeringEnv.margin, static_argnums=0)


@partial(jax.jit, static_argnums=0)
def condition(env, heights, motion):
    """Return the margin of the environment's condition on this local terrain."""
    return env.condition(heights, motion)


@partial(jax.jit, static_argnums=0)
def observe_local_heights(env, atlas, state):
    """Return what robots see, in the two passes that `look` makes one."""
    heights = env.local_heights(atlas, state.plan.map_index, state.motion)
    return env.observe(heights, state.motion, env.goal(state))


@jax.jit
def height_at(atlas, map_index, points):
    """Return the height of each robot's map at its point."""
    return atlas.height_at(map_index, points[:, None])[:, 0]
