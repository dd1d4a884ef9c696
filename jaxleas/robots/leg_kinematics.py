"""Forward and inverse kinematics of the left leg in closed form, for many postures at once.

For the right leg mirror what goes in and what comes out: positions by (1, -1, 1), rotations by
that on both sides, angles by `MIRRORED_JOINTS`.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots.legs import JOINTS, LegModel

# Of each joint: the axis it turns about, then the two that it turns, in cyclic order.
_X, _Y, _Z = (0, 1, 2), (1, 2, 0), (2, 0, 1)
_AXES = (_Z, _X, _Y, _Y, _Y, _X)


@dataclass(frozen=True)
class LegPosture:
    """Where the six links of the left leg are, in the root frame.

    Attributes:
        frames: of the links, each turned by its joint; the last is the foot's, whose third column
            is the sole's normal.
        origins: of the joints: three times the hip, the knee, twice the ankle [m].
        sole: position of the sole's origin [m].
    """

    frames: Float[np.ndarray, "*batch 6 3 3"]
    origins: Float[np.ndarray, "*batch 6 3"]
    sole: Float[np.ndarray, "*batch 3"]

    @property
    def foot(self) -> Float[np.ndarray, "*batch 3 3"]:
        """The rotation of foot and sole."""
        return self.frames[..., 5, :, :]


def leg_posture(legs: LegModel, angles: Float[np.ndarray, "*batch 6"]) -> LegPosture:
    """Place the left leg's links in the root frame.

    Args:
        legs: the model.
        angles: of the six joints [rad].
    """
    batch = angles.shape[:-1]
    cosines, sines = np.cos(angles)[..., None], np.sin(angles)[..., None]
    frames = np.empty((*batch, JOINTS, 3, 3))
    before = np.broadcast_to(np.eye(3), (*batch, 3, 3))
    for joint, (kept, first, second) in enumerate(_AXES):
        cosine, sine = cosines[..., joint, :], sines[..., joint, :]
        frame = frames[..., joint, :, :]
        frame[..., kept] = before[..., kept]
        frame[..., first] = cosine * before[..., first] + sine * before[..., second]
        frame[..., second] = cosine * before[..., second] - sine * before[..., first]
        before = frame
    origins = np.empty((*batch, JOINTS, 3))
    origins[..., :3, :] = legs.hip
    origins[..., 3, :] = legs.hip - legs.thigh * frames[..., 2, :, 2]
    origins[..., 4, :] = origins[..., 3, :] - legs.shank * frames[..., 3, :, 2]
    origins[..., 5, :] = origins[..., 4, :]
    return LegPosture(frames, origins, origins[..., 5, :] - legs.sole * frames[..., 5, :, 2])


def leg_angles(
    legs: LegModel,
    sole: Float[np.ndarray, "*batch 3"],
    rotation: Float[np.ndarray, "*batch 3 3"],
) -> tuple[Float[np.ndarray, "*batch 6"], Bool[np.ndarray, "*batch"]]:
    """Return the angles that bring the left sole to a pose, the knee bent forwards.

    The distance of hip and ankle gives the knee; the hip as the foot sees it gives the ankle's two
    angles; what is then left of the rotation is the hip's (the textbook solution for a spherical
    hip; Kajita et al. 2014, sec. 2.5).

    Args:
        legs: the model.
        sole: position in the root frame [m].
        rotation: of the foot in the root frame.

    Returns:
        Angles [rad], and whether the pose is in reach and within the joint limits; angles of a
        pose out of reach are those of the leg stretched towards it.
    """
    ankle = sole + legs.sole * rotation[..., :, 2]
    to_hip = legs.hip - ankle
    # The hip as seen by the foot.
    seen = (to_hip[..., None, :] @ rotation)[..., 0, :]
    x, y, z = seen[..., 0], seen[..., 1], seen[..., 2]
    squared = x * x + y * y + z * z
    bend = (squared - legs.thigh**2 - legs.shank**2) / (2.0 * legs.thigh * legs.shank)
    in_reach = np.abs(bend) <= 1.0
    cosine = np.clip(bend, -1.0, 1.0)
    knee = np.arccos(cosine)
    ankle_roll = np.arctan2(y, z)
    leg_pitch = np.arctan2(-legs.thigh * np.sin(knee), legs.shank + legs.thigh * cosine)
    ankle_pitch = leg_pitch - np.arctan2(x, np.sqrt(y * y + z * z))
    # Hip = foot * Rx(-roll) * Ry(-(ankle pitch + knee)), of which two columns suffice.
    cr, sr = np.cos(ankle_roll)[..., None], np.sin(ankle_roll)[..., None]
    pitch = ankle_pitch + knee
    cp, sp = np.cos(pitch)[..., None], np.sin(pitch)[..., None]
    first, second, third = rotation[..., :, 0], rotation[..., :, 1], rotation[..., :, 2]
    lateral = cr * second - sr * third
    upward = sr * second + cr * third
    hip_roll = np.arcsin(np.clip(lateral[..., 2], -1.0, 1.0))
    hip_yaw = np.arctan2(-lateral[..., 0], lateral[..., 1])
    forward_z = (cp * first + sp * upward)[..., 2]
    upward_z = (cp * upward - sp * first)[..., 2]
    hip_pitch = np.arctan2(-forward_z, upward_z)
    angles = np.stack([hip_yaw, hip_roll, hip_pitch, knee, ankle_pitch, ankle_roll], axis=-1)
    within = ((angles >= legs.lower) & (angles <= legs.upper)).all(axis=-1)
    return angles, in_reach & within


def mass_moment(
    legs: LegModel,
    frames: Float[np.ndarray, "*batch 6 3 3"],
    origins: Float[np.ndarray, "*batch 6 3"],
) -> Float[np.ndarray, "*batch 3"]:
    """Return the sum of mass times centre over the links, where frames and origins are [kg m]."""
    centres = (frames @ legs.link_com[:, :, None])[..., 0] + origins
    return (legs.link_mass[:, None] * centres).sum(axis=-2)
