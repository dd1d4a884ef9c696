"""Best-first search (A*, Hart et al. 1968): states, successors and costs are callables."""

import heapq
import itertools
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Generic, TypeVar

import numpy as np

State = TypeVar("State")


class OutOfTimeError(Exception):
    """The deadline passed before the search ended: no verdict."""


@dataclass(frozen=True, eq=False)
class Node(Generic[State]):
    """A state with the way to it.

    Attributes:
        state: the state.
        cost: sum of the costs from the start.
        parent: node that it follows from; None for a start.
    """

    state: State
    cost: float
    parent: "Node[State] | None" = None

    def path(self) -> list[State]:
        """Return the states from the start to this one."""
        node, states = self, []
        while node is not None:
            states.append(node.state)
            node = node.parent
        return states[::-1]


@dataclass(frozen=True)
class Graph(Generic[State]):
    """What best-first search knows of the world.

    Attributes:
        successors: costs of the steps that can be made from a state, and the states after them.
        heuristic: lower bound on the cost from a state to the goal; infinite where there is no way.
            With one that is too large somewhere, goals need not come in the order of their costs.
        is_goal: whether a state is a goal.
        order: value by which states are taken whose costs promise the same, least first.
        admits: whether a state is needed beside those met before; asked when a state is met.
        needs: whether a state is still needed beside those met since; asked when it is taken.
    """

    successors: Callable[[State], Iterable[tuple[float, State]]]
    heuristic: Callable[[State], float]
    is_goal: Callable[[State], bool]
    order: Callable[[State], Any] = lambda state: 0
    admits: Callable[[State], bool] = lambda state: True
    needs: Callable[[State], bool] = lambda state: True


@dataclass(eq=False)
class BestFirst(Generic[State]):
    """A search under way.

    Attributes:
        graph: states and their successors.
        expansions: number of states whose successors were asked for.
    """

    graph: Graph[State]
    expansions: int = field(default=0, init=False)

    def goals(self, starts: Iterable[State], deadline: float = np.inf) -> Iterator[Node[State]]:
        """Yield goals, cheapest first; that no more come proves that there are no others.

        Goals are not gone on from.

        Args:
            starts: states to begin with, at no cost.
            deadline: time by `time.perf_counter` after which to stop [s].

        Raises:
            OutOfTimeError: the deadline passed first.
        """
        graph, numbers = self.graph, itertools.count()
        queue: list[tuple[float, Any, int, Node[State]]] = []

        def meet(node: Node[State]) -> None:
            promised = node.cost + graph.heuristic(node.state)
            if promised < np.inf and graph.admits(node.state):
                order = graph.order(node.state)
                heapq.heappush(queue, (promised, order, next(numbers), node))

        for state in starts:
            meet(Node(state, 0.0))
        while queue:
            if time.perf_counter() > deadline:
                raise OutOfTimeError
            *_, node = heapq.heappop(queue)
            if graph.is_goal(node.state):
                yield node
                continue
            if not graph.needs(node.state):
                continue
            self.expansions += 1
            for cost, state in graph.successors(node.state):
                meet(Node(state, node.cost + cost, node))
