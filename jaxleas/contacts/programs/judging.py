"""Programs as judges: guide path and scene -> contact problem -> verdict (T 5.2.3)."""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from jaxleas.contacts.from_guide import (
    MOST_ASIDE,
    NoGroundError,
    Stepping,
    kept_configurations,
    problem_from_guide,
)
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import PlannerError, mean_step
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.prefix import last_feasible_step
from jaxleas.contacts.programs.settings import ProgramSettings
from jaxleas.contacts.reference import widest_reference
from jaxleas.contacts.trunk import trunk_collision
from jaxleas.robots import load_robot
from jaxleas.terrain import Scene
from jaxleas.types import NO_MEASURES, Cause, GuidePath, PathProgress, PlannerMeasures, Verdict

Program = Callable[[ContactProblem, float], ContactPlan]
"""Plans a problem within a time limit [s], without looking for reasons."""


def judge_by_program(
    asked: tuple[int, Scene, GuidePath], robot: str, settings: ProgramSettings, program: Program
) -> Verdict:
    """Ask a program about one guide path.

    Where there is no plan for the whole path, the last configuration reached is that of the last
    step of the longest prefix with a plan, found by binary search. Standing beside the first
    configuration already reaches it. Where the trunk touches an obstacle, the path ends there, and
    only its free part is planned.

    Args:
        asked: number of the guide path, scene to walk on, and the guide path.
        robot: name of the robot.
        settings: settings of the planner.
        program: planner of contact problems.

    Raises:
        InputError: the guide path cannot be used.
    """
    begun = time.perf_counter()
    number, scene, path = asked
    touched = trunk_collision(load_robot(robot), scene, path)
    stop = None if touched is None else _Stop("collision", touched.sentence)
    free = len(path) if touched is None else _free_length(path, settings, touched.index)
    if not free:
        return _verdict(_progress(number, path, settings, -1), stop, begun, NO_MEASURES)
    near = _around(robot, scene, path, settings.window)
    problem, lost = _problem(robot, near, path[:free], settings)
    if lost is not None:
        stop = _Stop("no_start" if lost.step < 0 else "no_ground", str(lost))
    if problem is None or free == 1:
        steps = -1 if lost is not None and lost.step < 0 else 0
        return _verdict(_progress(number, path, settings, steps), stop, begun, NO_MEASURES)
    search = _Search(problem, program, begun, settings.time_limit)
    first = search.plan(len(problem))
    measures = NO_MEASURES
    if first is None:
        stop = search.trouble
    else:
        measures = PlannerMeasures(undecided=first.undecided, combinations=first.combinations)
        if not first.feasible:
            last = last_feasible_step(problem, search.status)
            stop = search.trouble if last is None else _first_not_made(problem, last + 1, first)
    return _verdict(_progress(number, path, settings, search.made), stop, begun, measures)


class _Stop(NamedTuple):
    """Why a path was not followed to its end, as a value and as a sentence."""

    cause: Cause
    reason: str


class _Search:
    """Plans for various prefixes of a problem, within one time limit.

    `made` counts the steps of the longest prefix that has a certified plan.
    """

    def __init__(
        self, problem: ContactProblem, program: Program, begun: float, time_limit: float
    ) -> None:
        self.problem, self.program = problem, program
        self.deadline, self.time_limit = begun + time_limit, time_limit
        self.made = 0
        self.trouble: _Stop | None = None

    def plan(self, steps: int) -> ContactPlan | None:
        """Plan for the first steps; return None, and set `trouble`, if that is not decided."""
        left = max(self.deadline - time.perf_counter(), 1e-3)
        try:
            plan = self.program(self.problem.prefix(steps), left)
        except PlannerError as error:
            self.trouble = _Stop("planner_failed", f"the planner failed: {error}")
            return None
        if plan.status == "time_limit":
            limit = f"not decided within the time limit of {self.time_limit:g} s"
            self.trouble = _Stop("time_limit", limit)
            return None
        if plan.feasible:
            self.made = max(self.made, steps)
        return plan

    def status(self, prefix: ContactProblem) -> str:
        """Answer one question of the binary search."""
        plan = self.plan(len(prefix))
        return "failed" if plan is None else "optimal" if plan.feasible else "infeasible"


