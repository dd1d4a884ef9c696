"""Feelers: the margin of the task's own conditions with the root moved a little, or turned.

The grid of heights shows the terrain at points 9 to 17 cm apart, between which a post or the far
side of a gap is not seen. A feeler asks what the policy must know: would the robot be valid there?
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jax import Array
from jaxtyping import Float

from jaxleas.conditions import Condition, is_under_root, outline_points, trunk_bottoms
from jaxleas.geometry import rotate_by_yaw
from jaxleas.robots import Robot
from jaxleas.types import RootMotion

Feeler = tuple[float, float, float]
"""How far the root is moved ahead and to the left [m] and turned to the left [rad]."""

MOST_FELT = 0.4
"""Bound to which felt margins are clipped, +- [m]: about what the root can rise or sink."""
FELT_SPACING = 0.06
"""Largest distance of the points along the trunk's outline that a feeler reads [m]."""
FELT_UNDER_ROOT = 0.2
"""Largest distance of the points that a feeler reads under the root [m]: the square's corners."""


def points_to_feel(robot: Robot, move: Feeler) -> Float[np.ndarray, "P 2"]:
    """Return the points that a feeler reads, in the frame of the moved root [m].

    They are those of the moved trunk's outline that the trunk covers neither now nor halfway, where
    an obstacle would be met, and those under the moved root, where there must be ground.

    Args:
        robot: robot that feels.
        move: how the root is moved.
    """
    outline = outline_points(robot, FELT_SPACING)
    here, bottoms = in_root(outline, move), trunk_bottoms(robot, outline)
    ahead, left, turn = (0.5 * each for each in move)
    halfway = in_root(here - np.array([ahead, left]), (0.0, 0.0, -turn))
    uncovered = np.minimum(*(trunk_bottoms(robot, each) for each in (here, halfway))) > bottoms
    corners = outline_points(robot, FELT_UNDER_ROOT)
    return np.concatenate([outline[uncovered], corners[is_under_root(corners)]])


def in_root(points: Float[np.ndarray, "P 2"], move: Feeler) -> Float[np.ndarray, "P 2"]:
    """Return points of the moved root's frame in the frame of the root [m]."""
    ahead, left, turn = move
    cosine, sine = np.cos(turn), np.sin(turn)
    return points @ np.array([[cosine, sine], [-sine, cosine]]) + np.array([ahead, left])


@dataclass(frozen=True, eq=False, init=False)
class Feelers:
    """Feelers of a layout, and what each of them asks.

    Attributes:
        moves: how each feeler moves the root.
        conditions: condition whose margin each feeler returns, on points of its own.
        points_in_root: points that all feelers read in the root frame [m], feeler by feeler.
    """

    moves: tuple[Feeler, ...]
    conditions: tuple[Condition, ...]
    points_in_root: Float[np.ndarray, "points 2"]

    def __init__(
        self,
        robot: Robot,
        moves: Sequence[Feeler],
        make: Callable[[Float[np.ndarray, "P 2"]], Condition],
    ) -> None:
        """Prepare the feelers.

        Args:
            robot: robot that feels.
            moves: how each feeler moves the root.
            make: function that makes a condition of the points whose heights are sampled anyway.
        """
        conditions = tuple(make(points_to_feel(robot, move)) for move in moves)
        points = [
            in_root(np.asarray(each.points_in_root, np.float64), move)
            for each, move in zip(conditions, moves, strict=True)
        ]
        vars(self).update(
            moves=tuple(moves), conditions=conditions, points_in_root=np.concatenate(points)
        )

    def __call__(
        self, heights_in_root: Float[Array, "*batch points"], motion: RootMotion
    ) -> Float[Array, "*batch feelers"]:
        """Return the felt margins [m], clipped to +- `MOST_FELT`.

        Args:
            heights_in_root: height of the terrain under each of `points_in_root` minus the
                root's z [m].
            motion: root motion, before it is moved.
        """
        felt, first = [], 0
        for move, condition in zip(self.moves, self.conditions, strict=True):
            last = first + len(condition.points_in_root)
            felt.append(condition(heights_in_root[..., first:last], _moved(motion, move)))
            first = last
        return jnp.clip(jnp.stack(felt, axis=-1), -MOST_FELT, MOST_FELT)


def _moved(motion: RootMotion, move: Feeler) -> RootMotion:
    ahead, left, turn = move
    aside = jnp.broadcast_to(
        jnp.array([ahead, left, 0.0], jnp.float32).reshape((1,) * motion.yaw.ndim + (3,)),
        motion.position.shape,
    )
    return RootMotion(
        position=motion.position + rotate_by_yaw(aside, motion.yaw),
        velocity=motion.velocity,
        yaw=motion.yaw + turn,
    )
