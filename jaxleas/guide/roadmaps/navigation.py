"""Guide paths from start to goal by any steering method, with waypoints where it needs them."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import networkx
import numpy as np
from jaxtyping import Bool, Float

from jaxleas.guide.files import Reason
from jaxleas.guide.roadmaps.budget import Budget
from jaxleas.guide.roadmaps.connections import Connector
from jaxleas.guide.roadmaps.ledger import Key, Ledger, key_of
from jaxleas.guide.roadmaps.prm import Prm, search_prm
from jaxleas.guide.roadmaps.rrt import Rrt, search_rrt
from jaxleas.guide.roadmaps.samples import Samples
from jaxleas.guide.roadmaps.walked import motion_at, part_towards, passages, until_refused
from jaxleas.types import GuidePath, RootMotion

SHORTENINGS = 8
"""Maximum number of shorter ways that are tried; each is walked as a whole."""
PlannerName = Literal["rrt", "prm", "none"]
Refused = Callable[[GuidePath], Bool[np.ndarray, " T"]]
"""A function that returns which configurations of a path the exact conditions refuse."""


@dataclass(frozen=True)
class Navigation:
    """The answer to one query.

    Attributes:
        path: guide path to the goal, or the best partial one.
        reason: "reached", or the reason why the path ends elsewhere.
        waypoints: waypoints of the robot in order, the goal last [m].
        connections: number of connections that the search asked for.
        seconds: duration of the search [s].
    """

    path: GuidePath
    reason: Reason
    waypoints: Float[np.ndarray, "W 2"]
    connections: int
    seconds: float

    @property
    def reached(self) -> bool:
        """Whether the path leads to the goal, every configuration valid."""
        return self.reason == "reached"


@dataclass(frozen=True)
class Navigator:
    """A steering method and a search for the waypoints it needs.

    Attributes:
        connector: steering method on its terrain.
        planner: planner that searches for waypoints; "none" only tries the goal directly.
        reach: maximum length of an edge of a tree [m].
        refused: exact check of every whole path, if the terrain has polygons.
    """

    connector: Connector
    planner: PlannerName
    reach: float
    refused: Refused | None = None

    def navigate(
        self, start: RootMotion, goal: Float[np.ndarray, " 2"], budget: Budget, seed: int = 0
    ) -> Navigation:
        """Find a guide path to the goal, without waypoints if possible.

        A path is returned as reached only after the steering method has followed it from start to
        goal without a break; a connection that fails then is removed, and the search continues.

        Args:
            start: root motion at the start, without a batch axis.
            goal: goal x, y [m].
            budget: limit of the search, after which the best partial path is returned.
            seed: random seed of the search.
        """
        goal = np.asarray(goal, dtype=np.float64)
        budget.used += 1
        direct = self._followed(start, goal[None], budget)
        if direct.reached or self.planner == "none":
            return direct
        ledger = Ledger(self.connector, budget)
        while not budget.spent:
            places = self._search(ledger, start, goal, seed)
            if places is None:
                break
            waypoints = np.array(places[1:])
            whole = self._followed(start, waypoints, budget)
            if whole.reached:
                return self._shortened(start, whole, budget)
            failed = self._failed(whole, waypoints)
            ledger.banned.add((places[failed], places[failed + 1]))
            ledger.banned.add((places[failed + 1], places[failed]))
        return self._partial(ledger, start, goal, direct, budget)

    def _search(
        self, ledger: Ledger, start: RootMotion, goal: np.ndarray, seed: int
    ) -> list[Key] | None:
        # Begin again with the same samples: the ledger has the answers to what was tried before.
        places = self.connector.places
        target = key_of(goal)
        if self.planner == "rrt":
            tree = Rrt(ledger, Samples(places, seed, goal), start, self.reach)
            return search_rrt(tree, target)
        here = key_of(np.asarray(start.position))
        return search_prm(Prm(ledger, Samples(places, seed), (here, target)), here, target)

    def _shortened(self, start: RootMotion, whole: Navigation, budget: Budget) -> Navigation:
        """Return a path through fewer waypoints, the fewest that the method can still follow."""
        count = len(whole.waypoints)
        if count == 1:
            return whole
        passed = passages(whole.path, whole.waypoints, self.connector.radius)
        motions = [start, *(motion_at(whole.path, index) for index in passed[:-1])]
        pairs = [(i, j) for i in range(count) for j in range(i + 2, count + 1)]
        tried = self.connector.connect(
            [motions[i] for i, _ in pairs], whole.waypoints[[j - 1 for _, j in pairs]]
        )
        jumps = networkx.DiGraph([(i, i + 1) for i in range(count)])
        jumps.add_edges_from(
            pair for pair, reached in zip(pairs, tried.reached, strict=True) if reached
        )
        for _ in range(SHORTENINGS):
            kept = networkx.shortest_path(jumps, 0, count)
            if len(kept) > count:
                break
            waypoints = whole.waypoints[[j - 1 for j in kept[1:]]]
            shorter = self._followed(start, waypoints, budget)
            if shorter.reached:
                return shorter
            failed = self._failed(shorter, waypoints)
            jumps.remove_edge(kept[failed], kept[failed + 1])
            # Every step of the way that is known to work stays.
            jumps.add_edges_from((i, i + 1) for i in range(count))
        return whole

    def _failed(self, walked: Navigation, waypoints: np.ndarray) -> int:
        """Return the index of the first waypoint that a walk through all of them did not reach."""
        passed = passages(walked.path, waypoints, self.connector.radius)
        return min(len(passed), len(waypoints) - 1)

    def _partial(
        self,
        ledger: Ledger,
        start: RootMotion,
        goal: np.ndarray,
        direct: Navigation,
        budget: Budget,
    ) -> Navigation:
        """Return the known valid path that ends nearest to the goal."""
        known = networkx.DiGraph(ledger.reached())
        here = key_of(np.asarray(start.position))
        candidates = [direct]
        if here in known:
            ways = networkx.single_source_shortest_path(known, here)
            nearest = min(ways, key=lambda place: float(np.hypot(*(np.array(place) - goal))))
            if len(ways[nearest]) > 1:
                way = self._followed(start, np.array(ways[nearest][1:]), budget)
                if way.reached and nearest == key_of(goal):  # one of the ledger's guesses
                    return self._shortened(start, way, budget)
                candidates.append(way)
        best = min(
            (replace(each, path=part_towards(each.path, goal)) for each in candidates),
            key=lambda each: float(np.hypot(*(each.path.position[-1, :2] - goal))),
        )
        return replace(
            best, reason="stopped", connections=budget.used, seconds=round(budget.elapsed, 3)
        )

    def _followed(self, start: RootMotion, waypoints: np.ndarray, budget: Budget) -> Navigation:
        path, reached, invalid = self.connector.follow(start, waypoints)
        if self.refused is not None and (refused := self.refused(path)).any():
            path, reached, invalid = until_refused(path, refused), False, True
        reason: Reason = "reached" if reached else "invalid" if invalid else "stopped"
        return Navigation(path, reason, waypoints, budget.used, round(budget.elapsed, 3))
