"""Predictors and labels of motion models, in the robot's frame: where it is, and how it is turned,
changes nothing.

The robot's frame has its origin under the centre of mass and its x axis along the heading, both at
the beginning of a footstep (Taouil's thesis, section 4.1.3). Its velocity after the footstep is in
the frame at the end, since that is where the next footstep takes it from.
"""

from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.records import Footsteps

Predictors = Literal["C1", "C2", "C3", "C4"]
"""What a model sees (thesis, section 5.1): C1 the command and the most significant coordinates of
feet; C2 all of them; C3 the previous command, too; C4 the velocity of the centre of mass, too."""
CHOICES: tuple[Predictors, ...] = ("C1", "C2", "C3", "C4")
COM = ("com x", "com y", "com yaw")
VELOCITY = ("velocity x", "velocity y", "velocity z", "yaw rate")


def predictors_of(footsteps: Footsteps) -> Float[np.ndarray, "N P"]:
    """Return all predictors of footsteps.

    Returns:
        The command (3), x and y of each foot (2 E) [m], the previous command (3), the velocity of
        the centre of mass (3) [m/s] and the turning rate [rad/s], in this order.
    """
    yaw = footsteps.yaw_before
    return np.column_stack(
        [
            footsteps.command,
            local_feet(footsteps).reshape(len(footsteps), -1),
            footsteps.previous_command,
            turned(footsteps.com_velocity_before, -yaw),
            footsteps.yaw_rate_before,
        ]
    )


def local_feet(footsteps: Footsteps) -> Float[np.ndarray, "N E 2"]:
    """Return x and y of the feet in the robot's frame at the beginning of each footstep [m]."""
    offset = footsteps.feet_before - footsteps.com_before[:, None]
    return turned(offset, -footsteps.yaw_before[:, None])[..., :2]


def com_labels(footsteps: Footsteps) -> Float[np.ndarray, "N 3"]:
    """Return how far the centre of mass moves in each footstep: x, y [m] and yaw [rad]."""
    moved = turned(footsteps.com_after - footsteps.com_before, -footsteps.yaw_before)
    return np.column_stack([moved[:, :2], wrapped(footsteps.yaw_after - footsteps.yaw_before)])


def velocity_labels(footsteps: Footsteps) -> Float[np.ndarray, "N 4"]:
    """Return velocity [m/s] and yaw rate [rad/s] after each footstep, in the frame there."""
    velocity = turned(footsteps.com_velocity_after, -footsteps.yaw_after)
    return np.column_stack([velocity, footsteps.yaw_rate_after])


def absolute_feet(footsteps: Footsteps) -> Float[np.ndarray, "N E 2"]:
    """Return how far each foot moves over the ground, in the frame at the beginning [m]."""
    moved = footsteps.feet_after - footsteps.feet_before
    return turned(moved, -footsteps.yaw_before[:, None])[..., :2]


def relative_feet(footsteps: Footsteps) -> Float[np.ndarray, "N E 2"]:
    """Return where each foot is at the end, in the frame of the robot there [m]."""
    offset = footsteps.feet_after - footsteps.com_after[:, None]
    return turned(offset, -footsteps.yaw_after[:, None])[..., :2]


def columns_for(choice: Predictors, target: str, swinging: tuple[int, ...], feet: int) -> list[int]:
    """Return the indices of the predictors that a model sees.

    Args:
        choice: choice of predictors.
        target: what the model predicts: one of `COM`, or anything else for a foot or a velocity.
        swinging: indices of the swinging feet.
        feet: number of feet of the robot.
    """
    command, end = [0, 1, 2], 3 + 2 * feet
    if choice == "C1":
        if target in COM:
            axis = 0 if target == "com x" else 1
            return command + [3 + 2 * foot + axis for foot in range(feet)]
        return command + [3 + 2 * foot + axis for foot in swinging for axis in (0, 1)]
    more = {"C2": 0, "C3": 3, "C4": 7}[choice]
    return list(range(end + more))


def turned(
    vectors: Float[np.ndarray, "*batch K"], angle: Float[np.ndarray, "*batch"]
) -> Float[np.ndarray, "*batch K"]:
    """Return vectors turned counter-clockwise about the vertical; K is 2 or 3.

    Args:
        vectors: x, y, and z if K is 3.
        angle: angle [rad], broadcast over the batch.
    """
    cos, sin = np.cos(angle), np.sin(angle)
    x, y = vectors[..., 0], vectors[..., 1]
    plane = [cos * x - sin * y, sin * x + cos * y]
    return np.stack([*plane, *np.moveaxis(vectors[..., 2:], -1, 0)], axis=-1)


def wrapped(angle: Float[np.ndarray, "*batch"]) -> Float[np.ndarray, "*batch"]:
    """Return angles [rad] brought into [-pi, pi)."""
    return (angle + np.pi) % (2 * np.pi) - np.pi
