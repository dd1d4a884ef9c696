"""Where an effector stands beside the root, in the robot's reference configuration."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.robots import Robot


def reference_foothold(
    robot: Robot, effector: str, root: Float[np.ndarray, " 3"], yaw: float
) -> Float[np.ndarray, " 3"]:
    """Return the horizontal place of an effector under a root, at the height of the root [m].

    Args:
        robot: robot in its reference configuration.
        effector: name of the effector.
        root: position of the root in the world [m].
        yaw: heading of the root [rad].
    """
    x, y, _ = robot.references[robot.effector_index(effector)]
    forward = np.array([math.cos(yaw), math.sin(yaw), 0.0])
    left = np.array([-math.sin(yaw), math.cos(yaw), 0.0])
    return root + x * forward + y * left


def widest_reference(robot: Robot) -> float:
    """Return the largest horizontal distance of a foot from the root [m]."""
    return float(np.linalg.norm(robot.references[list(robot.feet), :2], axis=1).max())
