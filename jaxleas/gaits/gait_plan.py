"""Plans of support phases."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.envs.gait_planning import (
    GaitPlanningConfig,
    Phases,
    QuadrupedConfig,
)
from jaxleas.gaits.gait import Ending, Gait

Pair = tuple[float, float]
WORDS: dict[Ending, str] = {
    "reached": "the goal is reached",
    "budget": "the goal is not reached: the plan would be too long",
    "no move": "the goal is not reached: no further move was found",
    "refused": "the goal is not reached: the policy's next transition is refused",
}


@dataclass(frozen=True)
class Program:
    """How the transitions of a plan are decided; see `GaitPlanningConfig`."""

    instants: int
    least_margin: float
    foot_clearance: float
    edge_rise: float


@dataclass(frozen=True, eq=False)
class GaitPlan:
    """A plan of support phases.

    Attributes:
        planner: who proposed it: `search`, or the file of a policy.
        ending: how planning ended.
        goal: x and y of the goal [m].
        robot: robot that it is for.
        program: how its transitions are decided.
        phases: phases at their beginnings [K + 1].
        times: t_E* and t_S of each transition [s].
    """

    planner: str
    ending: Ending
    goal: Pair
    robot: QuadrupedConfig
    program: Program
    phases: Phases
    times: Float[np.ndarray, "K 2"]

    @property
    def length(self) -> int:
        """Number of transitions."""
        return len(self.times)

    def in_words(self) -> str:
        """Return the result as a sentence."""
        seconds = float(self.times.sum())
        return f"{WORDS[self.ending]}; {self.length} transitions in {seconds:.1f} s"


def plan_of(config: GaitPlanningConfig, gait: Gait, planner: str) -> GaitPlan:
    """Return the plan that a way is.

    Args:
        config: configuration of the task.
        gait: way of one robot.
        planner: who proposed it.
    """
    program = Program(config.instants, config.least_margin, config.foot_clearance, config.edge_rise)
    x, y = (float(each) for each in gait.states.goal[0])
    phases, times = gait.states.phase, gait.commands.times
    return GaitPlan(planner, gait.ending, (x, y), config.robot, program, phases, times)
