"""SL1M's relaxation (T eq. 5.9, 5.10): distance of each foothold from each candidate, in metres."""

import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.linear_program import Outcome, Program, Rows, solve
from jaxleas.contacts.programs.mixed_integer import Candidates, add_step
from jaxleas.contacts.programs.placement import put_com
from jaxleas.contacts.programs.slack_weights import SlackWeights, slack_weights
from jaxleas.contacts.programs.steps import Step


@dataclass(frozen=True, eq=False)
class Relaxed:
    """The answer of the relaxation.

    Attributes:
        outcome: "infeasible" proves that there is no plan.
        steps: steps as given, with the cuts that were found on the way.
        footholds: foothold of each phase [m].
        slack: alpha of each candidate of each phase [m]: its distance, and 0 on the surface.
    """

    outcome: Outcome
    steps: list[Step]
    footholds: Float[np.ndarray, "n 3"] | None = None
    slack: tuple[Float[np.ndarray, " c"], ...] = ()


def relax(
    problem: ContactProblem,
    steps: list[Step],
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
        steps: steps of the problem's phases, with cuts.
        candidates: candidates of each phase; a single one is a hard constraint.
        deadline: time by `time.perf_counter` after which to stop [s].
        weights: weights of the slacks, see `slack_weights`.
    """
    program, starts = _assemble(
        problem, steps, candidates, slack_weights(problem, candidates, weights)
    )
    solution = solve(program, deadline - time.perf_counter())
    if solution.outcome != "optimal":
        return Relaxed(solution.outcome, steps)
    footholds = solution.x[starts[:-1, None] + np.arange(3)]
    _, steps, _ = put_com(problem, steps, footholds)
    slack = tuple(
        np.array([problem.surfaces[name].distance(point) for name in names])
        for names, point in zip(candidates, footholds, strict=True)
    )
    return Relaxed("optimal", steps, footholds, slack)


def _assemble(
    problem: ContactProblem,
    steps: list[Step],
    candidates: Candidates,
    weights: list[Float[np.ndarray, " c"]],
) -> tuple[Program, np.ndarray]:
    slacks = [len(names) if len(names) > 1 else 0 for names in candidates]
    starts = np.cumsum([0, *(3 + each for each in slacks)])
    total = int(starts[-1])
    rows, cost = Rows(total), np.zeros(total)
    low = np.full(total, -np.inf)
    for index, (step, names) in enumerate(zip(steps, candidates, strict=True)):
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
        add_step(problem, step, rows, begin, starts)
    row_low, row_high = rows.bounds()
    high = np.full(total, np.inf)
    return Program(cost, low, high, rows.matrix(), row_low, row_high), starts
