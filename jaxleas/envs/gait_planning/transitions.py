"""From a phase to its candidate: the contact transition that CROC is asked (D sec. III-A).

The centre of mass moves from one to the other in t_S on the present support and t_E* on the next.
"""

import numpy as np
from jaxtyping import Float

from jaxleas.dynamics import BoundaryState, Limits, Reach, Supports, Transitions
from jaxleas.envs.gait_planning.config import GaitPlanningConfig
from jaxleas.envs.gait_planning.phases import Phases, rotate
from jaxleas.envs.gait_planning.quadruped import QuadrupedConfig
from jaxleas.envs.gait_planning.supports import in_contact
from jaxleas.geometry import wrap_angle_on_host

FAR = 100.0  # bound of a face that no foot makes [m]


def transitions_of(
    config: GaitPlanningConfig,
    phase: Phases,
    candidate: Phases,
    times: Float[np.ndarray, "N 2"],
) -> Transitions:
    """Return the transitions from phases to their candidates.

    Args:
        config: configuration of the task.
        phase: present phases.
        candidate: phases that follow.
        times: t_E* and t_S [s].
    """
    durations = np.asarray(times, np.float64)[:, ::-1]
    feet = np.stack([phase.feet, candidate.feet], axis=1).astype(np.float64)
    standing = np.stack([in_contact(phase.support), in_contact(candidate.support)], axis=1)
    up, ahead = np.zeros(feet.shape), np.zeros(feet.shape)
    up[..., 2] = 1.0
    ahead[..., 0] = 1.0
    robot = config.robot
    return Transitions(
        _boundary(phase),
        _boundary(candidate),
        durations,
        Supports(feet, up, ahead, standing),
        _reach(robot, _yaws(phase, candidate, durations, config.instants), feet, standing),
        Limits(robot.friction, robot.acceleration_limit, robot.force_limit),
    )


def _boundary(phase: Phases) -> BoundaryState:
    com = phase.com.astype(np.float64)
    velocity = np.zeros_like(com)
    velocity[:, :2] = phase.velocity  # heights do not change at either end
    return BoundaryState(com, velocity, np.zeros_like(com))


def _yaws(
    phase: Phases, candidate: Phases, durations: np.ndarray, instants: int
) -> Float[np.ndarray, "N 2 L"]:
    """Return the headings at the instants of both phases: they turn evenly."""
    turn = wrap_angle_on_host(candidate.yaw.astype(np.float64) - phase.yaw)
    switch = (durations[:, :1] / durations.sum(axis=1, keepdims=True))[..., None]
    inside = np.linspace(0.0, 1.0, instants)
    share = np.concatenate([switch * inside, switch + (1.0 - switch) * inside], axis=1)
    return phase.yaw[:, None, None] + turn[:, None, None] * share


def _reach(
    robot: QuadrupedConfig,
    yaw: Float[np.ndarray, "N 2 L"],
    feet: Float[np.ndarray, "N 2 4 3"],
    standing: np.ndarray,
) -> Reach:
    """Return the box in which the centre of mass is within reach of all standing feet.

    The boxes of all feet have the base's axes, so that they meet in one box.
    """
    low, high = robot.reach_box
    count, phases, instants = yaw.shape
    flat = np.repeat(feet[..., :2].reshape(-1, 4, 2), instants, axis=0)
    turned = rotate(-yaw.reshape(-1), flat).reshape(count, phases, instants, 4, 2)
    heights = np.broadcast_to(feet[:, :, None, :, 2:], (*turned.shape[:-1], 1))
    in_axes = np.concatenate([turned, heights], axis=-1)
    stands = standing[:, :, None, :, None]
    most = np.where(stands, in_axes - low, FAR).min(axis=3)
    least = np.where(stands, in_axes - high, -FAR).max(axis=3)
    rows = np.zeros((count, phases, instants, 6, 3))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    rows[..., 0, 0], rows[..., 0, 1] = cosine, sine
    rows[..., 1, 0], rows[..., 1, 1] = -sine, cosine
    rows[..., 2, 2] = 1.0
    rows[..., 3:, :] = -rows[..., :3, :]
    return Reach(rows, np.concatenate([most, -least], axis=-1))
