"""How far the feet of a phase are within reach: CROC's limits at the ends of a curve."""

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning.phases import Phases, rotate
from jaxleas.envs.gait_planning.quadruped import QuadrupedConfig
from jaxleas.envs.gait_planning.supports import in_contact


def reach_slack(robot: QuadrupedConfig, phase: Phases) -> Float[np.ndarray, " N"]:
    """Return the least distance of a foot in contact from a side of its box [m].

    Where a curve begins and ends, the centre of mass is given. So a transition to the phase has at
    most this slack over 10 cm as its margin, and where that is too small needs no program.
    """
    slack = foot_slacks(robot, phase)
    return np.where(in_contact(phase.support), slack, np.inf).min(axis=-1)


def foot_slacks(robot: QuadrupedConfig, phase: Phases) -> Float[np.ndarray, "N 4"]:
    """Return the distance of each foot from the nearest side of its box, outside below 0 [m]."""
    low, high = robot.reach_box
    relative = phase.feet.astype(np.float64) - phase.com[:, None]
    flat = rotate(-phase.yaw.astype(np.float64), relative[..., :2])
    offset = np.concatenate([flat, relative[..., 2:]], axis=-1)
    return np.minimum(offset - low, high - offset).min(axis=-1)
