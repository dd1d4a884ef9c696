"""The function behind `jaxleas check`."""

from pathlib import Path

from jaxleas.contacts.checking import (
    check_footholds,
    check_postures,
    check_proof,
    check_trunk,
    followed_by,
)
from jaxleas.contacts.plan import read_plan
from jaxleas.contacts.plan_report import draw
from jaxleas.contacts.problem_file import read_problem
from jaxleas.terrain import (
    PLANE_SEARCH,
    READING,
    PlaneSearch,
    Reading,
    load_scene,
    require_picture,
)
from jaxleas.types import InputError


def check(
    plan: Path,
    problem: Path | None = None,
    *,
    guide: Path | None = None,
    scene: Path | None = None,
    query: int = 0,
    robot: str | None = None,
    without_guide: bool = False,
    picture: Path | None = None,
    reading: Reading = READING,
    search: PlaneSearch = PLANE_SEARCH,
) -> None:
    """Recompute every constraint on a plan, in metres, or verify a proof that there is none.

    Args:
        plan: file of the contact plan, .json.
        problem: file of the contact problem that it answers, .json; for sampling, one whose roots
            it follows.
        guide: file of the guide path that it follows, .npz; for planners other than sampling it
            serves to check the trunk.
        scene: scene that it crosses: .json, a mesh or a map; needs --guide.
        query: number of the path in the guide's file.
        robot: robot of a plan that follows a guide; by default the one that walked the
            guide path, or talos where its file does not say.
        without_guide: the plan was made with --without-guide: every whole surface is allowed in
            every step but the last.
        picture: draw the plan from above and from the side (.png, .svg, .pdf).
        reading: what the scene's file does not state itself.
        search: what counts as a surface, if the scene is a map.
    """
    read = read_plan(plan)
    if scene is None and (reading != READING or search.given):
        raise InputError("options of a terrain file were given without --scene, which they are of")
    if picture is not None:
        require_picture(picture)
    ground = None if scene is None else load_scene(scene, reading, search)
    if read.postures is not None:
        asked = followed_by(plan, problem, guide, ground, query, robot)
        check_postures(plan, read, asked, str(problem or f"{guide} on {scene}"), picture)
        return
    if problem is None:
        raise InputError(
            f"{plan} is of the {read.planner} planner: say which problem it answers:"
            f" jaxleas check {plan} PROBLEM.json"
        )
    asked = read_problem(problem)
    if without_guide:
        asked = asked.without_guide()
    if picture is not None:
        draw(picture, asked, read)
    if read.status == "infeasible" and read.proof is not None:
        taken = check_proof(plan, read, problem, asked)
        print(f"{plan} is certified: there is no plan of {len(asked)} steps ({taken})")
        return
    tightest = check_footholds(plan, read, problem, asked)
    trunk = check_trunk(plan, guide, ground, query, robot)
    print(
        f"{plan} is certified: {len(asked)} steps, nothing violated (tightest: {tightest}); {trunk}"
    )
