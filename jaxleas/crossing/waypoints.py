"""Waypoints from a guide path: poses along it, at most a stretch apart."""

from pathlib import Path

import numpy as np

from jaxleas.footsteps import Goal
from jaxleas.guide import read_guide_paths
from jaxleas.types import GuidePath, InputError

STRETCH = 0.5
"""Way along the path from one waypoint to the next [m]."""
NEAR, TURNED = 0.15, float(np.radians(15.0))
"""Distance [m] and difference of the heading [rad] at which a waypoint is passed."""


def read_waypoints(path: Path) -> list[Goal]:
    """Return the waypoints of a file with one guide path, its last pose left out.

    Raises:
        InputError: the file holds no guide path, or several.
    """
    paths = read_guide_paths(path).paths
    if len(paths) != 1 or len(paths[0]) < 2:
        raise InputError(
            f"{path} holds {len(paths)} guide paths; waypoints are taken from one that leads"
            " somewhere: give --query to jaxleas rollout, or write one path"
        )
    return waypoints_along(paths[0])


def waypoints_along(path: GuidePath) -> list[Goal]:
    """Return poses along a guide path, at equal ways of at most `STRETCH`, without both ends."""
    count = int(np.ceil(path.length / STRETCH))
    ways = np.linspace(0.0, path.length, max(count, 1) + 1)[1:-1]
    rows = np.searchsorted(path.distance, ways)
    return [
        Goal(float(x), float(y), float(yaw), NEAR, TURNED)
        for (x, y, _), yaw in zip(path.position[rows], path.yaw[rows], strict=True)
    ]
