"""SL1M's relaxation (T eq. 5.9, 5.10): distance of each foothold from each candidate, in metres."""

import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import StepConstraints
from jaxleas.contacts.programs.linear_program import Program, Rows, SolverStatus, solve
from jaxleas.contacts.programs.mixed_integer import Candidates, add_constraint
from jaxleas.contacts.programs.placement import put_com
from jaxleas.contacts.programs.slack_weights import SlackWeights, slack_weights


@dataclass(frozen=True, eq=False)
class Relaxed:
    """The answer of the relaxation.

    Attributes:
        status: "infeasible" proves that there is no plan.
        constraints: constraints on the steps as given, with the cuts that were found on the way.
        footholds: foothold of each step [m].
        slack: alpha of each candidate of each step [m]: its distance, and 0 on the surface.
    """

    status: SolverStatus
    constraints: list[StepConstraints]
    footholds: Float[np.ndarray, "n 3"] | None = None
    slack: tuple[Float[np.ndarray, " c"], ...] = ()


def relax(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    candidates: Candidates,
    deadline: float = np.inf,
    weights: SlackWeights = "uniform",
) -> Relaxed:
    """Minimise the weighted sum of all slacks over footholds that the steps allow.

    min sum_kj w_kj a_kj  s.t.  S_j p_k <= s_j + a_kj,  |d_j . p_k - e_j| <= a_kj,  a >= 0, and
    steps. Rows have unit normals and there is no big-M, so that a slack is a distance in metres.
    Where the footholds leave no place for the centre of mass, cuts are returned, but the program is
    not solved again: `place` keeps every constraint, and a second solution decided no more.

    Args:
        problem: the contact problem.
        constraints: constraints on the problem's steps, with cuts.
        candidates: candidates of each step; a single one is a hard constraint.
        deadline: time by `time.perf_counter` after which to stop [s].
        weights: weights of the slacks, see `slack_weights`.
    """
    program, starts = _assemble(
        problem, constraints, candidates, slack_weights(problem, candidates, weights)
    )
    solution = solve(program, deadline - time.perf_counter())
    if solution.status != "optimal":
        return Relaxed(solution.status, constraints)
    footholds = solution.x[starts[:-1, None] + np.arange(3)]
    _, constraints, _ = put_com(problem, constraints, footholds)
    slack = tuple(
        np.array([problem.surfaces[name].distance(point) for name in names])
        for names, point in zip(candidates, footholds, strict=True)
    )
    return Relaxed("optimal", constraints, footholds, slack)


def _assemble(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    candidates: Candidates,
    weights: list[Float[np.ndarray, " c"]],
) -> tuple[Program, np.ndarray]:
    slacks = [len(names) if len(names) > 1 else 0 for names in candidates]
    starts = np.cumsum([0, *(3 + each for each in slacks)])
    total = int(starts[-1])
    rows, cost = Rows(total), np.zeros(total)
    low = np.full(total, -np.inf)
    for index, (constraint, names) in enumerate(zip(constraints, candidates, strict=True)):
        begin = int(starts[index])
        alpha = begin + 3 + np.arange(slacks[index])
        cost[alpha], low[alpha] = weights[index][: len(alpha)], 0.0
        for number, name in enumerate(names):
            surface = problem.surfaces[name]
            A = np.concatenate([surface.edge_normals, surface.normal[None], -surface.normal[None]])
            b = np.concatenate([surface.edge_offsets, [surface.offset, -surface.offset]])
            blocks = [(begin + np.arange(3), A)]
            if len(alpha):
                blocks.append((alpha[number : number + 1], -np.ones((len(b), 1))))
            rows.add(blocks, b)
        add_constraint(problem, constraint, rows, begin, starts)
    row_low, row_high = rows.bounds()
    high = np.full(total, np.inf)
    return Program(cost, low, high, rows.matrix(), row_low, row_high), starts
