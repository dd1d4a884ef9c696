"""Legs in the world: left and right, their postures, boxes and masses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.box_collision import boxes_meet_ground
from jaxleas.contacts.sampling.ground import Ground
from jaxleas.geometry.boxes import Box
from jaxleas.robots.leg_kinematics import LegPosture, leg_angles, leg_com, leg_posture
from jaxleas.robots.legs import MIRRORED_JOINTS, LegModel

SIDES = np.array([1.0, -1.0])
"""Sign of y: left, right."""


@dataclass(frozen=True)
class Roots:
    """Upright root poses, one a row.

    Attributes:
        position: in the world [m].
        yaw: heading [rad].
    """

    position: Float[np.ndarray, "N 3"]
    yaw: Float[np.ndarray, " N"]

    def __getitem__(self, rows) -> "Roots":
        """Return some of the poses."""
        return Roots(self.position[rows], self.yaw[rows])

    def __len__(self) -> int:
        """Return the number of poses."""
        return len(self.yaw)


@dataclass(frozen=True)
class PlacedLegs:
    """Legs that reach for a foothold, one a row, mirrored to the left leg and in the root frame.

    Attributes:
        roots: of the robots.
        side: +1 left, -1 right.
        angles: of the joints, the left leg's convention [rad].
        reachable: whether the foothold is in reach within the joint limits.
        posture: where the parts are.
    """

    roots: Roots
    side: Float[np.ndarray, " N"]
    angles: Float[np.ndarray, "N 6"]
    reachable: Bool[np.ndarray, " N"]
    posture: LegPosture


def to_left_root(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Turn world vectors into the root's axes and mirror the right leg's."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y, z = vectors[:, 0], vectors[:, 1], vectors[:, 2]
    return np.stack([cosine * x + sine * y, side * (cosine * y - sine * x), z], axis=1)


def to_world(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Undo `to_left_root`."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    x, y, z = vectors[:, 0], side * vectors[:, 1], vectors[:, 2]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y, z], axis=1)


def rotations_to_world(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Turn left-leg rotations in the root frame into the world, mirroring the right leg's."""
    return _turned(_mirrored(rotations, side), yaw)


def rotations_to_left_root(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Undo `rotations_to_world`."""
    return _mirrored(_turned(rotations, -yaw), side)


def place_legs(
    legs: LegModel,
    roots: Roots,
    limb: Int[np.ndarray, " N"],
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
) -> PlacedLegs:
    """Let legs reach for soles given in the world.

    Args:
        legs: the model.
        roots: one a leg.
        limb: 0 left, 1 right.
        sole: where the soles shall be [m].
        rotation: of the feet.
    """
    side = SIDES[limb]
    local = to_left_root(sole - roots.position, roots.yaw, side)
    angles, reachable = leg_angles(legs, local, rotations_to_left_root(rotation, roots.yaw, side))
    return PlacedLegs(roots, side, angles, reachable, leg_posture(legs, angles))


def joint_angles(placed: PlacedLegs) -> Float[np.ndarray, "N 6"]:
    """Return the angles as the robot's own joints count them [rad]."""
    return np.where(placed.side[:, None] > 0.0, placed.angles, placed.angles * MIRRORED_JOINTS)


def legs_collide(
    legs: LegModel,
    placed: PlacedLegs,
    rows: Int[np.ndarray, " M"],
    ground: Ground,
    *,
    feet: bool,
) -> Bool[np.ndarray, " M"]:
    """Tell which of some legs touch the scene.

    Args:
        legs: the model.
        placed: all legs.
        rows: those to be judged.
        ground: the scene.
        feet: whether feet count; one that keeps its contact has been judged before.
    """
    posture = placed.posture
    parts: list[tuple[np.ndarray, np.ndarray, Box]] = [
        (posture.hip_rotation, np.broadcast_to(legs.hip, posture.knee.shape), legs.thigh_box),
        (posture.knee_rotation, posture.knee, legs.shank_box),
    ]
    if feet:
        parts.append((posture.foot_rotation, posture.ankle, legs.foot_box))
    turns, middles, halves = [], [], []
    for rotation, origin, box in parts:
        low, high = np.asarray(box.low), np.asarray(box.high)
        turns.append(rotation[rows])
        middles.append(origin[rows] + rotation[rows] @ (0.5 * (low + high)))
        halves.append(np.broadcast_to(0.5 * (high - low), (len(rows), 3)))
    count = len(parts)
    yaw, side = np.tile(placed.roots.yaw[rows], count), np.tile(placed.side[rows], count)
    position = np.tile(placed.roots.position[rows], (count, 1))
    hits = boxes_meet_ground(
        to_world(np.concatenate(middles), yaw, side) + position,
        rotations_to_world(np.concatenate(turns), yaw, side),
        np.concatenate(halves),
        ground,
    )
    return hits.reshape(count, len(rows)).any(axis=0)


def mass_moments(legs: LegModel, placed: PlacedLegs) -> Float[np.ndarray, "N 3"]:
    """Return each leg's mass times position in the world [kg m]."""
    moment = leg_com(legs, placed.posture, placed.angles)
    mass = float(legs.link_mass.sum())
    return to_world(moment, placed.roots.yaw, placed.side) + mass * placed.roots.position


def body_moments(legs: LegModel, roots: Roots) -> Float[np.ndarray, "N 3"]:
    """Return mass times position of all that is not leg, in the world [kg m]."""
    com = np.broadcast_to(legs.body_com, roots.position.shape)
    ones = np.ones(len(roots))
    return legs.body_mass * (to_world(com, roots.yaw, ones) + roots.position)


def _mirrored(rotations: np.ndarray, side: np.ndarray) -> np.ndarray:
    signs = np.ones((len(side), 3, 3))
    signs[:, 0, 1] = signs[:, 1, 0] = signs[:, 1, 2] = signs[:, 2, 1] = side
    return rotations * signs


def _turned(rotations: np.ndarray, yaw: np.ndarray) -> np.ndarray:
    cosine, sine = np.cos(yaw)[:, None], np.sin(yaw)[:, None]
    first, second = rotations[:, 0], rotations[:, 1]
    return np.stack(
        [cosine * first - sine * second, sine * first + cosine * second, rotations[:, 2]], axis=1
    )
