"""PRM by OMPL: a roadmap of places whose edges a steering method decides."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.guide.places import on_host
from jaxleas.guide.roadmaps.connections import BATCH
from jaxleas.guide.roadmaps.ledger import Key, Ledger, Question, key_of
from jaxleas.guide.roadmaps.ompl import SAME, import_ompl, solution_of, space_of, state_of
from jaxleas.guide.roadmaps.samples import Samples
from jaxleas.types import RootMotion

NEIGHBOURS = 8
"""Number of neighbours of a new place that a PRM tries to connect."""
GROW = 32
"""Number of places by which a PRM grows between two checks for a path."""


class Prm:
    """A roadmap of places; each edge works both ways, from rest and facing its end."""

    def __init__(self, ledger: Ledger, samples: Samples, ends: Sequence[Key]):
        """Prepare.

        Args:
            ledger: ledger of the connections.
            samples: places that join the roadmap.
            ends: start and goal, the first places of the roadmap.
        """
        self.ledger, self.samples = ledger, samples
        self.nodes = [np.array(each) for each in ends]
        self.edges: set[tuple[Key, Key]] = set()

    def join(self) -> Float[np.ndarray, " 2"]:
        """Return the next place, which joins the roadmap."""
        place = self.samples.next()
        self.nodes.append(place)
        return place

    def connects(self, origin: Key, target: Key) -> bool:
        """Return whether a robot gets from either place to the other."""
        there, back = self._questions(origin, target)
        works = (
            self.ledger.ask(there, lambda: [back, *self._guesses()]).reached
            and self.ledger.ask(back, self._guesses).reached
        )
        if works:
            self.edges.add((origin, target))
        return works

    def _questions(self, origin: Key, target: Key) -> tuple[Question, Question]:
        ends = np.array([origin, target])
        along = ends[1] - ends[0]
        yaw = np.arctan2(along[1], along[0])
        standing = self.ledger.connector.places.standing(ends, np.array([yaw, yaw + np.pi]))
        there, back = (on_host(*parts) for parts in zip(*_leaves(standing), strict=True))
        return Question(origin, target, there), Question(target, origin, back)

    def _guesses(self) -> list[Question]:
        """Return the edges of the newest place and of the places that will join next."""
        ahead = self.samples.ahead(BATCH // NEIGHBOURS)
        nodes = np.concatenate([np.array(self.nodes), ahead])
        guesses: list[Question] = []
        for index in range(len(self.nodes) - 1, len(nodes)):
            distance = np.linalg.norm(nodes[:index] - nodes[index], axis=1)
            for other in np.argsort(distance, kind="stable")[:NEIGHBOURS]:
                guesses += self._questions(key_of(nodes[other]), key_of(nodes[index]))
        return guesses


def search_prm(prm: Prm, start: Key, goal: Key) -> list[Key] | None:
    """Grow a roadmap until it joins start and goal or the budget is spent.

    Returns:
        The places from start to goal, both included, or None.
    """
    base, geometric = import_ompl()

    class Sampler(base.ValidStateSampler):
        def sample(self, state: Any) -> bool:
            state[0], state[1] = prm.join()
            return True

        def sampleNear(self, state: Any, near: Any, distance: float) -> bool:  # noqa: N802
            del near, distance
            return self.sample(state)

    space_information = space_of(base, prm.ledger, prm.connects)
    space_information.setValidStateSamplerAllocator(lambda information: Sampler(information))
    problem = base.ProblemDefinition(space_information)
    problem.setStartAndGoalStates(
        state_of(space_information, start), state_of(space_information, goal), SAME
    )
    planner = geometric.PRM(space_information)
    planner.setMaxNearestNeighbors(NEIGHBOURS)
    planner.setProblemDefinition(problem)
    planner.setup()
    budget = prm.ledger.budget
    planner.solve(base.plannerAlwaysTerminatingCondition())  # start and goal join the roadmap
    while not budget.spent:
        enough = prm.samples.position + GROW
        planner.growRoadmapPtc(
            base.PlannerTerminationCondition(
                lambda enough=enough: prm.samples.position >= enough or budget.spent
            )
        )
        if _joined(prm, start, goal):
            # OMPL searches for the path in a separate thread, and keeps growing until it has one.
            planner.solve(base.timedPlannerTerminationCondition(1.0))
            return solution_of(problem)
    return None


def _joined(prm: Prm, start: Key, goal: Key) -> bool:
    import networkx

    net = networkx.Graph(prm.edges)
    return start in net and goal in net and networkx.has_path(net, start, goal)


def _leaves(motion: RootMotion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return np.asarray(motion.position), np.asarray(motion.velocity), np.asarray(motion.yaw)
