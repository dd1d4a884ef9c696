"""Positions and orientations: poses of roots and of effectors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from jaxtyping import Float

from jaxleas.types.errors import InputError
from jaxleas.types.quaternions import (
    IDENTITY,
    matrix_of,
    multiply,
    quaternion_about_z,
    quaternion_of,
)

if TYPE_CHECKING:
    from jaxleas.types.root import RootMotion

_UNIT = 1e-6


@dataclass(frozen=True, eq=False)
class Pose:
    """A rigid transformation from a body's frame to another one, of one body or of any batch.

    x_outside = R(quaternion) x_inside + position.

    Attributes:
        position: origin of the body's frame [m].
        quaternion: orientation of the body's axes (w, x, y, z), of unit length; q and -q are the
            same orientation.

    Raises:
        InputError: shapes disagree, a number is not finite, or the quaternion is not of length 1.
    """

    position: Float[np.ndarray, "*batch 3"]
    quaternion: Float[np.ndarray, "*batch 4"]

    def __post_init__(self) -> None:
        position = np.asarray(self.position, dtype=np.float64)
        quaternion = np.asarray(self.quaternion, dtype=np.float64)
        shapes = position.shape, quaternion.shape
        if shapes[0][-1:] != (3,) or shapes[1][-1:] != (4,) or shapes[0][:-1] != shapes[1][:-1]:
            raise InputError(
                f"a position of shape {shapes[0]} and a quaternion of shape {shapes[1]} make no"
                " pose: give [..., 3] and [..., 4]"
            )
        if not (np.isfinite(position).all() and np.isfinite(quaternion).all()):
            raise InputError("the position and quaternion of a pose must be finite numbers")
        with np.errstate(over="ignore"):  # untrusted files may hold numbers of any size
            length = np.linalg.norm(quaternion, axis=-1)
        if np.abs(length - 1.0).max(initial=0.0) > _UNIT:
            raise InputError("the quaternion of a pose (w, x, y, z) must have length 1")
        object.__setattr__(self, "position", position)
        object.__setattr__(self, "quaternion", quaternion)

    @classmethod
    def identity(cls) -> Self:
        """Return the pose of a frame in itself."""
        return cls(np.zeros(3), np.array(IDENTITY))

    @classmethod
    def from_yaw(
        cls, position: Float[np.ndarray, "*batch 3"], yaw: Float[np.ndarray, "*batch"] | float
    ) -> Self:
        """Return an upright pose.

        Args:
            position: origin of the frame [m].
            yaw: heading, 0 along x [rad].
        """
        return cls(position, quaternion_about_z(yaw))

    @classmethod
    def from_matrix(
        cls, position: Float[np.ndarray, "*batch 3"], rotation: Float[np.ndarray, "*batch 3 3"]
    ) -> Self:
        """Return the pose with a given rotation matrix."""
        return cls(position, quaternion_of(rotation))

    @cached_property
    def rotation(self) -> Float[np.ndarray, "*batch 3 3"]:
        """The rotation matrix, whose columns are the body's axes."""
        return matrix_of(self.quaternion)

    @property
    def yaw(self) -> Float[np.ndarray, "*batch"]:
        """Heading of the body's x axis, seen from above [rad]."""
        w, x, y, z = (self.quaternion[..., index] for index in range(4))
        return np.arctan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))

    def transform(self, points: Float[np.ndarray, "*batch P 3"]) -> Float[np.ndarray, "*batch P 3"]:
        """Return points given in the body's frame in the outer frame [m]."""
        return points @ np.swapaxes(self.rotation, -1, -2) + self.position[..., None, :]

    def inverse(self) -> Self:
        """Return the transformation from the outer frame to the body's frame."""
        conjugate = self.quaternion * np.array([1.0, -1.0, -1.0, -1.0])
        turned = (matrix_of(conjugate) @ self.position[..., None])[..., 0]
        return type(self)(-turned, conjugate)

    def __matmul__(self, inner: Pose) -> Self:
        """Return the pose of a body that has the pose `inner` in this body's frame."""
        position = (self.rotation @ inner.position[..., None])[..., 0] + self.position
        return type(self)(position, multiply(self.quaternion, inner.quaternion))


@dataclass(frozen=True, eq=False)
class RootPose(Pose):
    """The pose of a root in the world, upright or not."""

    @classmethod
    def from_motion(cls, motion: RootMotion) -> Self:
        """Return the pose of the root of a motion, which is upright."""
        return cls.from_yaw(np.asarray(motion.position), np.asarray(motion.yaw))
