"""The robot whose contacts are planned along guide paths: the one that walked them."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.guide_file import read_recorded_guide
from jaxleas.contacts.planner import AskedGuide
from jaxleas.robots import PlannedRobot, RecordedRobot, height_complaint, load_robot, robot_for
from jaxleas.terrain import Scene, polygon_area_vector
from jaxleas.types import Ending, GuidePath, InputError

MOST_LOOKED_AT = 200
"""Number of configurations whose height above the ground is looked up."""
_STEEPEST = 0.1  # a polygon whose normal has a smaller vertical part is no ground


def read_asked(
    guide: Path, query: int, scene: Scene, robot: str | None
) -> tuple[AskedGuide, Ending]:
    """Read a guide path and whose it is; also return how the path ended.

    Where the robot is not plain, a line is printed.

    Args:
        guide: file of the guide path.
        query: number of the path in the file.
        scene: scene that it crosses.
        robot: robot that a person named; None if none was named.

    Raises:
        InputError: a file cannot be used, or the path is another robot's.
    """
    walked = read_recorded_guide(guide, query)
    planned = planned_robot(walked.robot, robot, [walked.guide], lambda: scene, guide)
    if planned.note:
        print(planned.note)
    return AskedGuide(planned.name, walked.guide, scene), walked.ending


def planned_robot(
    recorded: RecordedRobot | None,
    given: str | None,
    guides: Sequence[GuidePath],
    scene: Callable[[], Scene],
    where: object,
) -> PlannedRobot:
    """Return the robot to plan with for a file's guide paths.

    It is the recorded robot. Of a file from before robots were recorded it is the one that a
    person named, or Talos, if the paths are at a height at which Talos walks.

    Args:
        recorded: robot that the file records, if any.
        given: robot that a person named, if any.
        guides: guide paths of the file.
        scene: function that returns the scene that they cross, called only where it is needed.
        where: name of the file, for messages.

    Raises:
        InputError: the paths are another robot's, or that robot is not known here.
    """
    planned = robot_for(recorded, given, where)
    if recorded is None and given is None:
        roots = np.concatenate([np.asarray(each.position, np.float64) for each in guides])
        some = roots[:: max(1, len(roots) // MOST_LOOKED_AT)]
        problem = height_complaint(load_robot(planned.name), heights_above_ground(scene(), some))
        if problem:
            raise InputError(f"{where} does not say whose path it is, and {problem}")
    return planned


def heights_above_ground(scene: Scene, roots: Float[np.ndarray, "N 3"]) -> Float[np.ndarray, " K"]:
    """Return the heights of those roots that have ground below them, above it [m].

    Args:
        scene: scene whose walkable surfaces are the ground.
        roots: positions of the roots [m].
    """
    ground = np.full(len(roots), -np.inf)
    for vertices in scene.walkable.values():
        normal = polygon_area_vector(vertices)
        if abs(normal[2]) < _STEEPEST * np.linalg.norm(normal):
            continue
        corners, offset = vertices[:, :2], roots[:, None, :2] - vertices[:, :2]
        along = np.roll(corners, -1, axis=0) - corners
        turning = along[:, 0] * offset[..., 1] - along[:, 1] * offset[..., 0]
        over = (turning * np.sign(normal[2]) >= -1e-9).all(axis=1)
        z = vertices[0, 2] - (roots[:, :2] - vertices[0, :2]) @ normal[:2] / normal[2]
        below = over & (z <= roots[:, 2])
        ground[below] = np.maximum(ground[below], z[below])
    known = np.isfinite(ground)
    return roots[known, 2] - ground[known]
