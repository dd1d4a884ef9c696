"""What ends an episode besides CROC: unsafe footholds, and terrain that the trunk touches."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.envs.gait_planning.ground import Ground
from jaxleas.envs.gait_planning.phases import Phases, rotate
from jaxleas.envs.gait_planning.quadruped import QuadrupedConfig
from jaxleas.envs.gait_planning.supports import in_contact

ALONG, ACROSS = 5, 3
"""Points below the trunk at which the ground is asked, along it and across."""


def footholds_are_safe(ground: Ground, field: np.ndarray, phase: Phases) -> Bool[np.ndarray, " N"]:
    """Return whether all feet in contact stand safely, T_footholds of D sec. III-A."""
    safe = ground.safe_at(field[:, None], phase.feet[..., :2])
    return np.all(safe | ~in_contact(phase.support), axis=1)


def trunk_is_free(
    robot: QuadrupedConfig, ground: Ground, field: np.ndarray, phase: Phases
) -> Bool[np.ndarray, " N"]:
    """Return whether the terrain below the trunk is lower than it, T_base of D sec. III-A."""
    points = phase.com[:, None, :2] + rotate(phase.yaw, _below(robot)[None])
    heights = ground.heights_at(field[:, None], points)
    return heights.max(axis=1) < phase.com[:, 2] + robot.trunk_bottom


def _below(robot: QuadrupedConfig) -> Float[np.ndarray, "points 2"]:
    half_length, half_width = robot.trunk_half
    along = np.linspace(-half_length, half_length, ALONG)
    across = np.linspace(-half_width, half_width, ACROSS)
    return np.stack(np.meshgrid(along, across, indexing="ij"), axis=-1).reshape(-1, 2)
