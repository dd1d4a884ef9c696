"""The planner `astar`: exact, by a best-first search over sets of places."""

import math
import time

from jaxleas.configuration import Strict
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import AskedGuides, Planner, PlannerError, require_time_limit
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.answers import certified, diagnosed, late
from jaxleas.contacts.programs.judging import judge_by_program
from jaxleas.contacts.search.decide_by_sets import decide_by_sets
from jaxleas.contacts.search.displacements import SLACK
from jaxleas.contacts.search.proof_writing import proof_of
from jaxleas.contacts.search.settings import AstarSettings
from jaxleas.types import Verdict


class Astar(Planner):
    """The search by forward sets in the registry."""

    title = "A* on sets"
    settings = AstarSettings
    needs = "problem"
    in_thesis = False

    def plan(
        self,
        asked: ContactProblem,
        settings: Strict,
        *,
        time_limit: float,
        diagnose: bool = True,
    ) -> ContactPlan:
        """Plan contacts for one problem."""
        del settings
        return plan_astar(asked, time_limit=time_limit, diagnose=diagnose)

    def judge(self, asked: AskedGuides, settings: AstarSettings) -> list[Verdict]:
        """Judge guide paths one after the other."""

        def plan(prefix: ContactProblem, time_limit: float) -> ContactPlan:
            return plan_astar(prefix, time_limit=time_limit, diagnose=False)

        return [judge_by_program(each, asked.robot, settings, plan) for each in asked]


def plan_astar(
    problem: ContactProblem, *, time_limit: float = math.inf, diagnose: bool = True
) -> ContactPlan:
    """Plan by A* over exact convex sets of places: exact, "infeasible" is a proof.

    Instead of a place, a state of the search holds all places at once that the standing foot may
    have, a convex polygon on one surface: F' = surface and (F + D), with D the displacements that
    the step allows (after CASSR, Wang and Tonneau 2026, arXiv 2603.02989). With the surfaces
    found, the linear program of `plan_mip` places the feet with the most distance to spare. The
    plan has the fewest steps, which a problem states, and no least cost. Where there is none, the
    answer holds a proof, which `certify_infeasible` verifies.

    Args:
        problem: the contact problem, of two feet; `problem.without_guide()` for
            contact-before-motion.
        time_limit: time limit [s]; when it is over, the plan's status says "time_limit".
        diagnose: whether to find the last feasible step and the reason for an infeasible problem.

    Raises:
        InputError: the problem has other than two feet.
        PlannerError: a bug of ours.
    """
    require_time_limit(time_limit)
    begin = time.perf_counter()
    deadline = begin + time_limit
    found = decide_by_sets(problem, deadline)
    seconds = time.perf_counter() - begin
    if found.placement is not None:
        return certified("astar", problem, found.surfaces, found.placement, seconds)
    if found.status == "time_limit":
        return late("astar", seconds, time_limit)
    if found.status == "failed":
        raise PlannerError("the linear-program solver gave no answer")
    if found.status == "marginal":
        why = (
            f"the feet could only just be placed: within {SLACK:g} m of the limits the search and"
            " its last program disagree; this proves nothing: ask the planner mip"
        )
        return ContactPlan("astar", False, "not_found", why, seconds=seconds, cause="not_found")
    why = "no choice of surfaces works"
    plan = ContactPlan("astar", False, "infeasible", why, seconds=seconds, cause="infeasible")
    plan = plan.but(proof=proof_of(found), seconds=time.perf_counter() - begin)
    if not diagnose:
        return plan

    def judge(prefix: ContactProblem) -> str:
        return decide_by_sets(prefix, deadline).status

    plan = diagnosed(plan, problem, judge, None, deadline, exact=True)
    return plan.but(seconds=time.perf_counter() - begin)
