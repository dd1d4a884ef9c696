"""Velocity A*: the commands whose footsteps lead to a goal and land far from edges.

Taouil's thesis, section 4.2.3, searches greedily and without what was spent so far. Here the cost
of a plan is the number of its footsteps, more for landings near edges, and about what is left at
its end; the horizon is the number of footsteps of a plan. The thesis's cost is there by name.
"""

from dataclasses import dataclass

from jaxleas.footsteps.beam import beam_search
from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.exact_search import exact_search
from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.limits import Limits
from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.plan import FootstepPlan, PlannedFootstep
from jaxleas.footsteps.search_costs import Cost, Found, SearchCosts
from jaxleas.footsteps.search_states import Node, start_node
from jaxleas.footsteps.walking_state import Goal, WalkingState, require_goal
from jaxleas.footsteps.way_left import Strides, WayLeft
from jaxleas.types import ControllerIdentity, InputError


@dataclass(frozen=True)
class SearchSettings:
    """How far, and how thoroughly, commands are searched.

    Attributes:
        horizon: number of footsteps of a plan that does not reach the goal.
        cost: "footsteps", or "thesis": distance left and nearness to edges of the last landings.
        clearance: footsteps that a landing 1 m nearer to an edge than `FAR_ENOUGH` is worth.
        width: number of states that go on after each footstep; None for all, which is exact.
        most_expansions: number of states after which an exact search ends with what it has.
        fastest: largest speed that is commanded, over the controller's largest.
        climbing: the same where a foot steps up or down by more than `CLIMBS`: models are fitted
            to level ground, and on stairs they are wrong at speed.
        doubt: what each footstep before adds to the buffer of a landing [m]: a plan whose later
            landings just fit is put off at each contact, and never walked.
        jump: largest change of the command between footsteps, its parts over the controller's
            largest, in sum.
        sway: largest difference of two changes of the forward speed in turn, over the controller's
            largest: the robot sways when it goes up and down from one footstep to the next.
        concessions: shares of the buffer that are tried in turn where a walking robot has no safe
            command; stopping takes footsteps, too, whose landings are not planned.
    """

    horizon: int = 2
    cost: Cost = "footsteps"
    clearance: float = 10.0
    width: int | None = None
    most_expansions: int = 5000
    fastest: float = 1.0
    climbing: float = 1.0
    doubt: float = 0.0
    jump: float = float("inf")
    sway: float = float("inf")
    concessions: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        least = min(self.horizon, self.most_expansions, 1 if self.width is None else self.width)
        if least < 1 or self.clearance < 0 or not min(self.fastest, self.climbing) > 0:
            raise InputError(
                "a search needs a horizon, width and budget of at least 1, speeds above 0 and no"
                f" negative clearance: {self}"
            )

    @property
    def limits(self) -> Limits:
        """What footsteps are kept within."""
        return Limits(self.fastest, self.climbing, self.doubt, self.jump, self.sway)


WIDTH = 64
"""Width of a search that is not exact."""


def settings_for(horizon: int) -> SearchSettings:
    """Return settings for a plan within a control cycle: exact up to two footsteps."""
    return SearchSettings(horizon, width=None if horizon <= 2 else WIDTH)


class FootstepPlanner:
    """Plans footsteps on one map; a map that stays is prepared once.

    Args:
        model: motion models of the controller.
        costs: foot cost map.
        settings: how far, and how thoroughly; exact at a horizon of two by default.

    Raises:
        InputError: no command of the models is as slow as the settings want it.
    """

    def __init__(
        self, model: MotionModel, costs: FootCostMap, settings: SearchSettings | None = None
    ) -> None:
        self._costs = costs
        self._settings = SearchSettings() if settings is None else settings
        self._expander = Expander(model, costs, self._settings.limits)
        self._strides = Strides.of(model, self._expander.commands)

    @property
    def controller(self) -> ControllerIdentity:
        """Controller whose footsteps are planned."""
        return self._expander.controller

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the footsteps from a measured state towards a goal.

        Raises:
            InputError: the goal is outside the map.
        """
        require_goal(goal, self._costs)
        settings, start = self._settings, start_node(state, self._costs)
        self._expander.forget()
        if goal.is_met_by(state):
            return self._plan(Found("reached", start, 0.0, 0.0))
        left = WayLeft(self._expander.model, self._strides, goal)
        costs = SearchCosts(goal, left, settings.cost, settings.clearance)
        plan = self._plan(self._found(costs, start))
        for share in settings.concessions if state.command.any() else ():
            if plan.footsteps:
                break
            self._expander.forget(share)
            conceded = self._plan(self._found(costs, start))
            plan = conceded if conceded.footsteps else plan
        return plan

    def _found(self, costs: SearchCosts, start: Node) -> Found:
        settings = self._settings
        if settings.width is None:
            horizon, budget = settings.horizon, settings.most_expansions
            return exact_search(self._expander, costs, start, horizon, budget)
        return beam_search(self._expander, costs, start, settings.horizon, settings.width)

    def _plan(self, found: Found) -> FootstepPlan:
        footsteps: list[PlannedFootstep] = []
        node, pairs = found.node, len(self._expander.controller.pairs)
        while node is not None and node.parent is not None:
            swung = (node.pair - 1) % pairs
            footsteps.append(PlannedFootstep(swung, node.command, node.com, node.yaw, node.feet))
            node = node.parent
        return FootstepPlan(
            status=found.status,
            footsteps=tuple(reversed(footsteps)),
            cost=found.cost,
            gap=max(0.0, found.cost - found.bound) if footsteps else 0.0,
            expansions=found.expansions,
            refused=dict(self._expander.refused),
            miss=self._expander.miss,
            controller=self.controller.name,
        )


def plan_footsteps(
    model: MotionModel,
    costs: FootCostMap,
    state: WalkingState,
    goal: Goal,
    settings: SearchSettings | None = None,
) -> FootstepPlan:
    """Return the footsteps from a state towards a goal.

    Args:
        model: motion models of the controller.
        costs: foot cost map.
        state: measured state.
        goal: pose to reach.
        settings: how far, and how thoroughly; exact at a horizon of two by default.

    Raises:
        InputError: the goal is outside the map.
    """
    return FootstepPlanner(model, costs, settings).plan(state, goal)
