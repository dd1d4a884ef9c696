"""Exact decision whether a plan exists: prune, mixed-integer program, placement, cuts, repeat."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.attempt import search
from jaxleas.contacts.programs.com import with_first_cuts
from jaxleas.contacts.programs.linear_program import Outcome, solve
from jaxleas.contacts.programs.mixed_integer import Formulation, assemble, chosen_surfaces
from jaxleas.contacts.programs.placement import Placement, Targets, place
from jaxleas.contacts.programs.pruning import prune
from jaxleas.contacts.programs.steps import Family, Step, make_steps

SEARCH_SHARE = 0.8
"""Share of the remaining time for the search for surfaces at least cost; the placement gets the
rest."""


START_COMBINATIONS = 8
"""Number of SL1M's combinations to try first: most feasible problems end there, much sooner."""


@dataclass(frozen=True, eq=False)
class Decision:
    """The answer, with the plan if there is one.

    Attributes:
        outcome: "optimal" for a plan, "infeasible" for proof that there is none.
        surfaces: surface of each phase.
        placement: footholds and centre of mass.
        dead_phase: where infeasible, a phase that certainly cannot be made, if pruning found one.
        programs: number of mixed-integer programs solved.
    """

    outcome: Outcome
    surfaces: tuple[str, ...] = ()
    placement: Placement | None = None
    dead_phase: int | None = None
    programs: int = 0


def decide(
    problem: ContactProblem,
    deadline: float = np.inf,
    formulation: Formulation = "big_m",
    targets: Targets | None = None,
    relaxed: Mapping[Family, float] | None = None,
    start: bool = True,
) -> Decision:
    """Find a plan or prove that there is none.

    Args:
        problem: the contact problem.
        deadline: time by `time.perf_counter` after which to stop [s].
        formulation: formulation of the mixed-integer program.
        targets: targets of the footholds; a quadratic cost is minimised on the surfaces that the
            linear one chose, since HiGHS takes no quadratic cost with integers (as in T 5.2.3).
        relaxed: amount by which the last phase may violate each family of constraints [m].
        start: whether to try SL1M's first few combinations before any mixed-integer program
            (without cost).
    """
    complete = len(problem) - (1 if relaxed else 0)
    steps = with_first_cuts(problem, make_steps(problem, relaxed), complete)
    candidates = prune(problem, steps)
    dead = next((index for index, names in enumerate(candidates) if not names), None)
    if dead is not None:
        return Decision("infeasible", dead_phase=dead)
    if targets is None and start:
        found = search(problem, steps, candidates, deadline, START_COMBINATIONS)
        if found.placement is not None:
            return Decision("optimal", found.surfaces, found.placement)
        if found.outcome in ("infeasible", "time_limit"):
            return Decision("infeasible" if found.outcome == "infeasible" else "time_limit")
        steps = found.steps
    failed: list[tuple[str, ...]] = []
    programs = 0
    while True:
        surfaces, outcome = tuple(names[0] for names in candidates), "optimal"
        if targets is not None or any(len(names) > 1 for names in candidates):
            program, choices = assemble(problem, steps, candidates, formulation, targets, failed)
            programs += 1
            left = deadline - time.perf_counter()
            solution = solve(program, left if targets is None else SEARCH_SHARE * left)
            outcome = solution.outcome
            if outcome == "optimal":
                surfaces = chosen_surfaces(solution.x, choices, candidates)
        elif failed:
            outcome = "infeasible"
        if outcome != "optimal":
            return Decision(outcome, programs=programs)
        placement = place(problem, steps, surfaces, deadline, targets)
        if placement.outcome == "optimal":
            return Decision("optimal", surfaces, placement, programs=programs)
        if placement.outcome != "infeasible":
            return Decision(placement.outcome, programs=programs)
        if cuts_of(placement.steps) == cuts_of(steps):
            failed.append(surfaces)  # within the solver's tolerance only
        steps = placement.steps


def cuts_of(steps: list[Step]) -> int:
    """Return the number of rows of all steps."""
    return sum(step.size for step in steps)
