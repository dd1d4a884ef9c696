"""Another run-up for a robot that gets no nearer: its feet then meet the edges ahead otherwise."""

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps import Goal, WalkingState, turned

NEARER, PATIENCE = 0.05, 10
"""Progress towards the goal [m] that is expected within a number of decisions [1]."""
RUN_UPS = (0.15, 0.60)
"""Lengths of run-ups [m]."""
NEAR_GOAL = 0.3
"""Distance from the goal within which none is taken [m]."""
REST_ANGLE = float(np.pi)
"""Difference of the heading that does not matter [rad]."""


class RunUp:
    """Sends a robot back that gets no nearer to its goal.

    Args:
        rng: source of the lengths of run-ups.
    """

    def __init__(self, rng: np.random.Generator) -> None:
        self._rng = rng
        self._nearest, self._waits = np.inf, 0
        self._back: Goal | None = None
        self._asked: Goal | None = None

    @property
    def is_taken(self) -> bool:
        """Whether the robot walks back now."""
        return self._back is not None

    def end(self) -> None:
        """Let the robot walk to its goal again."""
        self._back, self._nearest, self._waits = None, np.inf, 0

    def goal_for(self, state: WalkingState, goal: Goal) -> Goal:
        """Return the goal, or a place behind the robot."""
        if goal is not self._asked:
            self._asked = goal
            self.end()
        self._waits += 1
        apart = float(np.hypot(*(state.com[:2] - (goal.x, goal.y))))
        if self._back is None and apart < self._nearest - NEARER:
            self._nearest, self._waits = apart, 0
        if self._back is not None and self._waits > PATIENCE:
            self.end()
        elif self._back is None and self._waits > PATIENCE and apart > NEAR_GOAL:
            length = self._rng.uniform(*RUN_UPS)
            x, y = map(float, state.com[:2] + length * _away(state, goal))
            self._back = Goal(x, y, goal.yaw, 0.5 * RUN_UPS[0], REST_ANGLE)
            self._waits = 0
        return goal if self._back is None else self._back


def _away(state: WalkingState, goal: Goal) -> Float[np.ndarray, "2"]:
    """Return which way the robot backs off: behind it, or to the side if the goal is beside it."""
    yaw = np.asarray(state.yaw)
    forward, left = turned(np.array([goal.x, goal.y]) - state.com[:2], -yaw)
    beside = abs(left) > abs(forward)
    back = np.array([0.0, -np.sign(left)]) if beside else np.array([-1.0, 0.0])
    return turned(back, yaw)
