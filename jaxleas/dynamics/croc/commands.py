"""The function behind `jaxleas transition check`."""

from pathlib import Path

import numpy as np

from jaxleas.dynamics.croc.certificate import Certificate, certify_transition
from jaxleas.dynamics.croc.definition import margin_by_definition
from jaxleas.dynamics.croc.solution import Ended, Solutions
from jaxleas.dynamics.croc.solving import Solver, solve_transitions
from jaxleas.dynamics.croc.transition_file import TransitionFile, read_transition
from jaxleas.dynamics.croc.transitions import GRAVITY, LEAST_MARGIN
from jaxleas.types import InputError

_NONNEGATIVE = "give 0 or more"


def check(
    file: Path,
    *,
    solver: Solver | None = None,
    least: float = LEAST_MARGIN,
    definition: bool = False,
) -> Solutions:
    """Say whether the centre of mass can cross from one support to the next, and certify it.

    Args:
        file: transition, .json; docs/transitions.md states its keys.
        solver: compiled (by numba) or jax; by default the first that is installed.
        least: least margin of a feasible transition.
        definition: find the margin by HiGHS as well, and print it.
    """
    if not (np.isfinite(least) and least >= 0.0):
        raise InputError(f"--least {least}: {_NONNEGATIVE}")
    stated = read_transition(file)
    solution = solve_transitions(stated.transition, stated.discretisation, solver)
    print(f"{file}: {_verdict(solution, least)}")
    if definition:
        exact = margin_by_definition(stated.transition, stated.discretisation)
        print(f"by HiGHS: margin {exact.margin:.6f}")
    if solution.ended == Ended.CONVERGED:
        print(_certified(stated, solution))
    return solution


def _verdict(solution: Solutions, least: float) -> str:
    if solution.ended == Ended.UNSUPPORTED:
        return "infeasible: a phase stands on nothing, on one point or on a line"
    if solution.ended == Ended.NOT_CONVERGED:
        return (
            f"no verdict: the search did not converge in {int(solution.iterations)} iterations;"
            f" the best margin found is {float(solution.margin):.6f}"
        )
    word = "feasible" if solution.feasible(least) else "infeasible"
    return f"{word}, margin {float(solution.margin):.6f} (feasible from {least:g} on)"


def _certified(stated: TransitionFile, solution: Solutions) -> str:
    found: Certificate = certify_transition(
        stated.transition, stated.discretisation, solution.free_point, solution.forces
    )
    name, time = found.weakest
    weight = stated.mass * GRAVITY
    x, y, z = solution.free_point
    return (
        f"free point {x:.4f}, {y:.4f}, {z:.4f} m\n"
        f"certificate: margin {found.margin:.6f} at {len(found.times)} instants, least in {name} at"
        f" {time:.2f} s; forces balance within {weight * found.imbalance:.2g} N and N m, and leave"
        f" their limits by {weight * found.outside:.2g} N"
    )
