"""The function behind `jaxleas contacts export`."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.guide_file import RecordedGuide, read_recorded_guide
from jaxleas.contacts.plan import ContactPlan, read_plan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import read_problem
from jaxleas.contacts.sequence.files import (
    Sampling,
    require_sequence_name,
    write_footsteps,
    write_phases,
    write_schedule,
)
from jaxleas.contacts.sequence.from_plan import sequence_of_postures, sequence_of_steps
from jaxleas.contacts.sequence.timing import (
    apart,
    guide_times,
    rows_of_postures,
    rows_of_steps,
    steady_times,
)
from jaxleas.contacts.sequence.values import ContactSequence
from jaxleas.contacts.surfaces import ContactSurface, make_surface
from jaxleas.robots import PlannedRobot, load_robot, robot_for
from jaxleas.terrain import PLANE_SEARCH, READING, PlaneSearch, Reading, Scene, load_scene
from jaxleas.types import GuidePath, InputError

USUAL_STEP = 1.0
"""Time of a step where neither a guide path nor the user states one [s]."""
USUAL = Sampling()


def export(
    plan: Path,
    problem: Path | None = None,
    *,
    out: Path,
    guide: Path | None = None,
    scene: Path | None = None,
    query: int = 0,
    robot: str | None = None,
    step_time: float | None = None,
    standing: float = 0.2,
    sampling: Sampling = USUAL,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
) -> ContactSequence:
    """Write a contact plan for other programs: footsteps, phases, or a schedule of nodes.

    Args:
        plan: file of the contact plan, .json.
        problem: file of the contact problem that it answers, .json; a plan of sampling needs only
            --scene.
        out: footsteps (.csv), phases for Crocoddyl and multicontact-api (.json), or a schedule for
            mpx (.npz).
        guide: file of the guide path, .npz, which gives landings their times and a schedule its
            root.
        scene: scene that a plan of sampling crosses: .json, a mesh or a map.
        query: number of the path in the guide's file.
        robot: robot of a plan of sampling; by default the problem's, or the one that walked the
            guide path, or talos where no file says.
        step_time: time of each step instead of the guide path's, 1.0 without a guide path [s].
        standing: share of the time of each step in which all effectors stand.
        sampling: how a schedule is sampled.
        reading: what the scene's file does not state itself.
        search: what counts as a surface, if the scene is a map.
    """
    require_sequence_name(out)
    if scene is None and (reading != READING or search.given):
        raise InputError("options of a terrain file were given without --scene, which they are of")
    made = read_plan(plan)
    steps = 0 if made.footholds is None else len(made.footholds)
    if not steps:
        raise InputError(f"{plan} is '{made.status}' and has no footholds: nothing can be written")
    asked = None if problem is None else read_problem(problem)
    walked = None if guide is None else read_recorded_guide(guide, query)
    path = None if walked is None else walked.guide
    planned = _planned_robot(walked, robot or (asked.robot if asked else None), guide)
    rows = None if path is None else _rows(made, asked, path)
    raw = _times(steps, rows, path, step_time)
    times = apart(plan, raw)
    if made.postures is not None:
        ground = None if scene is None else load_scene(scene, reading, search)
        surfaces = _surfaces(plan, asked, ground, scene)
        sequence = sequence_of_postures(made, surfaces, load_robot(planned.name), times, standing)
    elif asked is None:
        raise InputError(
            f"{plan} is of the {made.planner} planner: say which problem it answers: jaxleas"
            f" contacts export {plan} PROBLEM.json --out {out}"
        )
    else:
        sequence = sequence_of_steps(asked, made, times, standing)
    match out.suffix.lower():
        case ".csv":
            said = write_footsteps(out, sequence)
        case ".json":
            said = write_phases(out, sequence)
        case _:
            said = write_schedule(out, sequence, sampling, _in_time(path, rows, times))
    early = "" if made.feasible else f"; the plan ends early: {made.reason}"
    if rows is None and step_time is None:
        print(f"{plan}: {USUAL_STEP:g} s a step; --guide or --step-time say otherwise")
    print(f"{plan}: {said}{early}\nwritten to {out}")
    return sequence


def _planned_robot(
    walked: RecordedGuide | None, named: str | None, guide: Path | None
) -> PlannedRobot:
    """Return the robot of a plan, which must be the one that walked its guide path."""
    walker = robot_for(None if walked is None else walked.robot, named, guide)
    if walker.note:
        print(walker.note)
    return walker


def _rows(plan: ContactPlan, problem: ContactProblem | None, guide: GuidePath) -> list[int]:
    if plan.postures is not None:
        return rows_of_postures(plan)
    assert plan.footholds is not None
    return [] if problem is None else rows_of_steps(problem, guide, len(plan.footholds))


def _times(
    steps: int,
    rows: list[int] | None,
    guide: GuidePath | None,
    step_time: float | None,
) -> Float[np.ndarray, " L"]:
    if guide is not None and rows is not None and step_time is None:
        return guide_times(rows, guide)
    return steady_times(steps, USUAL_STEP if step_time is None else step_time)


def _surfaces(
    plan: Path, problem: ContactProblem | None, ground: Scene | None, where: Path | None
) -> dict[str, ContactSurface]:
    if ground is not None:
        named = ground.surfaces.items()
        return {name: make_surface(each, f"{where}: '{name}'") for name, each in named}
    if problem is not None:
        return problem.surfaces
    raise InputError(
        f"{plan} holds postures along a guide path: say the surfaces that it stands on, with"
        " --scene SCENE.json, or its PROBLEM.json"
    )


def _in_time(
    guide: GuidePath | None, rows: list[int] | None, times: Float[np.ndarray, " L"]
) -> GuidePath | None:
    """Return a guide path in the time of a sequence, whose landings come at other times."""
    if guide is None or rows is None:
        return None
    own = np.concatenate([[0.0], guide_times(rows, guide)])
    since = np.asarray(guide.time, np.float64) - float(guide.time[0])
    return replace(guide, time=np.interp(since, own, np.concatenate([[0.0], times])))
