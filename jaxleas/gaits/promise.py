"""How promising a state is: what is left of its way, and what will cost moves."""

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    PlanningState,
    base_distance,
    bearing,
    feet_distance,
    foot_offsets,
    in_contact,
)

FACING, MOST_OFF = 0.25, 2.5
"""Way that a radian between heading and goal is worth [m/rad], and the most that counts [rad]."""
STRETCHED, FREE_STRETCH, SIDEWAYS = 2.0, 0.12, 1.6
"""Way that a metre of stretch is worth [m/m], the stretch that costs nothing [m], and how much more
an offset to the side counts."""
ALL_FOUR = 0.02
"""Way that a phase on all four feet is worth: it moves no foot [m]."""


def promise(config: GaitPlanningConfig, state: PlanningState) -> Float[np.ndarray, " N"]:
    """Return how promising states are: minus the way that is left, and what will cost moves [m]."""
    phase = state.phase
    left = 0.5 * feet_distance(phase, state.goal) + 0.5 * base_distance(phase, state.goal)
    offset = foot_offsets(config.robot, phase)
    along, across = config.robot.reach_high[0], config.robot.reach_high[1]
    stretch = np.abs(offset * [1.0, min(SIDEWAYS, along / across)]).max(axis=-1)
    stretch = np.where(in_contact(phase.support), stretch, 0.0).max(axis=1)
    cost = FACING * np.abs(bearing(phase, state.goal)).clip(0.0, MOST_OFF)
    cost = cost + STRETCHED * np.maximum(0.0, stretch - FREE_STRETCH)
    return -left - cost - ALL_FOUR * (phase.support == 0)
