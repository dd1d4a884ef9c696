"""A learned proposal in the planner's place: success, how often the planner is asked, times."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.contacts.rows import Row
from benchmarks.measurements import read_measurements
from benchmarks.quadruped.walks import BODY, CELL, CONTROLLER, Crossed, crossed
from jaxleas.controllers import Walk, find_controller
from jaxleas.crossing import WalkSettings, make_course, measured_at_start, standing_on
from jaxleas.footsteps import (
    SURE,
    FootCostMap,
    MotionModel,
    Proposal,
    ProposalSession,
    ProposalSight,
    ProposedPlanner,
    buffer_of,
    shipped_model,
    shipped_proposal,
    start_node,
)
from jaxleas.physics import load_body, make_physics
from jaxleas.terrain import HELD_OUT_SEED, rasterise
from jaxleas.types import InputError

SHARE, MICROSECONDS = 95.0, 50.0  # this project's own targets [%], [us]
REPEATS, ANSWERS = 3, 5000
Show = Callable[[str, Crossed], Crossed]


@dataclass(frozen=True)
class Proposed:
    """What became of robots with a proposal on some courses.

    Attributes:
        found: what became of them, by course.
        planners: their planners, by course.
    """

    found: list[Crossed]
    planners: list[ProposedPlanner]

    @property
    def reached(self) -> int:
        """Number of robots at the goal."""
        return sum(each.reached for each in self.found)


def proposal_rows(
    courses: Sequence[str], starts: int, seed: int, planned: int, show: Show
) -> Iterator[Row]:
    """Yield the proposal's share of the planner's success, and the times of its answers.

    Args:
        courses: names of the courses that robots cross.
        starts: number of starts on each.
        seed: seed of the starts.
        planned: number of these starts from which the planner reaches its goal.
        show: function that shows what came of a course, and returns it.
    """
    where = f"% of the planner's {planned} of {len(courses) * starts}"
    checked = proposed_on(courses, starts, seed, SURE, show)
    yield Row("proposal_success", where, [_share(checked, planned)], limit=SHARE, better="higher")
    asked = sum(each.asked for each in checked.planners)
    searched = sum(each.searched for each in checked.planners)
    yield Row("proposal_searched", f"% of {asked} plans", [100.0 * searched / max(asked, 1)])
    worst = max(float(np.max(each.counts.unsafe_share)) for each in checked.found)
    yield Row("proposal_unsafe_worst", "% of landings", [worst])
    alone = proposed_on(courses, starts, seed, None, show)
    yield Row("proposal_alone_success", where, [_share(alone, planned)], better="higher")
    yield from time_rows(courses[0])


def planned_before(path: Path, starts: dict[str, int]) -> int:
    """Return from how many starts the planner reached its goal, as measured before.

    Args:
        path: benchmark file.
        starts: number of starts of each figure of success in it.

    Raises:
        InputError: a figure is missing.
    """
    known = {each.name: each.value for each in read_measurements(path)}
    missing = [name for name in starts if known.get(name) is None]
    if missing:
        raise InputError(f"proposal: {path} has no {' and no '.join(missing)}: measure them first")
    return round(sum(count * (known[name] or 0.0) / 100.0 for name, count in starts.items()))


def proposed_on(
    courses: Sequence[str],
    starts: int,
    seed: int,
    sure: float | None,
    show: Show,
    proposal: Proposal | None = None,
) -> Proposed:
    """Return what became of robots whose commands a proposal chooses; by default the shipped one.

    Args:
        courses: names of the courses.
        starts: number of starts on each.
        seed: seed of the starts.
        sure: least probability of commands that are taken; None for the network alone.
        show: function that shows what came of a course, and returns it.
        proposal: proposal.
    """
    found, planners = [], []
    for name in courses:
        course = make_course(name)
        model, costs = _model(), _costs(name)
        chosen = shipped_proposal(model.controller) if proposal is None else proposal
        session = ProposalSession(chosen)
        planner = ProposedPlanner(session, model, costs, WalkSettings().search, sure)
        made = crossed(course, starts, seed, watched=lambda _, planner=planner: planner)
        found.append(show(f"{name}, {'alone' if sure is None else 'checked'}", made))
        planners.append(planner)
        print(planner.in_words(), flush=True)
    return Proposed(found, planners)


def time_rows(name: str) -> Iterator[Row]:
    """Yield the times of one answer: of the network alone, and with all that is around it.

    Args:
        name: name of a course, at whose start the robot stands.
    """
    model, costs = _model(), _costs(name)
    proposal = shipped_proposal(model.controller)
    session, settings = ProposalSession(proposal), WalkSettings().search
    course = make_course(name)
    body = load_body(BODY)
    walk = Walk(make_physics(body, 1, course.scene), find_controller(CONTROLLER, body))
    stands = standing_on(course.scene, body, course.starts(1, HELD_OUT_SEED))
    state, goal = measured_at_start(walk, stands), course.goals[0]
    node = start_node(state, costs)
    sight = ProposalSight(model, costs, model.commands())
    inputs = sight.of(node, goal)
    planner = ProposedPlanner(session, model, costs, settings)
    for label, answer in (
        ("proposal_time", lambda: session.scores(inputs)),
        ("proposal_time_numpy", lambda: proposal.scores(inputs)),
        ("proposal_time_inputs", lambda: sight.of(node, goal)),
        ("proposal_time_whole", lambda: planner.plan(state, goal)),
    ):
        limit = MICROSECONDS if label == "proposal_time" else None
        yield Row(label, "us, median", [_median(answer) for _ in range(REPEATS)], limit=limit)


def _median(answer: Callable[[], object]) -> float:
    """Return the median time of an answer [us]."""
    times = []
    for _ in range(ANSWERS):
        begin = time.perf_counter()
        answer()
        times.append(time.perf_counter() - begin)
    return 1e6 * float(np.median(times))


def _share(found: Proposed, planned: int) -> float:
    return 100.0 * found.reached / max(planned, 1)


def _model() -> MotionModel:
    return shipped_model(find_controller(CONTROLLER, load_body(BODY)).identity)


def _costs(name: str) -> FootCostMap:
    return FootCostMap.of(rasterise(make_course(name).scene, CELL, 0.5), buffer_of(_model()))
