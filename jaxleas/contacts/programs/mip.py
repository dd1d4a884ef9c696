"""The mixed-integer planner: exact."""

import math
import time

import numpy as np

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import AskedGuides, Planner, PlannerError, require_time_limit
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.answers import certified, diagnosed, late
from jaxleas.contacts.programs.decision import decide
from jaxleas.contacts.programs.judging import judge_by_program
from jaxleas.contacts.programs.mixed_integer import Formulation
from jaxleas.contacts.programs.nearest import Targets
from jaxleas.contacts.programs.settings import Cost, MipPlanSettings, MipSettings
from jaxleas.contacts.reference import reference_foothold
from jaxleas.robots import load_robot
from jaxleas.types import InputError, Verdict


class Mip(Planner):
    """The mixed-integer planner in the registry."""

    title = "MIP"
    settings = MipSettings
    plan_settings = MipPlanSettings
    needs = "problem"

    def plan(
        self,
        asked: ContactProblem,
        settings: MipPlanSettings,
        *,
        time_limit: float,
        diagnose: bool = True,
    ) -> ContactPlan:
        """Plan contacts for one problem."""
        return plan_mip(asked, cost=settings.cost, time_limit=time_limit, diagnose=diagnose)

    def judge(self, asked: AskedGuides, settings: MipSettings) -> list[Verdict]:
        """Judge guide paths one after the other."""

        def plan(prefix: ContactProblem, time_limit: float) -> ContactPlan:
            return plan_mip(prefix, time_limit=time_limit, diagnose=False)

        return [judge_by_program(each, asked.robot, settings, plan) for each in asked]


def plan_mip(
    problem: ContactProblem,
    *,
    cost: Cost = "none",
    time_limit: float = math.inf,
    diagnose: bool = True,
    formulation: Formulation = "big_m",
    start: bool = True,
) -> ContactPlan:
    """Plan by mixed-integer programming (T 5.2, app. B): exact, "infeasible" is a proof.

    Args:
        problem: the contact problem; `problem.without_guide()` for contact-before-motion.
        cost: "none": any plan, with distance to spare; else footholds near the reference ones
            beside the guide's root, by L1 or squared distance [m]; needs a root in each step.
        time_limit: time limit [s]; when it is over, the plan's status says "time_limit".
        diagnose: whether to find the last feasible step and the reason for an infeasible problem.
        formulation: "big_m" (T 5.3, 5.4), or "hull", slower but without any big-M.
        start: whether to try SL1M's first combinations before the mixed-integer program: faster,
            and as exact.

    Raises:
        InputError: a cost is requested, but the steps have no root.
        PlannerError: a bug of ours.
    """
    require_time_limit(time_limit)
    begin = time.perf_counter()
    deadline = begin + time_limit
    targets = None if cost == "none" else _reference_footholds(problem, cost)
    decision = decide(problem, deadline, formulation, targets, start=start)
    seconds = time.perf_counter() - begin
    if decision.placement is not None:
        return certified("mip", problem, decision.surfaces, decision.placement, seconds)
    if decision.status == "time_limit":
        return late("mip", seconds, time_limit)
    if decision.status == "failed":
        raise PlannerError("the mixed-integer solver gave no answer")
    why = "no choice of surfaces works"
    plan = ContactPlan("mip", False, "infeasible", why, seconds=seconds, cause="infeasible")
    if not diagnose:
        return plan
    judge = lambda prefix: decide(prefix, deadline, formulation).status  # noqa: E731
    plan = diagnosed(plan, problem, judge, decision.dead_step, deadline, exact=True)
    return plan.but(seconds=time.perf_counter() - begin)


def _reference_footholds(problem: ContactProblem, cost: Cost) -> Targets:
    robot, points = load_robot(problem.robot), []
    for index, step in enumerate(problem.steps):
        if step.root is None:
            raise InputError(f"step {index} has no root, which a cost needs: ask for cost 'none'")
        points.append(reference_foothold(robot, step.foot, step.root, step.yaw)[:2])
    return Targets(np.array(points), "quadratic" if cost == "quadratic" else "linear")
