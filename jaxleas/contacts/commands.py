"""The functions behind `jaxleas plan`, `check` and `contacts`."""

from pathlib import Path
from typing import Literal

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.plan import ContactPlan, read_plan, write_plan
from jaxleas.contacts.planners import Cost, plan_mip, plan_sl1m
from jaxleas.contacts.problem import ContactProblem, Model
from jaxleas.contacts.problem_file import read_problem, write_problem
from jaxleas.types.errors import InputError, JaxleasError

Planner = Literal["mip", "sl1m"]


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
    max_combinations: int = 2000,
    picture: Path | None = None,
) -> ContactPlan:
    """Plan contacts for a problem file and write the certified plan.

    Args:
        problem: the contact problem, .json.
        planner: mip (exact) or sl1m (fast, incomplete).
        out: the plan, .json; one without footholds, but with the reason, when there is no plan.
        time_limit: [s]; a plan not found in time has the status time_limit.
        cost: of the mip: footholds near the guide's reference ones, by L1 or squared distance.
        without_guide: allow every surface in every phase but the last.
        max_combinations: after which sl1m gives up.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    read = read_problem(problem)
    if without_guide:
        read = read.without_guide()
    return _plan_and_write(read, planner, out, time_limit, cost, max_combinations, picture)


def check(plan: Path, problem: Path, *, picture: Path | None = None) -> None:
    """Recompute every constraint of a problem for a plan, in metres.

    Args:
        plan: the contact plan, .json.
        problem: the contact problem it answers, .json.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    read, asked = read_plan(plan), read_problem(problem)
    worst = certify(asked, read)
    if picture is not None:
        _draw(picture, asked, read)
    verdict = f"{worst.constraint}, phase {worst.phase}: {worst.metres:.3g} m"
    if not worst.certified:
        raise NotCertifiedError(f"{plan} is no plan for {problem}: it violates the {verdict}")
    print(f"{plan} is certified: {len(asked)} phases, nothing violated (tightest: {verdict})")


def contacts(
    guide: Path,
    *,
    scene: Path,
    planner: Planner = "mip",
    out: Path,
    problem: Path | None = None,
    query: int = 0,
    robot: str = "talos",
    model: Model = "two_com",
    every: int = 14,
    candidates: Literal["window", "rom"] = "window",
    window: float = 0.8,
    time_limit: float = 60.0,
    cost: Cost = "none",
    max_combinations: int = 2000,
    picture: Path | None = None,
) -> ContactPlan:
    """Plan contacts along a guide path through a scene.

    Args:
        guide: the guide path, .npz.
        scene: its terrain as polygons, .json.
        planner: mip (exact) or sl1m (fast, incomplete).
        out: the plan, .json.
        problem: write the contact problem here too, .json.
        query: which path of the file.
        robot: whose step polytopes are used.
        model: two_com (with the centre of mass) or feet.
        every: keep one configuration of so many, one step each.
        candidates: surfaces in a window around the root, or in the moving leg's range of motion.
        window: the window's edge [m].
        time_limit: [s]; a plan not found in time has the status time_limit.
        cost: of the mip: footholds near the guide's reference ones, by L1 or squared distance.
        max_combinations: after which sl1m gives up.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
    """
    from jaxleas.contacts.from_guide import problem_from_guide
    from jaxleas.contacts.guide_file import read_guide_path
    from jaxleas.terrain.scene import read_scene

    made = problem_from_guide(
        read_guide_path(guide, query),
        read_scene(scene),
        robot=robot,
        model=model,
        every=every,
        candidates=candidates,
        window=window,
    )
    if problem is not None:
        write_problem(problem, made)
    return _plan_and_write(made, planner, out, time_limit, cost, max_combinations, picture)


def _plan_and_write(
    problem: ContactProblem,
    planner: Planner,
    out: Path,
    time_limit: float,
    cost: Cost,
    max_combinations: int,
    picture: Path | None,
) -> ContactPlan:
    if Path(out).suffix != ".json":
        raise InputError(f"--out {out}: contact plans are written as .json")
    if picture is not None:
        from jaxleas.contacts.pictures import require_picture

        require_picture(picture)
    if planner == "sl1m":
        if cost != "none":
            raise InputError("a cost is for the mip planner; sl1m's cost is the L1 norm itself")
        found = plan_sl1m(problem, time_limit=time_limit, max_combinations=max_combinations)
    else:
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


def _draw(picture: Path, problem: ContactProblem, found: ContactPlan) -> None:
    from jaxleas.contacts.pictures import draw_plan

    draw_plan(picture, problem, found)
