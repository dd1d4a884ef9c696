"""Parts of a guide path that was walked: where it passed waypoints, and up to where it counts."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.guide.places import on_host
from jaxleas.types import GuidePath, RootMotion


def passages(
    path: GuidePath, waypoints: Float[np.ndarray, "W 2"], radius: float
) -> Int[np.ndarray, " passed"]:
    """Return when each waypoint was passed, in order, up to the first that was not.

    Args:
        path: guide path that was walked.
        waypoints: waypoints x, y in order [m].
        radius: distance within which a waypoint is passed [m].

    Returns:
        Indices of configurations.
    """
    passed: list[int] = []
    index = 0
    for waypoint in waypoints:
        offset = path.position[index:, :2].astype(np.float64) - waypoint
        close = np.flatnonzero(np.hypot(*offset.T) <= radius + 1e-6)
        if not len(close):
            break
        index += int(close[0])
        passed.append(index)
    return np.array(passed, dtype=np.int64)


def motion_at(path: GuidePath, index: int) -> RootMotion:
    """Return the root motion of one configuration of a path."""
    return on_host(path.position[index], path.velocity[index], path.yaw[index])


def until_refused(path: GuidePath, refused: Bool[np.ndarray, " T"]) -> GuidePath:
    """Return a path up to the first refused configuration, which is marked as not valid."""
    count = 1 + int(np.argmax(refused))
    valid = path.valid[:count] & ~refused[:count]
    return replace(path[:count], valid=valid)


def part_towards(path: GuidePath, goal: Float[np.ndarray, " 2"]) -> GuidePath:
    """Return a path up to the valid configuration nearest to the goal; at least its first one."""
    valid = len(path) if path.valid.all() else max(1, int(np.argmin(path.valid)))
    offset = path.position[:valid, :2].astype(np.float64) - goal
    return path[: 1 + int(np.argmin(np.hypot(*offset.T)))]
