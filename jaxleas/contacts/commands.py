"""The functions behind `jaxleas plan` and `jaxleas contacts`."""

from pathlib import Path
from typing import Any

from jaxleas.contacts.along_guide import plan_along
from jaxleas.contacts.checking import along_roots
from jaxleas.contacts.from_guide import Candidates, Stepping, problem_from_guide
from jaxleas.contacts.models import model_note
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.plan_report import report_plan
from jaxleas.contacts.planner import AskedGuide, Planner
from jaxleas.contacts.planner_settings import in_words, plan_settings_from
from jaxleas.contacts.problem import ContactProblem, Model
from jaxleas.contacts.problem_file import read_problem, write_problem
from jaxleas.contacts.programs.settings import Cost
from jaxleas.contacts.registry import DEFAULT_PLANNER, PLANNERS, PlannerName, find_planner
from jaxleas.terrain import (
    PLANE_SEARCH,
    READING,
    PlaneSearch,
    Reading,
    load_scene,
    require_picture,
)
from jaxleas.types import InputError

NO_OBSTACLES = (
    "a problem file states no obstacles: whether the trunk touches any was not looked at; jaxleas"
    " contacts, and check with --guide and --scene, look"
)


def plan(
    problem: Path,
    *,
    planner: PlannerName = DEFAULT_PLANNER,
    out: Path,
    time_limit: float = 60.0,
    cost: Cost | None = None,
    without_guide: bool = False,
    max_combinations: int | None = None,
    picture: Path | None = None,
) -> ContactPlan:
    """Plan contacts for a problem file and write the certified plan.

    Args:
        problem: file of the contact problem, .json.
        planner: planner to use; one that follows guide paths walks along the roots of the steps.
        out: file of the plan, .json; where there is no plan it states the reason instead of
            footholds.
        time_limit: time limit [s]; a plan not found in time has the status time_limit.
        cost: cost that mip minimises: linear (L1) or quadratic distance of footholds from those
            that the guide suggests; none by default.
        without_guide: allow every surface in every step but the last.
        max_combinations: number of combinations after which sl1m gives up, 2000 by default.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    _require_writable_names(out, picture)
    found = find_planner(planner, [planner])
    if found.needs == "guide":
        _require_own_contacts(found, without_guide=without_guide or None, cost=_wanted(cost))
    settings = plan_settings_from(found, cost=_wanted(cost), max_combinations=max_combinations)
    asked = read_problem(problem)
    if found.needs == "guide":
        followed = along_roots(asked)
        answer = found.plan(followed, settings, time_limit=time_limit)
        report_plan(answer, followed, out, picture)
    else:
        if without_guide:
            asked = asked.without_guide()
        answer = found.plan(asked, settings, time_limit=time_limit)
        report_plan(answer, asked, out, picture)
    if answer.feasible:
        print(NO_OBSTACLES)
    return answer


def contacts(
    guide: Path,
    *,
    scene: Path,
    planner: PlannerName = DEFAULT_PLANNER,
    out: Path,
    problem: Path | None = None,
    query: int = 0,
    robot: str | None = None,
    model: Model | None = None,
    every: int | None = None,
    candidates: Candidates | None = None,
    window: float | None = None,
    time_limit: float = 60.0,
    cost: Cost | None = None,
    max_combinations: int | None = None,
    picture: Path | None = None,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
) -> ContactPlan:
    """Plan contacts along a guide path through a scene.

    Args:
        guide: file of the guide path, .npz.
        scene: terrain of the path: a scene (.json), a mesh, or a map, whose surfaces are found.
        planner: planner to use; those that need a contact problem get one made of the guide.
        out: file of the plan, .json.
        problem: file for the contact problem, .json, if it is to be kept.
        query: number of the path in the file.
        robot: robot whose step polytopes are used; by default the one that walked the guide path,
            or talos where its file does not say.
        model: two_com (with the centre of mass) or feet; by default two_com where the robot has two
            feet and step polytopes of its centre of mass.
        every: keep every N-th configuration; by default the planner's own number.
        candidates: surfaces in a window around the root (the default), or in the moving leg's
            range of motion (rom).
        window: edge of that window [m]; 0.8 by default.
        time_limit: time limit [s]; a plan not found in time has the status time_limit.
        cost: cost that mip minimises: linear (L1) or quadratic distance of footholds from those
            that the guide suggests; none by default.
        max_combinations: number of combinations after which sl1m gives up, 2000 by default.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
        reading: what the scene's file does not state itself.
        search: what counts as a surface, if the scene is a map.
    """
    from jaxleas.contacts.guide_robot import read_asked

    _require_writable_names(out, picture)
    found = find_planner(planner, [planner])
    options = {"model": model, "candidates": candidates, "window": window}
    given = {"cost": _wanted(cost), "max_combinations": max_combinations}
    if every is not None and every < 1:
        raise InputError(f"every {every} must be at least 1: every N-th configuration is kept")
    if found.needs == "guide":
        _require_own_contacts(found, problem=problem, **options, cost=given["cost"])
        settings = plan_settings_from(found, keep_every=every, **given)
        crossed = load_scene(scene, reading, search)
        followed, ending = read_asked(guide, query, crossed, robot)
        answer = found.plan(followed, settings, time_limit=time_limit)
        return report_plan(answer.but(guide_ended=ending), followed, out, picture)
    settings = plan_settings_from(found, **given)
    crossed = load_scene(scene, reading, search)
    followed, ending = read_asked(guide, query, crossed, robot)
    kept = found.settings().keep_every if every is None else every
    made = _problem(followed, kept, options)
    if note := model_note(model, followed.robot):
        print(note)
    if problem is not None:
        write_problem(problem, made)
    answer = plan_along(found, followed, made, kept, settings, time_limit)
    return report_plan(answer.but(guide_ended=ending), made, out, picture)


def _problem(asked: AskedGuide, every: int, options: dict[str, Any]) -> ContactProblem:
    """Make the contact problem of a guide."""
    chosen = {name: each for name, each in options.items() if each is not None}
    return problem_from_guide(
        asked.guide,
        asked.scene,
        asked.robot,
        Stepping(every=every, **chosen),
    )


def _wanted(cost: Cost | None) -> Cost | None:
    """Return the requested cost: "none" requests no cost, which every planner can give."""
    return None if cost == "none" else cost


def _require_writable_names(out: Path, picture: Path | None) -> None:
    """Refuse, before planning, files that could not be written after it."""
    if Path(out).suffix != ".json":
        raise InputError(f"--out {out}: contact plans are written as .json")
    if picture is not None:
        require_picture(picture)


def _require_own_contacts(planner: Planner, **given: object) -> None:
    """Refuse options that make contact problems, or choose among contacts given in one."""
    wrong = [f"--{name.replace('_', '-')}" for name, each in given.items() if each is not None]
    if wrong:
        others = [name for name in PLANNERS if find_planner(name).needs == "problem"]
        raise InputError(
            f"the {planner.name} planner chooses its own contacts: {', '.join(wrong)} is for"
            f" {in_words(others)}"
        )
