"""Velocity A*: the commands whose footsteps lead to a goal and land far from edges.

Taouil's thesis, section 4.2.3, searches greedily and without what was spent so far. Here the cost
of a plan is the number of its footsteps, more for landings near edges, and a bound on what is
left; the horizon is the number of footsteps of a plan. The thesis's cost is there by name.
"""

import heapq
import itertools
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from jaxleas.footsteps.cost_map import FootCostMap
from jaxleas.footsteps.expansion import Children, Expander, Node
from jaxleas.footsteps.features import turned, wrapped
from jaxleas.footsteps.model import MotionModel
from jaxleas.footsteps.plan import FootstepPlan, PlannedFootstep, Status
from jaxleas.footsteps.walking_state import Goal, WalkingState, require_goal
from jaxleas.types import InputError

Cost = Literal["footsteps", "thesis"]


@dataclass(frozen=True)
class SearchSettings:
    """How far, and how thoroughly, commands are searched.

    Attributes:
        horizon: number of footsteps of a plan that does not reach the goal.
        cost: "footsteps", or "thesis": distance left and nearness to edges of the last landings.
        clearance: footsteps that a landing 1 m nearer to an edge than `FAR_ENOUGH` is worth.
        slack: footsteps by which a plan may cost more than the best one; 0 is exact.
        merge: whether two states of one command, whose poses are in one cell of 2 cm and 2 degrees
            after the same number of footsteps, count as one; False is exact.
        most_expansions: number of states after which the search ends with what it has.
    """

    horizon: int = 2
    cost: Cost = "footsteps"
    clearance: float = 10.0
    slack: float = 0.0
    merge: bool = False
    most_expansions: int = 5000

    def __post_init__(self) -> None:
        if self.horizon < 1 or self.most_expansions < 1 or self.slack < 0 or self.clearance < 0:
            raise InputError(
                "a search needs a horizon and a budget of at least 1, and no negative slack or"
                f" clearance: {self}"
            )


def settings_for(horizon: int) -> SearchSettings:
    """Return settings for a plan within a control cycle: exact up to two footsteps."""
    if horizon <= 2:
        return SearchSettings(horizon)
    return SearchSettings(horizon, slack=0.5, merge=True, most_expansions=400)


TOGETHER = 64
"""Open states that are expanded together: one prediction for all commands of all of them."""
MERGED_CELL, MERGED_YAW = 0.02, float(np.radians(2.0))
_NOWHERE = Node(*(np.zeros(2), 0.0, np.zeros(4), np.zeros((0, 3)), 0, np.zeros(3)))


