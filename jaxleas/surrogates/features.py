"""Inputs of a surrogate at a kept configuration: local terrain, and motion since the last one."""

from typing import Self

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float, Int

from jaxleas.configuration import Positive, Strict
from jaxleas.envs.steering import SteeringConfig
from jaxleas.geometry import rotate_by_yaw, wrap_angle
from jaxleas.types import RootMotion

MOTION_FEATURES = 7  # displacement, turn, velocity


class Pace(Strict):
    """The task's usual motion, by which features are divided: they become of order one.

    The defaults are those of files that record none.
    """

    speed: Positive = 0.1
    """desired speed [m/s]"""
    time_step: Positive = 0.2
    """time between two configurations [s]"""
    turn: Positive = 0.07
    """turn in one time step at the greatest turn rate [rad]"""

    @classmethod
    def of(cls, env: SteeringConfig) -> Self:
        """Return the pace of a task, each number to one significant digit."""
        limits = env.limits
        numbers = env.desired_speed, limits.time_step, limits.max_turn_rate * limits.time_step
        speed, time_step, turn = (float(f"{each:.1g}") for each in numbers)
        return cls(speed=speed, time_step=time_step, turn=turn)


USUAL_PACE = Pace()


def near_points(
    points_in_root: Float[np.ndarray, "P 2"], window: tuple[float, float]
) -> Int[np.ndarray, " points"]:
    """Return the indices of the points of the local terrain that a surrogate sees.

    The terrain beyond the contacts of the next stretch has no influence on the verdict.

    Args:
        points_in_root: points of the local terrain in the root frame [m].
        window: largest distance of those contacts ahead of the root, and to a side of it [m].
    """
    ahead, beside = points_in_root.T
    return np.flatnonzero((ahead < window[0]) & (np.abs(beside) < window[1]))


def path_features(
    heights_in_root: Float[Array, "*batch points"],
    motion: RootMotion,
    last: RootMotion,
    keep_every: int,
    height_range: tuple[float, float],
    pace: Pace = USUAL_PACE,
) -> Float[Array, "*batch size"]:
    """Return the features of one kept configuration.

    Args:
        heights_in_root: local terrain relative to the root, near it [m].
        motion: current root motion.
        last: root motion at the previous kept configuration; at the first one, the current motion.
        keep_every: number of time steps from one kept configuration to the next.
        height_range: lowest and highest height, to which heights are clipped [m].
        pace: usual motion.
    """
    low, high = height_range
    heights = jnp.clip(heights_in_root, low, high)
    heights = (2.0 * heights - (low + high)) / (high - low)
    displacement = rotate_by_yaw(motion.position - last.position, -motion.yaw)
    turn = wrap_angle(motion.yaw - last.yaw)
    velocity = rotate_by_yaw(motion.velocity, -motion.yaw)
    return jnp.concatenate(
        [
            heights,
            displacement / (keep_every * pace.time_step * pace.speed),
            turn[..., None] / (keep_every * pace.turn),
            velocity / pace.speed,
        ],
        axis=-1,
    )


def mirrored(
    points_in_root: Float[np.ndarray, "points 2"],
) -> tuple[Int[np.ndarray, " size"], Float[np.ndarray, " size"]]:
    """Return the permutation and signs that turn features into those of the mirror image.

    Args:
        points_in_root: points of the local terrain in the root frame, symmetric in y = 0 [m].
    """
    image = points_in_root * np.array([1.0, -1.0])
    distance = np.linalg.norm(image[:, None] - points_in_root[None], axis=-1)
    points = np.argmin(distance, axis=1)
    if np.max(np.min(distance, axis=1)) > 1e-6 or len(np.unique(points)) < len(points):
        raise ValueError("the points of the local terrain are not symmetric in y = 0")
    motion = np.arange(len(points), len(points) + MOTION_FEATURES)
    sideways = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0])  # displacement, turn, velocity
    return np.concatenate([points, motion]), np.concatenate([np.ones(len(points)), sideways])
