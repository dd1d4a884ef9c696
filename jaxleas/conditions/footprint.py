"""The grid of points in the root frame whose heights the analytic conditions read."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots import Robot

MOST_SPACING = (0.112, 0.101)  # along x and y [m]: two or more points across any 0.3 m bridge
UNDER_ROOT = 0.1  # half side of the square "directly under the root" of T eq. 3.6 [m]
_TOLERANCE = 1e-6  # [m]


def footprint_points(robot: Robot) -> Float[np.ndarray, "P 2"]:
    """Return points that cover the shadow of the trunk's lowest box, including its edges.

    For Talos 4 x 7 points, x in [-0.2, 0.133], y in [-0.3, 0.3], mirrored in y = 0. Higher boxes
    extend beyond this shadow by 4 cm at most, and only 0.6 m higher up.

    Args:
        robot: robot whose trunk casts the shadow.

    Returns:
        Points in the root frame [m], x slowest.
    """
    lowest = min(robot.trunk, key=lambda box: box.low[2])
    lines = []
    for axis in (0, 1):
        low, high = lowest.low[axis], lowest.high[axis]
        count = int(np.ceil((high - low) / MOST_SPACING[axis] - _TOLERANCE)) + 1
        lines.append(np.linspace(low, high, count))
    x, y = np.meshgrid(*lines, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=-1)


def is_under_root(points: Float[np.ndarray, "P 2"]) -> Bool[np.ndarray, " P"]:
    """Return which points lie directly under the root: H* of T eq. 3.6."""
    return np.all(np.abs(points) <= UNDER_ROOT + _TOLERANCE, axis=-1)
