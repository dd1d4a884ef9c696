"""Ground forces of standing feet that give the trunk a wanted acceleration."""

import numpy as np
from jaxtyping import Bool, Float

_SMALL = 1e-4
"""What the feet need not follow exactly: forces [1] and moments [m2], over those of unit forces."""


def ground_forces(
    wrench: Float[np.ndarray, "N 6"],
    arms: Float[np.ndarray, "N E 3"],
    stands: Bool[np.ndarray, "N E"],
    friction: float,
) -> Float[np.ndarray, "N E 3"]:
    """Return the least forces on the standing feet whose sum is nearest to a wrench.

    With the grasp matrix A of the standing feet, f = A^T (A A^T + eps I)^-1 w: two point feet
    cannot turn the trunk about the line between them, and nothing is asked of them there. Then
    each force is brought into its friction cone.

    Args:
        wrench: force [N] and moment about the centre of mass [Nm].
        arms: positions of the feet relative to the centre of mass, in the axes of the wrench [m].
        stands: whether a foot stands.
        friction: friction coefficient of the ground.
    """
    count, feet = stands.shape
    flat = grasp_of(arms, stands)
    square = flat @ np.swapaxes(flat, 1, 2) + _SMALL * np.eye(6)
    dual = np.linalg.solve(square, wrench[..., None])
    forces = (np.swapaxes(flat, 1, 2) @ dual).reshape(count, feet, 3)
    return within_cone(forces, friction)


def grasp_of(
    arms: Float[np.ndarray, "N E 3"], stands: Bool[np.ndarray, "N E"]
) -> Float[np.ndarray, "N 6 F"]:
    """Return the matrices from the forces on standing feet to their force and moment.

    Args:
        arms: positions of the feet relative to the point of the moment [m].
        stands: whether a foot stands.
    """
    count, feet = stands.shape
    grasp = np.zeros((count, 6, feet, 3))
    carried = stands.astype(float)
    for axis in range(3):
        grasp[:, axis, :, axis] = carried
    x, y, z = (arms[..., axis] * carried for axis in range(3))
    grasp[:, 3, :, 1], grasp[:, 3, :, 2] = -z, y
    grasp[:, 4, :, 0], grasp[:, 4, :, 2] = z, -x
    grasp[:, 5, :, 0], grasp[:, 5, :, 1] = -y, x
    return grasp.reshape(count, 6, 3 * feet)


def within_cone(
    forces: Float[np.ndarray, "*batch 3"], friction: float
) -> Float[np.ndarray, "*batch 3"]:
    """Return forces that push, and whose horizontal part is at most friction times that.

    Args:
        forces: forces of the ground [N].
        friction: friction coefficient of the ground.
    """
    up = np.maximum(forces[..., 2:], 0.0)
    along = forces[..., :2]
    size = np.sqrt((along * along).sum(axis=-1, keepdims=True))
    share = np.minimum(1.0, friction * up / np.maximum(size, 1e-9))
    return np.concatenate([along * share, up], axis=-1)
