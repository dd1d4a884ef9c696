"""RRT and PRM by OMPL over places whose connections a steering method decides.

OMPL asks one question at a time; the ledger answers it from a batch. For that the next samples must
be known, so this module supplies them: to PRM by a valid-state sampler, to RRT (whose binding does
not accept one) by the goal's own sampler with a goal bias of 1.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from jaxtyping import Float

from jaxleas.guide.places import on_host
from jaxleas.guide.roadmaps.connections import BATCH
from jaxleas.guide.roadmaps.ledger import Key, Ledger, Question, key_of
from jaxleas.guide.roadmaps.samples import Samples
from jaxleas.types import JaxleasError, RootMotion

NEIGHBOURS = 8
"""Number of neighbours of a new place that a PRM tries to connect."""
GROW = 32
"""Number of places by which a PRM grows between two checks for a path."""
SAME = 1e-6  # [m]


def import_ompl() -> tuple[Any, Any]:
    """Return OMPL's modules `base` and `geometric`, set to log errors only.

    Raises:
        JaxleasError: OMPL is not installed.
    """
    try:
        from ompl import base, geometric, util
    except ImportError as error:
        raise JaxleasError(
            "roadmaps need OMPL: install the extra 'roadmaps', pip install 'jaxleas[roadmaps]'"
        ) from error
    util.setLogLevel(util.LOG_ERROR)
    return base, geometric


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


def _leaves(motion: RootMotion) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return np.asarray(motion.position), np.asarray(motion.velocity), np.asarray(motion.yaw)


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

    space_information = _space(base, rrt)
    problem = base.ProblemDefinition(space_information)
    problem.addStartState(_state(space_information, rrt.start))
    region = Sampler(space_information)
    region.setThreshold(SAME)
    problem.setGoal(region)
    planner = geometric.RRT(space_information)
    planner.setRange(rrt.reach)
    planner.setGoalBias(1.0)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.PlannerTerminationCondition(lambda: rrt.ledger.budget.spent))
    return _solution(problem)


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

    space_information = _space(base, prm)
    space_information.setValidStateSamplerAllocator(lambda information: Sampler(information))
    problem = base.ProblemDefinition(space_information)
    problem.setStartAndGoalStates(
        _state(space_information, start), _state(space_information, goal), SAME
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
            return _solution(problem)
    return None


def _joined(prm: Prm, start: Key, goal: Key) -> bool:
    import networkx

    net = networkx.Graph(prm.edges)
    return start in net and goal in net and networkx.has_path(net, start, goal)


def _space(base: Any, planner: Rrt | Prm) -> Any:
    """Return OMPL's description of the places, which leaves every decision to `planner`."""

    class Validator(base.MotionValidator):
        def checkMotion(self, origin: Any, target: Any) -> bool:  # noqa: N802
            return planner.connects(key_of((origin[0], origin[1])), key_of((target[0], target[1])))

    class Checker(base.StateValidityChecker):
        def isValid(self, state: Any) -> bool:  # noqa: N802
            del state
            return True

    x_min, x_max, y_min, y_max = planner.ledger.connector.places.terrain.extent
    space = base.RealVectorStateSpace(2)
    bounds = base.RealVectorBounds(2)
    for axis, (low, high) in enumerate(((x_min, x_max), (y_min, y_max))):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    space.setBounds(bounds)
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(Checker(information))
    information.setMotionValidator(Validator(information))
    information.setup()
    return information


def _state(information: Any, place: Key) -> Any:
    state = information.allocState()
    state[0], state[1] = place
    return state


def _solution(problem: Any) -> list[Key] | None:
    if not problem.hasExactSolution():
        return None
    return [key_of((each[0], each[1])) for each in problem.getSolutionPath().getStates()]
