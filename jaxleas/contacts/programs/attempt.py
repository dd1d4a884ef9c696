"""SL1M (T 5.3): relax, keep the surfaces that the L1 norm decided, enumerate others by cost."""

from dataclasses import dataclass

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.com import with_first_cuts
from jaxleas.contacts.programs.combinations import Combinations
from jaxleas.contacts.programs.constraints import StepConstraints, make_constraints
from jaxleas.contacts.programs.linear_program import SolverStatus
from jaxleas.contacts.programs.mixed_integer import Candidates
from jaxleas.contacts.programs.placement import Placement, place
from jaxleas.contacts.programs.pruning import prune
from jaxleas.contacts.programs.relaxation import Relaxed, relax
from jaxleas.contacts.programs.slack_weights import SlackWeights

DECIDED = 1e-6
"""A foothold this near to a surface has selected it (the LP is solved to 1e-9) [m]."""
MAX_COMBINATIONS = 2000


@dataclass(frozen=True, eq=False)
class Attempt:
    """The result of an attempt by SL1M.

    Attributes:
        status: "optimal" for a plan; "infeasible" if the relaxation already is; else "not_found".
        constraints: constraints on the steps with the cuts found on the way.
        surfaces: surface of each step.
        placement: footholds and centre of mass.
        undecided: steps that the relaxation left without a surface.
        combinations: number of combinations tried.
        exhausted: whether every combination was tried, or ruled out by one that was.
        relaxed: answer of the relaxation.
    """

    status: SolverStatus | str
    constraints: list[StepConstraints]
    surfaces: tuple[str, ...] = ()
    placement: Placement | None = None
    undecided: int | None = None
    combinations: int = 0
    exhausted: bool = False
    relaxed: Relaxed | None = None


def attempt(
    problem: ContactProblem,
    deadline: float = np.inf,
    max_combinations: int = MAX_COMBINATIONS,
    pruning: bool = True,
    weights: SlackWeights = "uniform",
) -> Attempt:
    """Look for a plan by SL1M.

    Args:
        problem: the contact problem.
        deadline: time by `time.perf_counter` after which to stop [s].
        max_combinations: number of combinations after which it gives up.
        pruning: whether candidates that no step can reach are dropped first.
        weights: weights of the slacks.
    """
    constraints = with_first_cuts(problem, make_constraints(problem), len(problem))
    candidates: Candidates = [step.candidates for step in problem.steps]
    if pruning:
        candidates = prune(problem, constraints)
        if not all(candidates):
            return Attempt("infeasible", constraints)
    return search(problem, constraints, candidates, deadline, max_combinations, weights)


def search(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    candidates: Candidates,
    deadline: float,
    max_combinations: int,
    weights: SlackWeights = "uniform",
) -> Attempt:
    """Relax, take the nearest surfaces, then others by cost where a failure requires it.

    Args:
        problem: the contact problem.
        constraints: constraints on the problem's steps, with cuts.
        candidates: candidates of each step, at least one each.
        deadline: time by `time.perf_counter` after which to stop [s].
        max_combinations: number of combinations after which it gives up; 0: a problem that the
            relaxation leaves undecided fails.
        weights: weights of the slacks.
    """
    relaxed = relax(problem, constraints, candidates, deadline, weights)
    if relaxed.status != "optimal":
        return Attempt(relaxed.status, constraints=relaxed.constraints, relaxed=relaxed)
    constraints = relaxed.constraints
    undecided = sum(float(slack.min()) > DECIDED for slack in relaxed.slack)
    most = max_combinations if undecided else max(1, max_combinations)
    tried, status = 0, "not_found"
    combinations = Combinations(candidates, relaxed.slack)
    for surfaces in combinations:
        if tried == most:
            break
        tried += 1
        placement = place(problem, constraints, surfaces, deadline)
        constraints = placement.constraints
        if placement.status == "optimal":
            return Attempt(
                "optimal", constraints, surfaces, placement, undecided, tried, False, relaxed
            )
        if placement.status == "time_limit":
            status = "time_limit"
            break
        if placement.status == "infeasible":
            combinations.refute(placement.blamed)
    exhausted = combinations.exhausted
    return Attempt(status, constraints, (), None, undecided, tried, exhausted, relaxed)
