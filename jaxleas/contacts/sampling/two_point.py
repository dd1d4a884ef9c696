"""Whether one foot can move while the other stands: two points for the centre of mass (T app. B).

The foot m moves while o stands. Quasi-statically the centre of mass stays above o's sole; before
m leaves there must be a point c0 there which both feet reach at their old places, and after m has
arrived a point c1 which both reach at the new ones. By convexity the straight line from c0 to c1 is
in equilibrium and in reach of o all the way (Tonneau et al. 2018, "2PAC").
"""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.dynamics.small_lp import maximise
from jaxleas.geometry.polytopes import Polytope

_HEIGHTS = np.array([0.5, 0.6, 0.7, 0.8])  # of points tried before any linear program [m]


def com_exists(
    com_in_foot: Polytope,
    standing_sole: Float[np.ndarray, "N 3"],
    standing_rotation: Float[np.ndarray, "N 3 3"],
    standing_corners: Float[np.ndarray, "N 4 3"],
    other_sole: Float[np.ndarray, "N 3"],
    other_rotation: Float[np.ndarray, "N 3 3"],
    side: Float[np.ndarray, " N"],
) -> Bool[np.ndarray, " N"]:
    """Return whether the centre of mass can be above the standing sole, in reach of both feet.

    Args:
        com_in_foot: polytope of the left foot; the right foot's one is its mirror image.
        standing_sole: middle of the standing sole [m].
        standing_rotation: rotation of the standing foot.
        standing_corners: corners of the part of it that touches, counter-clockwise from above [m].
        other_sole: middle of the other sole [m].
        other_rotation: rotation of the other foot.
        side: side of the standing foot, +1 left, -1 right.
    """
    normals, slack = _constraints(
        com_in_foot,
        standing_sole,
        standing_rotation,
        standing_corners,
        other_sole,
        other_rotation,
        side,
    )
    if not len(side):
        return np.zeros(0, dtype=bool)
    exists = _some_point_fits(normals, slack, standing_corners - standing_sole[:, None])
    open_ = np.flatnonzero(~exists)
    if len(open_):
        exists[open_] = _margin(normals[open_], slack[open_]) >= 0.0
    return exists


def _constraints(
    com_in_foot: Polytope,
    standing_sole: np.ndarray,
    standing_rotation: np.ndarray,
    standing_corners: np.ndarray,
    other_sole: np.ndarray,
    other_rotation: np.ndarray,
    side: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return unit rows and slacks: rows . c <= slack, c relative to the standing sole."""
    count = len(side)
    first = _turned_faces(com_in_foot, standing_rotation, side)
    second = _turned_faces(com_in_foot, other_rotation, -side)
    offsets = com_in_foot.offsets
    apart = other_sole - standing_sole
    corners = standing_corners - standing_sole[:, None]
    edges = np.roll(corners, -1, axis=1) - corners
    # Outward, horizontal: the sole's prism along gravity.
    outward = np.stack([edges[..., 1], -edges[..., 0], np.zeros((count, 4))], axis=2)
    length = np.linalg.norm(outward, axis=2, keepdims=True)
    outward = np.where(length > 1e-9, outward / np.maximum(length, 1e-9), 0.0)
    normals = np.concatenate([first, second, outward], axis=1)
    slack = np.concatenate(
        [
            np.broadcast_to(offsets, (count, len(offsets))),
            offsets + (second @ apart[:, :, None])[:, :, 0],
            (outward * corners).sum(axis=2),
        ],
        axis=1,
    )
    return normals, slack


def _turned_faces(
    polytope: Polytope, rotation: np.ndarray, side: np.ndarray
) -> Float[np.ndarray, "N F 3"]:
    """Return the face normals in the world: mirrored for the right, turned by the foot's yaw."""
    yaw = np.arctan2(rotation[:, 1, 0], rotation[:, 0, 0])[:, None]
    x, z = polytope.normals[:, 0], polytope.normals[:, 2]
    y = side[:, None] * polytope.normals[:, 1]
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.stack(
        [cosine * x - sine * y, sine * x + cosine * y, np.broadcast_to(z, y.shape)], axis=2
    )


def _some_point_fits(
    normals: np.ndarray, slack: np.ndarray, corners: np.ndarray
) -> Bool[np.ndarray, " N"]:
    """Try a few points above the standing sole: nearly always one of them is valid."""
    middle = corners.mean(axis=1, keepdims=True)
    places = np.concatenate([middle, 0.5 * (corners + middle)], axis=1)[:, :, None]
    points = places + _HEIGHTS[:, None] * np.array([0.0, 0.0, 1.0])
    points = points.reshape(len(corners), places.shape[1] * len(_HEIGHTS), 3)
    fits = points @ normals.transpose(0, 2, 1) <= slack[:, None]
    return np.any(np.all(fits, axis=2), axis=1)


def _margin(normals: np.ndarray, slack: np.ndarray) -> Float[np.ndarray, " N"]:
    """Return the largest t such that some c keeps all rows . c + t <= slack [m]."""
    start = np.array([0.0, 0.0, 0.65])
    room = slack - normals @ start
    least = np.minimum(room.min(axis=1), 0.0)
    rows = np.concatenate([normals, np.ones((*normals.shape[:2], 1))], axis=2)
    objective = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(rows), 4))
    answer = maximise(objective, rows, room - least[:, None])
    return np.where(answer.solved, least + answer.variables[:, 3], -np.inf)
