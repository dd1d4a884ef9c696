"""SL1M as a planner: fast, incomplete."""

import math
import time
from typing import Any

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import AskedGuides, Planner, PlannerError, require_time_limit
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.answers import certified, diagnosed, late
from jaxleas.contacts.programs.attempt import MAX_COMBINATIONS, Attempt, attempt
from jaxleas.contacts.programs.judging import judge_by_program
from jaxleas.contacts.programs.settings import Sl1mPlanSettings, Sl1mSettings
from jaxleas.contacts.programs.slack_weights import SlackWeights
from jaxleas.types import InputError, Verdict


class Sl1m(Planner):
    """SL1M in the registry."""

    title = "SL1M"
    settings = Sl1mSettings
    plan_settings = Sl1mPlanSettings
    needs = "problem"
    measures = frozenset({"undecided", "combinations"})

    def plan(
        self,
        asked: ContactProblem,
        settings: Sl1mPlanSettings,
        *,
        time_limit: float,
        diagnose: bool = True,
    ) -> ContactPlan:
        """Plan contacts for one problem."""
        most = settings.max_combinations
        return plan_sl1m(asked, max_combinations=most, time_limit=time_limit, diagnose=diagnose)

    def judge(self, asked: AskedGuides, settings: Sl1mSettings) -> list[Verdict]:
        """Judge guide paths one after the other."""

        def plan(prefix: ContactProblem, time_limit: float) -> ContactPlan:
            return plan_sl1m(
                prefix,
                max_combinations=settings.max_combinations,
                weights=settings.weights,
                time_limit=time_limit,
                diagnose=False,
            )

        return [judge_by_program(each, asked.robot, settings, plan) for each in asked]


def plan_sl1m(
    problem: ContactProblem,
    *,
    max_combinations: int = MAX_COMBINATIONS,
    weights: SlackWeights = "uniform",
    time_limit: float = math.inf,
    diagnose: bool = True,
    pruning: bool = True,
) -> ContactPlan:
    """Plan by SL1M (T 5.3): fast, incomplete; "not_found" proves nothing.

    Args:
        problem: the contact problem.
        max_combinations: number of combinations of surfaces to try in the undecided steps; 0: none
            (the thesis's SL1M without heuristics), which plans where every step is decided.
        weights: weights of the slacks: "uniform", as published, or "guide": the guide path chooses.
        time_limit: time limit [s]; when it is over, the plan's status says "time_limit".
        diagnose: whether to find the last step for which SL1M has a plan, if it has none for all.
        pruning: whether candidates that no step can reach are dropped first.

    Raises:
        InputError: max_combinations is negative.
        PlannerError: a bug of ours.
    """
    require_time_limit(time_limit)
    if max_combinations < 0:
        raise InputError(f"max_combinations is {max_combinations}; give 0 or more")
    begin = time.perf_counter()
    deadline = begin + time_limit
    found = attempt(problem, deadline, max_combinations, pruning, weights)
    seconds = time.perf_counter() - begin
    counts: dict[str, Any] = {"combinations": found.combinations, "undecided": found.undecided}
    if found.placement is not None:
        plan = certified("sl1m", problem, found.surfaces, found.placement, seconds)
        return plan.but(**counts)
    if found.status == "time_limit":
        return late("sl1m", seconds, time_limit).but(**counts)
    if found.status == "failed":
        raise PlannerError("the linear-program solver gave no answer")
    status = "infeasible" if found.status == "infeasible" else "not_found"
    plan = ContactPlan("sl1m", False, status, _sl1m_reason(found), seconds=seconds)
    plan = plan.but(cause=status, **counts)
    if not diagnose:
        return plan

    def judge(prefix: ContactProblem) -> str:
        return attempt(prefix, deadline, max_combinations, pruning, weights).status

    plan = diagnosed(plan, problem, judge, None, deadline, exact=status == "infeasible")
    return plan.but(seconds=time.perf_counter() - begin)


def _sl1m_reason(found: Attempt) -> str:
    if found.status == "infeasible":
        return "not even the relaxation has a solution"
    failed = f"the first {found.combinations} combinations of surfaces failed"
    if found.exhausted:
        failed = f"every combination of surfaces fails ({found.combinations} were tried)"
    return (
        f"the relaxation left {found.undecided} steps undecided, and {failed}; this proves"
        " nothing: ask the mip planner"
    )
