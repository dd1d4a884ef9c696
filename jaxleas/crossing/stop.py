"""Stopping at a goal: after the command to stand a robot drifts on, which its aim allows for."""

from dataclasses import replace

import numpy as np

from jaxleas.footsteps import Goal, WalkingState, wrapped

RESTS = 0.05
"""Speed of the centre of mass below which a robot counts as standing [m/s]."""
MOST = np.array([0.10, 0.10, 0.2])
"""Most that is allowed for, along each axis [m] and of the heading [rad]."""


class Stop:
    """Lets a robot come to rest after the command to stand; aims anew where it missed its goal.

    After the command to stand a controller makes some more footsteps, of which motion models know
    nothing. Planning at each of them would send the robot back and forth around its goal.

    Attributes:
        is_taken: whether the robot is stopping, or stands at its goal.
    """

    def __init__(self) -> None:
        self.is_taken = False
        self._beside = np.zeros(3)
        self._asked: Goal | None = None
        self._aim: Goal | None = None

    def begin(self) -> None:
        """Let the robot stop."""
        self.is_taken = True

    def aim_of(self, state: WalkingState, goal: Goal) -> Goal:
        """Return the pose to plan to, so that the robot comes to rest at its goal.

        Args:
            state: measured state.
            goal: pose to come to rest at.
        """
        if self._asked is not goal or self._aim is None:
            self.is_taken, self._beside = False, np.zeros(3)
            self._asked = self._aim = goal
        rests = not state.command.any() and np.hypot(*state.com_velocity[:2]) < RESTS
        if self.is_taken and rests and not goal.is_met_by(state):
            self.is_taken = False
            turned_away = wrapped(np.asarray(state.yaw - goal.yaw))
            missed = np.append(state.com[:2] - (goal.x, goal.y), turned_away)
            self._beside = np.clip(self._beside + missed, -MOST, MOST)
            x, y, yaw = np.array([goal.x, goal.y, goal.yaw]) - self._beside
            self._aim = replace(goal, x=float(x), y=float(y), yaw=float(yaw))
        return self._aim
