"""Conversion of a program's result to a plan: certified, late, or with a reason for failure."""

import time
from collections.abc import Callable

from jaxleas.contacts.certificate import certify
from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.planner import PlannerError
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.explanation import explain
from jaxleas.contacts.programs.linear_program import SolverStatus
from jaxleas.contacts.programs.placement import Placement
from jaxleas.contacts.programs.prefix import last_feasible_step


def certified(
    planner: str,
    problem: ContactProblem,
    surfaces: tuple[str, ...],
    placement: Placement,
    seconds: float,
) -> ContactPlan:
    """Return a certified plan.

    Raises:
        PlannerError: the plan fails its certificate: a bug of ours.
    """
    plan = ContactPlan(
        planner,
        True,
        "feasible",
        surfaces=surfaces,
        footholds=placement.footholds,
        com=placement.com,
        last_feasible_step=len(problem) - 1,
        seconds=seconds,
    )
    worst = certify(problem, plan)
    if not worst.certified:
        raise PlannerError(
            f"the {planner} planner made a plan that violates {worst.constraint} in step"
            f" {worst.step} by {worst.metres:.3g} m"
        )
    return plan.but(max_violation=worst.metres)


def late(planner: str, seconds: float, time_limit: float) -> ContactPlan:
    """Return the answer of a planner whose time is over."""
    reason = f"not decided within the time limit of {time_limit:g} s"
    return ContactPlan(planner, False, "time_limit", reason, seconds=seconds, cause="time_limit")


def diagnosed(
    plan: ContactPlan,
    problem: ContactProblem,
    judge: Callable[[ContactProblem], SolverStatus | str],
    dead_step: int | None,
    deadline: float,
    exact: bool,
) -> ContactPlan:
    """Add the last feasible step and, where proved, the reason why the next cannot be made."""
    last = last_feasible_step(problem, judge, dead_step)
    if last is None:
        return plan.but(reason=f"{plan.reason}; its time ran out before the failing step was found")
    if not exact or time.perf_counter() > deadline:
        return plan.but(
            last_feasible_step=last, reason=f"{plan.reason}; it stops before step {last + 1}"
        )
    return plan.but(last_feasible_step=last, reason=explain(problem, last + 1, deadline))
