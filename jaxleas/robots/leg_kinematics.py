"""Forward and inverse kinematics of the left leg in closed form, for many postures at once.

For the right leg mirror what goes in and what comes out: positions by (1, -1, 1), rotations by
that on both sides, angles by `MIRRORED_JOINTS`.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.robots.legs import LegModel


@dataclass(frozen=True)
class LegPosture:
    """Where the parts of the left leg are, in the root frame.

    Attributes:
        hip_rotation: of the thigh.
        knee: position [m].
        knee_rotation: of the shank.
        ankle: position [m].
        foot_rotation: of foot and sole; its third column is the sole's normal.
        sole: position of the sole's origin [m].
    """

    hip_rotation: Float[np.ndarray, "*batch 3 3"]
    knee: Float[np.ndarray, "*batch 3"]
    knee_rotation: Float[np.ndarray, "*batch 3 3"]
    ankle: Float[np.ndarray, "*batch 3"]
    foot_rotation: Float[np.ndarray, "*batch 3 3"]
    sole: Float[np.ndarray, "*batch 3"]


def leg_posture(legs: LegModel, angles: Float[np.ndarray, "*batch 6"]) -> LegPosture:
    """Place the left leg's parts in the root frame.

    Args:
        legs: the model.
        angles: of the six joints [rad].
    """
    hip_rotation = turn_z(angles[..., 0]) @ turn_x(angles[..., 1]) @ turn_y(angles[..., 2])
    knee = legs.hip - legs.thigh * hip_rotation[..., :, 2]
    knee_rotation = hip_rotation @ turn_y(angles[..., 3])
    ankle = knee - legs.shank * knee_rotation[..., :, 2]
    foot_rotation = knee_rotation @ turn_y(angles[..., 4]) @ turn_x(angles[..., 5])
    sole = ankle - legs.sole * foot_rotation[..., :, 2]
    return LegPosture(hip_rotation, knee, knee_rotation, ankle, foot_rotation, sole)


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


def leg_com(legs: LegModel, posture: LegPosture, angles: Float[np.ndarray, "*batch 6"]):
    """Return the left leg's first mass moment in the root frame: sum of mass times position [kg m].

    Args:
        legs: the model.
        posture: of the leg.
        angles: that it was made from [rad].
    """
    yaw = turn_z(angles[..., 0])
    roll = yaw @ turn_x(angles[..., 1])
    ankle_rotation = posture.knee_rotation @ turn_y(angles[..., 4])
    frames = (
        (yaw, legs.hip),
        (roll, legs.hip),
        (posture.hip_rotation, legs.hip),
        (posture.knee_rotation, posture.knee),
        (ankle_rotation, posture.ankle),
        (posture.foot_rotation, posture.ankle),
    )
    moment = 0.0
    for (rotation, origin), mass, com in zip(frames, legs.link_mass, legs.link_com, strict=True):
        moment = moment + mass * (rotation @ com + origin)
    return moment


def turn_x(angle: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch 3 3"]:
    """Return rotations about x."""
    return _turn(angle, 1, 2)


def turn_y(angle: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch 3 3"]:
    """Return rotations about y."""
    return _turn(angle, 2, 0)


def turn_z(angle: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch 3 3"]:
    """Return rotations about z."""
    return _turn(angle, 0, 1)


def _turn(angle: np.ndarray, first: int, second: int) -> np.ndarray:
    rotation = np.zeros((*np.shape(angle), 3, 3))
    cosine, sine = np.cos(angle), np.sin(angle)
    rotation[..., 3 - first - second, 3 - first - second] = 1.0
    rotation[..., first, first] = rotation[..., second, second] = cosine
    rotation[..., second, first] = sine
    rotation[..., first, second] = -sine
    return rotation
