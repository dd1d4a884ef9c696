"""Collisions of rotated boxes with the ground's polygons, by separating axes, for many boxes."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.ground import Ground


@dataclass(frozen=True)
class Places:
    """Boxes that are close together, so that only the polygons near them are tested.

    Attributes:
        first: index of each place's first box; its boxes are those up to the next place's first.
        scene: index of the ground's scene that each place is in.
    """

    first: Int[np.ndarray, " G"]
    scene: Int[np.ndarray, " G"]

    @classmethod
    def of(
        cls, position: Float[np.ndarray, "M 3"], scene: Int[np.ndarray, " M"], each: int
    ) -> "Places":
        """Return the runs of rows at one position, where each row has `each` boxes."""
        new = np.ones(len(scene), dtype=bool)
        new[1:] = (position[1:] != position[:-1]).any(axis=1) | (scene[1:] != scene[:-1])
        rows = np.flatnonzero(new)
        return cls(rows * each, scene[rows])


def boxes_meet_ground(
    centres: Float[np.ndarray, "N 3"],
    rotations: Float[np.ndarray, "N 3 3"],
    half_sizes: Float[np.ndarray, "N 3"],
    ground: Ground,
    places: Places | None = None,
) -> Bool[np.ndarray, " N"]:
    """Return which boxes touch any polygon.

    Box and polygon are convex: they are apart exactly if their projections are, on a face normal
    of the box, on the polygon's normal, or on a product of an edge of each. (The polygon's own
    in-plane edge normals are limits of those products.)

    Args:
        centres: centres of the boxes, in the world [m].
        rotations: rotations whose columns are the boxes' axes.
        half_sizes: half sizes along these axes [m].
        ground: polygons of the ground.
        places: groups of boxes that are close together; one place in scene 0 if None.
    """
    if not len(centres):
        return np.zeros(0, dtype=bool)
    reach = (np.abs(rotations) @ half_sizes[:, :, None])[:, :, 0]
    low, high = centres - reach, centres + reach
    touching = np.zeros(len(centres), dtype=bool)
    zero = np.zeros(1, dtype=np.int64)
    box, polygon = _near_pairs(low, high, ground, places or Places(zero, zero))
    if len(box):
        meets = _meet(
            centres[box], rotations[box], half_sizes[box], ground.vertices[polygon],
            ground.normals[polygon],
        )  # fmt: skip
        touching[box[meets]] = True
    return touching


def _near_pairs(
    low: np.ndarray, high: np.ndarray, ground: Ground, places: Places
) -> tuple[np.ndarray, np.ndarray]:
    """Return (box, polygon) of all pairs whose bounding boxes overlap, box after box."""
    least = np.minimum.reduceat(low, places.first)
    most = np.maximum.reduceat(high, places.first)
    near = ground.scene == places.scene[:, None]
    for axis in range(3):
        near &= ground.low[:, axis] <= most[:, axis, None]
        near &= ground.high[:, axis] >= least[:, axis, None]
    polygon = np.nonzero(near)[1]
    polygons = near.sum(axis=1)
    boxes = np.diff(places.first, append=len(low))
    # Each box of a place with each polygon near it.
    pairs = np.repeat(polygons, boxes)
    box = np.repeat(np.arange(len(low)), pairs)
    before = np.repeat(np.cumsum(polygons) - polygons, boxes)
    within = np.arange(len(box)) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    polygon = polygon[before[box] + within]
    for axis in (2, 0, 1):
        overlap = ground.low[polygon, axis] <= high[box, axis]
        overlap &= ground.high[polygon, axis] >= low[box, axis]
        box, polygon = box[overlap], polygon[overlap]
    return box, polygon


def _meet(
    centres: np.ndarray,
    rotations: np.ndarray,
    half: np.ndarray,
    vertices: np.ndarray,
    normals: np.ndarray,
) -> Bool[np.ndarray, " M"]:
    """Decide pairs of one box and one polygon, axis by axis, for the pairs still undecided."""
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
