"""An exact planner as a question is put to it: its name, its settings, and a robot."""

from dataclasses import dataclass, field

from jaxleas.contacts import Planner, PlannerSettings, find_planner, require_settings


@dataclass(frozen=True)
class Oracle:
    """The planner that judges guide paths.

    Attributes:
        planner: name of a planner, or MODULE:CLASS of your own, which is imported when it is used.
        settings: settings of the planner; its defaults if None.
        robot: name of the robot.
    """

    planner: str
    settings: PlannerSettings | None = None
    robot: str = field(kw_only=True)

    def find(self) -> tuple[Planner, PlannerSettings]:
        """Return the planner and its settings, every one stated.

        Raises:
            InputError: there is no such planner or robot, or the settings are another planner's.
        """
        found = find_planner(self.planner, [self.planner])
        return found, require_settings(found, self.settings, self.robot)
