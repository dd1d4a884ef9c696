"""Settings that every contact planner has when it judges guide paths."""

from typing import Self

from pydantic import PositiveInt

from jaxleas.configuration import Strict


class PlannerSettings(Strict):
    """Base of a planner's settings: part of the provenance of every label."""

    keep_every: PositiveInt = 5
    """number N: the planner is asked about every N-th configuration of a guide path"""

    def for_robot(self, robot: str) -> Self:
        """Return the settings with everything stated that depends on the robot by default.

        Provenance records these, so that a change of defaults never mixes labels.

        Args:
            robot: name of the robot.

        Raises:
            InputError: there is no such robot.
        """
        del robot
        return self

    def note_for(self, robot: str) -> str:
        """Return a line on what `for_robot` states and not everybody expects; empty for nothing.

        Args:
            robot: name of the robot.

        Raises:
            InputError: there is no such robot.
        """
        del robot
        return ""