def _free_length(path: GuidePath, settings: ProgramSettings, blocked: int) -> int:
    """Return the number of configurations up to the last kept one before a blocked one."""
    kept = [0, *kept_configurations(len(path), settings.keep_every)]
    return max((1 + index for index in kept if index < blocked), default=0)


def _problem(
    robot: str, scene: Scene, path: GuidePath, settings: ProgramSettings
) -> tuple[ContactProblem | None, NoGroundError | None]:
    """Return the problem of the part of the path that has ground, and the error that ends it."""
    stepping = Stepping(
        model=settings.model,
        every=settings.keep_every,
        candidates=settings.candidates,
        window=settings.window,
        first_foot=_first_foot(robot, settings),
    )
    try:
        if len(path) == 1:  # no step to make, but a place to stand on is needed
            path = path[np.array([0, 0])]
        return problem_from_guide(path, scene, robot, stepping), None
    except NoGroundError as error:
        if error.step < 1:
            return None, error
        last = kept_configurations(len(path), settings.keep_every)[error.step - 1]
        return problem_from_guide(path[: last + 1], scene, robot, stepping), error


def _first_foot(robot: str, settings: ProgramSettings) -> str | None:
    """Return the foot that moves first; None for the robot's first, where it lacks the default."""
    is_stated = "first_foot" in settings.model_fields_set
    has_foot = settings.first_foot in load_robot(robot).foot_names
    return settings.first_foot if is_stated or has_foot else None


def _around(robot: str, scene: Scene, path: GuidePath, window: float) -> Scene:
    """Return the scene's surfaces that a foot can come near to along the path."""
    planned = load_robot(robot)
    legs = [planned.limbs[index].range_of_motion.vertices[:, :2] for index in planned.feet]
    reach = max(float(np.linalg.norm(each, axis=1).max()) for each in legs)
    reach = max(reach, window) + widest_reference(planned) + MOST_ASIDE
    places = np.asarray(path.position, dtype=np.float64)[:, :2]
    near = {}
    for name, vertices in scene.walkable.items():
        low, high = vertices[:, :2].min(axis=0) - reach, vertices[:, :2].max(axis=0) + reach
        if ((places >= low) & (places <= high)).all(axis=1).any():
            near[name] = vertices
    return Scene(near or scene.walkable, touch=dict.fromkeys(near or scene.walkable, "feet"))


def _first_not_made(problem: ContactProblem, number: int, plan: ContactPlan) -> _Stop:
    step = problem.steps[number]
    names = ", ".join(f"'{name}'" for name in step.candidates[:4])
    more = f" and {len(step.candidates) - 4} more" if len(step.candidates) > 4 else ""
    sentence = f"step {number} ({step.foot} onto {names}{more}) is the first not made"
    if plan.status == "infeasible":
        return _Stop("infeasible", sentence)
    return _Stop("not_found", f"{sentence} ({plan.reason})")


def _progress(number: int, path: GuidePath, settings: ProgramSettings, steps: int) -> PathProgress:
    """Return the part of a path followed by a number of steps; -1 for a path without a start."""
    kept = [0, *kept_configurations(len(path), settings.keep_every)][: len(path)]
    last = kept[steps] if steps >= 0 else -1
    return PathProgress(
        path=number,
        length=len(path),
        last_index=last,
        reached=(steps + 1) / len(kept),
        steps=max(steps, 0),
        mean_step=mean_step(path, last, steps),
    )


def _verdict(
    progress: PathProgress, stop: _Stop | None, begun: float, measures: PlannerMeasures
) -> Verdict:
    seconds = time.perf_counter() - begun
    if stop is None:
        return Verdict.succeeded(progress, seconds, measures)
    return Verdict.stopped(progress, stop.cause, stop.reason, seconds, measures)
