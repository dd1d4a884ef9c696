"""The guide path that a plan is checked against, and the report of the check."""

from pathlib import Path

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.guide_from_problem import guide_from_problem, scene_of_problem
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.plan_report import draw_along_guide
from jaxleas.contacts.planner import AskedGuide
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.problem_file import read_problem
from jaxleas.contacts.proof_check import certify_infeasible
from jaxleas.contacts.trunk import trunk_collision
from jaxleas.robots import load_robot
from jaxleas.runs import Progress
from jaxleas.terrain import Scene
from jaxleas.types import InputError, JaxleasError


class NotCertifiedError(JaxleasError):
    """A plan that violates its problem: an answer, not a bad input."""

    exit_code = 1


def followed_by(
    plan: Path,
    problem: Path | None,
    guide: Path | None,
    scene: Scene | None,
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


def check_footholds(plan: Path, read: ContactPlan, problem: Path, asked: ContactProblem) -> str:
    """Certify a plan of footholds, and return its tightest constraint in words.

    Args:
        plan: file of the plan, for messages.
        read: the plan.
        problem: file of the problem, for messages.
        asked: the problem that it answers.

    Raises:
        NotCertifiedError: the plan violates a constraint.
    """
    worst = certify(asked, read)
    verdict = f"{worst.constraint}, step {worst.step}: {worst.metres:.3g} m"
    if not worst.certified:
        raise NotCertifiedError(f"{plan} is no plan for {problem}: it violates the {verdict}")
    return verdict


def check_proof(plan: Path, read: ContactPlan, problem: Path, asked: ContactProblem) -> str:
    """Verify the proof of an answer that there is no plan, and return what it took in words.

    Args:
        plan: file of the answer, for messages.
        read: the answer, with its proof.
        problem: file of the problem, for messages.
        asked: the problem that it answers.

    Raises:
        NotCertifiedError: the proof does not hold.
    """
    assert read.proof is not None
    with Progress(len(read.proof.sets)) as progress:
        report = certify_infeasible(asked, read.proof, progress.update)
    if not report.holds:
        raise NotCertifiedError(f"{plan} is no proof for {problem}: {report.complaint}")
    return (
        f"{report.sets} sets of places, of {report.programs} steps from a set onto a surface by"
        " linear programs"
    )


def check_trunk(
    plan: Path, guide: Path | None, scene: Scene | None, query: int, robot: str | None
) -> str:
    """Return what is certain of the trunk of a plan of footholds alone, as a clause.

    Args:
        plan: file of the plan, for messages.
        guide: file of the guide path that it follows, if known.
        scene: scene that it crosses, if known.
        query: number of the path in the guide's file.
        robot: robot that a person named, if any.

    Raises:
        InputError: one of guide and scene is missing.
        NotCertifiedError: the trunk touches an obstacle.
    """
    from jaxleas.contacts.guide_robot import read_asked

    if guide is None and scene is None:
        return "obstacles of the trunk were not looked at, which takes --guide and --scene"
    if guide is None or scene is None:
        raise InputError("--guide and --scene belong together: both are needed to check the trunk")
    asked, _ = read_asked(guide, query, scene, robot)
    touched = trunk_collision(load_robot(asked.robot), asked.scene, asked.guide)
    if touched is not None:
        raise NotCertifiedError(f"{plan} is no plan for {guide}: {touched.sentence}")
    return "the trunk touches nothing along the guide path"


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
