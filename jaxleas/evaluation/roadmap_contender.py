"""A steering method with a roadmap as a contender: RB-Kino + RRT (T 3.4.2, table 4.3)."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from jaxleas.envs.steering import SteeringEnv
from jaxleas.evaluation.contender import Contender
from jaxleas.evaluation.judge import CellRollOut
from jaxleas.evaluation.starts import Grounds, Starts
from jaxleas.guide import (
    Budget,
    Edges,
    Navigation,
    Navigator,
    Places,
    SteeringMethod,
    make_navigator,
    motion_at,
)
from jaxleas.types import GuidePath, RootMotion

CONNECTIONS = 200
"""Number of edges that a search may try between two waypoints: the same on every machine."""
HOURS = 36_000.0


def roadmap_contender(env: SteeringEnv, method: SteeringMethod, edges: Edges) -> Contender:
    """Return a contender that uses a steering method and finds waypoints by RRT where needed.

    Args:
        env: environment that decides what is valid.
        method: steering method that connects waypoints.
        edges: edges of a roadmap that suit the method.
    """

    def walks(grounds: Grounds, starts: Starts, steps: int) -> CellRollOut:
        navigators: dict[int, Navigator] = {}
        found = []
        for number, index in enumerate(np.asarray(starts.map_index).tolist()):
            if index not in navigators:
                places = Places(env, grounds.maps[index])
                navigators[index] = make_navigator(places, method, edges, "rrt")
            found.append(_navigate(navigators[index], starts, number, steps))
        return stack([path for path, _ in found], np.array([each for _, each in found]), starts)

    return walks


def _navigate(
    navigator: Navigator, starts: Starts, number: int, steps: int
) -> tuple[GuidePath, bool]:
    """Navigate over a start's waypoints; return the path, and whether it leads to the last one."""
    motion = RootMotion(
        *(
            np.asarray(getattr(starts.motion, name))[number]
            for name in ("position", "velocity", "yaw")
        )
    )
    parts: list[GuidePath] = []
    for waypoint in np.asarray(starts.waypoints)[number]:
        budget = Budget(HOURS, CONNECTIONS)
        leg: Navigation = navigator.navigate(motion, waypoint[:2], budget, seed=number)
        parts.append(leg.path)
        motion = motion_at(leg.path, len(leg.path) - 1)
        if not leg.reached:
            return GuidePath.join(parts), False
    path = GuidePath.join(parts)
    return path, len(path) - 1 <= steps


def stack(
    paths: Sequence[GuidePath], reached: Bool[np.ndarray, " N"], starts: Starts
) -> CellRollOut:
    """Return guide paths as the roll-outs of a cell; the last configuration of each is repeated.

    A path that ends before its goal is valid as far as it goes: it counts as stopped.
    """
    end = np.array([len(path) - 1 for path in paths])
    rows = np.minimum(np.arange(end.max() + 1), end[:, None])

    def padded(name: str) -> np.ndarray:
        return np.stack([getattr(path, name)[row] for path, row in zip(paths, rows, strict=True)])

    valid = padded("valid").astype(bool)
    invalid = np.any(~valid, axis=1)
    return CellRollOut(
        starts=starts,
        position=padded("position"),
        yaw=padded("yaw"),
        velocity=padded("velocity"),
        valid=valid,
        end=end,
        reached=reached & ~invalid,
        invalid=np.asarray(invalid),
    )
