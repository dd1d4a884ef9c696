"""Robots that cross a course, all starts at once."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from jaxleas.controllers import Switching, Walk, find_controller
from jaxleas.crossing import (
    BlindCommander,
    Course,
    Crossing,
    InTurn,
    MapErrors,
    PlanningCommander,
    Tally,
    WalkSettings,
    cross,
    standing_on,
    tally,
    together,
)
from jaxleas.footsteps import (
    FootCostMap,
    FootstepPlanner,
    MotionModel,
    Planner,
    buffer_of,
    shipped_model,
)
from jaxleas.physics import BodyState, load_body, make_physics
from jaxleas.terrain import HeightMap, SceneEdges, rasterise
from jaxleas.types import ControllerIdentity

CELL, COARSE = 0.01, 0.02
"""Edge of a cell of the true map, and of the noisy one [m]."""
NOISE, SHIFT = 0.01, 0.02
"""Errors of the noisy map [m]."""
SECONDS = 60.0
"""Time that a robot gets for a course [s]."""
CONTROLLER, BODY = "trot", "anymal_b"


@dataclass(frozen=True)
class Crossed:
    """What became of some robots on one course.

    Attributes:
        crossings: one for each robot.
        counts: what was counted of all together.
        controller: identity of the controller that walked.
    """

    crossings: Sequence[Crossing]
    counts: Tally
    controller: ControllerIdentity

    @property
    def reached(self) -> int:
        """Number of robots that stand at the goal."""
        return sum(each.outcome == "reached" for each in self.crossings)

    def share_of(self, controller: str) -> float:
        """Return the share of all footsteps that a controller made [%]."""
        made = [each.controller for one in self.crossings for each in one.footsteps]
        return 100.0 * made.count(controller) / max(len(made), 1)

    @property
    def endings(self) -> str:
        """How the robots ended, counted."""
        names = [each.outcome for each in self.crossings]
        return ", ".join(f"{names.count(name)} {name}" for name in sorted(set(names)))


def planner_on(course: Course, settings: WalkSettings) -> FootstepPlanner:
    """Return a planner of the first controller on the true map of a course."""
    model = shipped_model(find_controller(CONTROLLER, load_body(BODY)).identity)
    return _planner(model, rasterise(course.scene, CELL, 0.5), settings)


def _planner(model: MotionModel, height_map: HeightMap, settings: WalkSettings) -> FootstepPlanner:
    return FootstepPlanner(model, FootCostMap.of(height_map, buffer_of(model)), settings.search)


def crossed(
    course: Course,
    count: int,
    seed: int,
    noisy: bool = False,
    controller: str = CONTROLLER,
    watched: Callable[[FootstepPlanner], Planner] = lambda planner: planner,
) -> Crossed:
    """Return what became of robots that plan at each contact.

    Args:
        course: course to cross.
        count: number of starts.
        seed: seed of the starts, and of the errors of each robot's map.
        noisy: whether each robot's map is noisy and shifted.
        controller: name of the controller that walks.
        watched: what asks the planner in a robot's place.
    """
    settings = WalkSettings()
    walk, start = _walk(course, course.starts(count, seed), controller)
    model = shipped_model(walk.controller.identity)
    true = rasterise(course.scene, COARSE if noisy else CELL, 0.5)
    errors = [MapErrors(NOISE, SHIFT, seed + robot) for robot in range(count)]
    errors = errors if noisy else [MapErrors()]  # the true map serves all robots
    planners = [watched(_planner(model, each.of(true), settings)) for each in errors]
    commanders = [
        PlanningCommander(planners[robot % len(planners)], course.goals) for robot in range(count)
    ]
    return _judged(course, walk, cross(walk, start, commanders, SECONDS))


def crossed_in_turn(course: Course, count: int, seed: int, controllers: Sequence[str]) -> Crossed:
    """Return what became of robots whose controllers take turns, by the terrain ahead.

    Args:
        course: course to cross.
        count: number of starts.
        seed: seed of the starts.
        controllers: names of the controllers.
    """
    settings, body = WalkSettings(), load_body(BODY)
    walkers = [find_controller(name, body) for name in controllers]
    models = [shipped_model(each.identity) for each in walkers]
    true = rasterise(course.scene, CELL, 0.5)
    turns = InTurn(walkers, models, true, course.goals, settings, body)
    starts = course.starts(count, seed)
    walk = Walk(make_physics(body, count, course.scene), Switching(walkers))
    commanders = [PlanningCommander(turns.planner(), course.goals) for _ in starts]
    start = standing_on(course.scene, body, starts)
    return _judged(course, walk, cross(walk, start, commanders, SECONDS))


def crossed_blind(course: Course, count: int, seed: int, shares: Sequence[float]) -> Crossed:
    """Return what became of robots that go straight ahead, at several speeds.

    Args:
        course: course to cross.
        count: number of starts at each speed.
        seed: seed of the starts.
        shares: speeds over the largest.
    """
    starts = course.starts(count, seed)
    walk, start = _walk(course, [each for _ in shares for each in starts])
    commanders = [
        BlindCommander(walk.controller.identity, course.goals, share)
        for share in shares
        for _ in range(count)
    ]
    return _judged(course, walk, cross(walk, start, commanders, SECONDS))


def _walk(
    course: Course, starts: Sequence[tuple[float, float, float]], controller: str = CONTROLLER
) -> tuple[Walk, BodyState]:
    body = load_body(BODY)
    physics = make_physics(body, len(starts), course.scene)
    return Walk(physics, find_controller(controller, body)), standing_on(course.scene, body, starts)


def _judged(course: Course, walk: Walk, crossings: Sequence[Crossing]) -> Crossed:
    edges, identity = SceneEdges.of(course.scene), walk.controller.identity
    counts = [tally(each, edges, identity) for each in crossings]
    return Crossed(crossings, together(counts), identity)


def worst_unsafe(found: Sequence[Crossed]) -> float:
    """Return the share of unsafe landings of the worst foot on the worst course [%]."""
    return float(np.max([each.counts.unsafe_share for each in found]))
