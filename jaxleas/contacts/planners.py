"""The exact planners: a problem in, a certified plan out."""

import math
import time
from collections.abc import Callable
from typing import Literal

import numpy as np

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.decision import decide
from jaxleas.contacts.explanation import explain
from jaxleas.contacts.linear_program import Outcome
from jaxleas.contacts.mixed_integer import Formulation
from jaxleas.contacts.placement import Placement, Targets
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.prefix import last_feasible_phase
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.sl1m import MAX_COMBINATIONS, Attempt, attempt
from jaxleas.contacts.slack_weights import SlackWeights
from jaxleas.types.errors import InputError

Cost = Literal["none", "linear", "quadratic"]
BESIDE_ROOT = 0.0848
"""The reference foothold lies this far to the side of the root [m] (Talos)."""


class PlannerError(RuntimeError):
    """A bug of ours: a plan that fails its certificate, or a solver that gave no answer."""


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
            beside the guide's root, by L1 or squared distance [m]; needs a root in each phase.
        time_limit: [s]; when it is over, the plan's status says "time_limit".
        diagnose: for an infeasible problem, find the last feasible phase and the reason.
        formulation: "big_m" (T 5.3, 5.4), or "hull", slower but without any big-M.
        start: try SL1M's first combinations before the mixed-integer program: sooner, as exact.

    Raises:
        InputError: a cost is asked for, but the phases have no root.
        PlannerError: a bug of ours.
    """
    require_time_limit(time_limit)
    begin = time.perf_counter()
    deadline = begin + time_limit
    targets = None if cost == "none" else _reference_footholds(problem, cost)
    decision = decide(problem, deadline, formulation, targets, start=start)
    seconds = time.perf_counter() - begin
    if decision.placement is not None:
        return _certified("mip", problem, decision.surfaces, decision.placement, seconds)
    if decision.outcome == "time_limit":
        return _late("mip", seconds, time_limit)
    if decision.outcome == "failed":
        raise PlannerError("the mixed-integer solver gave no answer")
    plan = ContactPlan("mip", False, "infeasible", "no choice of surfaces works", seconds=seconds)
    if not diagnose:
        return plan
    judge = lambda prefix: decide(prefix, deadline, formulation).outcome  # noqa: E731
    plan = _diagnosed(plan, problem, judge, decision.dead_phase, deadline, exact=True)
    return plan.but(seconds=time.perf_counter() - begin)


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
        max_combinations: of surfaces for the undecided phases, tried one after the other; 0: none
            (the thesis's SL1M without heuristics), which plans where every phase is decided.
        weights: of the slacks: "uniform", as published, or "guide": the guide path chooses.
        time_limit: [s]; when it is over, the plan's status says "time_limit".
        diagnose: when there is no plan, find the last phase for which SL1M has one.
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
    counts = {"combinations": found.combinations, "undecided": found.undecided}
    if found.placement is not None:
        plan = _certified("sl1m", problem, found.surfaces, found.placement, seconds)
        return plan.but(**counts)
    if found.outcome == "time_limit":
        return _late("sl1m", seconds, time_limit).but(**counts)
    if found.outcome == "failed":
        raise PlannerError("the linear-program solver gave no answer")
    status = "infeasible" if found.outcome == "infeasible" else "not_found"
    plan = ContactPlan("sl1m", False, status, _sl1m_reason(found), seconds=seconds).but(**counts)
    if not diagnose:
        return plan

    def judge(prefix: ContactProblem) -> str:
        return attempt(prefix, deadline, max_combinations, pruning, weights).outcome

    plan = _diagnosed(plan, problem, judge, None, deadline, exact=status == "infeasible")
    return plan.but(seconds=time.perf_counter() - begin)


PLANNERS: dict[str, Callable[..., ContactPlan]] = {"mip": plan_mip, "sl1m": plan_sl1m}


def require_time_limit(time_limit: float) -> None:
    """Refuse a time limit that is no positive number of seconds."""
    if not time_limit > 0.0:
        raise InputError(f"time limit {time_limit} must be a positive number of seconds")


def _certified(
    planner: str,
    problem: ContactProblem,
    surfaces: tuple[str, ...],
    placement: Placement,
    seconds: float,
) -> ContactPlan:
    plan = ContactPlan(
        planner,
        True,
        "feasible",
        surfaces=surfaces,
        footholds=placement.footholds,
        com=placement.com,
        last_feasible_phase=len(problem) - 1,
        seconds=seconds,
    )
    worst = certify(problem, plan)
    if not worst.certified:
        raise PlannerError(
            f"the {planner} planner made a plan that violates {worst.constraint} in phase"
            f" {worst.phase} by {worst.metres:.3g} m"
        )
    return plan.but(max_violation=worst.metres)


def _late(planner: str, seconds: float, time_limit: float) -> ContactPlan:
    reason = f"not decided within the time limit of {time_limit:g} s"
    return ContactPlan(planner, False, "time_limit", reason, seconds=seconds)


def _diagnosed(
    plan: ContactPlan,
    problem: ContactProblem,
    judge: Callable[[ContactProblem], Outcome | str],
    dead_phase: int | None,
    deadline: float,
    exact: bool,
) -> ContactPlan:
    """Add the last feasible phase and, where it is proved, why the next cannot be made."""
    last = last_feasible_phase(problem, judge, dead_phase)
    if last is None:
        return plan.but(reason=f"{plan.reason}; its time ran out before the failing step was found")
    if not exact or time.perf_counter() > deadline:
        return plan.but(
            last_feasible_phase=last, reason=f"{plan.reason}; it stops before phase {last + 1}"
        )
    return plan.but(last_feasible_phase=last, reason=explain(problem, last + 1, deadline))


def _sl1m_reason(found: Attempt) -> str:
    if found.outcome == "infeasible":
        return "not even the relaxation has a solution"
    failed = f"the first {found.combinations} combinations of surfaces failed"
    if found.exhausted:
        failed = f"every combination of surfaces fails ({found.combinations} were tried)"
    return (
        f"the relaxation left {found.undecided} phases undecided, and {failed}; this proves"
        " nothing: ask the mip planner"
    )


def _reference_footholds(problem: ContactProblem, cost: Cost) -> Targets:
    points = []
    for index, phase in enumerate(problem.phases):
        if phase.root is None:
            raise InputError(f"phase {index} has no root, which a cost needs: ask for cost 'none'")
        side = BESIDE_ROOT if phase.foot == "LF" else -BESIDE_ROOT
        left = np.array([-math.sin(phase.yaw), math.cos(phase.yaw)])
        points.append(phase.root[:2] + side * left)
    return Targets(np.array(points), "quadratic" if cost == "quadratic" else "linear")
