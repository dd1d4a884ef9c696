"""Whether a robot can cross a limit: a search over place, heading and height of the root.

The obstacle is taken as endless and periodic, so that the search has few cells: x across it, y
over one period along it. R* and C are tested with the exact shapes: the trunk's boxes against the
obstacle's, the range of motion of each leg over points 1 cm apart.
"""

import math
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from jaxleas.conditions import UNDER_ROOT
from jaxleas.geometry import Box
from jaxleas.robots import Robot
from jaxleas.terrain import Limit

Rectangle = Float[np.ndarray, "2 2"]
"""Low and high [m], across (first row) and along the obstacle."""

Crossability = Literal["crossable", "between", "hopeless"]

SPARE = 0.04
"""How much worse a crossable obstacle may become and still be crossable [m]."""
PLACE, HEIGHT, HEADINGS, POINTS = 0.02, 0.02, 24, 0.01
"""Spacing of the places and heights of the root [m], number of headings of the search, and spacing
of the points under the root [m]."""


def crossability(robot: Robot, limit: Limit) -> Crossability:
    """Return whether a robot can cross an obstacle with 4 cm to spare, never, or between the two.

    Crossable: the tops of bars are not stood on, and each size of the obstacle may be 4 cm larger.
    Hopeless: not even by standing on the bars.

    Args:
        robot: robot whose trunk must be free and whose legs must reach ground (R*, C).
        limit: obstacle.
    """
    if can_cross(robot, limit.worse(SPARE), on_bars=False):
        return "crossable"
    return "between" if can_cross(robot, limit, on_bars=True) else "hopeless"


def can_cross(robot: Robot, limit: Limit, on_bars: bool) -> bool:
    """Return whether valid configurations lead without a break from before an obstacle to behind.

    Args:
        robot: robot whose trunk must be free and whose legs must reach ground.
        limit: obstacle.
        on_bars: whether the tops of bars may be stood on.
    """
    free = free_configurations(robot, limit, on_bars)
    # Twice round in heading and along: what leaves at one end comes in at the other.
    parts = np.zeros(np.multiply(free.shape, (2, 1, 2, 1)), dtype=np.int32)
    ndimage.label(np.tile(free, (2, 1, 2, 1)), structure=np.ones((3,) * 4), output=parts)
    before, behind = np.unique(parts[:, 0]), np.unique(parts[:, -1])
    return bool(np.intersect1d(before[before > 0], behind[behind > 0]).size)


def free_configurations(
    robot: Robot, limit: Limit, on_bars: bool
) -> Bool[np.ndarray, "headings across along heights"]:
    """Return which configurations of the search satisfy R* and C.

    Args:
        robot: robot whose trunk must be free and whose legs must reach ground.
        limit: obstacle.
        on_bars: whether the tops of bars may be stood on.
    """
    headings, across, along, heights = lattice(robot, limit)
    places = np.stack(np.meshgrid(across, along, indexing="ij"), axis=-1)
    free = [
        (heights > _lowest_free(robot, limit, places, heading)[..., None])
        & _reaching(robot, limit, places, heading, heights, on_bars)
        for heading in headings
    ]
    return np.stack(free)


def lattice(robot: Robot, limit: Limit) -> tuple[Float[np.ndarray, " N"], ...]:
    """Return the headings [rad] and the places across, along and above [m] of a search."""
    corners = [np.abs([box.low[:2], box.high[:2]]).max(axis=0) for box in robot.trunk]
    clear = PLACE + max(map(np.linalg.norm, corners))
    clear += 0.5 * max((bar.thickness for bar in limit.bars), default=0.0)
    period = PLACE if limit.uniform else limit.period
    columns = max(1, round(period / PLACE))
    lowest, highest = _root_heights(robot, limit)
    return (
        np.arange(HEADINGS) * (2.0 * math.pi / HEADINGS),
        np.arange(-clear, limit.gap + clear + PLACE, PLACE),
        np.arange(columns) * (period / columns),
        np.arange(lowest, highest + HEIGHT, HEIGHT),
    )


def _root_heights(robot: Robot, limit: Limit) -> tuple[float, float]:
    """Return the lowest and the highest root height that is searched [m].

    What is higher above the ground than the legs' whole range cannot be stepped on: no root
    reaches both.
    """
    reaches = [limb.range_of_motion.bounds for limb in robot.legs]
    shortest = -max(each.high[2] for each in reaches)
    longest = -min(each.low[2] for each in reaches)
    levels = (0.0, limit.rise, *(bar.top for bar in limit.bars))
    stepped_on = [level for level in levels if abs(level) <= longest - shortest]
    return min(stepped_on) + shortest, max(stepped_on) + longest


