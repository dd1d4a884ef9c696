"""What plans a walk of several controllers in turn."""

from collections.abc import Sequence

from jaxleas.controllers import Controller
from jaxleas.crossing.first_pair import first_pair
from jaxleas.crossing.walk_planner import costs_of
from jaxleas.crossing.walk_settings import WalkSettings
from jaxleas.footsteps import (
    FootstepPlanner,
    Goal,
    MotionModel,
    SwingChoice,
)
from jaxleas.physics import Body
from jaxleas.terrain import HeightMap
from jaxleas.types import InputError


class InTurn:
    """Makes planners that choose among controllers by the terrain ahead, one for each robot.

    Args:
        controllers: controllers of the robot.
        models: motion models of each.
        height_map: map that the robots have.
        goals: poses to reach, all on the map.
        settings: how commands are searched.
        body: robot.

    Raises:
        InputError: the controllers begin with different pairs of feet.
    """

    def __init__(
        self,
        controllers: Sequence[Controller],
        models: Sequence[MotionModel],
        height_map: HeightMap,
        goals: Sequence[Goal],
        settings: WalkSettings,
        body: Body,
    ) -> None:
        first = {each.identity.name: first_pair(body, each) for each in controllers}
        if len(set(first.values())) > 1:
            raise InputError(
                "the controllers cannot take turns: they begin with different pairs of feet,"
                f" {', '.join(f'{name} with number {pair}' for name, pair in first.items())}"
            )
        self._first = next(iter(first.values()))
        self._planners = [
            FootstepPlanner(model, costs_of(model, height_map, goals, settings), settings.search)
            for model in models
        ]

    def planner(self) -> SwingChoice:
        """Return a planner of one robot, which remembers whose turn it is."""
        return SwingChoice(self._planners, self._first)
