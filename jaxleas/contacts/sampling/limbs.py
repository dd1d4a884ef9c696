"""Legs in the world: left and right, their postures, boxes and masses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.box_collision import Places, boxes_meet_ground
from jaxleas.contacts.sampling.ground import Ground
from jaxleas.robots.legs import LegModel, leg_angles, leg_posture

SIDES = np.array([1.0, -1.0])
"""Sign of y of each leg: left, right. This planner moves two legs that are mirror images."""


def other_leg(limb: Int[np.ndarray, "*batch"]) -> Int[np.ndarray, "*batch"]:
    """Return the index of the leg that stands while one moves."""
    return len(SIDES) - 1 - limb


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


@dataclass(frozen=True)
class PlacedLegs:
    """Legs that reach for a foothold, one per row, in the world.

    Attributes:
        roots: root poses, one per leg.
        side: +1 left, -1 right.
        angles: joint angles, in the left leg's convention [rad].
        reachable: whether the foothold is in reach within the joint limits.
        frames: frames of the links; for a right leg mirror images, whose second axis is reversed.
        origins: origins of the joints [m].
        sole: position of the sole's origin [m].
    """

    roots: Roots
    side: Float[np.ndarray, " N"]
    angles: Float[np.ndarray, "N J"]
    reachable: Bool[np.ndarray, " N"]
    frames: Float[np.ndarray, "N J 3 3"]
    origins: Float[np.ndarray, "N J 3"]
    sole: Float[np.ndarray, "N 3"]

    def __getitem__(self, rows) -> "PlacedLegs":
        """Return some of the legs."""
        return PlacedLegs(
            self.roots[rows],
            self.side[rows],
            self.angles[rows],
            self.reachable[rows],
            self.frames[rows],
            self.origins[rows],
            self.sole[rows],
        )


def to_left_root(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Turn world vectors into the root's axes and mirror the right leg's."""
    return (vectors[:, None] @ _left_root_frames(yaw, side))[:, 0]


def to_world(
    vectors: Float[np.ndarray, "N 3"], yaw: Float[np.ndarray, " N"], side: Float[np.ndarray, " N"]
) -> Float[np.ndarray, "N 3"]:
    """Undo `to_left_root`."""
    return (_left_root_frames(yaw, side) @ vectors[:, :, None])[:, :, 0]


def rotations_to_world(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Turn left-leg rotations in the root frame into the world, mirroring the right leg's."""
    turned = _left_root_frames(yaw, side) @ rotations
    turned[:, :, 1] *= side[:, None]
    return turned


def rotations_to_left_root(
    rotations: Float[np.ndarray, "N 3 3"],
    yaw: Float[np.ndarray, " N"],
    side: Float[np.ndarray, " N"],
) -> Float[np.ndarray, "N 3 3"]:
    """Undo `rotations_to_world`."""
    turned = _left_root_frames(yaw, side).transpose(0, 2, 1) @ rotations
    turned[:, :, 1] *= side[:, None]
    return turned


def place_legs(
    legs: LegModel,
    roots: Roots,
    limb: Int[np.ndarray, " N"],
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
) -> PlacedLegs:
    """Make legs reach for soles given in the world.

    Args:
        legs: model of the legs.
        roots: root poses, one per leg.
        limb: index of each limb: 0 left, 1 right.
        sole: desired positions of the soles [m].
        rotation: desired rotations of the feet.
    """
    side = SIDES[limb]
    local = to_left_root(sole - roots.position, roots.yaw, side)
    angles, reachable = leg_angles(legs, local, rotations_to_left_root(rotation, roots.yaw, side))
    posture = leg_posture(legs, angles)
    turn = _left_root_frames(roots.yaw, side)[:, None]
    return PlacedLegs(
        roots,
        side,
        angles,
        reachable,
        turn @ posture.frames,
        posture.origins @ turn[:, 0].transpose(0, 2, 1) + roots.position[:, None],
        sole,
    )


def joint_angles(placed: PlacedLegs, legs: LegModel) -> Float[np.ndarray, "N J"]:
    """Return the angles in the convention of the robot's own joints [rad]."""
    return np.where(placed.side[:, None] > 0.0, placed.angles, placed.angles * legs.mirror_signs)


def legs_collide(
    legs: LegModel,
    placed: PlacedLegs,
    rows: Int[np.ndarray, " M"],
    ground: Ground,
    *,
    feet: bool,
) -> Bool[np.ndarray, " M"]:
    """Return which of some legs touch the scene.

    Args:
        legs: model of the legs.
        placed: all legs.
        rows: indices of the legs to judge.
        ground: polygons of the scene.
        feet: whether feet count; a foot that keeps its contact has been judged before.
    """
    last = legs.joints - 1
    shapes = [each for each in legs.left.boxes if feet or each.link != last]
    count = len(shapes)
    if not count:
        return np.zeros(len(rows), dtype=bool)
    boxes, links = [each.box for each in shapes], np.array([each.link for each in shapes])
    middle = np.array([0.5 * (np.add(box.low, box.high)) for box in boxes])
    half = np.array([0.5 * (np.subtract(box.high, box.low)) for box in boxes])
    # A box looks the same in a mirrored frame: its axes need not be right-handed.
    frames = placed.frames[rows[:, None], links]
    centres = (frames @ middle[:, :, None])[..., 0] + placed.origins[rows[:, None], links]
    hits = boxes_meet_ground(
        centres.reshape(-1, 3),
        frames.reshape(-1, 3, 3),
        np.broadcast_to(half, centres.shape).reshape(-1, 3),
        ground,
        Places.of(placed.roots.position[rows], placed.roots.scene[rows], count),
    )
    return np.any(hits.reshape(len(rows), count), axis=1)


def body_moments(legs: LegModel, roots: Roots) -> Float[np.ndarray, "N 3"]:
    """Return mass times position of everything that is not leg, in the world [kg m]."""
    com = np.broadcast_to(legs.body.com, roots.position.shape)
    ones = np.ones(len(roots))
    return legs.body.mass * (to_world(com, roots.yaw, ones) + roots.position)


def _left_root_frames(yaw: np.ndarray, side: np.ndarray) -> Float[np.ndarray, "N 3 3"]:
    """Return the matrices of `to_world`."""
    frames = np.zeros((len(yaw), 3, 3))
    cosine, sine = np.cos(yaw), np.sin(yaw)
    frames[:, 0, 0], frames[:, 0, 1] = cosine, -sine * side
    frames[:, 1, 0], frames[:, 1, 1] = sine, cosine * side
    frames[:, 2, 2] = 1.0
    return frames
