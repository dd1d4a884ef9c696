"""How a crossing ended, as a sentence."""

import numpy as np

from jaxleas.crossing.outcomes import Crossing
from jaxleas.footsteps import Goal
from jaxleas.types import JaxleasError

CAUSES = {
    "tilted": "its trunk tilted",
    "low": "its trunk sank between its feet",
    "diverged": "the simulation failed: its numbers are no longer finite",
}
"""What a fall is seen by, in words."""


class NotReachedError(JaxleasError):
    """A walk that did not end at its goal: an answer, not a bad input.

    Attributes:
        exit_code: exit code of a command that ends so: what a shell reports for Ctrl-C if a person
            stopped it.
    """

    def __init__(self, crossing: Crossing, goal: Goal) -> None:
        self.exit_code = 130 if crossing.outcome == "interrupted" else 1
        super().__init__(in_words(crossing, goal))


def in_words(crossing: Crossing, goal: Goal) -> str:
    """Return how a crossing ended.

    Args:
        crossing: what became of a robot.
        goal: pose that it was to reach last.
    """
    x, y, _ = crossing.com
    apart = float(np.hypot(x - goal.x, y - goal.y))
    where = f"at ({x:.2f}, {y:.2f}) m, {apart:.2f} m from the goal, after {crossing.time:.1f} s"
    if crossing.outcome == "reached":
        return f"reached: it stands {where}"
    if crossing.outcome == "fell":
        return f"fell {where}: {CAUSES.get(crossing.cause, crossing.cause)}"
    if crossing.outcome == "no path" and crossing.last_plan is not None:
        return f"no path: it stands {where}; {crossing.last_plan.in_words()}"
    ends = {"time": "its time was over", "interrupted": "it was stopped"}
    return f"{ends.get(crossing.outcome, crossing.outcome)} {where}"
