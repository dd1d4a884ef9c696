"""The guide path that a plan is checked against, and the report of the check."""

from pathlib import Path

from jaxleas.contacts.guide_from_problem import guide_from_problem, scene_of_problem
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.plan_report import draw_along_guide
from jaxleas.contacts.planner import AskedGuide
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import read_problem
from jaxleas.robots import load_robot
from jaxleas.types import InputError, JaxleasError


class NotCertifiedError(JaxleasError):
    """A plan that violates its problem: an answer, not a bad input."""

    exit_code = 1


def followed_by(
    plan: Path,
    problem: Path | None,
    guide: Path | None,
    scene: Path | None,
    query: int,
    robot: str | None,
) -> AskedGuide:
    """Return the guide path that a plan follows, the scene and the robot."""
    from jaxleas.contacts.guide_robot import read_asked

    if problem is not None and guide is None and scene is None:
        return along_roots(read_problem(problem), robot)
    if problem is None and guide is not None and scene is not None:
        return read_asked(guide, query, scene, robot)[0]
    raise InputError(
        f"{plan} holds postures along a guide path: it is checked against its guide and scene,"
        " with --guide GUIDE.npz --scene SCENE.json, or against a PROBLEM.json"
    )


def along_roots(problem: ContactProblem, robot: str | None = None) -> AskedGuide:
    """Return the guide path through a problem's roots, over its surfaces."""
    guide, scene = guide_from_problem(problem), scene_of_problem(problem)
    return AskedGuide(robot or problem.robot, guide, scene)


def check_postures(
    plan: Path, read: ContactPlan, asked: AskedGuide, what: str, picture: Path | None
) -> None:
    """Certify a plan of postures, and print the result.

    Args:
        plan: file of the plan, for messages.
        read: the plan.
        asked: guide path that it follows, with scene and robot.
        what: name of the problem or guide that it answers, for messages.
        picture: file to draw the plan to; None for no picture.

    Raises:
        NotCertifiedError: the plan violates a constraint.
    """
    from jaxleas.contacts.posture_certificate import certify_postures

    certificate = certify_postures(read, asked.guide, asked.scene, load_robot(asked.robot))
    if picture is not None:
        draw_along_guide(picture, read, asked)
    if not certificate.certified:
        raise NotCertifiedError(f"{plan} is no plan for {what}: {certificate.complaint}")
    worst, end = certificate.worst, "" if read.feasible else f", which end early: {read.reason}"
    print(
        f"{plan} is certified: {len(read.postures or ())} postures, nothing violated (tightest:"
        f" {worst.constraint}, posture {worst.step}: {worst.metres:.3g} m), least robustness"
        f" {certificate.least_robustness:.3g} N{end}"
    )
