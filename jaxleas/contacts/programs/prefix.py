"""The last step that can be made, by binary search (T 5.2.3)."""

from collections.abc import Callable

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.linear_program import SolverStatus


def last_feasible_step(
    problem: ContactProblem,
    can_be_made: Callable[[ContactProblem], SolverStatus | str],
    infeasible_step: int | None = None,
) -> int | None:
    """Return the last step up to which a plan exists; -1 if not even the first can be made.

    Args:
        problem: problem that has no plan.
        can_be_made: function that judges the problem of the first steps; "optimal" means yes. If
            the first n steps have a plan, so have the first n - 1: n is found in log2 questions.
        infeasible_step: index of a step known to be impossible; by default the last.

    Returns:
        The step's index, or None if a question was not answered in time.
    """
    made, failed = -1, len(problem) - 1 if infeasible_step is None else infeasible_step
    while failed - made > 1:
        middle = (made + failed) // 2
        status = can_be_made(problem.prefix(middle + 1))
        if status in ("time_limit", "failed"):
            return None
        if status == "optimal":
            made = middle
        else:
            failed = middle
    return made
