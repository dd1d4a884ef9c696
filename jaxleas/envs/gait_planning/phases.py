"""Support phases of many robots, and the state of their episodes, in NumPy arrays."""

import numpy as np
from flax import struct
from jaxtyping import Float, Float32, Int32

from jaxleas.envs.gait_planning.supports import in_contact


@struct.dataclass
class Phases:
    """A support phase of each robot (D sec. II-B).

    Attributes:
        com: centre of mass at the beginning of the phase [m].
        yaw: heading [rad].
        velocity: horizontal velocity of the centre of mass [m/s].
        feet: feet in the world [m]; those in contact are footholds.
        support: number of the support, an index of `STANDING`.
    """

    com: Float32[np.ndarray, "N 3"]
    yaw: Float32[np.ndarray, " N"]
    velocity: Float32[np.ndarray, "N 2"]
    feet: Float32[np.ndarray, "N 4 3"]
    support: Int32[np.ndarray, " N"]


@struct.dataclass
class PlanningState:
    """State of each episode.

    Attributes:
        phase: present support phase.
        field: index of the field that the robot is on.
        goal: goal [m].
        grounded: number of consecutive phases in which each foot has been in contact.
        step: number of phases since the episode began.
    """

    phase: Phases
    field: Int32[np.ndarray, " N"]
    goal: Float32[np.ndarray, "N 2"]
    grounded: Int32[np.ndarray, "N 4"]
    step: Int32[np.ndarray, " N"]


def rotate(yaw: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return horizontal vectors [N, ..., 2] turned by a yaw [N] [rad]."""
    shape = (len(yaw), *(1,) * (vectors.ndim - 2))
    cosine, sine = np.cos(yaw).reshape(shape), np.sin(yaw).reshape(shape)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def lowest_foothold(feet: np.ndarray, support: np.ndarray) -> np.ndarray:
    """Return the height of the lowest foot in contact [N] [m]."""
    return np.where(in_contact(support), feet[..., 2], np.inf).min(axis=-1)


def bearing(phase: Phases, goal: np.ndarray) -> np.ndarray:
    """Return the angle of the goal from the heading, counted to the left [N] [rad]."""
    ahead = rotate(-phase.yaw, goal - phase.com[:, :2])
    return np.arctan2(ahead[:, 1], ahead[:, 0])


def base_distance(phase: Phases, goal: np.ndarray) -> Float[np.ndarray, " N"]:
    """Return the distance of the base from the goal [m]."""
    return np.linalg.norm(phase.com[:, :2] - goal, axis=1)


def feet_distance(phase: Phases, goal: np.ndarray) -> Float[np.ndarray, " N"]:
    """Return the distance of the mean of all four feet from the goal [m].

    Swinging feet count where they are planned: the mean over feet in contact jumps by centimetres
    where one is lifted.
    """
    return np.linalg.norm(phase.feet[..., :2].mean(axis=1) - goal, axis=1)
