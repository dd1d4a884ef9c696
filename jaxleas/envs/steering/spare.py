"""Harder conditions for training: what is just valid on a map there is valid on the polygons.

A map has cells of some centimetres, and a policy that learns on it passes as closely as the map
allows. Under these conditions it learns to leave some room.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float

from jaxleas.conditions import MOST_SPACING, extended, is_under_root, outline_points
from jaxleas.geometry import Box
from jaxleas.robots import Robot


def with_larger_trunk(robot: Robot, spare: float) -> Robot:
    """Return a robot whose trunk is larger to each side by `spare` [m]."""
    sides = np.array([spare, spare, 0.0])
    trunk = tuple(
        Box(tuple(np.array(box.low) - sides), tuple(np.array(box.high) + sides))
        for box in robot.trunk
    )
    return replace(robot, trunk=trunk)


def points_with_spare(
    points: Float[np.ndarray, "P 2"], robot: Robot, spacing: float, spare: float
) -> Float[np.ndarray, "Q 2"]:
    """Return the points for conditions that leave room, of which the first remain in their order.

    The ring just inside the edge of the square under the root (R*) is left out, so that ground
    there does not count.

    Args:
        points: points whose heights are sampled anyway, in the root frame [m].
        robot: robot with the larger trunk.
        spacing: largest distance of the points along its outline [m]; 0: that of the footprint.
        spare: width of the ring [m].
    """
    every = extended(points, outline_points(robot, spacing or min(MOST_SPACING), spare))
    ring = is_under_root(every) & ~is_under_root(every, spare)
    return every[~ring]
