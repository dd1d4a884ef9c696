"""A question for a steering method: from here, now, to there."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Query:
    """One start and goal.

    Attributes:
        position: of the root in the world [m]: x, y, z.
        yaw: heading [rad].
        velocity: in the world [m/s]: x, y, z.
        goal: in the world [m]: x, y.
    """

    position: tuple[float, float, float]
    yaw: float
    velocity: tuple[float, float, float]
    goal: tuple[float, float]
