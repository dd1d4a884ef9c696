"""Queries for a steering method: a start and a goal."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Query:
    """One start and goal.

    Attributes:
        position: position of the root in the world [m]: x, y, z.
        yaw: heading [rad].
        velocity: velocity of the root in the world [m/s]: x, y, z.
        goal: goal in the world [m]: x, y.
    """

    position: tuple[float, float, float]
    yaw: float
    velocity: tuple[float, float, float]
    goal: tuple[float, float]