def _lowest_free(
    robot: Robot, limit: Limit, places: Float[np.ndarray, "X Y 2"], heading: float
) -> Float[np.ndarray, "X Y"]:
    """Return the root height at which the trunk touches what is under it [m]."""
    lowest = np.full(places.shape[:2], -math.inf)
    for box in robot.trunk:
        for rectangle, top in _solids(limit):
            meets = _rectangles_meet(box, places, heading, rectangle)
            lowest = np.where(meets, np.maximum(lowest, top - box.low[2]), lowest)
    return lowest


def _solids(limit: Limit) -> list[tuple[Rectangle, float]]:
    """Return the outlines of grounds and bars, and their heights [m]."""
    solids = [
        (np.array([[-math.inf, 0.0], [-math.inf, math.inf]]), 0.0),
        (np.array([[limit.gap, math.inf], [-math.inf, math.inf]]), limit.rise),
    ]
    for bar in limit.bars:
        endless = math.isinf(bar.length)
        if not (limit.uniform and not endless):
            half = 0.5 * np.array([[-bar.thickness, bar.thickness], [-bar.length, bar.length]])
            copies = (0.0,) if endless else limit.period * np.arange(-2, 4)
            solids += [(half + np.array([[0.0], [at]]), bar.top) for at in copies]
    return solids


def _rectangles_meet(
    box: Box, places: Float[np.ndarray, "X Y 2"], heading: float, rectangle: Rectangle
) -> Bool[np.ndarray, "X Y"]:
    """Return where a box of the root frame stands over a rectangle (separating axes)."""
    low, high = np.array(box.low[:2]), np.array(box.high[:2])
    ahead, left = _axes(heading)
    half = 0.5 * (high - low)
    centre = places + 0.5 * (low + high) @ np.stack([ahead, left])
    extent = np.abs(ahead) * half[0] + np.abs(left) * half[1]
    lower, upper = rectangle.T
    meets = ((centre + extent > lower) & (centre - extent < upper)).all(axis=-1)
    if np.isfinite(rectangle).all():  # an endless one is parted by its own sides alone
        size, middle = 0.5 * (upper - lower), 0.5 * (upper + lower)
        for axis, own in ((ahead, half[0]), (left, half[1])):
            meets &= np.abs((centre - middle) @ axis) < own + np.abs(axis) @ size
    return meets


def _reaching(
    robot: Robot,
    limit: Limit,
    places: Float[np.ndarray, "X Y 2"],
    heading: float,
    heights: Float[np.ndarray, " Z"],
    on_bars: bool,
) -> Bool[np.ndarray, "X Y Z"]:
    """Return where a leg reaches ground under the root: R* (T eq. 3.6)."""
    side = np.linspace(-UNDER_ROOT, UNDER_ROOT, round(2.0 * UNDER_ROOT / POINTS) + 1)
    points = np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1).reshape(-1, 2)
    intervals = [limb.range_of_motion.z_interval(points) for limb in robot.legs]

    def reached(places: Float[np.ndarray, "X Y 2"]) -> Bool[np.ndarray, "X Y Z"]:
        under = (places[..., None, :] + points @ _axes(heading)).astype(np.float32)
        found = np.zeros((*places.shape[:2], len(heights)), dtype=bool)
        for covers, top in _tops(limit, under, on_bars):
            below = top - heights
            within = np.zeros((len(points), len(heights)), dtype=bool)
            for lowest, highest in intervals:  # NaN where the leg does not reach: false
                within |= (below >= lowest[:, None]) & (below <= highest[:, None])
            found |= covers.astype(np.float32) @ within.astype(np.float32) > 0.5
        return found

    # Only near the bars does it matter where along the obstacle the root is.
    widest = max((bar.thickness for bar in limit.bars), default=0.0)
    near = np.abs(places[:, 0, 0]) <= math.sqrt(2.0) * UNDER_ROOT + 0.5 * widest
    everywhere = np.repeat(reached(places[:, :1]), places.shape[1], axis=1)
    if places.shape[1] > 1:
        everywhere[near] = reached(places[near])
    return everywhere


def _tops(
    limit: Limit, points: Float[np.ndarray, "*batch 2"], on_bars: bool
) -> list[tuple[Bool[np.ndarray, "*batch"], float]]:
    """Return which points lie on each level that may be stood on, and its height [m]."""
    across, along = points[..., 0], points[..., 1]
    free, tops = np.ones(across.shape, dtype=bool), []
    for bar in sorted(limit.bars, key=lambda bar: -bar.top):
        covered = np.abs(across) <= 0.5 * bar.thickness
        if not math.isinf(bar.length):
            half = 0.5 * limit.period
            covered &= np.abs((along + half) % limit.period - half) <= 0.5 * bar.length
        if on_bars:
            tops.append((covered & free, bar.top))
        free &= ~covered
    return [*tops, (free & (across <= 0.0), 0.0), (free & (across >= limit.gap), limit.rise)]


def _axes(heading: float) -> Float[np.ndarray, "2 2"]:
    """Return the directions ahead and left of the root, one in each row."""
    cosine, sine = math.cos(heading), math.sin(heading)
    return np.array([[cosine, sine], [-sine, cosine]])
