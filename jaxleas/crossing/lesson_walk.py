"""Robots that walk a lesson, while a planner is asked what it would do."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from jaxleas.controllers import Controller, Ticked, Walk
from jaxleas.crossing.commanders import PlanningCommander
from jaxleas.crossing.crossing import cross
from jaxleas.crossing.ground_start import standing_on
from jaxleas.crossing.lesson_file import Choice, LessonNotes, LessonRows
from jaxleas.crossing.lessons import Lesson
from jaxleas.crossing.walk_settings import WalkSettings
from jaxleas.footsteps import (
    FootCostMap,
    FootstepPlan,
    FootstepPlanner,
    Goal,
    MotionModel,
    Planner,
    Proposal,
    ProposalSession,
    ProposedPlanner,
    WalkingState,
    buffer_of,
    node_after,
    start_node,
)
from jaxleas.physics import Body, make_physics
from jaxleas.terrain import rasterise

CELL, MARGIN = 0.01, 0.5
"""Edge of a cell of the map, and what is around the scene [m]."""
DEEP = 4
"""Footsteps of a plan whose commands are choices, too: each in the state that is predicted."""


@dataclass(frozen=True)
class School:
    """What lessons are walked with.

    Attributes:
        body: robot.
        controller: controller that walks.
        model: its motion models.
        settings: how it is walked, and for how long.
        robots: number of robots that walk a lesson at once.
        share: share of the contacts at which the planner is asked where it does not walk itself.
    """

    body: Body
    controller: Controller
    model: MotionModel
    settings: WalkSettings
    robots: int
    share: float

    def costs(self, lesson: Lesson) -> FootCostMap:
        """Return the foot cost map of a lesson."""
        return FootCostMap.of(rasterise(lesson.course.scene, CELL, MARGIN), buffer_of(self.model))


class Teacher:
    """A planner whose answers are kept.

    Args:
        planner: planner that is asked.
        model: its motion models.
        costs: foot cost map.

    Attributes:
        chosen: what it chose, and what it would choose in the states that it planned.
    """

    def __init__(self, planner: Planner, model: MotionModel, costs: FootCostMap) -> None:
        self._planner, self._model, self._costs = planner, model, costs
        self.chosen: list[Choice] = []

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the planner's plan, and keep its first footsteps."""
        plan = self._planner.plan(state, goal)
        node = start_node(state, self._costs)
        for footstep in plan.footsteps[:DEEP]:
            self.chosen.append((node, goal, footstep.command))
            node = node_after(self._model, node, footstep)
        return plan


class Pupil:
    """A proposal that walks, and asks its teacher more often than it must.

    Args:
        proposed: proposal, whose planner is the teacher.
        teacher: what is asked.
        share: share of the contacts at which the teacher is asked although the proposal goes on.
        rng: source of these contacts.
    """

    def __init__(
        self, proposed: ProposedPlanner, teacher: Teacher, share: float, rng: np.random.Generator
    ) -> None:
        self._proposed, self._teacher, self._share, self._rng = proposed, teacher, share, rng

    def plan(self, state: WalkingState, goal: Goal) -> FootstepPlan:
        """Return the proposal's plan."""
        before = self._proposed.searched
        plan = self._proposed.plan(state, goal)
        if self._proposed.searched == before and self._rng.uniform() < self._share:
            self._teacher.plan(state, goal)
        return plan


def walk_lesson(
    school: School,
    lesson: Lesson,
    proposal: Proposal | None,
    key: str,
    shown: Callable[[], None] = lambda: None,
) -> tuple[LessonRows, LessonNotes]:
    """Return the planner's choices in a lesson.

    Args:
        school: what lessons are walked with.
        lesson: lesson to walk.
        proposal: proposal that walks and asks the planner where it must; None: the planner walks.
        key: digest of all this, for the notes.
        shown: function called at each tick.

    Raises:
        KeyboardInterrupt: a person stopped it.
    """
    rng = np.random.default_rng((lesson.number, 1))
    costs, model, search = school.costs(lesson), school.model, school.settings.search
    teacher = Teacher(FootstepPlanner(model, costs, search), model, costs)
    walker: Planner = teacher
    proposed: ProposedPlanner | None = None
    if proposal is not None:
        session = ProposalSession(proposal)
        proposed = ProposedPlanner(session, model, costs, search, planner=teacher)
        walker = Pupil(proposed, teacher, school.share, rng)
    course, count = lesson.course, school.robots
    start = standing_on(course.scene, school.body, course.starts(count, lesson.number))
    walk = Walk(make_physics(school.body, count, course.scene), school.controller)
    commanders = [
        PlanningCommander(walker, lesson.goals, lesson.number + robot) for robot in range(count)
    ]

    def observe(ticked: Ticked, command: Float[np.ndarray, "N 3"]) -> None:
        del ticked, command
        shown()

    found = cross(walk, start, commanders, school.settings.seconds, observe)
    if any(each.outcome == "interrupted" for each in found):
        raise KeyboardInterrupt
    rows = LessonRows.of(teacher.chosen, len(model.controller.feet))
    notes = LessonNotes(key, course.name, tuple(each.outcome for each in found), 0, 0)
    if proposed is not None:
        notes = replace(notes, asked=proposed.asked, searched=proposed.searched)
    return rows, notes