class FootstepPlanner:
    """Plans footsteps on one map; a map that stays is prepared once.

    Args:
        model: motion models of the controller.
        costs: foot cost map.
        settings: how far, and how thoroughly; exact at a horizon of two by default.
    """

    def __init__(
        self, model: MotionModel, costs: FootCostMap, settings: SearchSettings | None = None
    ) -> None:
        self._costs = costs
        self._expander = Expander(model, costs)
        self._settings = SearchSettings() if settings is None else settings

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the footsteps from a measured state towards a goal.

        Raises:
            InputError: the goal is outside the map.
        """
        require_goal(goal, self._costs)
        self._expander.forget()
        return _Search(self._expander, goal, self._settings).run(_start(state, self._costs))


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


def _start(state: WalkingState, costs: FootCostMap) -> Node:
    """Return a measured state as a node; feet stand on the map where it has ground."""
    ground = costs.height_map.height_at(state.feet[:, :2]).astype(np.float64)
    feet = np.column_stack(
        [state.feet[:, :2], np.where(np.isnan(ground), state.feet[:, 2], ground)]
    )
    velocity = turned(state.com_velocity, np.asarray(-state.yaw))
    return Node(
        com=state.com[:2].astype(np.float64),
        yaw=state.yaw,
        velocity=np.append(velocity, state.yaw_rate),
        feet=feet,
        pair=state.pair,
        command=state.command.astype(np.float64),
    )


class _Search:
    """One search. Open states wait in a heap as children, made states when their turn comes."""

    def __init__(self, expander: Expander, goal: Goal, settings: SearchSettings) -> None:
        self._expander, self._model = expander, expander.model
        self._goal, self._settings = goal, settings
        self._heap: list[tuple[float, int, int, float, float, Children, int]] = []
        self._order = itertools.count()
        self._cheapest: dict[tuple[float, ...], float] = {}
        self._expansions = 0
        self._best: tuple[Status, Node] = ("stand", _NOWHERE)
        self._total = np.inf

    def run(self, start: Node) -> FootstepPlan:
        if self._is_there(start.com[None], np.array([start.yaw])).all():
            self._best = ("reached", start)
            self._total = 0.0
            return self._plan(0.0)
        self._expand([start])
        # All that is open costs at least its key, and a plan may cost the slack more.
        while self._heap and self._heap[0][0] < self._total - self._settings.slack:
            if self._expansions >= self._settings.most_expansions:
                return self._out_of_budget()
            if nodes := self._next():
                self._expand(nodes)
        return self._plan(self._bound())

    def _next(self) -> list[Node]:
        """Return the open states to expand together: the cheapest, of one depth."""
        room = self._settings.most_expansions - self._expansions
        nodes: list[Node] = []
        while self._heap and len(nodes) < min(TOGETHER, room):
            key, depth = self._heap[0][:2]
            if key >= self._total - self._settings.slack or (nodes and -depth != nodes[0].depth):
                break
            _, _, _, _, spent, children, index = heapq.heappop(self._heap)
            if self._settings.merge or self._expander.swings_clear(children, np.array([index]))[0]:
                nodes.append(self._expander.child(children, index, spent))
        return nodes

    def _expand(self, nodes: list[Node]) -> None:
        """Try all commands in states of one depth."""
        self._expansions += len(nodes)
        children, depth = self._expander.children(nodes), nodes[0].depth + 1
        left = self._left(children.com, children.yaw)
        if self._settings.cost == "thesis":
            spent = np.zeros(len(left))
            goal = (self._goal.x, self._goal.y)
            totals = np.hypot(*(children.com - goal).T) + children.near
        else:
            before = np.array([node.spent for node in nodes])[children.parent]
            spent = before + 1.0 + self._settings.clearance * children.near
            totals = spent + left
        there = self._is_there(children.com, children.yaw)
        self._end_at(children, totals, spent, there, "reached")
        if depth == self._settings.horizon:
            self._end_at(children, totals, spent, ~there, "horizon")
            return
        # A deeper state may go first, as long as no other is cheaper by more than the slack.
        keys = totals - self._settings.slack * depth / self._settings.horizon
        is_open = np.flatnonzero(~there & (keys < self._total - self._settings.slack))
        merged = None
        if self._settings.merge and len(is_open):
            # A state whose swing is refused must not stand for others.
            is_open = is_open[self._expander.swings_clear(children, is_open)]
            merged = self._merged(children, depth)
        for index in is_open[np.argsort(totals[is_open], kind="stable")].tolist():
            total = float(totals[index])
            if merged is not None:
                place = tuple(merged[index])
                if self._cheapest.get(place, np.inf) <= total:
                    continue
                self._cheapest[place] = total
            order, cost = next(self._order), float(spent[index])
            entry = (float(keys[index]), -depth, order, total, cost, children, index)
            heapq.heappush(self._heap, entry)

    def _end_at(
        self,
        children: Children,
        totals: Float[np.ndarray, " K"],
        spent: Float[np.ndarray, " K"],
        chosen: Bool[np.ndarray, " K"],
        status: Status,
    ) -> None:
        """Keep the cheapest of the chosen children as the end of the plan, if it is cheaper."""
        left = np.where(chosen, totals, np.inf)
        while len(left) and (total := float(left.min())) < self._total:
            index = int(left.argmin())
            left[index] = np.inf
            if self._expander.swings_clear(children, np.array([index]))[0]:
                end = self._expander.child(children, index, float(spent[index]))
                self._best = (status, end)
                self._total = total

    @staticmethod
    def _merged(children: Children, depth: int) -> list[list[float]]:
        """Return what states that count as one have in common."""
        columns = [
            *np.floor(children.com / MERGED_CELL).T,
            np.floor(wrapped(children.yaw) / MERGED_YAW),
            children.command,
            np.full(len(children.command), depth),
        ]
        return np.column_stack(columns).tolist()

    def _left(
        self, com: Float[np.ndarray, "C 2"], yaw: Float[np.ndarray, " C"]
    ) -> Float[np.ndarray, " C"]:
        """Return the least number of footsteps left: no stride is longer than those in the data."""
        goal = self._goal
        apart = np.hypot(com[:, 0] - goal.x, com[:, 1] - goal.y) - goal.distance
        turn = np.abs(wrapped(goal.yaw - yaw)) - goal.angle
        strides = apart / self._model.longest_stride
        turns = turn / self._model.largest_turn if self._model.largest_turn > 0 else 0.0 * turn
        return np.maximum(np.maximum(strides, turns), 0.0)

    def _is_there(
        self, com: Float[np.ndarray, "K 2"], yaw: Float[np.ndarray, " K"]
    ) -> Bool[np.ndarray, " K"]:
        goal = self._goal
        apart = np.hypot(com[:, 0] - goal.x, com[:, 1] - goal.y)
        return (apart <= goal.distance) & (np.abs(wrapped(goal.yaw - yaw)) <= goal.angle)

    def _bound(self) -> float:
        """Return what no plan costs less than."""
        return min((entry[3] for entry in self._heap), default=self._total)

    def _out_of_budget(self) -> FootstepPlan:
        """Return the best plan found; else the deepest of the open ones."""
        bound = self._bound()
        if np.isinf(self._total):
            depth = min(entry[1] for entry in self._heap)
            last = min(entry for entry in self._heap if entry[1] == depth)
            _, _, _, self._total, spent, children, index = last
            self._best = ("budget", self._expander.child(children, index, spent))
        return self._plan(bound)

    def _plan(self, bound: float) -> FootstepPlan:
        status, node = self._best
        footsteps: list[PlannedFootstep] = []
        pairs = len(self._model.controller.pairs)
        while node.parent is not None:
            swung = (node.pair - 1) % pairs
            footsteps.append(PlannedFootstep(swung, node.command, node.com, node.yaw, node.feet))
            node = node.parent
        return FootstepPlan(
            status=status,
            footsteps=tuple(reversed(footsteps)),
            cost=self._total,
            gap=max(0.0, self._total - bound) if footsteps else 0.0,
            expansions=self._expansions,
            refused=dict(self._expander.refused),
            miss=self._expander.miss,
        )
