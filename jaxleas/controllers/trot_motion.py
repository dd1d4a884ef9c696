"""How robots move, as the trot needs it: feet in the world, headings, and torques from forces."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.controllers.legs import LegKinematics, LegPosture, cross
from jaxleas.physics import BodyState
from jaxleas.types import matrix_of


@dataclass(frozen=True, eq=False)
class TrotMotion:
    """Motion of robots, as the trot needs it.

    Attributes:
        rotation: orientation of the root.
        posture: feet and Jacobians in the root frame.
        feet: positions of the feet in the world [m].
        foot_velocities: their velocities in the world [m/s].
        yaw: heading [rad].
        level: rotation by the heading alone.
    """

    rotation: Float[np.ndarray, "N 3 3"]
    posture: LegPosture
    feet: Float[np.ndarray, "N E 3"]
    foot_velocities: Float[np.ndarray, "N E 3"]
    yaw: Float[np.ndarray, " N"]
    level: Float[np.ndarray, "N 3 3"]


def motion_of(legs: LegKinematics, state: BodyState) -> TrotMotion:
    """Return the motion of robots.

    Args:
        legs: kinematics of their legs.
        state: their state.
    """
    rotation = matrix_of(state.quaternion)
    posture = legs.posture(state.angles)
    arms = posture.feet @ np.swapaxes(rotation, 1, 2)
    count = arms.shape[1]
    speeds = state.joint_speeds.reshape(len(state), count, -1, 1)
    moving = (posture.jacobians @ speeds)[..., 0] @ np.swapaxes(rotation, 1, 2)
    turning = (rotation @ state.turning_rate[..., None])[:, None, :, 0]
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])
    cosine, sine = np.cos(yaw), np.sin(yaw)
    level = np.zeros_like(rotation)
    level[:, 0, 0] = level[:, 1, 1] = cosine
    level[:, 1, 0], level[:, 0, 1] = sine, -sine
    level[:, 2, 2] = 1.0
    return TrotMotion(
        rotation,
        posture,
        state.position[:, None] + arms,
        state.velocity[:, None] + cross(turning, arms) + moving,
        yaw,
        level,
    )


def torques_of(motion: TrotMotion, forces: np.ndarray) -> np.ndarray:
    """Return the torques of joints whose feet push with forces, given in the world [Nm]."""
    inside = forces @ motion.rotation
    torques = np.swapaxes(motion.posture.jacobians, -1, -2) @ inside[..., None]
    return torques[..., 0].reshape(len(forces), -1)
