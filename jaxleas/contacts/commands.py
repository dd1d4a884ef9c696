"""The functions behind `jaxleas plan`, `check` and `contacts`."""

from pathlib import Path
from typing import Any, Literal

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.guide_from_problem import guide_from_problem, scene_of_problem
from jaxleas.contacts.plan import ContactPlan, read_plan, write_plan
from jaxleas.contacts.planners import PLANNERS, Cost, plan_mip, plan_sl1m
from jaxleas.contacts.problem import ContactProblem, Model
from jaxleas.contacts.problem_file import read_problem, write_problem
from jaxleas.contacts.sl1m import MAX_COMBINATIONS
from jaxleas.terrain.mesh_scene import load_scene
from jaxleas.terrain.scene import Scene
from jaxleas.types import GuidePath
from jaxleas.types.errors import InputError, JaxleasError

Planner = Literal["mip", "sl1m", "sampling"]
EVERY: dict[str, int] = {"mip": 14, "sl1m": 14, "sampling": 5}
"""Which configurations of the guide are kept: T 5.2.3, T 4.1.4."""

FOR_PICTURE = 10.0
"""Most time spent on drawing how far a failed plan could go [s]."""


class NotCertifiedError(JaxleasError):
    """A plan that violates its problem: an answer, not a bad input."""

    exit_code = 1


def plan(
    problem: Path,
    *,
    planner: Planner = "mip",
    out: Path,
    time_limit: float = 60.0,
    cost: Cost = "none",
    without_guide: bool = False,
    max_combinations: int | None = None,
    picture: Path | None = None,
) -> ContactPlan:
    """Plan contacts for a problem file and write the certified plan.

    Args:
        problem: the contact problem, .json.
        planner: mip (exact), sl1m (fast, incomplete) or sampling (follows the phases' roots).
        out: the plan, .json; one without footholds, but with the reason, when there is no plan.
        time_limit: [s]; a plan not found in time has the status time_limit.
        cost: of the mip: footholds near the guide's reference ones, by L1 or squared distance.
        without_guide: allow every surface in every phase but the last.
        max_combinations: after which sl1m gives up, 2000 by default.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    _require_writable_names(out, picture)
    if planner == "sampling":
        changed = {
            "cost": cost != "none",
            "without-guide": without_guide,
            "max-combinations": max_combinations is not None,
        }
        _require_none_of(changed)
        asked = read_problem(problem)
        followed, crossed = guide_from_problem(asked), scene_of_problem(asked)
        every = EVERY["sampling"]
        return _sample_and_write(followed, crossed, asked.robot, every, time_limit, out, picture)
    read = read_problem(problem)
    if without_guide:
        read = read.without_guide()
    return _plan_and_write(read, planner, out, time_limit, cost, max_combinations, picture)


def check(
    plan: Path,
    problem: Path | None = None,
    *,
    guide: Path | None = None,
    scene: Path | None = None,
    query: int = 0,
    picture: Path | None = None,
) -> None:
    """Recompute every constraint on a plan, in metres.

    Args:
        plan: the contact plan, .json.
        problem: the contact problem it answers, .json; of sampling, whose roots it follows.
        guide: the guide path it follows, .npz (sampling).
        scene: the scene it crosses, .json or a mesh (sampling).
        query: which path of the guide's file.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    read = read_plan(plan)
    if picture is not None:
        _require_writable_names(Path("plan.json"), picture)
    if read.planner == "sampling":
        _check_postures(plan, read, problem, guide, scene, query, picture)
        return
    if problem is None:
        raise InputError(
            f"{plan} is of the {read.planner} planner: say which problem it answers:"
            f" jaxleas check {plan} PROBLEM.json"
        )
    asked = read_problem(problem)
    worst = certify(asked, read)
    if picture is not None:
        _draw(picture, asked, read)
    verdict = f"{worst.constraint}, phase {worst.phase}: {worst.metres:.3g} m"
    if not worst.certified:
        raise NotCertifiedError(f"{plan} is no plan for {problem}: it violates the {verdict}")
    print(f"{plan} is certified: {len(asked)} phases, nothing violated (tightest: {verdict})")


