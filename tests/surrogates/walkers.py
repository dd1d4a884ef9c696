"""Small worlds for surrogates: walks over flat ground, judged by planners whose rule is known."""

import numpy as np

from jaxleas.envs.steering import SteeringConfig, SteeringEnv
from jaxleas.surrogates import Identity
from jaxleas.terrain.atlas import Atlas, make_atlas
from jaxleas.terrain.height_map import HeightMap
from jaxleas.types import GuidePath

KEEP_EVERY = 5
TIME_STEP = 0.2


def env() -> SteeringEnv:
    return SteeringEnv(SteeringConfig())


def identity(**changes) -> Identity:
    config = SteeringConfig()
    return Identity(
        **{
            "planner": "sampling",
            "parameters": {"keep_every": KEEP_EVERY, "seed": 0},
            "robot": config.robot,
            "observation": config.observation,
            "height_low": config.height_low,
            "height_high": config.height_high,
        }
        | changes
    )


def flat_atlas(maps: int) -> Atlas:
    one = HeightMap(np.zeros((100, 100), np.float32), 0.2, (-10.0, -10.0))
    return make_atlas([one] * maps)


def wander(generator: np.random.Generator, kept: int) -> GuidePath:
    """A walk on flat ground: between two kept configurations straight or with a turn, at random."""
    steps = KEEP_EVERY * (kept - 1) + 1
    stretch = np.arange(steps) // KEEP_EVERY
    turning = np.where(generator.random(kept) < 0.3, generator.choice([-0.06, 0.06], kept), 0.0)
    yaw = np.cumsum(turning[stretch])
    speed = generator.uniform(0.02, 0.15, kept)[stretch]
    velocity = np.stack([speed * np.cos(yaw), speed * np.sin(yaw), 0.0 * yaw], axis=1)
    position = np.array([0.0, 0.0, 0.95]) + np.cumsum(velocity, axis=0) * TIME_STEP
    return GuidePath(np.arange(steps) * TIME_STEP, position, yaw, velocity, np.ones(steps, bool))


def kept_turns(path: GuidePath) -> np.ndarray:
    """The turn into each kept configuration [rad]; 0 into the first."""
    return np.diff(path.yaw[::KEEP_EVERY], prepend=path.yaw[0])


def dizzy(path: GuidePath) -> int:
    """A planner with memory: fails at the second stretch in a row that turns left."""
    left = kept_turns(path) > 0.15
    twice = np.flatnonzero(left[1:] & left[:-1])
    return KEEP_EVERY * int(twice[0]) if len(twice) else len(path) - 1
