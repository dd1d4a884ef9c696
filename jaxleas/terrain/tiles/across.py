"""The polygons of a straight obstacle across a rectangle of ground."""

import math

import numpy as np
from jaxtyping import Float

from jaxleas.geometry import Polytope, clip_polygon
from jaxleas.terrain.limit import Bar, Limit
from jaxleas.terrain.polygons import box_faces

_SQUARE = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])


def ground_across(
    limit: Limit, angle: float, half_size: tuple[float, float], at: float = 0.0
) -> list[Float[np.ndarray, "V 3"]]:
    """Return the ground before an obstacle and behind it, in a rectangle around the origin.

    Args:
        limit: obstacle; the ground before it lies at 0.
        angle: angle from the way ahead (x) to the normal of the obstacle [rad].
        half_size: half the rectangle along x and y [m].
        at: x at which the line of the obstacle crosses the x axis [m].
    """
    course = np.column_stack([_SQUARE * half_size, np.zeros(4)])
    normal = np.array([math.cos(angle), math.sin(angle), 0.0])
    line = at * normal[0]
    before = _beyond(course, -normal, -line)
    behind = _beyond(course, normal, line + limit.gap)
    return [before, behind + np.array([0.0, 0.0, limit.rise])]


def bars_across(
    limit: Limit, angle: float, reach: float, shift: float = 0.0, at: float = 0.0
) -> list[dict[str, Float[np.ndarray, "4 3"]]]:
    """Return the faces of each bar of an obstacle.

    Args:
        limit: obstacle; the ground before it lies at 0.
        angle: angle from the way ahead (x) to the normal of the obstacle [rad].
        reach: distance along the obstacle to either side up to which there are bars [m].
        shift: distance along the obstacle from its middle to the centre of a post [m].
        at: x at which the line of the obstacle crosses the x axis [m].
    """
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    boxes = []
    for bar in limit.bars:
        for middle, half in _stretches(bar, limit.period, shift, reach):
            corners = _SQUARE * (0.5 * bar.thickness, half) + (0.0, middle)
            boxes.append(box_faces(corners @ turn.T + (at, 0.0), bar.bottom, bar.top))
    return boxes


def _beyond(
    polygon: Float[np.ndarray, "V 3"], normal: Float[np.ndarray, " 3"], distance: float
) -> Float[np.ndarray, "W 3"]:
    """Return the part of a polygon that lies at least `distance` [m] along `normal`."""
    return clip_polygon(polygon, Polytope(-normal[None], np.array([-distance])))


def _stretches(bar: Bar, period: float, shift: float, reach: float) -> list[tuple[float, float]]:
    """Return the middle and half the length [m] of each copy of a bar along the obstacle."""
    if math.isinf(bar.length):
        return [(0.0, reach)]
    first, last = math.ceil((-reach - shift) / period), math.floor((reach - shift) / period)
    return [(shift + number * period, 0.5 * bar.length) for number in range(first, last + 1)]
