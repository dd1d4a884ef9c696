"""What is measured on the scenarios of the thesis: walks planned and blind, and times of plans."""

import os
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from benchmarks.quadruped.blind_rows import SPEEDS
from benchmarks.quadruped.plans import Question, Recorder
from benchmarks.quadruped.starts import Starts, shown
from benchmarks.quadruped.walks import Crossed, crossed, crossed_blind, planner_on
from jaxleas.crossing import Course, Crossing, Tally, WalkSettings, tally
from jaxleas.terrain import SceneEdges
from jaxleas.types import ControllerIdentity

HORIZON = 2
"""Footsteps ahead, as in the thesis, at which the times of plans are measured."""


@dataclass(frozen=True)
class Run:
    """What is counted of one robot, in the thesis's units.

    Attributes:
        outcome: how it ended.
        landings: number of landings of each foot.
        unsafe: number of those nearer than 1.5 cm to an edge.
        nearest: least distance of a landing from an edge [cm]; None if there are no edges.
        com: mean absolute errors of predictions: x, y [cm], heading [rad]; None if none was made.
        landing: mean absolute errors of landings: x, y [cm]; likewise.
    """

    outcome: str
    landings: list[int]
    unsafe: list[int]
    nearest: float | None
    com: list[float] | None
    landing: list[float] | None


@dataclass(frozen=True)
class Times:
    """Processor times of plans [ms]."""

    plans: int
    mean: float
    most: float


def measure(course: Course, starts: Starts, is_drawn: bool) -> dict[str, Any]:
    """Return all that the tables and figures show of a course, as plain values.

    Args:
        course: course to cross.
        starts: starts of planned robots, and of blind ones at each speed.
        is_drawn: whether the footsteps of the first robot are kept.
    """
    asked: list[Question] = []
    found = crossed(
        *(course, starts.count, starts.seed),
        watched=lambda planner: Recorder(planner, asked),
    )
    shown(course.name, found)
    edges = SceneEdges.of(course.scene)
    return {
        "starts": starts.count,
        "planned": _runs(found, edges),
        "blind": _blind(course, starts, edges),
        "times": asdict(_timed(course, asked)),
        "load": round(os.getloadavg()[0], 1),
        "walk": _walk(found.crossings[0], found.controller) if is_drawn else [],
    }


def _blind(course: Course, starts: Starts, edges: SceneEdges) -> dict[str, list[dict[str, Any]]]:
    """Return what became of blind robots, by speed over the largest."""
    found = shown(f"{course.name}, blind", crossed_blind(course, starts.count, starts.seed, SPEEDS))
    runs = _runs(found, edges)  # all starts at the first speed come first
    return {
        str(speed): runs[index * starts.count : (index + 1) * starts.count]
        for index, speed in enumerate(SPEEDS)
    }


def _runs(found: Crossed, edges: SceneEdges) -> list[dict[str, Any]]:
    return [asdict(_run(each, edges, found.controller)) for each in found.crossings]


def _run(crossing: Crossing, edges: SceneEdges, controller: ControllerIdentity) -> Run:
    counts: Tally = tally(crossing, edges, controller)
    com, landing = (_mean(each) for each in (counts.pose_errors, counts.landing_errors))
    if com is not None and landing is not None:
        com = [round(100.0 * com[0], 3), round(100.0 * com[1], 3), round(com[2], 5)]
        landing = [round(100.0 * each, 3) for each in landing]
    nearest = 100.0 * float(counts.nearest.min(initial=np.inf))
    return Run(
        *(crossing.outcome, counts.landings.tolist(), counts.unsafe.tolist()),
        round(nearest, 2) if np.isfinite(nearest) else None,
        *(com, landing),
    )


def _mean(errors: np.ndarray) -> list[float] | None:
    return errors.mean(axis=0).tolist() if len(errors) else None


def _timed(course: Course, asked: Sequence[Question]) -> Times:
    """Return the processor times of plans two footsteps ahead, asked again what robots asked."""
    planner = planner_on(course, replace(WalkSettings(), horizon=HORIZON))
    planner.plan(asked[0].state, asked[0].goal)  # warm
    times = []
    for each in asked:
        begin = time.process_time()
        planner.plan(each.state, each.goal)
        times.append(1000.0 * (time.process_time() - begin))
    return Times(len(times), round(float(np.mean(times)), 3), round(max(times), 3))


def _walk(crossing: Crossing, controller: ControllerIdentity) -> list[dict[str, Any]]:
    """Return the footsteps of one robot: where they were planned, and where they led [m]."""
    footsteps = []
    for each in crossing.footsteps:
        swung = list(controller.pairs[each.expected if each.pair is None else each.pair])
        planned = None
        if each.planned is not None and each.planned.pair == each.pair:
            feet = _rounded(each.planned.feet[swung])
            planned = {"com": _rounded(each.planned.com), "feet": feet}
        walked = {"com": _rounded(each.com), "feet": _rounded(each.feet[swung])}
        footsteps.append({**walked, "planned": planned})
    return footsteps


def _rounded(places: np.ndarray) -> list[Any]:
    return np.round(places, 3).tolist()
