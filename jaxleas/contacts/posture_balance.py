"""Whether the centre of mass can shift above the standing feet, computed the slow way."""

import math

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, QhullError

from jaxleas.contacts.posture_limbs import about, limb_of
from jaxleas.contacts.posture_model import Stood
from jaxleas.robots import Robot

_LEAST_AREA = 1e-8  # a smaller sole is a point [m^2]


def two_point_margin(stood: Stood, moving: str, robot: Robot) -> float:
    """Return the room of the centre of mass above what carries, in reach of all feet [m].

    Args:
        stood: posture before the foot leaves, or after it has landed.
        moving: name of the foot that moves.
        robot: robot with a model of each leg.
    """
    rows, bounds = [], []
    for foot, rotation in stood.rotations.items():
        reach = limb_of(robot, foot).com_reach
        turn = about("z", math.atan2(rotation[1, 0], rotation[0, 0]))
        normals = reach.normals @ turn.T
        rows.append(normals)
        bounds.append(reach.offsets + normals @ stood.soles[foot])
    corners = _carrying_polygon(stood, moving, robot)
    if not len(corners):
        return -math.inf
    for here, there in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        outward = np.array([there[1] - here[1], here[0] - there[0], 0.0])
        length = float(np.linalg.norm(outward))
        if length > 1e-9:
            rows.append(outward[None] / length)
            bounds.append(np.array([outward @ here / length]))
    A = np.concatenate(rows)
    answer = linprog(
        [0.0, 0.0, 0.0, -1.0],
        A_ub=np.column_stack([A, np.ones(len(A))]),
        b_ub=np.concatenate(bounds),
        bounds=[(None, None)] * 3 + [(None, 1.0)],
    )
    return float(answer.x[3]) if answer.status == 0 else -math.inf


def _carrying_polygon(stood: Stood, moving: str, robot: Robot) -> np.ndarray:
    """Return the corners above which the centre of mass is carried, counter-clockwise from above.

    These are the sole's of one standing foot; of several, those of the hull of all soles. A sole
    whose friction cone does not hold the vertical counts for nothing: the forces straight up at the
    corners, which carry the robot, are not in the cone. None if what carries has no area.
    """
    standing = [foot for foot in stood.corners if foot != moving]
    slopes = {foot: math.acos(min(1.0, stood.rotations[foot][2, 2])) for foot in standing}
    points = [
        stood.corners[foot]
        for foot in standing
        if math.tan(slopes[foot]) <= robot.effector(foot).friction + 1e-9
    ]
    if len(standing) == 1 and points:
        (x, y), (next_x, next_y) = points[0].T[:2], np.roll(points[0], -1, axis=0).T[:2]
        area = 0.5 * abs(float((x * next_y - next_x * y).sum()))
        return points[0] if area > _LEAST_AREA else np.zeros((0, 3))
    try:
        together = np.concatenate(points)
        return together[ConvexHull(together[:, :2]).vertices]
    except (QhullError, ValueError):
        return np.zeros((0, 3))
