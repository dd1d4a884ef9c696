"""Legs that reach for footholds in the world, their masses, and whether they touch the scene."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from jaxleas.contacts.sampling.box_collision import Places, boxes_meet_ground
from jaxleas.contacts.sampling.ground import Ground
from jaxleas.contacts.sampling.roots import (
    Roots,
    model_axes,
    rotations_to_model,
    to_model,
    to_world,
)
from jaxleas.robots import ALL_DIRECTIONS, Legs, LimbModel


@dataclass(frozen=True)
class PlacedLegs:
    """Legs that reach for a foothold, one per row, in the world.

    Attributes:
        roots: root poses, one per leg.
        limb: index of each leg.
        reachable: whether the foothold is in reach within the joint limits.
        frames: frames of the links; for mirror images of a model, frames whose second axis is
            reversed; zero after a leg's last link.
        origins: origins of the joints [m].
    """

    roots: Roots
    limb: Int[np.ndarray, " N"]
    reachable: Bool[np.ndarray, " N"]
    frames: Float[np.ndarray, "N J 3 3"]
    origins: Float[np.ndarray, "N J 3"]

    def __getitem__(self, rows) -> "PlacedLegs":
        """Return some of the legs."""
        return PlacedLegs(
            self.roots[rows],
            self.limb[rows],
            self.reachable[rows],
            self.frames[rows],
            self.origins[rows],
        )

    def __len__(self) -> int:
        """Return the number of legs."""
        return len(self.limb)


def place_legs(
    legs: Legs,
    roots: Roots,
    limb: Int[np.ndarray, " N"],
    sole: Float[np.ndarray, "N 3"],
    rotation: Float[np.ndarray, "N 3 3"],
) -> PlacedLegs:
    """Make legs reach for soles given in the world.

    Args:
        legs: legs of the robot.
        roots: root poses, one per leg.
        limb: index of each leg.
        sole: desired positions of the soles [m].
        rotation: desired rotations of the feet.
    """
    side = legs.side[limb]
    local = to_model(sole - roots.position, roots.yaw, side)
    turned = rotations_to_model(rotation, roots.yaw, side)
    axes = model_axes(roots.yaw, side)[:, None]
    if len(legs.models) == 1:
        found = _reach(legs.models[0], local, turned, axes)
    else:
        count, joints = len(limb), legs.most_joints
        found = (
            np.zeros(count, dtype=bool),
            np.zeros((count, joints, 3, 3)),
            np.zeros((count, joints, 3)),
        )
        for number, rows in legs.by_model(limb):
            reachable, frames, origins = _reach(
                legs.models[number], local[rows], turned[rows], axes[rows]
            )
            found[0][rows] = reachable
            found[1][rows, : frames.shape[1]], found[2][rows, : frames.shape[1]] = frames, origins
    reachable, frames, origins = found
    return PlacedLegs(roots, limb, reachable, frames, origins + roots.position[:, None])


def _reach(
    model: LimbModel, sole: np.ndarray, rotation: np.ndarray, axes: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return whether legs of one model reach, and their frames and origins along the world."""
    angles, reachable = model.inverse(sole, rotation)
    posture = model.posture(angles)
    return reachable, axes @ posture.frames, posture.origins @ axes[:, 0].transpose(0, 2, 1)


def mass_moments(legs: Legs, placed: PlacedLegs) -> Float[np.ndarray, "N 3"]:
    """Return the sum of mass times centre over each leg's links, in the world [kg m]."""
    moments = np.empty((len(placed), 3))
    for number, rows in legs.by_model(placed.limb):
        model = legs.models[number]
        joints = len(model.chain)
        moments[rows] = model.mass_moment(
            placed.frames[rows, :joints], placed.origins[rows, :joints]
        )
    return moments


def body_moments(legs: Legs, roots: Roots) -> Float[np.ndarray, "N 3"]:
    """Return mass times position of everything that is not leg, in the world [kg m]."""
    com = np.broadcast_to(legs.body.com, roots.position.shape)
    ones = np.ones(len(roots))
    return legs.body.mass * (to_world(com, roots.yaw, ones) + roots.position)


def legs_collide(
    legs: Legs,
    placed: PlacedLegs,
    rows: Int[np.ndarray, " M"],
    ground: Ground,
    *,
    feet: bool,
) -> Bool[np.ndarray, " M"]:
    """Return which of some legs touch the scene.

    Args:
        legs: legs of the robot.
        placed: all legs.
        rows: indices of the legs to judge.
        ground: polygons of the scene.
        feet: whether feet count; a foot that keeps its contact has been judged before.
    """
    hit = np.zeros(len(rows), dtype=bool)
    for number, some in legs.by_model(placed.limb[rows]):
        hit[some] = _collide(legs.models[number], placed, rows[some], ground, feet)
    return hit


def _collide(
    model: LimbModel, placed: PlacedLegs, rows: np.ndarray, ground: Ground, feet: bool
) -> Bool[np.ndarray, " M"]:
    """Return which of some legs of one model touch the scene."""
    last = len(model.chain) - 1
    # The last link of a leg of few joints turns about its contact as the root moves on.
    every = feet or len(model.chain) < ALL_DIRECTIONS
    shapes = [each for each in model.boxes if every or each.link != last]
    count = len(shapes)
    if not count or not len(rows):
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
