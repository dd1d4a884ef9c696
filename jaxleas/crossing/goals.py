"""Goals that a robot walks to in turn."""

from collections.abc import Sequence

from jaxleas.footsteps import Goal, WalkingState


class Goals:
    """Goals that are walked to in turn.

    Args:
        goals: poses to reach in turn.

    Attributes:
        number: index of the one that is walked to.
    """

    def __init__(self, goals: Sequence[Goal]) -> None:
        self._goals = list(goals)
        self.number = 0

    def for_state(self, state: WalkingState) -> Goal:
        """Return the goal to walk to, the next one where that before is reached."""
        while self.number < len(self._goals) - 1 and self._goals[self.number].is_met_by(state):
            self.number += 1
        return self._goals[self.number]
