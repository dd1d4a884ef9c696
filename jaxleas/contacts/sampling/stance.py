"""The feet of many robots on the ground, and the area that carries them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.ground import Ground
from jaxleas.robots import Legs


@dataclass(frozen=True, eq=False)
class Stances:
    """Contacts of all feet, one row per robot.

    Attributes:
        sole: position of the middle of the sole, in the world [m].
        rotation: rotation of the foot in the world; the third column is the surface's normal.
        surface: index of the ground's polygon; -1 without a contact.
        corners: corners of the part of the sole that is over its surface, in the world, as many for
            each foot as `Legs.corners` has [m].
        since: order in which contacts were made: the smaller, the older.
    """

    sole: Float[np.ndarray, "N F 3"]
    rotation: Float[np.ndarray, "N F 3 3"]
    surface: Int[np.ndarray, "N F"]
    corners: Float[np.ndarray, "N F C 3"]
    since: Int[np.ndarray, "N F"]

    def __getitem__(self, rows) -> "Stances":
        """Return some of the stances (a copy where `rows` are indices)."""
        return Stances(
            self.sole[rows],
            self.rotation[rows],
            self.surface[rows],
            self.corners[rows],
            self.since[rows],
        )

    def __len__(self) -> int:
        """Return the number of robots."""
        return len(self.sole)


def no_stances(legs: Legs, count: int) -> Stances:
    """Return stances without contacts, to be filled in."""
    feet, corners = legs.corners.shape[:2]
    return Stances(
        sole=np.zeros((count, feet, 3)),
        rotation=np.broadcast_to(np.eye(3), (count, feet, 3, 3)).copy(),
        surface=np.full((count, feet), -1),
        corners=np.zeros((count, feet, corners, 3)),
        since=np.zeros((count, feet), dtype=np.int64),
    )


def put(stances: Stances, rows: Int[np.ndarray, " M"], new: Stances) -> None:
    """Write stances into some rows of others."""
    stances.sole[rows], stances.rotation[rows] = new.sole, new.rotation
    stances.surface[rows], stances.corners[rows] = new.surface, new.corners
    stances.since[rows] = new.since


def support_corners(
    ground: Ground,
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
    surface: Int[np.ndarray, " N"],
    corners: Float[np.ndarray, "N C 2"],
) -> Float[np.ndarray, "N C 3"]:
    """Return the sole's corners, each moved towards its middle until it is over the surface.

    The points span part of the area that really touches, never more.

    Args:
        ground: polygons of the scene.
        sole: middle of the sole, over the surface [m].
        rotation: rotation of the foot.
        surface: index of the surface that it stands on.
        corners: corners of the sole in its frame [m].
    """
    reach = corners @ rotation[:, :, :2].transpose(0, 2, 1)  # [N, corner, 3]
    inward = ground.inward[surface]  # [N, W, 3]
    room = (inward @ sole[:, :, None])[:, :, 0] - ground.inward_offsets[surface]
    outwards = -(reach @ inward.transpose(0, 2, 1))  # [N, corner, W]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(outwards > 1e-12, np.maximum(room, 0.0)[:, None] / outwards, 1.0)
    return sole[:, None] + np.minimum(share.min(axis=2), 1.0)[:, :, None] * reach
