"""RRT by OMPL: a tree of places whose edges a steering method decides."""

from typing import Any

import numpy as np

from jaxleas.guide.roadmaps.connections import BATCH
from jaxleas.guide.roadmaps.ledger import Key, Ledger, Question, key_of
from jaxleas.guide.roadmaps.ompl import SAME, import_ompl, solution_of, space_of, state_of
from jaxleas.guide.roadmaps.samples import Samples
from jaxleas.types import RootMotion


class Rrt:
    """A tree of arrivals: each edge begins with the root motion at the end of the one before it."""

    def __init__(self, ledger: Ledger, samples: Samples, start: RootMotion, reach: float):
        """Prepare.

        Args:
            ledger: ledger of the connections.
            samples: places to grow towards, among them the goal now and then.
            start: root motion at the start, without a batch axis.
            reach: maximum length of an edge [m].
        """
        self.ledger, self.samples, self.reach = ledger, samples, reach
        self.start = key_of(np.asarray(start.position))
        self.motions = {self.start: (-1, start)}
        self.nodes = [np.array(self.start)]

    def connects(self, origin: Key, target: Key) -> bool:
        """Return whether the robot that arrived at `origin` gets to `target`, which then joins."""
        if target in self.motions:
            return False  # the target is already in the tree
        answer = self.ledger.ask(self._question(origin, target), self._guesses)
        if answer.reached:
            self.motions[target] = (answer.number, answer.arrival)
            self.nodes.append(np.array(target))
        return answer.reached

    def _question(self, origin: Key, target: Key) -> Question:
        number, motion = self.motions[origin]
        return Question(origin, target, motion, number)

    def _guesses(self) -> list[Question]:
        """Return the edges towards the next samples, as if the tree stayed as it is."""
        nodes, ahead = np.array(self.nodes), self.samples.ahead(BATCH)
        distance = np.linalg.norm(ahead[:, None] - nodes[None], axis=-1)
        nearest = distance.argmin(axis=1)
        length = distance[np.arange(len(ahead)), nearest]
        share = np.minimum(1.0, self.reach / np.maximum(length, SAME))[:, None]
        target = nodes[nearest] + (ahead - nodes[nearest]) * share
        return [
            self._question(key_of(nodes[node]), key_of(place))
            for node, place in zip(nearest, target, strict=True)
            if key_of(place) not in self.motions
        ]


def search_rrt(rrt: Rrt, goal: Key) -> list[Key] | None:
    """Grow a tree until it holds the goal or the budget is spent.

    Returns:
        The places from start to goal, both included, or None.
    """
    base, geometric = import_ompl()

    class Sampler(base.GoalSampleableRegion):
        def sampleGoal(self, state: Any) -> None:  # noqa: N802 - OMPL's name
            state[0], state[1] = rrt.samples.next()

        def maxSampleCount(self) -> int:  # noqa: N802
            return 2**31 - 1

        def distanceGoal(self, state: Any) -> float:  # noqa: N802
            return float(np.hypot(state[0] - goal[0], state[1] - goal[1]))

    space_information = space_of(base, rrt.ledger, rrt.connects)
    problem = base.ProblemDefinition(space_information)
    problem.addStartState(state_of(space_information, rrt.start))
    region = Sampler(space_information)
    region.setThreshold(SAME)
    problem.setGoal(region)
    planner = geometric.RRT(space_information)
    planner.setRange(rrt.reach)
    planner.setGoalBias(1.0)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.PlannerTerminationCondition(lambda: rrt.ledger.budget.spent))
    return solution_of(problem)
