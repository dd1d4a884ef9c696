"""Exact decision whether a plan exists: prune, mixed-integer program, placement, cuts, repeat."""

import time
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.attempt import search
from jaxleas.contacts.programs.com import with_first_cuts
from jaxleas.contacts.programs.constraints import Family, StepConstraints, make_constraints
from jaxleas.contacts.programs.linear_program import SolverStatus, solve
from jaxleas.contacts.programs.mixed_integer import Formulation, assemble, chosen_surfaces
from jaxleas.contacts.programs.nearest import Targets
from jaxleas.contacts.programs.placement import Placement, place
from jaxleas.contacts.programs.pruning import prune

SEARCH_SHARE = 0.8
"""Share of the remaining time for the search for surfaces at least cost; the placement gets the
rest."""


START_COMBINATIONS = 8
"""Number of SL1M's combinations to try first: most feasible problems end there, much sooner."""


@dataclass(frozen=True, eq=False)
class Decision:
    """The answer, with the plan if there is one.

    Attributes:
        status: "optimal" for a plan, "infeasible" for proof that there is none.
        surfaces: surface of each step.
        placement: footholds and centre of mass.
        dead_step: step that certainly cannot be made, if pruning found one.
        programs: number of mixed-integer programs solved.
    """

    status: SolverStatus
    surfaces: tuple[str, ...] = ()
    placement: Placement | None = None
    dead_step: int | None = None
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
        relaxed: amount by which the last step may violate each family of constraints [m].
        start: whether to try SL1M's first few combinations before any mixed-integer program
            (without cost).
    """
    complete = len(problem) - (1 if relaxed else 0)
    constraints = with_first_cuts(problem, make_constraints(problem, relaxed), complete)
    candidates = prune(problem, constraints)
    dead = next((index for index, names in enumerate(candidates) if not names), None)
    if dead is not None:
        return Decision("infeasible", dead_step=dead)
    if targets is None and start:
        found = search(problem, constraints, candidates, deadline, START_COMBINATIONS)
        if found.placement is not None:
            return Decision("optimal", found.surfaces, found.placement)
        if found.status in ("infeasible", "time_limit"):
            return Decision("infeasible" if found.status == "infeasible" else "time_limit")
        constraints = found.constraints
    failed: list[tuple[str, ...]] = []
    programs = 0
    while True:
        surfaces, status = tuple(names[0] for names in candidates), "optimal"
        if targets is not None or any(len(names) > 1 for names in candidates):
            program, choices = assemble(
                problem, constraints, candidates, formulation, targets, failed
            )
            programs += 1
            left = deadline - time.perf_counter()
            solution = solve(program, left if targets is None else SEARCH_SHARE * left)
            status = solution.status
            if status == "optimal":
                surfaces = chosen_surfaces(solution.x, choices, candidates)
        elif failed:
            status = "infeasible"
        if status != "optimal":
            return Decision(status, programs=programs)
        placement = place(problem, constraints, surfaces, deadline, targets)
        if placement.status == "optimal":
            return Decision("optimal", surfaces, placement, programs=programs)
        if placement.status != "infeasible":
            return Decision(placement.status, programs=programs)
        if cuts_of(placement.constraints) == cuts_of(constraints):
            failed.append(surfaces)  # within the solver's tolerance only
        constraints = placement.constraints


def cuts_of(constraints: list[StepConstraints]) -> int:
    """Return the number of rows of all steps."""
    return sum(constraint.size for constraint in constraints)
