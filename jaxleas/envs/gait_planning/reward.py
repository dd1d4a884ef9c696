"""The reward of a transition (D table II and eq. 2): r_p r_h^2 r_k - r_c, and bonuses."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning.phases import Phases, bearing, feet_distance, rotate
from jaxleas.envs.gait_planning.quadruped import QuadrupedConfig


def reward_of(
    robot: QuadrupedConfig,
    weights: Mapping[str, float],
    phase: Phases,
    candidate: Phases,
    episode: tuple[np.ndarray, np.ndarray],
) -> Float[np.ndarray, " N"]:
    """Return the reward of transitions that are accepted.

    Args:
        robot: robot.
        weights: weights by name, `reward.progress` and so on.
        phase: phases before.
        candidate: phases after.
        episode: goals [N, 2] [m], and numbers of phases since each foot was lifted [N, 4].
    """
    goal, grounded = episode
    product = (
        weights["reward.progress"]
        * (feet_distance(phase, goal) - feet_distance(candidate, goal))
        * _facing(candidate, goal) ** 2
        * _ease(robot, weights["reward.effort"], candidate)
    )
    stance = weights["reward.stance"] * grounded.sum(axis=1)
    changes = candidate.support != phase.support
    return product - stance + weights["reward.alive"] + weights["reward.change"] * changes


def _facing(phase: Phases, goal: np.ndarray) -> Float[np.ndarray, " N"]:
    """Return r_h: 1 where the goal is ahead, 0 where it is behind."""
    return 1.0 - np.abs(bearing(phase, goal)) / np.pi


def _ease(robot: QuadrupedConfig, effort: float, phase: Phases) -> Float[np.ndarray, " N"]:
    """Return r_k: 1 where all feet are at their nominal places."""
    offset = foot_offsets(robot, phase)
    return np.maximum(0.0, 1.0 - effort * (np.abs(offset) ** 3).sum(axis=(1, 2)))


def foot_offsets(robot: QuadrupedConfig, phase: Phases) -> Float[np.ndarray, "N 4 2"]:
    """Return the feet from their nominal places, in the base's frame [m]."""
    relative = phase.feet[..., :2] - phase.com[:, None, :2]
    return rotate(-phase.yaw, relative) - robot.nominal[:, :2]
