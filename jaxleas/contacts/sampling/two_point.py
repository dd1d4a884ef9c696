"""Whether one foot can move while all others stand: two points for the centre of mass (T app. B).

The foot m moves while the others stand. Quasi-statically the centre of mass stays above what
carries it; before m leaves there must be a point c0 there which all feet reach at their old places,
and after m has arrived a point c1 which all reach at the new ones. By convexity the straight line
from c0 to c1 is in equilibrium and in reach of the standing feet all the way (Tonneau et al. 2018,
"2PAC", for two feet).

One standing foot carries above its sole. On ground steeper than its friction it carries nothing:
the sum of its forces would have to be vertical, but lies in its friction cone. A point foot alone
carries nothing, either. Several feet carry above the convex hull of their soles, seen from above:
weights of the corners, straight down, then hold the robot. A foot whose friction cone does not hold
the vertical carries nothing of that. The hull is part of what several feet on uneven ground can
carry, never more.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.support import Sides, sides_of_hull, sides_of_polygon
from jaxleas.dynamics import maximise
from jaxleas.robots import Legs

_TRIED = np.array([0.35, 0.5, 0.65, 0.8])  # heights tried before any linear program, as shares
_START = 0.6  # height that a linear program starts from, likewise


@dataclass(frozen=True)
class Soles:
    """Soles of any number of feet, as many in each row.

    Attributes:
        limb: index of each foot.
        position: middle of each sole in the world [m].
        rotation: rotation of each foot in the world.
        corners: corners of the part of each sole that touches, counter-clockwise from above, in
            the world [m].
    """

    limb: Int[np.ndarray, "N S"]
    position: Float[np.ndarray, "N S 3"]
    rotation: Float[np.ndarray, "N S 3 3"]
    corners: Float[np.ndarray, "N S C 3"]


@dataclass(frozen=True)
class ComRegion:
    """Where the centre of mass can be while some feet stand: above them and in reach of each.

    All but the origin is relative to it: points c belong to the region if normals . c <= slack.

    Attributes:
        origin: middle of the first standing sole in the world [m].
        reach: half-spaces of the reach from each standing foot.
        sides: half-spaces of the prism above what carries.
        tried: points that are tried before any linear program [m].
    """

    origin: Float[np.ndarray, "N 3"]
    reach: Sides
    sides: Sides
    tried: Float[np.ndarray, "N P 3"]

    def __getitem__(self, rows) -> "ComRegion":
        """Return some of the regions."""
        return ComRegion(self.origin[rows], self.reach[rows], self.sides[rows], self.tried[rows])


def com_region(legs: Legs, standing: Soles) -> ComRegion:
    """Return where the centre of mass can be while some feet stand.

    Args:
        legs: legs of the robot.
        standing: soles of the feet that stand.
    """
    origin = standing.position[:, 0]
    corners = standing.corners - origin[:, None, None]
    steepest = 1.0 / np.sqrt(1.0 + legs.friction[standing.limb] ** 2)
    carries = standing.rotation[:, :, 2, 2] >= steepest
    if standing.limb.shape[1] == 1:
        sides = sides_of_polygon(corners[:, 0], carries[:, 0])
    else:
        sides = sides_of_hull(
            corners.reshape(len(origin), -1, 3), np.repeat(carries, corners.shape[2], axis=1)
        )
    points = corners.reshape(len(origin), -1, 3)
    middle = points.mean(axis=1, keepdims=True)
    places = np.concatenate([middle, 0.5 * (points + middle)], axis=1)[:, :, None]
    tried = places + _heights(legs, _TRIED)[:, None] * np.array([0.0, 0.0, 1.0])
    reaches = [
        _reach(legs, standing.limb[:, slot], standing.rotation[:, slot],
               standing.position[:, slot] - origin)
        for slot in range(standing.limb.shape[1])
    ]  # fmt: skip
    return ComRegion(origin, Sides.together(*reaches), sides, tried.reshape(len(origin), -1, 3))


def com_exists(
    legs: Legs,
    region: ComRegion,
    limb: Int[np.ndarray, " N"],
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
) -> Bool[np.ndarray, " N"]:
    """Return whether the centre of mass can be in a region and in reach of one more foot.

    Args:
        legs: legs of the robot.
        region: region of the feet that stand.
        limb: index of the foot that moves.
        sole: middle of the sole of that foot, in the world [m].
        rotation: rotation of that foot in the world.
    """
    if not len(limb):
        return np.zeros(0, dtype=bool)
    moving = _reach(legs, limb, rotation, sole - region.origin)
    rows = Sides.together(region.reach, moving, region.sides)
    fits = region.tried @ rows.normals.transpose(0, 2, 1) <= rows.slack[:, None]
    exists = np.any(np.all(fits, axis=2), axis=1)
    open_ = np.flatnonzero(~exists)
    if len(open_):
        exists[open_] = _margin(rows[open_], float(_heights(legs, _START))) >= 0.0
    return exists


def _reach(legs: Legs, limb: np.ndarray, rotation: np.ndarray, place: np.ndarray) -> Sides:
    """Return the reach of the centre of mass from feet, turned by the yaw of each.

    Args:
        legs: legs of the robot.
        limb: index of each foot.
        rotation: rotation of each foot in the world.
        place: middle of each sole [m].
    """
    normals, offsets = (each[limb] for each in legs.com_reach)
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])[:, None]
    x, y, z = (normals[..., axis] for axis in range(3))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    turned = np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=2)
    return Sides(turned, offsets + (turned @ place[:, :, None])[:, :, 0])


def _heights(legs: Legs, shares: float | np.ndarray) -> np.ndarray:
    """Return heights above a sole, from the lowest to the highest that the reaches allow [m]."""
    low, high = legs.com_heights
    return low + np.asarray(shares) * (high - low)


def _margin(rows: Sides, height: float) -> Float[np.ndarray, " N"]:
    """Return the largest t such that some c keeps all normals . c + t <= slack [m].

    Args:
        rows: half-spaces, relative to a sole.
        height: height above it that the search starts from [m].
    """
    start = np.array([0.0, 0.0, height])
    room = rows.slack - rows.normals @ start
    least = np.minimum(room.min(axis=1), 0.0)
    normals = np.concatenate([rows.normals, np.ones((*rows.slack.shape, 1))], axis=2)
    objective = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(normals), 4))
    answer = maximise(objective, normals, room - least[:, None])
    return np.where(answer.solved, least + answer.variables[:, 3], -np.inf)
