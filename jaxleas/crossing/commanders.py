"""Commanders of walking robots: one plans on a map, one walks blindly."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Literal, Protocol

import numpy as np
from jaxtyping import Float

from jaxleas.crossing.goals import Goals
from jaxleas.crossing.run_up import RunUp
from jaxleas.crossing.stop import Stop
from jaxleas.footsteps import FootstepPlan, Goal, Planner, WalkingState, turned, wrapped
from jaxleas.types import ControllerIdentity, InputError

Intent = Literal["go", "arrived", "no path"]
"""Whether the robot shall walk, has arrived, or must stand because no command is safe."""


@dataclass(frozen=True, eq=False)
class Decision:
    """What a robot shall do until its next contact.

    Attributes:
        intent: whether it shall walk, and if not, why.
        command: forward and sideways speed [m/s] and turning rate [rad/s].
        plan: plan whose first footstep is commanded; None without a planner.
        seconds: time that the decision took [s].
        goal: number of the goal that is walked to.
    """

    intent: Intent
    command: Float[np.ndarray, "3"]
    plan: FootstepPlan | None
    seconds: float
    goal: int


class Commander(Protocol):
    """Decides for one robot at each of its contacts."""

    def decide(self, state: WalkingState) -> Decision:
        """Return what the robot shall do.

        Args:
            state: measured state.
        """
        ...


class PlanningCommander:
    """Plans footsteps on a map at each contact, and commands the first velocity of the plan.

    A robot that gets no nearer to its goal takes another run-up: for a few footsteps its goal is a
    place behind it, at a drawn distance, so that its feet meet the edges ahead otherwise. After
    the command to stand, it gets no new plan until it rests.

    Args:
        planner: planner on the map that the robot has.
        goals: poses to reach in turn; only at the last one the robot must be slow enough to stop.
        seed: seed of the lengths of run-ups.
    """

    def __init__(self, planner: Planner, goals: Sequence[Goal], seed: int = 0) -> None:
        self._planner = planner
        self._goals = Goals(goals)
        self._run_up = RunUp(np.random.default_rng(seed))
        self._stop = Stop()
        self._plan: FootstepPlan | None = None

    def decide(self, state: WalkingState) -> Decision:
        """Return the first command of a plan from a measured state."""
        begin = perf_counter()
        goal = self._stop.aim_of(state, self._goals.for_state(state))
        if self._stop.is_taken and self._plan is not None:
            plan = self._plan
        else:
            plan = self._plan = self._planned(state, goal)
        intent: Intent = "go"
        if not plan.footsteps:
            intent = "arrived" if plan.status == "reached" else "no path"
        if intent == "arrived":
            self._stop.begin()
        return Decision(intent, plan.command, plan, perf_counter() - begin, self._goals.number)

    def _planned(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        plan = self._planner.plan(state, self._run_up.goal_for(state, goal))
        if not plan.footsteps and plan.status == "reached" and self._run_up.is_taken:
            self._run_up.end()
            plan = self._planner.plan(state, goal)
        return plan


class BlindCommander:
    """Commands a robot straight at its goals, whatever lies on the way.

    It goes towards the goal in a straight line, and turns to the heading that is wanted there.

    Args:
        controller: identity of the controller, whose largest speeds are kept.
        goals: poses to reach in turn.
        share: speed over the largest forward speed.

    Raises:
        InputError: the share is not above 0 and at most 1.
    """

    def __init__(
        self, controller: ControllerIdentity, goals: Sequence[Goal], share: float = 0.4
    ) -> None:
        if not 0.0 < share <= 1.0:
            raise InputError(
                f"a blind walk at {share:g} of the largest speed: give more than 0, and at most 1"
            )
        self._largest = np.array(controller.max_speeds)
        self._goals = Goals(goals)
        self._speed = share * self._largest[0]

    def decide(self, state: WalkingState) -> Decision:
        """Return the command that leads straight to the goal."""
        begin = perf_counter()
        goal = self._goals.for_state(state)
        away = turned(np.array([goal.x, goal.y]) - state.com[:2], np.asarray(-state.yaw))
        turn = float(wrapped(np.asarray(goal.yaw - state.yaw)))
        distance = float(np.hypot(*away))
        if replace(goal, speed=np.inf).is_met_by(state):
            nothing = np.zeros(3)
            return Decision("arrived", nothing, None, perf_counter() - begin, self._goals.number)
        speed = min(self._speed, APPROACH * distance)
        command = np.append(away / max(distance, 1e-9) * speed, TURNING * turn)
        command = np.clip(command, -self._largest, self._largest)
        return Decision("go", command, None, perf_counter() - begin, self._goals.number)


APPROACH, TURNING = 1.0, 1.0
"""Speed per distance left, and turning rate per angle left, of a robot without a map [1/s]."""
