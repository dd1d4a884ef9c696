"""The feet of many robots on the ground, and the area that carries them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from jaxleas.contacts.sampling.ground import Ground
from jaxleas.contacts.sampling.limbs import SIDES


@dataclass(frozen=True, eq=False)
class Stances:
    """Contacts of left and right foot, one row per robot.

    Attributes:
        sole: position of the middle of the sole, in the world [m].
        rotation: rotation of the foot in the world; the third column is the surface's normal.
        surface: index of the ground's polygon; -1 without a contact.
        corners: corners of the part of the sole that is over its surface, in the world [m].
        since: order in which contacts were made: the smaller, the older.
    """

    sole: Float[np.ndarray, "N 2 3"]
    rotation: Float[np.ndarray, "N 2 3 3"]
    surface: Int[np.ndarray, "N 2"]
    corners: Float[np.ndarray, "N 2 4 3"]
    since: Int[np.ndarray, "N 2"]

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


def no_stances(count: int) -> Stances:
    """Return stances without contacts, to be filled in."""
    limbs = len(SIDES)
    return Stances(
        sole=np.zeros((count, limbs, 3)),
        rotation=np.broadcast_to(np.eye(3), (count, limbs, 3, 3)).copy(),
        surface=np.full((count, limbs), -1),
        corners=np.zeros((count, limbs, 4, 3)),
        since=np.zeros((count, limbs), dtype=np.int64),
    )


def support_corners(
    ground: Ground,
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
    surface: Int[np.ndarray, " N"],
    half_size: tuple[float, float],
) -> Float[np.ndarray, "N 4 3"]:
    """Return the sole's corners, each moved towards its middle until it is over the surface.

    The four points span part of the area that really touches, never more.

    Args:
        ground: polygons of the scene.
        sole: middle of the sole, over the surface [m].
        rotation: rotation of the foot.
        surface: index of the surface that it stands on.
        half_size: half length and half width of the sole [m].
    """
    signs = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]]) * half_size
    reach = signs @ rotation[:, :, :2].transpose(0, 2, 1)  # [N, corner, 3]
    inward = ground.inward[surface]  # [N, W, 3]
    room = (inward @ sole[:, :, None])[:, :, 0] - ground.inward_offsets[surface]
    outwards = -(reach @ inward.transpose(0, 2, 1))  # [N, corner, W]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(outwards > 1e-12, np.maximum(room, 0.0)[:, None] / outwards, 1.0)
    return sole[:, None] + np.minimum(share.min(axis=2), 1.0)[:, :, None] * reach
