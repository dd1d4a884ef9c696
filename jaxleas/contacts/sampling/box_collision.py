"""Do turned boxes meet a scene's polygons? By separating axes, for many boxes at once."""

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.contacts.sampling.ground import Ground


def boxes_meet_ground(
    centres: Float[np.ndarray, "N 3"],
    rotations: Float[np.ndarray, "N 3 3"],
    half_sizes: Float[np.ndarray, "N 3"],
    ground: Ground,
) -> Bool[np.ndarray, " N"]:
    """Tell which boxes touch any polygon.

    Box and polygon are convex: they are apart exactly if their projections are, on a face normal
    of the box, on the polygon's normal, or on a product of an edge of each. (The polygon's own
    in-plane edge normals are limits of those products.)

    Args:
        centres: of the boxes, in the world [m].
        rotations: whose columns are the boxes' axes.
        half_sizes: along these axes [m].
        ground: the polygons.
    """
    if not len(centres):
        return np.zeros(0, dtype=bool)
    reach = (np.abs(rotations) @ half_sizes[:, :, None])[:, :, 0]
    low, high = centres - reach, centres + reach
    near = np.flatnonzero(
        (ground.low <= high.max(axis=0)).all(axis=1) & (ground.high >= low.min(axis=0)).all(axis=1)
    )
    touching = np.zeros(len(centres), dtype=bool)
    overlap = np.ones((len(centres), len(near)), dtype=bool)
    for axis in range(3):
        overlap &= ground.low[near, axis] <= high[:, axis, None]
        overlap &= ground.high[near, axis] >= low[:, axis, None]
    box, polygon = np.nonzero(overlap)
    if len(box):
        polygon = near[polygon]
        meets = _meet(
            centres[box], rotations[box], half_sizes[box], ground.vertices[polygon],
            ground.normals[polygon],
        )  # fmt: skip
        touching[box[meets]] = True
    return touching


def _meet(
    centres: np.ndarray,
    rotations: np.ndarray,
    half: np.ndarray,
    vertices: np.ndarray,
    normals: np.ndarray,
) -> Bool[np.ndarray, " M"]:
    """Decide pairs of one box and one polygon; axis after axis, on the pairs still open."""
    local = (vertices - centres[:, None]) @ rotations  # [M, W, 3], in the box's frame
    turned = (normals[:, None] @ rotations)[:, 0]
    open_ = (local.min(axis=1) <= half).all(axis=1) & (local.max(axis=1) >= -half).all(axis=1)
    distance = np.abs((turned * local[:, 0]).sum(axis=1))
    open_ &= distance <= (np.abs(turned) * half).sum(axis=1)
    undecided = np.flatnonzero(open_)
    if not len(undecided):
        return open_
    local, half = local[undecided], half[undecided]
    edges = np.roll(local, -1, axis=1) - local
    apart = np.zeros(len(undecided), dtype=bool)
    for axis in range(3):
        # The product of a box axis with an edge has only the edge's two other components.
        second, third = (axis + 1) % 3, (axis + 2) % 3
        u, v = edges[:, :, second, None], edges[:, :, third, None]
        along = u * local[:, None, :, third] - v * local[:, None, :, second]  # [M, edge, vertex]
        reach = (
            np.abs(u[:, :, 0]) * half[:, third, None] + np.abs(v[:, :, 0]) * half[:, second, None]
        )
        # An edge of length zero (padding) gives 0 > 0: it separates nothing.
        apart |= ((along.min(axis=2) > reach) | (along.max(axis=2) < -reach)).any(axis=1)
    open_[undecided[apart]] = False
    return open_
