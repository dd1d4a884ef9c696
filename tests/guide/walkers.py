"""Policies that were never trained, and places to walk."""

from itertools import pairwise

import jax.numpy as jnp
import numpy as np

from jaxleas.envs.steering.config import SteeringConfig
from jaxleas.envs.steering.env import SteeringEnv
from jaxleas.envs.steering.layout import layout_named
from jaxleas.envs.steering.scaling import affine_scaling
from jaxleas.terrain import GeneratorConfig, HeightMap, generate_arena, rasterise
from jaxleas.training.networks.mlp import Mlp, params_of
from jaxleas.training.policy import Policy
from jaxleas.types import RootMotion


def random_policy(seed: int = 0, activation: str = "relu", hidden=(16, 12), **task):
    """A policy of random weights, gentle enough to walk a while before it falls."""
    config = SteeringConfig(**task)
    layout = layout_named(config.observation)
    rng = np.random.default_rng(seed)
    sizes = [layout.size, *hidden, 8]
    mean, deviation = affine_scaling(
        layout, (config.height_low, config.height_high), config.limits.max_speed
    )
    kernels = [rng.normal(size=pair) / np.sqrt(pair[0]) for pair in pairwise(sizes)]
    kernels[-1][:, 2] *= 0.05  # up and down is where a random policy fails first
    lengths = iter(sizes[1:])

    def bias():
        return jnp.asarray(rng.normal(size=next(lengths)) * 0.1, jnp.float32)

    return Policy(
        mean=jnp.asarray(mean),
        deviation=jnp.asarray(deviation),
        params=params_of([(jnp.asarray(each, jnp.float32), bias()) for each in kernels]),
        network=Mlp(layout.size, tuple(hidden), 8, activation),
        signature=config.signature(),
        config=config,
    )


def homing_policy(speed: float = 0.1, **task):
    """A policy without hidden layers that turns to the goal and walks there, seeing no terrain."""
    policy = random_policy(hidden=(), **task)
    kernel, bias = np.zeros((len(policy.mean), 8), np.float32), np.zeros(8, np.float32)
    kernel[[0, 1, 2], [0, 1, 2]] = -4.0  # velocities are damped
    kernel[3, 3] = 4.0
    bias[0] = 4.0 * speed / policy.config.limits.max_speed
    return policy.replace(params=params_of([(jnp.asarray(kernel), jnp.asarray(bias))]))


def flat_map(half_size: float = 4.0, resolution: float = 0.1) -> HeightMap:
    count = round(2 * half_size / resolution) + 1
    return HeightMap(np.zeros((count, count), np.float32), resolution, (-half_size, -half_size))


def small_arena(seed: int = 3):
    """A generated arena and its height map."""
    arena = generate_arena(GeneratorConfig(rows=3, columns=3), seed)
    return arena, rasterise(arena.scene, 0.04)


def starts_on_links(env: SteeringEnv, arena, terrain: HeightMap, count: int, seed: int = 0):
    """Roots at rest, anywhere in the start areas, any heading; and goals across the links."""
    rng = np.random.default_rng(seed)
    links = [arena.links[index % len(arena.links)] for index in range(count)]
    start = np.array([link.start_area for link in links])
    goal = np.array([link.goal_area for link in links])
    places = start[:, 0::2] + rng.uniform(size=(count, 2)) * (start[:, 1::2] - start[:, 0::2])
    height = np.nan_to_num(terrain.height_at(places)) + env.robot.walking_height
    target = np.array([link.goal_height for link in links]) + env.robot.walking_height
    motion = RootMotion(
        position=jnp.asarray(np.column_stack([places, height]), jnp.float32),
        velocity=jnp.zeros((count, 3)),
        yaw=jnp.asarray(rng.uniform(-3.1, 3.1, count), jnp.float32),
    )
    middle = (goal[:, 0::2] + goal[:, 1::2]) / 2
    waypoints = np.column_stack([middle, target])[:, None, :]
    return motion, jnp.asarray(waypoints, jnp.float32)


def standing(env: SteeringEnv, places, yaw=0.0, ground: float = 0.0) -> RootMotion:
    """Roots at rest at walking height."""
    places = np.asarray(places, np.float32).reshape(-1, 2)
    z = np.full((len(places), 1), ground + env.robot.walking_height, np.float32)
    return RootMotion(
        position=jnp.asarray(np.concatenate([places, z], axis=1)),
        velocity=jnp.zeros((len(places), 3)),
        yaw=jnp.full(len(places), yaw, jnp.float32),
    )


def waypoints_at(env: SteeringEnv, *places):
    """Waypoints [1, W, 3] at walking height over level ground."""
    return jnp.asarray([[(*place, env.robot.walking_height) for place in places]], jnp.float32)
