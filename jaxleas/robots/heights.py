"""Whether a root walks at a height that a robot can have: a sign of whose path it is."""

import numpy as np
from jaxtyping import Float

from jaxleas.robots.catalogue import load_robot, robot_names
from jaxleas.robots.robot import Robot

LOWER, HIGHER = 0.02, 0.15
"""Lengths [m] by which a path may lie below or above all starts of a robot. Higher is the looser
bound: the ground right below the root of a robot on stones or a beam can be far away. Talos's paths
have medians 0.14 m below to 0.04 m above its walking height, where its starts may be 0.20 m below
to 0.07 m above it."""


def _fits(robot: Robot, above_ground: Float[np.ndarray, " N"]) -> bool:
    """Return whether a robot can have walked with its root at these heights.

    Args:
        robot: robot that may have walked.
        above_ground: heights of the root above the ground below it [m]; without any, all fit.
    """
    if not len(above_ground):
        return True
    low, high = robot.start_heights
    lowest = robot.walking_height + low - LOWER
    highest = robot.walking_height + high + HIGHER
    middle, tenth = np.percentile(above_ground, [50, 10])
    return bool(middle >= lowest and tenth <= highest)


def height_complaint(robot: Robot, above_ground: Float[np.ndarray, " N"]) -> str:
    """Return why a path without a recorded robot cannot be a robot's; empty where it can be.

    Args:
        robot: robot that would be taken for lack of another.
        above_ground: heights of the root above the ground below it [m].
    """
    if _fits(robot, above_ground):
        return ""
    others = [name for name in robot_names() if _fits(load_robot(name), above_ground)]
    hint = f" (that of {' or '.join(others)} could be)" if others else ""
    return (
        f"its root is {np.median(above_ground):.2f} m above the ground, where that of {robot.name}"
        f" walks at {robot.walking_height:g} m{hint}: say by --robot whose path it is"
    )
