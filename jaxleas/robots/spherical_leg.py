"""The inverse kinematics of a leg with a spherical hip and two ankle axes that meet."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots.chain import SerialChain

_AXES = (2, 0, 1, 1, 1, 0)
"""Axes of hip yaw, hip roll, hip pitch, knee, ankle pitch and ankle roll."""


@dataclass(frozen=True, eq=False)
class SphericalLeg:
    """A leg whose three hip axes meet in one point, and its two ankle axes in another.

    Attributes:
        hip: point where the hip's axes meet, in the root frame [m].
        thigh: length from hip to knee [m].
        shank: length from knee to ankle [m].
        sole: distance of the sole below the ankle [m].
    """

    hip: Float[np.ndarray, " 3"]
    thigh: float
    shank: float
    sole: float

    @classmethod
    def of(cls, chain: SerialChain) -> "SphericalLeg | None":
        """Return the leg of a chain; None if the chain is not such a leg."""
        straight = not any(chain.turned) and np.array_equal(chain.tip.rotation, np.eye(3))
        if chain.along != _AXES or not straight:
            return None
        offsets = np.concatenate([chain.positions[1:], chain.tip.position[None]])
        thigh, shank, sole = (-offsets[[2, 3, 5], 2]).tolist()
        expected = np.zeros((6, 3))
        expected[[2, 3, 5], 2] = -thigh, -shank, -sole
        if not np.array_equal(offsets, expected) or min(thigh, shank) <= 0.0:
            return None
        return cls(chain.positions[0], thigh, shank, sole)

    def inverse(
        self, sole: Float[np.ndarray, "*batch 3"], rotation: Float[np.ndarray, "*batch 3 3"]
    ) -> tuple[Float[np.ndarray, "*batch 6"], Bool[np.ndarray, "*batch"]]:
        """Return the angles that bring the sole to a pose, the knee bent forwards.

        The distance of hip and ankle gives the knee; the hip's position in the foot's frame gives
        the ankle's two angles; the rest of the rotation is the hip's (the textbook solution for a
        spherical hip; Kajita et al. 2014, sec. 2.5).

        Args:
            sole: position of the sole in the root frame [m].
            rotation: orientation of the foot in the root frame.

        Returns:
            The angles [rad], and whether the pose is in reach; angles of a pose out of reach are
            those of the leg stretched towards it.
        """
        ankle = sole + self.sole * rotation[..., :, 2]
        to_hip = self.hip - ankle
        # The hip in the foot's frame.
        seen = (to_hip[..., None, :] @ rotation)[..., 0, :]
        x, y, z = seen[..., 0], seen[..., 1], seen[..., 2]
        squared = x * x + y * y + z * z
        bend = (squared - self.thigh**2 - self.shank**2) / (2.0 * self.thigh * self.shank)
        cosine = np.clip(bend, -1.0, 1.0)
        knee = np.arccos(cosine)
        ankle_roll = np.arctan2(y, z)
        leg_pitch = np.arctan2(-self.thigh * np.sin(knee), self.shank + self.thigh * cosine)
        ankle_pitch = leg_pitch - np.arctan2(x, np.sqrt(y * y + z * z))
        hip = _hip_angles(rotation, ankle_roll, ankle_pitch + knee)
        return np.stack([*hip, knee, ankle_pitch, ankle_roll], axis=-1), np.abs(bend) <= 1.0


def _hip_angles(
    rotation: np.ndarray, ankle_roll: np.ndarray, pitch: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return yaw, roll and pitch of hip = foot * Rx(-roll) * Ry(-(ankle pitch + knee))."""
    # Two columns of it suffice.
    cr, sr = np.cos(ankle_roll)[..., None], np.sin(ankle_roll)[..., None]
    cp, sp = np.cos(pitch)[..., None], np.sin(pitch)[..., None]
    first, second, third = rotation[..., :, 0], rotation[..., :, 1], rotation[..., :, 2]
    lateral = cr * second - sr * third
    upward = sr * second + cr * third
    hip_roll = np.arcsin(np.clip(lateral[..., 2], -1.0, 1.0))
    hip_yaw = np.arctan2(-lateral[..., 0], lateral[..., 1])
    forward_z = (cp * first + sp * upward)[..., 2]
    upward_z = (cp * upward - sp * first)[..., 2]
    return hip_yaw, hip_roll, np.arctan2(-forward_z, upward_z)
