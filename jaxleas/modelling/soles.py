"""Where the sole of a foot is, as the shapes of its link say."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.modelling.bodies import Shape
from jaxleas.modelling.tree import UrdfTree

_THICK = 0.006
"""Height above the lowest point of a foot within which it counts as sole [m]."""
_SNAPPED = 0.02
"""Angle within which a frame's axes are taken for the root's [rad]."""


@dataclass(frozen=True, eq=False)
class FootShape:
    """A foot as its shapes say.

    Attributes:
        lowest: lowest point along the axes that the foot was seen in [m].
        middle: middle of the part that touches, in the frame of the link [m].
        half_size: half length and half width of that part [m].
        guessed: whether all shapes are boxes of inertia.
    """

    lowest: float
    middle: Float[np.ndarray, " 3"]
    half_size: tuple[float, float]
    guessed: bool


def foot_shape(tree: UrdfTree, link: str, axes: Float[np.ndarray, "3 3"]) -> FootShape | None:
    """Return a foot as its shapes say; None where it has none.

    Args:
        tree: links of the robot.
        link: link of the foot, or a frame on it.
        axes: axes of the level sole in the frame of the link, as columns.
    """
    shapes, guessed = shapes_around(tree, link)
    if not shapes:
        return None
    points = np.concatenate([each.points for each in shapes]) @ axes
    radius = np.concatenate([np.full(len(each.points), each.radius) for each in shapes])
    bottoms = points[:, 2] - radius
    lowest = float(bottoms.min())
    touching = points[bottoms <= lowest + _THICK]
    low, high = touching[:, :2].min(axis=0), touching[:, :2].max(axis=0)
    middle = np.array([*(0.5 * (low + high)), lowest])
    half = 0.5 * (high - low)
    return FootShape(lowest, axes @ middle, (float(half[0]), float(half[1])), guessed)


def shapes_around(tree: UrdfTree, link: str) -> tuple[list[Shape], bool]:
    """Return all shapes that are fixed to a link, in its frame, and whether all are guessed."""
    carrier = tree.carrier(link)
    poses = tree.poses({}, carrier)
    back, found, guessed = poses[link].inverse(), [], True
    for name, pose in poses.items():
        if tree.carrier(name) != carrier:
            continue
        body = tree.bodies[name]
        guessed = guessed and (body.guessed or not body.shapes)
        moved = back @ pose
        found += [Shape(moved.transform(each.points), each.radius) for each in body.shapes]
    return found, guessed


def outlines_around(tree: UrdfTree, link: str) -> list[Shape]:
    """Return the shapes that show how large all that is fixed to a link is, in its frame."""
    carrier = tree.carrier(link)
    poses = tree.poses({}, carrier)
    back = poses[link].inverse()
    return [
        Shape((back @ pose).transform(each.points), each.radius)
        for name, pose in poses.items()
        if tree.carrier(name) == carrier
        for each in tree.bodies[name].outline
    ]


def snapped(rotation: Float[np.ndarray, "3 3"]) -> Float[np.ndarray, "3 3"] | None:
    """Return the rotation by right angles that a rotation almost is; None if it is not one."""
    near = np.round(rotation)
    turn = near.T @ rotation
    is_turn = np.array_equal(np.abs(near).sum(axis=0), np.ones(3)) and np.linalg.det(near) > 0.0
    cosine = 0.5 * (np.trace(turn) - 1.0)
    return near + 0.0 if is_turn and cosine > np.cos(_SNAPPED) else None
