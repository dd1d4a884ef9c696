"""Upright root poses, and the axes in which the models of legs see the world."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int


@dataclass(frozen=True)
class Roots:
    """Upright root poses, one per row.

    Attributes:
        position: positions in the world [m].
        yaw: heading [rad].
        scene: index of the ground's scene that each root is in.
    """

    position: Float[np.ndarray, "N 3"]
    yaw: Float[np.ndarray, " N"]
    scene: Int[np.ndarray, " N"]

    def __getitem__(self, rows) -> "Roots":
        """Return some of the poses."""
        return Roots(self.position[rows], self.yaw[rows], self.scene[rows])

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self.yaw)


def to_model(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Turn world vectors into the root's axes, mirrored where a leg mirrors its model.

    Args:
        vectors: vectors in the world.
        yaw: heading of the roots [rad].
        side: side of the legs: -1 for mirror images of their models, else +1.
    """
    return (vectors[:, None] @ model_axes(yaw, side))[:, 0]


def to_world(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Undo `to_model`."""
    return (model_axes(yaw, side) @ vectors[:, :, None])[:, :, 0]


def rotations_to_world(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Turn rotations that models have in the root frame into the world, mirroring as needed."""
    turned = model_axes(yaw, side) @ rotations
    turned[:, :, 1] *= side[:, None]
    return turned


def rotations_to_model(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Undo `rotations_to_world`."""
    turned = model_axes(yaw, side).transpose(0, 2, 1) @ rotations
    turned[:, :, 1] *= side[:, None]
    return turned


def model_axes(
    yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3 3"]:
    """Return the matrices of `to_world`; for mirror images their second axis is reversed."""
    frames = np.zeros((len(yaw), 3, 3))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    frames[:, 0, 0], frames[:, 0, 1] = cosine, -sine * side
    frames[:, 1, 0], frames[:, 1, 1] = sine, cosine * side
    frames[:, 2, 2] = 1.0
    return frames