def _check_postures(
    path: Path,
    read: ContactPlan,
    problem: Path | None,
    guide: Path | None,
    scene: Path | None,
    query: int,
    picture: Path | None,
) -> None:
    from jaxleas.contacts.guide_file import read_guide_path
    from jaxleas.contacts.plan_sampling import walked_problem
    from jaxleas.contacts.posture_certificate import certify_postures

    if problem is not None and guide is None and scene is None:
        asked = read_problem(problem)
        followed, crossed = guide_from_problem(asked), scene_of_problem(asked)
    elif problem is None and guide is not None and scene is not None:
        followed, crossed = read_guide_path(guide, query), load_scene(scene)
    else:
        raise InputError(
            f"{path} is of the sampling planner: it is checked against its guide and scene, with"
            " --guide GUIDE.npz --scene SCENE.json, or against a PROBLEM.json"
        )
    certificate = certify_postures(read, followed, crossed)
    if picture is not None:
        _draw(picture, walked_problem(read, followed, crossed), read, followed)
    if not certificate.certified:
        raise NotCertifiedError(
            f"{path} is no plan for {problem or f'{guide} on {scene}'}: {certificate.complaint}"
        )
    worst, end = certificate.worst, "" if read.feasible else f", which end early: {read.reason}"
    print(
        f"{path} is certified: {len(read.postures or ())} postures, nothing violated (tightest:"
        f" {worst.constraint}, posture {worst.phase}: {worst.metres:.3g} m), least robustness"
        f" {certificate.least_robustness:.3g} N{end}"
    )


def contacts(
    guide: Path,
    *,
    scene: Path,
    planner: Planner = "mip",
    out: Path,
    problem: Path | None = None,
    query: int = 0,
    robot: str = "talos",
    model: Model | None = None,
    every: int | None = None,
    candidates: Literal["window", "rom"] | None = None,
    window: float | None = None,
    time_limit: float = 60.0,
    cost: Cost = "none",
    max_combinations: int | None = None,
    picture: Path | None = None,
) -> ContactPlan:
    """Plan contacts along a guide path through a scene.

    Args:
        guide: the guide path, .npz.
        scene: its terrain as polygons: .json scene, or .stl or .obj mesh in metres, z up.
        planner: mip (exact), sl1m (fast, incomplete) or sampling (acyclic, follows the guide).
        out: the plan, .json.
        problem: write the contact problem here too, .json (mip and sl1m).
        query: which path of the file.
        robot: whose step polytopes are used.
        model: two_com (with the centre of mass, the default) or feet.
        every: keep one configuration of so many; 14 for mip and sl1m (a step each), 5 for sampling.
        candidates: what lies in a window around the root (the default), or rom: in the moving
            leg's range of motion.
        window: the window's edge, 0.8 by default [m].
        time_limit: [s]; a plan not found in time has the status time_limit.
        cost: of the mip: footholds near the guide's reference ones, by L1 or squared distance.
        max_combinations: after which sl1m gives up, 2000 by default.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    from jaxleas.contacts.from_guide import problem_from_guide
    from jaxleas.contacts.guide_file import read_guide_path

    _require_writable_names(out, picture)
    followed, crossed = read_guide_path(guide, query), load_scene(scene)
    kept = EVERY[planner] if every is None else every
    if planner == "sampling":
        changed = {
            "problem": problem is not None,
            "model": model is not None,
            "candidates": candidates is not None,
            "window": window is not None,
            "cost": cost != "none",
            "max-combinations": max_combinations is not None,
        }
        _require_none_of(changed)
        return _sample_and_write(followed, crossed, robot, kept, time_limit, out, picture)
    options: dict[str, Any] = {"model": model, "candidates": candidates, "window": window}
    chosen = {name: each for name, each in options.items() if each is not None}
    made = problem_from_guide(followed, crossed, robot=robot, every=kept, **chosen)
    if problem is not None:
        write_problem(problem, made)
    return _plan_and_write(made, planner, out, time_limit, cost, max_combinations, picture)


def _require_writable_names(out: Path, picture: Path | None) -> None:
    """Find out before planning what cannot be written after it."""
    if Path(out).suffix != ".json":
        raise InputError(f"--out {out}: contact plans are written as .json")
    if picture is not None:
        from jaxleas.contacts.pictures import require_picture

        require_picture(picture)


def _require_none_of(changed: dict[str, bool]) -> None:
    wrong = [f"--{name}" for name, is_changed in changed.items() if is_changed]
    if wrong:
        raise InputError(
            f"the sampling planner chooses its own contacts: {', '.join(wrong)} is for mip and sl1m"
        )


def _sample_and_write(
    guide: GuidePath,
    scene: Scene,
    robot: str,
    every: int,
    time_limit: float,
    out: Path,
    picture: Path | None,
) -> ContactPlan:
    from jaxleas.contacts.plan_sampling import plan_sampling, walked_problem
    from jaxleas.contacts.sampling import SamplingSettings

    if robot != "talos":
        raise InputError(f"the sampling planner knows the legs of talos only, not of {robot!r}")
    if every < 1:
        raise InputError(f"every {every} must be at least 1: one configuration of so many is kept")
    found = plan_sampling(guide, scene, SamplingSettings(keep_every=every), time_limit=time_limit)
    write_plan(out, found)
    if picture is not None:
        _draw(picture, walked_problem(found, guide, scene), found, guide)
    print(f"{describe_walk(guide, found)}\nwritten to {out}")
    return found


def describe_walk(guide: GuidePath, found: ContactPlan) -> str:
    """Return a sampling plan's outcome in one line."""
    postures = found.postures or ()
    steps = f"{len(found.surfaces)} steps in {1000.0 * found.seconds:.0f} ms"
    if found.robustness:
        steps += f", least robustness {min(found.robustness):.3g} N"
    if found.feasible:
        return f"sampling: feasible, {steps}, certified to {found.max_violation:.1g} m"
    reached = postures[-1].configuration if postures else -1
    where = f"configuration {reached} of {len(guide) - 1} reached"
    return f"sampling: {found.status} ({where}), {steps}: {found.reason}"


