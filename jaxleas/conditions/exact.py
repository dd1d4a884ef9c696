"""The slow twins of R, R* and C: polytopes against the scene's polygons, in NumPy float64.

They share no code with the margins on height maps. The twins differ from them by definition: R and
R* test the polygons that they are given, so pass a scene's *surfaces* (nothing stands on the side
of a wall); C tests whether a trunk box meets a polygon, so ground *above* the trunk is free and
a trunk wholly inside a solid goes unnoticed, while the map's C refuses both.
"""

from collections.abc import Callable, Iterable, Iterator
from functools import cache

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.conditions.footprint import UNDER_ROOT
from jaxleas.geometry import Polytope, pack_polygons, polygons_meet_polytope
from jaxleas.robots import Robot
from jaxleas.types import InputError

Polygons = Iterable[Float[np.ndarray, "V 3"]]

_ROOTS_AT_ONCE = 256  # bounds the memory of a table of roots x polygons
_PAIRS_AT_ONCE = 8192  # bounds the memory of a table of pairs x vertices x faces


def exact_reachability(
    robot: Robot,
    polygons: Polygons,
    position: Float[np.ndarray, "*batch 3"],
    yaw: Float[np.ndarray, "*batch"],
) -> Bool[np.ndarray, "*batch"]:
    """Return where R holds: some polygon meets the range of motion of some leg (T 3.1.1).

    Args:
        robot: robot whose legs reach.
        polygons: convex contact surfaces in the world [m]; see `pack_polygons`.
        position: position of the root in the world [m].
        yaw: heading of the root [rad].
    """
    reaches = [limb.range_of_motion for limb in robot.legs]
    return _meets_any(reaches, polygons, position, yaw)


def exact_strict_reachability(
    robot: Robot,
    polygons: Polygons,
    position: Float[np.ndarray, "*batch 3"],
    yaw: Float[np.ndarray, "*batch"],
) -> Bool[np.ndarray, "*batch"]:
    """Return where R* holds: as R, within the column |x|, |y| <= 0.1 m under the root (T eq. 3.6).

    Args:
        robot: robot whose legs reach.
        polygons: convex contact surfaces in the world [m].
        position: position of the root in the world [m].
        yaw: heading of the root [rad].
    """
    sides = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 1.0, 0], [0, -1.0, 0]])
    reaches = [limb.range_of_motion.cut(sides, np.full(4, UNDER_ROOT)) for limb in robot.legs]
    return _meets_any(reaches, polygons, position, yaw)


def exact_collision(
    robot: Robot,
    polygons: Polygons,
    position: Float[np.ndarray, "*batch 3"],
    yaw: Float[np.ndarray, "*batch"],
) -> Bool[np.ndarray, "*batch"]:
    """Return where C holds, so where the trunk is free: no polygon meets a trunk box (T 3.1.1).

    Args:
        robot: robot whose trunk must be free.
        polygons: polygons of surfaces and obstacles, including sides, in the world [m].
        position: position of the root in the world [m].
        yaw: heading of the root [rad].
    """
    boxes = [_box_with_corners(box) for box in robot.trunk]
    return ~_meets_any(boxes, polygons, position, yaw)


def reconfirm(
    satisfied: Bool[np.ndarray, " N"],
    position: Float[np.ndarray, "N 3"],
    yaw: Float[np.ndarray, " N"],
    exact: Callable[[np.ndarray, np.ndarray], Bool[np.ndarray, " M"]],
) -> Bool[np.ndarray, " N"]:
    """Ask the exact condition wherever the approximation refused (T 3.3.1).

    The map can overlook a small surface between its points, so that a refusal may be wrong; an
    approval of R or R* rarely is.

    Args:
        satisfied: answers of the approximation.
        position: positions of the roots in the world [m].
        yaw: headings of the roots [rad].
        exact: exact condition, which is called with the refused positions and yaws alone.
    """
    holds = np.array(satisfied, dtype=bool)
    refused = np.flatnonzero(~holds)
    if len(refused):
        holds[refused] = exact(np.asarray(position)[refused], np.asarray(yaw)[refused])
    return holds


_box_with_corners = cache(Polytope.from_box)
"""Finding the corners of a polytope takes a linear program, longer than to judge a short path."""


def _meets_any(
    polytopes: list[Polytope],
    polygons: Polygons,
    position: Float[np.ndarray, "*batch 3"],
    yaw: Float[np.ndarray, "*batch"],
) -> Bool[np.ndarray, "*batch"]:
    position, yaw = np.asarray(position, dtype=np.float64), np.asarray(yaw, dtype=np.float64)
    if position.shape != (*yaw.shape, 3):
        raise InputError(
            f"positions of shape {position.shape} and yaws of shape {yaw.shape} do not belong "
            "together: one yaw for each position x, y, z"
        )
    if not (np.isfinite(position).all() and np.isfinite(yaw).all()):
        raise InputError("positions and yaws must be finite numbers")
    packed = pack_polygons(polygons)
    flat_position, flat_yaw = position.reshape(-1, 3), yaw.reshape(-1)
    meets = np.zeros(len(flat_yaw), dtype=bool)
    for polytope in polytopes:
        undecided = np.flatnonzero(~meets)
        for roots, faces in _near_pairs(polytope, packed, flat_position, undecided):
            local = _to_root(packed[faces], flat_position[roots], flat_yaw[roots])
            meets[roots[polygons_meet_polytope(local, polytope)]] = True
    return meets.reshape(yaw.shape)


def _near_pairs(
    polytope: Polytope, packed: np.ndarray, position: np.ndarray, chosen: np.ndarray
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    # Pairs (root, polygon) whose bounding boxes overlap, whatever the yaw.
    reach = np.linalg.norm(polytope.vertices[:, :2], axis=1).max()
    extent = polytope.bounds
    below = np.array([-reach, -reach, extent.low[2]]) - 1e-6
    above = np.array([reach, reach, extent.high[2]]) + 1e-6
    low, high = packed.min(axis=1), packed.max(axis=1)
    for first in range(0, len(chosen), _ROOTS_AT_ONCE):
        roots = chosen[first : first + _ROOTS_AT_ONCE]
        at = position[roots]
        # Roots that follow one another lie close together: few polygons are near any of them.
        some = (high >= at.min(axis=0) + below) & (low <= at.max(axis=0) + above)
        around = np.flatnonzero(some.all(axis=1))
        near = np.ones((len(roots), len(around)), dtype=bool)
        for axis in range(3):
            here = at[:, axis, None]
            near &= high[around, axis] >= here + below[axis]
            near &= low[around, axis] <= here + above[axis]
        rows, columns = np.nonzero(near)
        faces = around[columns]
        for start in range(0, len(rows), _PAIRS_AT_ONCE):
            part = slice(start, start + _PAIRS_AT_ONCE)
            yield roots[rows[part]], faces[part]


def _to_root(vertices: np.ndarray, position: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    relative = vertices - position[:, None]
    cosine, sine = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    x, y = relative[..., 0], relative[..., 1]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x, relative[..., 2]], axis=-1)
