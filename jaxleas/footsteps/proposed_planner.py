"""A planner that asks a learned proposal first, and searches where that is unsure or not safe."""

from typing import Protocol

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.plan import FootstepPlan, PlannedFootstep
from jaxleas.footsteps.proposal_inputs import ProposalInputs, ProposalSight
from jaxleas.footsteps.search import FootstepPlanner, SearchSettings, start_node
from jaxleas.footsteps.search_states import Node
from jaxleas.footsteps.walking_state import Goal, WalkingState, require_goal


class Scorer(Protocol):
    """Scores commands, as `Proposal` and `ProposalSession` do."""

    def scores(self, inputs: ProposalInputs) -> Float[np.ndarray, " C"]:
        """Return the score of each command; the highest is proposed."""
        ...


class Planner(Protocol):
    """Plans footsteps on a map, as `FootstepPlanner` does."""

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the footsteps from a measured state towards a goal."""
        ...


SURE = 0.3
"""Probability of a proposed command below which the planner is asked."""


LOOKED_AT = 8
"""Next footsteps, those that land farthest from edges, whose swings are looked at."""


class ProposedPlanner:
    """Proposes the next footstep, and plans where the proposal is unsure or not safe.

    A proposed command is taken if it is probable enough (the softmax of the scores), and if the
    footstep that the motion models predict for it passes every check that the search has for its
    first footstep, and another safe one follows it. Otherwise the planner searches; it alone
    concedes some of the buffer, and says to stand.

    Args:
        scorer: what scores commands.
        model: motion models of the controller.
        costs: foot cost map.
        settings: settings of the search, whose limits proposed commands keep, too.
        sure: least probability of a command that is taken; None: every command is taken, and
            neither checked nor searched for.
        planner: planner that is asked; by default one with these settings.

    Attributes:
        asked: number of plans asked for.
        unsure: number of those in which no command was probable enough.
        searched: number of those that the planner searched for, the unsure ones included.
    """

    def __init__(
        self,
        scorer: Scorer,
        model: MotionModel,
        costs: FootCostMap,
        settings: SearchSettings | None = None,
        sure: float | None = SURE,
        planner: Planner | None = None,
    ) -> None:
        settings = SearchSettings() if settings is None else settings
        self._scorer, self._costs, self._sure = scorer, costs, sure
        self._planner = FootstepPlanner(model, costs, settings) if planner is None else planner
        self._expander = Expander(model, costs, settings.limits)
        self._sight = ProposalSight(model, costs, self._expander.commands)
        self.asked = self.unsure = self.searched = 0

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return a plan of the proposed footstep, or that of the planner.

        Raises:
            InputError: the goal is outside the map.
        """
        require_goal(goal, self._costs)
        self.asked += 1
        if not goal.is_met_by(state):
            node = start_node(state, self._costs)
            proposed = self._proposed(node, goal)
            if proposed is not None:
                name = self._expander.controller.name
                return FootstepPlan("horizon", (proposed,), np.inf, np.inf, 1, controller=name)
            self.searched += 1
        return self._planner.plan(state, goal)

    def in_words(self) -> str:
        """Return how often the planner searched, as a sentence."""
        share = 100.0 * self.searched / max(self.asked, 1)
        unsafe = self.searched - self.unsure
        return (
            f"{self.asked} proposals; the planner searched for {self.searched} ({share:.1f} %):"
            f" {self.unsure} unsure, {unsafe} not safe"
        )

    def _proposed(self, node: Node, goal: Goal) -> PlannedFootstep | None:
        """Return the footstep of the best command; None if it is unsure or not safe."""
        scores = self._scorer.scores(self._sight.of(node, goal))
        chosen = int(np.argmax(scores))
        if self._sure is None:
            return self._bare(node, chosen)
        if 1.0 / np.exp(scores - scores[chosen]).sum() < self._sure:
            self.unsure += 1
            return None
        after = self._checked(node, chosen)
        if after is None or not (_is_met_by(goal, after) or self._leads_on(after)):
            return None
        return PlannedFootstep(node.pair, after.command, after.com, after.yaw, after.feet)

    def _checked(self, node: Node, chosen: int) -> Node | None:
        """Return the state after a command's footstep, None if that is not safe."""
        children = self._expander.children([node])
        (rows,) = np.nonzero(children.command == chosen)
        if not len(rows) or not self._expander.swings_clear(children, rows)[0]:
            return None
        return self._expander.child(children, int(rows[0]), 0.0)

    def _leads_on(self, after: Node) -> bool:
        """Return whether a state has a safe footstep: a robot at speed cannot just stop."""
        children = self._expander.children([after])
        rows = np.argsort(children.near, kind="stable")[:LOOKED_AT]
        return len(rows) > 0 and bool(self._expander.swings_clear(children, rows).any())

    def _bare(self, node: Node, chosen: int) -> PlannedFootstep:
        """Return a command with nothing said of where it leads."""
        return PlannedFootstep(
            node.pair, self._expander.commands[chosen], node.com, node.yaw, node.feet
        )


def _is_met_by(goal: Goal, node: Node) -> bool:
    yaw = np.array([node.yaw])
    return bool(goal.is_met(node.com[None], yaw, node.velocity[None, :2])[0])
