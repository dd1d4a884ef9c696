"""The door to all solvers of transitions, on the host."""

from typing import Literal, get_args

import jax
import numpy as np

from jaxleas.dynamics.croc.checks import require_transitions
from jaxleas.dynamics.croc.definition import margin_by_definition
from jaxleas.dynamics.croc.host_solver import has_compiler, solve_on_host
from jaxleas.dynamics.croc.interior_point import solve_in_jax
from jaxleas.dynamics.croc.program import assemble
from jaxleas.dynamics.croc.sampled_curve import one_of
from jaxleas.dynamics.croc.solution import Ended, Solutions
from jaxleas.dynamics.croc.transitions import LEAST_MARGIN, Discretisation, Transitions
from jaxleas.types import InputError

Solver = Literal["compiled", "jax"]
SOLVERS: tuple[Solver, ...] = get_args(Solver)


def solve_transitions(
    transitions: Transitions,
    discretisation: Discretisation | None = None,
    solver: Solver | None = None,
) -> Solutions:
    """Return the largest margin of each transition, in doubles.

    Inside a program of JAX, compose `assemble` and `solve_in_jax` instead, under
    `jax.enable_x64(True)`.

    Args:
        transitions: transitions of any batch shape, in NumPy arrays.
        discretisation: degree of the curve, and where it is checked; None for degree 4 and four
            instants of each phase.
        solver: `compiled`, by numba, or `jax`; None for the first that is installed.

    Raises:
        InputError: shapes disagree, a number is out of range, or numba is not installed.
    """
    where = discretisation or Discretisation()
    chosen = solver or ("compiled" if has_compiler() else "jax")
    if chosen not in SOLVERS:
        raise InputError(f"solver is {chosen!r}: give one of {', '.join(SOLVERS)}")
    doubles = _doubles(transitions)
    require_transitions(doubles, where)
    if chosen == "compiled":
        return solve_on_host(assemble(doubles, where))
    with jax.enable_x64(True):
        answers = _solve_in_jax(jax.tree.map(jax.numpy.asarray, doubles), where)
        return jax.tree.map(np.asarray, answers)


def decide_transitions(
    transitions: Transitions,
    least: float = LEAST_MARGIN,
    discretisation: Discretisation | None = None,
    solver: Solver | None = None,
) -> Solutions:
    """Return whether each transition reaches a margin: `feasible(least)` of the answer.

    The compiled solver ends a search as soon as an iterate proves the answer, and the margin is
    then not the largest (`Ended.DECIDED`); it takes about half of the iterations.

    Args:
        transitions: transitions of any batch shape, in NumPy arrays.
        least: margin that is asked for [1].
        discretisation: degree of the curve, and where it is checked; as for `solve_transitions`.
        solver: solver to use, as in `solve_transitions`; `jax` finds the largest margins.

    Raises:
        InputError: shapes disagree, a number is out of range, or numba is not installed.
    """
    chosen = solver or ("compiled" if has_compiler() else "jax")
    if chosen != "compiled":
        return solve_transitions(transitions, discretisation, chosen)
    where = discretisation or Discretisation()
    doubles = _doubles(transitions)
    require_transitions(doubles, where)
    return solve_on_host(assemble(doubles, where), asked=least)


def margins_by_definition(
    transitions: Transitions, discretisation: Discretisation | None = None
) -> np.ndarray:
    """Return the same margins by HiGHS, one after another: the slow twin.

    Args:
        transitions: transitions of any batch shape, in NumPy arrays.
        discretisation: degree of the curve, and where it is checked.

    Raises:
        InputError: shapes disagree, or a number is out of range.
        JaxleasError: HiGHS found no answer.
    """
    where = discretisation or Discretisation()
    doubles = _doubles(transitions)
    require_transitions(doubles, where)
    found = np.empty(doubles.durations.shape[:-1])
    for index in np.ndindex(found.shape):
        found[index] = margin_by_definition(one_of(doubles, index), where).margin
    return found


@jax.jit(static_argnums=1)
def _solve_in_jax(transitions: Transitions, discretisation: Discretisation) -> Solutions:
    with jax.numpy_rank_promotion("allow"):
        return solve_in_jax(assemble(transitions, discretisation))


def _doubles(transitions: Transitions) -> Transitions:
    def double(value: object) -> np.ndarray:
        array = np.asarray(value)
        return array if array.dtype == np.bool_ else array.astype(np.float64)

    return jax.tree.map(double, transitions)


__all__ = ["SOLVERS", "Ended", "Solver", "margins_by_definition", "solve_transitions"]
