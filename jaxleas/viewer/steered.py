"""A commander of a robot whose goal changes while it walks."""

import numpy as np

from jaxleas.crossing import Decision, PlanningCommander
from jaxleas.footsteps import Goal, Planner, WalkingState


class SteeredCommander:
    """Decides for a robot whose goal changes while it walks.

    Args:
        planner: planner on the robot's map.
        goal: first goal.
    """

    def __init__(self, planner: Planner, goal: Goal) -> None:
        self._planner = planner
        self.aim(goal)

    def aim(self, goal: Goal | None) -> None:
        """Walk to another goal; None to stand."""
        self._inner = None if goal is None else PlanningCommander(self._planner, [goal])

    def decide(self, state: WalkingState) -> Decision:
        """Return what the robot shall do."""
        if self._inner is None:
            return Decision("arrived", np.zeros(3), None, 0.0, 0)
        return self._inner.decide(state)
