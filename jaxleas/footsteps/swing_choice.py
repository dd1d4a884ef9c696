"""The swing height chosen by the terrain ahead, where several controllers are at hand.

An outlook of Taouil's thesis (chapter 6): high swings where they are required, and only there.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from jaxleas.footsteps.plan import FootstepPlan
from jaxleas.footsteps.walking_state import Goal, WalkingState
from jaxleas.types import ControllerIdentity

AHEAD = 4
"""Footsteps of a plan within which a step that is too high for a controller counts."""
RESTS = 0.05
"""Horizontal speed below which a robot that is told to stand rests [m/s]."""


class ControllerPlanner(Protocol):
    """Plans the footsteps of one controller on one map, as `FootstepPlanner` does."""

    @property
    def controller(self) -> ControllerIdentity:
        """Controller whose footsteps are planned."""
        ...

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the footsteps from a measured state towards a goal."""
        ...


class SwingChoice:
    """Plans with the controller of the lowest swing that clears the steps ahead.

    Where the lowest one finds footsteps and refuses none as too high, it walks. Else the plan of
    the highest says how high the next steps are, and the lowest whose swing is as high walks, if
    it finds a plan. Another controller takes over only where the pair that it begins with swings
    next, or the robot rests.

    Args:
        planners: planners of controllers whose pairs are the same, on one map.
        first: index of the pair that every controller swings first.
    """

    def __init__(self, planners: Sequence[ControllerPlanner], first: int) -> None:
        self._planners = sorted(planners, key=lambda each: each.controller.swing_height)
        self._first = first
        self._now = self._planners[0]

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the footsteps from a measured state, and the controller that walks them."""
        rests = not state.command.any() and np.hypot(*state.com_velocity[:2]) < RESTS
        if state.pair != self._first and not rests:
            return self._now.plan(state, goal)
        anew = replace(state, pair=self._first)  # what another controller begins with
        found = {self._now.controller.name: self._now.plan(state, goal)}

        def plan_of(planner: ControllerPlanner) -> FootstepPlan:
            name = planner.controller.name
            if name not in found:
                found[name] = planner.plan(anew, goal)
            return found[name]

        lowest = self._planners[0]
        plan = plan_of(lowest)
        if plan.status == "reached" and not plan.footsteps:
            return found[self._now.controller.name]
        chosen, astride = lowest, float(np.ptp(state.feet[:, 2]))
        stays = self._now is not lowest and astride > lowest.controller.swing_height
        if stays or not plan.footsteps or plan.refused.get("step height"):
            needed = highest_step(plan_of(self._planners[-1]), state, self._now.controller)
            needed = max(needed, astride) if stays else needed
            high = [each for each in self._planners if each.controller.swing_height >= needed]
            order = (*high, self._now, *self._planners)
            chosen = next((each for each in order if plan_of(each).footsteps), self._now)
        self._now = chosen
        return plan_of(chosen)


def highest_step(plan: FootstepPlan, state: WalkingState, controller: ControllerIdentity) -> float:
    """Return how far a foot steps up or down at most in the next footsteps of a plan [m]."""
    before = state.feet[:, 2] - controller.foot_radius
    most = 0.0
    for each in plan.footsteps[:AHEAD]:
        swinging = list(controller.pairs[each.pair])
        most = max(most, float(np.abs(each.feet[swinging, 2] - before[swinging]).max()))
        before = each.feet[:, 2]
    return most
