"""Small worlds with known answers."""

import jax.numpy as jnp
import numpy as np

from jaxleas.envs.steering import Route, SteeringEnv, World
from jaxleas.envs.steering.state import GOALS
from jaxleas.terrain.atlas import make_atlas
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import RootMotion

RESOLUTION = 0.05


def height_map(height, half_size: float = 5.0, resolution: float = RESOLUTION) -> HeightMap:
    """Sample `height(x, y)` on a square around the origin."""
    axis = np.arange(-half_size, half_size + resolution / 2, resolution)
    x, y = np.meshgrid(axis, axis)
    heights = np.broadcast_to(height(x, y), x.shape).astype(np.float32)
    return HeightMap(heights, resolution, (float(axis[0]), float(axis[0])))


def flat(x, y):
    return np.zeros_like(x)


def bumpy(x, y):
    return 0.1 * np.sin(3 * x) + 0.05 * np.cos(5 * y + x)


def world_of(*maps: HeightMap) -> World:
    """A world with one link a map: from its left quarter to its right quarter."""
    areas = np.array([each.extent for each in maps], dtype=np.float32)
    third = (areas[:, 1] - areas[:, 0]) / 3
    start, goal = areas.copy(), areas.copy()
    start[:, 1] = areas[:, 0] + third
    goal[:, 0] = areas[:, 1] - third
    return World(
        atlas=make_atlas(maps),
        map_index=jnp.asarray(np.arange(len(maps), dtype=np.int32)),
        start_area=jnp.asarray(start),
        near_area=jnp.asarray(start),
        goal_area=jnp.asarray(goal),
        arena_area=jnp.asarray(areas),
        kind=jnp.asarray(np.zeros(len(maps), np.int32)),
        crossable=jnp.asarray(np.ones(len(maps), bool)),
        cumulative_share=jnp.asarray(np.linspace(1 / len(maps), 1.0, len(maps)), jnp.float32),
    )


def standing(env: SteeringEnv, places, yaw, ground=0.0) -> RootMotion:
    """Robots at rest at walking height."""
    places = np.asarray(places, dtype=np.float32).reshape(-1, 2)
    z = np.full((len(places), 1), ground + env.robot.walking_height, np.float32)
    return RootMotion(
        position=jnp.asarray(np.concatenate([places, z], axis=1)),
        velocity=jnp.asarray(np.zeros((len(places), 3), np.float32)),
        yaw=jnp.asarray(np.broadcast_to(np.float32(yaw), (len(places),))),
    )


def route_to(goal, count: int, steps: int = 10_000) -> Route:
    """Everybody is sent to one goal, then to the origin for ever."""
    goals = np.zeros((count, GOALS, 2), np.float32)
    goals[:, 0] = goal
    return Route(
        map_index=jnp.asarray(np.zeros(count, np.int32)),
        goals=jnp.asarray(goals),
        goal_steps=jnp.asarray(np.full((count, GOALS), steps, np.int32)),
    )
