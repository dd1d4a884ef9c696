"""What footsteps cost, and what a search has found."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps.plan import Status
from jaxleas.footsteps.search_states import Children, Node
from jaxleas.footsteps.walking_state import Goal
from jaxleas.footsteps.way_left import WayLeft

Cost = Literal["footsteps", "thesis"]


@dataclass(eq=False)
class Found:
    """The best plan so far, and what it could cost less.

    Attributes:
        status: how it ends.
        node: state at its end.
        cost: its cost.
        bound: what no plan costs less than.
        expansions: number of states whose commands were tried.
    """

    status: Status = "stand"
    node: Node | None = None
    cost: float = np.inf
    bound: float = np.inf
    expansions: int = 0

    def take(self, status: Status, node: Node, cost: float) -> None:
        """Take a plan as the best one."""
        self.status, self.node, self.cost = status, node, cost


@dataclass(frozen=True, eq=False)
class StepCosts:
    """Costs of the footsteps from some states.

    Attributes:
        spent: cost so far.
        bound: cost so far and the least cost that is left.
        total: cost so far and an estimate of what is left: the cost of a plan that ends here.
    """

    spent: Float[np.ndarray, " K"]
    bound: Float[np.ndarray, " K"]
    total: Float[np.ndarray, " K"]


@dataclass(frozen=True, eq=False)
class SearchCosts:
    """Costs of plans towards a goal.

    Attributes:
        goal: pose to reach.
        left: footsteps that are left to it.
        kind: kind of cost; see `SearchSettings`.
        clearance: footsteps that a landing 1 m nearer to an edge is worth.
    """

    goal: Goal
    left: WayLeft
    kind: Cost
    clearance: float

    def of(self, children: Children) -> StepCosts:
        """Return the costs of footsteps."""
        if self.kind == "thesis":
            apart = np.hypot(*(children.com - (self.goal.x, self.goal.y)).T)
            greedy = apart + children.near
            return StepCosts(np.zeros(len(greedy)), greedy, greedy)
        before = np.array([node.spent for node in children.parents])[children.parent]
        spent = before + 1.0 + self.clearance * children.near
        at_least = self.left.at_least(children.com, children.yaw)
        about = self.left.about(children.com, children.yaw)
        return StepCosts(spent, spent + at_least, spent + about)
