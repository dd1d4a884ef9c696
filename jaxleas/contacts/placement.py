"""Footholds on chosen surfaces: a linear program, with the centre of mass put back by cuts."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy import sparse

from jaxleas.contacts.com import foot_yaws, place_com
from jaxleas.contacts.linear_program import Outcome, Program, Rows, solve
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.steps import INITIAL, Step, rotation

MOST_MARGIN = 0.02
"""More distance to spare than this [m] is not asked for."""
LEAST_MARGIN = -1e-7
"""Footholds that violate a constraint by more [m] are none (the certificate accepts 1e-6)."""
MAX_ROUNDS = 200


@dataclass(frozen=True, eq=False)
class Placement:
    """Footholds on given surfaces, or the news that there are none.

    Attributes:
        outcome: "optimal" when there are some, "infeasible" when provably none.
        steps: as given, with the cuts that were found on the way.
        footholds: of each phase [m].
        com: of each phase [m]; None for the model "feet".
    """

    outcome: Outcome
    steps: list[Step]
    footholds: Float[np.ndarray, "n 3"] | None = None
    com: Float[np.ndarray, "n 2 3"] | None = None


@dataclass(frozen=True, eq=False)
class Targets:
    """Where footholds should be, horizontally.

    Attributes:
        points: x, y of each phase [m].
    """

    points: Float[np.ndarray, "n 2"]


def place(
    problem: ContactProblem,
    steps: list[Step],
    surfaces: tuple[str, ...],
    time_limit: float = np.inf,
    targets: Targets | None = None,
) -> Placement:
    """Place each foot on its surface, with the most distance to spare or nearest to targets.

    Args:
        problem: the contact problem.
        steps: of `make_steps`, with or without cuts.
        surfaces: one a phase.
        time_limit: [s].
        targets: minimise the sum of squared distances to these, else maximise the least slack.
    """
    for _ in range(MAX_ROUNDS):
        outcome, footholds = _place_feet(problem, steps, surfaces, time_limit, targets)
        if footholds is None:
            return Placement(outcome, steps)
        com, steps, found = put_com(problem, steps, footholds)
        if not found:
            return Placement("optimal", steps, footholds, com)
    return Placement("failed", steps)


def put_com(
    problem: ContactProblem, steps: list[Step], footholds: Float[np.ndarray, "n 3"]
) -> tuple[Float[np.ndarray, "n 2 3"] | None, list[Step], int]:
    """Put the centre of mass over given footholds.

    Returns:
        Its places [m], the steps with cuts for those that leave it none, and how many these are.
    """
    if problem.model != "two_com":
        return None, steps, 0
    com, steps, found = np.zeros((len(steps), 2, 3)), list(steps), 0
    for index, yaws in enumerate(foot_yaws(problem, steps)):
        step = steps[index]
        stood = standing_point(problem, step, footholds)
        turns = rotation(yaws[0]), rotation(yaws[1])
        places, cuts = place_com(step, footholds[index] - stood, problem.foot_half_size, turns)
        com[index] = stood + places
        if cuts:
            found += 1
            normals, bounds = zip(*cuts, strict=True)
            steps[index] = step.with_cuts(np.array(normals), np.array(bounds))
    return com, steps, found


def standing_point(
    problem: ContactProblem, step: Step, footholds: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, " 3"]:
    """Return where the foot stands that does not move [m]."""
    if step.standing != INITIAL:
        return footholds[step.standing]
    return problem.initial["RF" if step.foot == "LF" else "LF"].position


def _place_feet(
    problem: ContactProblem,
    steps: list[Step],
    surfaces: tuple[str, ...],
    time_limit: float,
    targets: Targets | None,
) -> tuple[Outcome, Float[np.ndarray, "n 3"] | None]:
    """Solve for two coordinates in the plane of each surface, and the least slack."""
    count = len(steps)
    planes = [problem.surfaces[name] for name in surfaces]
    origin = np.array([plane.vertices.mean(axis=0) for plane in planes])
    columns = np.arange(2 * count).reshape(count, 2)
    slack = np.array([2 * count])
    rows = Rows(2 * count + 1)
    for index, (plane, step) in enumerate(zip(planes, steps, strict=True)):
        inside = plane.edge_offsets - plane.edge_normals @ origin[index]
        ones = np.ones((len(inside), 1))
        rows.add([(columns[index], plane.edge_normals @ plane.basis.T), (slack, ones)], inside)
        ones = np.ones((len(step.b), 1))
        blocks = [(columns[index], step.A @ plane.basis.T), (slack, ones)]
        bound = step.b - step.A @ origin[index]
        if step.standing == INITIAL:
            bound = bound + step.A @ standing_point(problem, step, origin)
        else:
            blocks.append((columns[step.standing], -step.A @ planes[step.standing].basis.T))
            bound = bound + step.A @ origin[step.standing]
        rows.add(blocks, bound)
    program = _most_slack(rows, count)
    solution = solve(program, time_limit)
    if solution.outcome != "optimal":
        return solution.outcome, None
    margin = float(solution.x[-1])
    if margin < LEAST_MARGIN:
        return "infeasible", None
    bases = np.stack([plane.basis for plane in planes])
    if targets is not None:
        nearer = solve(_nearest(program, origin, bases, targets, margin), time_limit)
        if nearer.outcome == "time_limit":
            return "time_limit", None
        solution = nearer if nearer.outcome == "optimal" else solution
    local = solution.x[:-1].reshape(count, 1, 2)
    return "optimal", origin + (local @ bases)[:, 0, :]


def _most_slack(rows: Rows, count: int) -> Program:
    cost = np.zeros(2 * count + 1)
    cost[-1] = -1.0
    row_low, row_high = rows.bounds()
    return Program(
        cost=cost,
        low=np.append(np.full(2 * count, -np.inf), -1.0),
        high=np.append(np.full(2 * count, np.inf), MOST_MARGIN),
        A=rows.matrix(),
        row_low=row_low,
        row_high=row_high,
    )


def _nearest(
    program: Program, origin: np.ndarray, bases: np.ndarray, targets: Targets, margin: float
) -> Program:
    """Minimise sum |p_xy - target|^2 = |origin_xy + B' w - target|^2 over the same rows."""
    flat = bases[:, :, :2]  # phase, coordinate in the plane, world x y
    hessian = 2.0 * np.einsum("kax,kbx->kab", flat, flat)
    linear = 2.0 * np.einsum("kax,kx->ka", flat, origin[:, :2] - targets.points)
    keep = min(margin, 1e-6)  # so that the solver's tolerance does no harm
    Q = sparse.block_diag([*hessian, np.zeros((1, 1))], format="csc")
    low, high = program.low.copy(), program.high.copy()
    low[-1] = high[-1] = keep
    return Program(
        cost=np.append(linear.ravel(), 0.0),
        low=low,
        high=high,
        A=program.A,
        row_low=program.row_low,
        row_high=program.row_high,
        Q=sparse.csc_array(Q),
    )
