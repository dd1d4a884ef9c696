"""SL1M (T 5.3): relax, keep the surfaces that the L1 norm decided, enumerate others by cost."""

from dataclasses import dataclass

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.com import with_first_cuts
from jaxleas.contacts.programs.combinations import Combinations
from jaxleas.contacts.programs.linear_program import Outcome
from jaxleas.contacts.programs.mixed_integer import Candidates
from jaxleas.contacts.programs.placement import Placement, place
from jaxleas.contacts.programs.pruning import prune
from jaxleas.contacts.programs.relaxation import Relaxed, relax
from jaxleas.contacts.programs.slack_weights import SlackWeights
from jaxleas.contacts.programs.steps import Step, make_steps

DECIDED = 1e-6
"""A foothold this near to a surface has selected it (the LP is solved to 1e-9) [m]."""
MAX_COMBINATIONS = 2000


@dataclass(frozen=True, eq=False)
class Attempt:
    """The result of an attempt by SL1M.

    Attributes:
        outcome: "optimal" for a plan; "infeasible" if the relaxation already is; else "not_found".
        steps: steps with the cuts found on the way.
        surfaces: surface of each phase.
        placement: footholds and centre of mass.
        undecided: phases that the relaxation left without a surface.
        combinations: number of combinations tried.
        exhausted: whether every combination was tried, or ruled out by one that was.
        relaxed: answer of the relaxation.
    """

    outcome: Outcome | str
    steps: list[Step]
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
    steps = with_first_cuts(problem, make_steps(problem), len(problem))
    candidates: Candidates = [phase.candidates for phase in problem.phases]
    if pruning:
        candidates = prune(problem, steps)
        if not all(candidates):
            return Attempt("infeasible", steps)
    return search(problem, steps, candidates, deadline, max_combinations, weights)


def search(
    problem: ContactProblem,
    steps: list[Step],
    candidates: Candidates,
    deadline: float,
    max_combinations: int,
    weights: SlackWeights = "uniform",
) -> Attempt:
    """Relax, take the nearest surfaces, then others by cost where a failure requires it.

    Args:
        problem: the contact problem.
        steps: steps of the problem's phases, with cuts.
        candidates: candidates of each phase, at least one each.
        deadline: time by `time.perf_counter` after which to stop [s].
        max_combinations: number of combinations after which it gives up; 0: a problem that the
            relaxation leaves undecided fails.
        weights: weights of the slacks.
    """
    relaxed = relax(problem, steps, candidates, deadline, weights)
    if relaxed.outcome != "optimal":
        return Attempt(relaxed.outcome, steps=relaxed.steps, relaxed=relaxed)
    steps = relaxed.steps
    undecided = sum(float(slack.min()) > DECIDED for slack in relaxed.slack)
    most = max_combinations if undecided else max(1, max_combinations)
    tried, outcome = 0, "not_found"
    combinations = Combinations(candidates, relaxed.slack)
    for surfaces in combinations:
        if tried == most:
            break
        tried += 1
        placement = place(problem, steps, surfaces, deadline)
        steps = placement.steps
        if placement.outcome == "optimal":
            return Attempt("optimal", steps, surfaces, placement, undecided, tried, False, relaxed)
        if placement.outcome == "time_limit":
            outcome = "time_limit"
            break
        if placement.outcome == "infeasible":
            combinations.refute(placement.blamed)
    exhausted = combinations.exhausted
    return Attempt(outcome, steps, (), None, undecided, tried, exhausted, relaxed)
