"""The trunk along a guide path, against what feet may not touch: walls, ceilings, obstacles.

MIP and SL1M place feet and know no trunk; the guide path fixes where it is. So no plan that follows
a path through an obstacle exists, whatever the feet do.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.conditions import exact_collision
from jaxleas.robots import Robot
from jaxleas.terrain import Scene
from jaxleas.types import GuidePath


@dataclass(frozen=True)
class TrunkCollision:
    """The first configuration of a guide path at which the trunk touches an obstacle.

    Attributes:
        index: index of the configuration.
        sentence: sentence that says where, and what is touched.
    """

    index: int
    sentence: str


def trunk_collision(robot: Robot, scene: Scene, path: GuidePath) -> TrunkCollision | None:
    """Return the first collision of the trunk along a guide path; None for a free path.

    Every configuration is judged, by the exact twin of C. Surfaces that feet may touch do not
    count: a step's edge is the legs' matter.

    Args:
        robot: robot with its trunk boxes.
        scene: scene whose obstacles, and whose surfaces that feet may not touch, block.
        path: guide path of the root.
    """
    if not scene.blocking:
        return None
    position = np.asarray(path.position, np.float64)
    near = np.flatnonzero(_near_path(robot, scene.blocking_bounds, position))
    if not len(near):
        return None
    named = list(scene.blocking.items())
    names, polygons = zip(*(named[index] for index in near.tolist()), strict=True)
    free = exact_collision(robot, polygons, position, path.yaw)
    if free.all():
        return None
    index = int(np.argmin(free))
    here, yaw = position[index : index + 1], np.asarray(path.yaw)[index : index + 1]
    touched = next(
        name
        for name, polygon in zip(names, polygons, strict=True)
        if not exact_collision(robot, [polygon], here, yaw)[0]
    )
    x, y, _ = here[0]
    return TrunkCollision(
        index,
        f"the trunk touches '{touched}' at configuration {index} of the guide path, at"
        f" ({x:.2f}, {y:.2f}), {float(path.time[index] - path.time[0]):.1f} s",
    )


def _near_path(
    robot: Robot, bounds: Float[np.ndarray, "P 2 3"], position: Float[np.ndarray, "T 3"]
) -> Bool[np.ndarray, " P"]:
    """Return which polygons may be touched from somewhere along a path, whatever the yaw."""
    boxes = np.array([(box.low, box.high) for box in robot.trunk])
    aside = float(np.linalg.norm(np.abs(boxes[:, :, :2]).max(axis=1), axis=-1).max())
    low = position.min(axis=0) + np.array([-aside, -aside, boxes[:, 0, 2].min()])
    high = position.max(axis=0) + np.array([aside, aside, boxes[:, 1, 2].max()])
    return ((bounds[:, 1] >= low) & (bounds[:, 0] <= high)).all(axis=1)
