"""The exact twins of the package's conditions on a scene: which polygons carry, and which block."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.conditions.exact import (
    exact_collision,
    exact_reachability,
    exact_strict_reachability,
)
from jaxleas.robots import Robot
from jaxleas.terrain import Scene

Twin = Callable[
    [Robot, Scene, Float[np.ndarray, "*batch 3"], Float[np.ndarray, "*batch"]],
    Bool[np.ndarray, "*batch"],
]
"""A function of robot, scene, positions [m] and yaws [rad] of roots that says where it holds."""

EXACT_TWINS: Mapping[str, Twin] = MappingProxyType(
    {
        "reachability": lambda robot, scene, position, yaw: exact_reachability(
            robot, scene.walkable.values(), position, yaw
        ),
        "strict_reachability": lambda robot, scene, position, yaw: exact_strict_reachability(
            robot, scene.walkable.values(), position, yaw
        ),
        "collision": lambda robot, scene, position, yaw: exact_collision(
            robot, scene.polygons, position, yaw
        ),
    }
)
"""The exact twins by the names of the conditions: walkable surfaces carry, all polygons block."""
