"""The function behind `jaxleas gait plan`."""

from math import atan2
from pathlib import Path

from jaxleas.envs.gait_planning import GaitPlanningConfig
from jaxleas.files import policy_path
from jaxleas.footsteps import Goal, parse_pose
from jaxleas.gaits.certifying import certify_gait
from jaxleas.gaits.crawl_search import search_crawls
from jaxleas.gaits.crawl_settings import CrawlSettings
from jaxleas.gaits.gait_plan import GaitPlan, plan_of
from jaxleas.gaits.on_terrain import OnTerrain
from jaxleas.gaits.plan_file import write_gait_plan
from jaxleas.gaits.policy_way import Retries, walk_policy
from jaxleas.runs import Progress
from jaxleas.terrain import READING, Reading, import_terrain, with_cells
from jaxleas.training import read_policy
from jaxleas.types import InputError, JaxleasError

SEARCH = "search"
CELL = 0.02
"""Edge of a cell of polygons where none is stated [m]."""


class NoGaitError(JaxleasError):
    """No plan reaches the goal: an answer, not a bad input.

    Attributes:
        exit_code: exit code of a command that ends so.
    """

    exit_code = 1


def plan(
    planner: str,
    *,
    terrain: Path,
    goal: str,
    out: Path,
    start: str = "0,0,0",
    width: int = 4,
    phases: int = 150,
    draws: int = Retries.draws,
    reading: Reading = READING,
) -> GaitPlan:
    """Plan a quadruped's support phases to a goal, and certify the plan.

    Args:
        planner: policy of gait planning (policy.npz, or pretrained:gaits), or `search`, which needs
            none.
        terrain: height map, scene, mesh, image, table or bag; docs/files.md lists all kinds.
        goal: place to reach: X,Y [m].
        out: file for the plan (.json).
        start: place and heading to begin at: X,Y or X,Y,YAW [m, rad].
        width: number of states that the search keeps after each phase.
        phases: largest number of transitions.
        draws: number of phases drawn from a policy where its own next phase is refused; with 0 the
            plan ends there.
        reading: what the terrain file does not state itself.
    """
    for name, value in (("--width", width), ("--phases", phases)):
        if value < 1:
            raise InputError(f"{name} {value}: give 1 or more")
    if draws < 0:
        raise InputError(f"--draws {draws}: give 0 or more")
    if out.suffix != ".json":
        raise InputError(f"{out}: the name of a plan must end in .json")
    begin, end = parse_pose(start, "--start"), parse_pose(goal, "--goal")
    policy = None if planner == SEARCH else read_policy(policy_path(planner), of=GaitPlanningConfig)
    config = GaitPlanningConfig() if policy is None else policy.config
    height_map = import_terrain(terrain, with_cells(terrain, reading, CELL))
    place = OnTerrain(config, height_map)
    state = place.stand((begin.x, begin.y, _heading(begin, end, start)), (end.x, end.y))
    cause = ""
    if policy is None:
        settings = CrawlSettings(width=width, most_phases=phases)
        with Progress(phases, unit="phases") as progress:
            gait = search_crawls(
                config, place.footing, state, settings, lambda done, _: progress.update(done)
            )[0]
        found = plan_of(config, place.in_its_frame(gait), SEARCH)
    else:
        way = walk_policy(policy, place.footing.ground, state, phases, Retries(draws))
        found = plan_of(config, place.in_its_frame(way.gait), planner)
        cause = f" ({way.cause})" if way.cause else ""
    certificate = certify_gait(found, height_map)
    write_gait_plan(out, found, certificate.to_json())
    print(f"{found.in_words()}{cause}\n{certificate.in_words()}\nwritten to {out}")
    if found.ending != "reached":
        raise NoGaitError(f"{found.in_words()}{cause}; {out} holds the plan up to there")
    if not certificate.holds:
        raise NoGaitError(f"the plan does not hold: {certificate.in_words()}; it is in {out}")
    return found


def _heading(begin: Goal, end: Goal, start: str) -> float:
    """Return the heading to begin with: stated, or towards the goal."""
    stated = start.count(",") == 2
    return begin.yaw if stated else atan2(end.y - begin.y, end.x - begin.x)
