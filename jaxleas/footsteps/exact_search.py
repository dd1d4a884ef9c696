"""A* over commands: no plan of the horizon costs less than the one that is returned."""

import heapq
import itertools

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.expansion import Expander
from jaxleas.footsteps.plan import Status
from jaxleas.footsteps.search_costs import Found, SearchCosts
from jaxleas.footsteps.search_states import Children, Node

TOGETHER = 64
"""Open states that are expanded together: one prediction for all commands of all of them."""
Open = tuple[float, int, int, float, Children, int]
"""Bound, depth (deep ones first), order, cost so far, and the child that is to become a state."""


def exact_search(
    expander: Expander, costs: SearchCosts, start: Node, horizon: int, budget: int
) -> Found:
    """Return the cheapest plan that reaches the goal or the horizon.

    Args:
        expander: what predicts footsteps and refuses those that are not safe.
        costs: costs of footsteps towards a goal.
        start: state to begin in.
        horizon: number of footsteps of a plan that does not reach the goal.
        budget: number of states after which the search ends with what it has.
    """
    return _Search(expander, costs, horizon, budget).run(start)


class _Search:
    """One search. Open states wait in a heap as children, made states when their turn comes."""

    def __init__(self, expander: Expander, costs: SearchCosts, horizon: int, budget: int) -> None:
        self._expander, self._costs = expander, costs
        self._horizon, self._budget = horizon, budget
        self._heap: list[Open] = []
        self._order = itertools.count()
        self._found = Found()

    def run(self, start: Node) -> Found:
        self._expand([start])
        # All that is open costs at least its key.
        while self._heap and self._heap[0][0] < self._found.cost:
            if self._found.expansions >= self._budget:
                return self._out_of_budget()
            if nodes := self._next():
                self._expand(nodes)
        self._found.bound = self._bound()
        return self._found

    def _next(self) -> list[Node]:
        """Return the open states to expand together: the cheapest, of one depth."""
        room = self._budget - self._found.expansions
        taken: list[Open] = []
        while self._heap and len(taken) < min(TOGETHER, room):
            key, depth = self._heap[0][:2]
            if key >= self._found.cost or (taken and depth != taken[0][1]):
                break
            taken.append(heapq.heappop(self._heap))
        return self._made(taken)

    def _made(self, taken: list[Open]) -> list[Node]:
        """Return the states of those whose swings are clear, which is asked of many at once."""
        siblings: dict[int, list[int]] = {}
        for number, (_, _, _, _, children, _) in enumerate(taken):
            siblings.setdefault(id(children), []).append(number)
        clear = np.zeros(len(taken), bool)
        for numbers in siblings.values():
            rows = np.array([taken[each][5] for each in numbers])
            clear[numbers] = self._expander.swings_clear(taken[numbers[0]][4], rows)
        return [
            self._expander.child(children, index, spent)
            for (_, _, _, spent, children, index), is_clear in zip(taken, clear, strict=True)
            if is_clear
        ]

    def _expand(self, nodes: list[Node]) -> None:
        """Try all commands in states of one depth."""
        self._found.expansions += len(nodes)
        children, depth = self._expander.children(nodes), nodes[0].depth + 1
        costs = self._costs.of(children)
        there = self._costs.goal.is_met(children.com, children.yaw, children.velocity)
        self._end_at(children, costs.total, there, "reached")
        if depth == self._horizon:
            self._end_at(children, costs.total, ~there, "horizon")
            return
        is_open = np.flatnonzero(~there & (costs.bound < self._found.cost))
        for index in is_open[np.argsort(costs.bound[is_open], kind="stable")].tolist():
            key, spent = float(costs.bound[index]), float(costs.spent[index])
            heapq.heappush(self._heap, (key, -depth, next(self._order), spent, children, index))

    def _end_at(
        self,
        children: Children,
        totals: Float[np.ndarray, " K"],
        chosen: Bool[np.ndarray, " K"],
        status: Status,
    ) -> None:
        """Keep the cheapest of the chosen children as the end of the plan, if it is cheaper."""
        left = np.where(chosen, totals, np.inf)
        while len(left) and (total := float(left.min())) < self._found.cost:
            index = int(left.argmin())
            left[index] = np.inf
            if self._expander.swings_clear(children, np.array([index]))[0]:
                self._found.take(status, self._expander.child(children, index, total), total)

    def _bound(self) -> float:
        """Return what no plan costs less than."""
        return min((entry[0] for entry in self._heap), default=self._found.cost)

    def _out_of_budget(self) -> Found:
        """Return the best plan found; else the deepest of the open ones."""
        self._found.bound = self._bound()
        if self._found.node is None:
            depth = min(entry[1] for entry in self._heap)
            cost, _, _, spent, children, index = min(e for e in self._heap if e[1] == depth)
            self._found.take("budget", self._expander.child(children, index, spent), cost)
        return self._found
