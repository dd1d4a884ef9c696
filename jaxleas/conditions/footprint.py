"""The grid of points in the root frame whose heights the analytic conditions read."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.conditions.points import union_of_points
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


def outline_points(robot: Robot, spacing: float, spare: float = 0.0) -> Float[np.ndarray, "P 2"]:
    """Return points along the outline of the trunk, and over the square under the root.

    What is thicker than the spacing cannot pass between them: it enters the trunk through its
    outline. A box's outline is left out where it lies in the shadow of a lower box, whose own
    outline is met first.

    Args:
        robot: robot whose trunk and legs are judged.
        spacing: largest distance of neighbouring points [m].
        spare: width of the rim of the square that is left out [m].

    Returns:
        Points in the root frame [m], mirrored in y = 0 if the trunk is; each once.
    """
    low, high = spare - UNDER_ROOT, UNDER_ROOT - spare
    found = [_lattice((low, low), (high, high), spacing)]
    for box in robot.trunk:
        lattice = _lattice(box.low[:2], box.high[:2], spacing)
        at_end = (lattice == lattice.min(axis=0)) | (lattice == lattice.max(axis=0))
        on_outline = np.any(at_end, axis=1)
        shadowed = np.zeros(len(lattice), dtype=bool)
        for other in robot.trunk:
            if other.low[2] < box.low[2]:
                above, below = lattice > np.array(other.low[:2]), lattice < np.array(other.high[:2])
                shadowed |= np.all(above & below, axis=1)
        found.append(lattice[on_outline & ~shadowed])
    return union_of_points(found)


def _lattice(
    low: Sequence[float], high: Sequence[float], spacing: float
) -> Float[np.ndarray, "P 2"]:
    """Return points over a rectangle, its edges included, at most `spacing` apart along an axis."""
    lines = [
        np.linspace(first, last, int(np.ceil((last - first) / spacing - _TOLERANCE)) + 1)
        for first, last in zip(low, high, strict=True)
    ]
    x, y = np.meshgrid(*lines, indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=-1)


def is_under_root(points: Float[np.ndarray, "P 2"], spare: float = 0.0) -> Bool[np.ndarray, " P"]:
    """Return which points lie directly under the root, H* of T eq. 3.6.

    Args:
        points: points in the root frame [m].
        spare: width of the rim of the square that is left out [m].
    """
    return np.all(np.abs(points) <= UNDER_ROOT - spare + _TOLERANCE, axis=-1)
