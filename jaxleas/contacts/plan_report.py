"""A planner's answer: written, drawn and described in one line."""

from pathlib import Path

from jaxleas.contacts.plan import ContactPlan, write_plan
from jaxleas.contacts.planner import AskedGuide
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.registry import PLANNERS, find_planner
from jaxleas.robots import load_robot
from jaxleas.types import Ending, GuidePath

_OF_GUIDE: dict[Ending | None, str] = {
    "reached": "; the guide path reaches its goal",
    "invalid": "; the guide path itself ends invalid",
    "stopped": "; the guide path itself stops before its goal",
}
FOR_PICTURE = 10.0
"""Time limit for drawing how far a failed plan could go [s]."""


def report_plan(
    answer: ContactPlan, asked: ContactProblem | AskedGuide, out: Path, picture: Path | None
) -> ContactPlan:
    """Write a plan, draw it, and print what came of it, and of the guide path that it follows."""
    write_plan(out, answer)
    if isinstance(asked, ContactProblem):
        if picture is not None:
            draw(picture, asked, answer)
        words = describe(asked, answer)
    else:
        if picture is not None:
            draw_along_guide(picture, answer, asked)
        words = describe_along_guide(asked.guide, answer)
    print(f"{words}{_OF_GUIDE.get(answer.guide_ended, '')}\nwritten to {out}")
    return answer


def describe(problem: ContactProblem, found: ContactPlan) -> str:
    """Return a description of a plan in one line."""
    tried = ""
    if found.undecided is not None:
        tried = f", {found.undecided} undecided, {found.combinations} combinations"
    timing = f"{len(problem)} steps in {1000.0 * found.seconds:.0f} ms{tried}"
    if found.feasible:
        return f"{found.planner}: feasible, {timing}, certified to {found.max_violation:.1g} m"
    reach = ""
    if found.last_feasible_step is not None:
        reach = f" ({found.last_feasible_step + 1} of {len(problem)} steps can be made)"
    return f"{found.planner}: {found.status}{reach}, {timing}: {found.reason}"


def describe_along_guide(guide: GuidePath, found: ContactPlan) -> str:
    """Return a description of a sampling plan in one line."""
    postures = found.postures or ()
    steps = f"{len(found.surfaces)} steps in {1000.0 * found.seconds:.0f} ms"
    if found.robustness:
        steps += f", least robustness {min(found.robustness):.3g} N"
    if found.feasible:
        return f"{found.planner}: feasible, {steps}, certified to {found.max_violation:.1g} m"
    reached = postures[-1].configuration if postures else -1
    where = f"configuration {reached} of {len(guide) - 1} reached"
    return f"{found.planner}: {found.status} ({where}), {steps}: {found.reason}"


def draw(
    picture: Path, problem: ContactProblem, found: ContactPlan, guide: GuidePath | None = None
) -> None:
    """Draw a plan, or how far it could go."""
    from jaxleas.contacts.pictures import draw_plan

    draw_plan(picture, problem, found, guide, _as_far_as_it_goes(problem, found))


def draw_along_guide(picture: Path, found: ContactPlan, asked: AskedGuide) -> None:
    """Draw a plan that follows a guide path."""
    from jaxleas.contacts.plan_sampling import problem_of_steps

    steps = problem_of_steps(found, asked.guide, asked.scene, load_robot(asked.robot))
    draw(picture, steps, found, asked.guide)


def _as_far_as_it_goes(problem: ContactProblem, found: ContactPlan) -> ContactPlan | None:
    """Plan the steps before the first that cannot be made, for a picture."""
    count = 0 if found.last_feasible_step is None else found.last_feasible_step + 1
    if found.feasible or found.planner not in PLANNERS or not 0 < count < len(problem):
        return None
    planner = find_planner(found.planner)
    if planner.needs != "problem":
        return None
    settings, prefix = planner.plan_settings(), problem.prefix(count)
    made = planner.plan(prefix, settings, time_limit=FOR_PICTURE, diagnose=False)
    return made if made.feasible else None