def _plan_and_write(
    problem: ContactProblem,
    planner: Planner,
    out: Path,
    time_limit: float,
    cost: Cost,
    max_combinations: int | None,
    picture: Path | None,
) -> ContactPlan:
    if planner == "sl1m":
        if cost != "none":
            raise InputError("a cost is for the mip planner; sl1m's cost is the L1 norm itself")
        most = MAX_COMBINATIONS if max_combinations is None else max_combinations
        found = plan_sl1m(problem, time_limit=time_limit, max_combinations=most)
    else:
        if max_combinations is not None:
            raise InputError("--max-combinations is for the sl1m planner; mip has no such limit")
        found = plan_mip(problem, time_limit=time_limit, cost=cost)
    write_plan(out, found)
    if picture is not None:
        _draw(picture, problem, found)
    print(f"{describe(problem, found)}\nwritten to {out}")
    return found


def describe(problem: ContactProblem, found: ContactPlan) -> str:
    """Return a plan's outcome in one line."""
    tried = ""
    if found.undecided is not None:
        tried = f", {found.undecided} undecided, {found.combinations} combinations"
    timing = f"{len(problem)} phases in {1000.0 * found.seconds:.0f} ms{tried}"
    if found.feasible:
        return f"{found.planner}: feasible, {timing}, certified to {found.max_violation:.1g} m"
    reach = ""
    if found.last_feasible_phase is not None:
        reach = f" ({found.last_feasible_phase + 1} of {len(problem)} phases can be made)"
    return f"{found.planner}: {found.status}{reach}, {timing}: {found.reason}"


def _draw(
    picture: Path, problem: ContactProblem, found: ContactPlan, guide: GuidePath | None = None
) -> None:
    from jaxleas.contacts.pictures import draw_plan

    draw_plan(picture, problem, found, guide, _as_far_as_it_goes(problem, found))


def _as_far_as_it_goes(problem: ContactProblem, found: ContactPlan) -> ContactPlan | None:
    """Plan the phases before the first that cannot be made, for a picture."""
    count = 0 if found.last_feasible_phase is None else found.last_feasible_phase + 1
    if found.feasible or found.planner not in PLANNERS or not 0 < count < len(problem):
        return None
    prefix = problem.prefix(count)
    made = PLANNERS[found.planner](prefix, diagnose=False, time_limit=FOR_PICTURE)
    return made if made.feasible else None
