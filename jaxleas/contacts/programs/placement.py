"""Footholds on chosen surfaces: a linear program, with cuts that stand for the centre of mass."""

import time
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy import sparse

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.com import foot_yaws
from jaxleas.contacts.programs.com_places import place_coms
from jaxleas.contacts.programs.constraints import INITIAL, Link, StepConstraints, rotation
from jaxleas.contacts.programs.least_distance import least_distance
from jaxleas.contacts.programs.linear_program import Program, Rows, Solution, SolverStatus, solve
from jaxleas.types import InputError

MOST_MARGIN = 0.02
"""Greatest distance to spare that the program aims for [m]."""
LEAST_MARGIN = -1e-7
"""Footholds that violate a constraint by more than this [m] are rejected (certificate: 1e-6)."""
KEPT_MARGIN = 1e-6
"""Distance to spare that a cost must leave, where possible: the solver's tolerance [m]."""
MAX_ROUNDS = 200


@dataclass(frozen=True, eq=False)
class Placement:
    """Footholds on given surfaces, or the result that there are none.

    Attributes:
        status: "optimal" when there are footholds, "infeasible" when there are provably none.
        constraints: constraints on the steps as given, with the cuts that were found on the way.
        footholds: foothold of each step [m].
        com: places of the centre of mass in each step [m]; None for the model "feet".
        blamed: steps of an infeasible problem whose surfaces together are impossible, whatever the
            surfaces of the others.
    """

    status: SolverStatus
    constraints: list[StepConstraints]
    footholds: Float[np.ndarray, "n 3"] | None = None
    com: Float[np.ndarray, "n 2 3"] | None = None
    blamed: tuple[int, ...] = ()


@dataclass(frozen=True, eq=False)
class Targets:
    """Places that footholds should be near, horizontally.

    Attributes:
        points: x, y of the target of each step [m].
        cost: "linear": sum of |x - x'| + |y - y'|; "quadratic": sum of squared distances.
    """

    points: Float[np.ndarray, "n 2"]
    cost: Literal["linear", "quadratic"] = "linear"


def place(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    surfaces: tuple[str, ...],
    deadline: float = np.inf,
    targets: Targets | None = None,
) -> Placement:
    """Place each foot on its surface, with the most distance to spare or nearest to targets.

    Args:
        problem: the contact problem.
        constraints: constraints on the steps from `make_constraints`, with or without cuts.
        surfaces: name of the surface of each step.
        deadline: time by `time.perf_counter` after which to stop [s].
        targets: places to minimise the distance to; None: maximise the least slack.
    """
    for _ in range(MAX_ROUNDS):
        status, footholds, blamed = _place_feet(problem, constraints, surfaces, deadline, targets)
        if footholds is None:
            return Placement(status, constraints, blamed=blamed)
        com, constraints, found = put_com(problem, constraints, footholds)
        if not found:
            return Placement("optimal", constraints, footholds, com)
    return Placement("failed", constraints)


def put_com(
    problem: ContactProblem, constraints: list[StepConstraints], footholds: Float[np.ndarray, "n 3"]
) -> tuple[Float[np.ndarray, "n 2 3"] | None, list[StepConstraints], int]:
    """Put the centre of mass over given footholds.

    Returns:
        Its places [m], the steps with cuts for those that leave no place, and how many such
        steps there are.
    """
    if problem.model != "two_com":
        return None, constraints, 0
    stood = np.array(
        [standing_point(problem, constraint.link, footholds) for constraint in constraints]
    )
    turns = np.array([[rotation(yaw) for yaw in yaws] for yaws in foot_yaws(problem, constraints)])
    half_sizes = np.array(
        [
            [problem.half_sizes[name] for name in (constraint.link.effector, constraint.foot)]
            for constraint in constraints
        ]
    )
    places, cuts = place_coms(constraints, footholds - stood, half_sizes, turns)
    constraints = list(constraints)
    for index, found in cuts.items():
        normals, bounds = zip(*found, strict=True)
        constraints[index] = constraints[index].with_cuts(np.array(normals), np.array(bounds))
    return stood[:, None] + places, constraints, len(cuts)


def standing_point(
    problem: ContactProblem, link: Link, footholds: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, " 3"]:
    """Return where the foot of a link stands, which does not move [m]."""
    if link.standing != INITIAL:
        return footholds[link.standing]
    return problem.initial[link.effector].position


def _place_feet(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    surfaces: tuple[str, ...],
    deadline: float,
    targets: Targets | None,
) -> tuple[SolverStatus, Float[np.ndarray, "n 3"] | None, tuple[int, ...]]:
    """Solve for two coordinates in the plane of each surface, and the least slack.

    Returns:
        The status, footholds where there are some, and the steps to blame where there are none.
    """
    count = len(constraints)
    planes = [problem.surfaces[name] for name in surfaces]
    origin = np.array([plane.vertices.mean(axis=0) for plane in planes])
    columns = np.arange(2 * count).reshape(count, 2)
    slack = np.array([2 * count])
    rows = Rows(2 * count + 1)
    owners = []  # the steps that a row concerns: where it lands, where another foot stands
    for index, (plane, constraint) in enumerate(zip(planes, constraints, strict=True)):
        inside = plane.edge_offsets - plane.edge_normals @ origin[index]
        ones = np.ones((len(inside), 1))
        rows.add([(columns[index], plane.edge_normals @ plane.basis.T), (slack, ones)], inside)
        owners += [(index, index)] * len(inside)
        for link in constraint.links:
            ones = np.ones((len(link.b), 1))
            blocks = [(columns[index], link.A @ plane.basis.T), (slack, ones)]
            bound = link.b - link.A @ origin[index]
            if link.standing == INITIAL:
                bound = bound + link.A @ standing_point(problem, link, origin)
            else:
                blocks.append((columns[link.standing], -link.A @ planes[link.standing].basis.T))
                bound = bound + link.A @ origin[link.standing]
            rows.add(blocks, bound)
            owners += [(index, link.standing)] * len(link.b)
    program = _most_slack(rows, count)
    solution = solve(program, deadline - time.perf_counter())
    if solution.status != "optimal":
        return solution.status, None, ()
    margin = float(solution.x[-1])
    if margin < LEAST_MARGIN:
        return "infeasible", None, _to_blame(solution.duals, owners)
    bases = np.stack([plane.basis for plane in planes])
    if targets is not None:
        kept = _with_margin(program, min(margin, KEPT_MARGIN))
        if targets.cost == "linear":
            solution = solve(
                _nearest_linear(kept, origin, bases, targets), deadline - time.perf_counter()
            )
        else:
            solution = _nearest_quadratic(kept, origin, bases, targets)
        if solution.status != "optimal":
            return solution.status, None, ()
    local = solution.x[: 2 * count].reshape(count, 1, 2)
    return "optimal", origin + (local @ bases)[:, 0, :], ()


def _to_blame(duals: Float[np.ndarray, " r"], owners: list[tuple[int, int]]) -> tuple[int, ...]:
    """Return the steps of the rows with a dual: these rows alone allow no more slack."""
    size = np.abs(duals)
    rows = np.flatnonzero(size > 1e-9 * size.max(initial=0.0))
    blamed = {step for row in rows for step in owners[row]} - {INITIAL}
    return tuple(sorted(blamed or {step for step, _ in owners}))


def _most_slack(rows: Rows, count: int) -> Program:
    cost = np.zeros(2 * count + 1)
    cost[-1] = -1.0
    row_low, row_high = rows.bounds()
    return Program(
        cost=cost,
        low=np.full(2 * count + 1, -np.inf),
        high=np.append(np.full(2 * count, np.inf), MOST_MARGIN),
        A=rows.matrix(),
        row_low=row_low,
        row_high=row_high,
    )


def _nearest_quadratic(
    program: Program, origin: np.ndarray, bases: np.ndarray, targets: Targets
) -> Solution:
    """Minimise sum |u|^2, u = p_xy - target = origin_xy + B' w - target, over the same rows."""
    flat = bases[:, :, :2].transpose(0, 2, 1)  # step, world x y, coordinate in the plane
    if (np.abs(np.linalg.det(flat)) < 1e-3).any():
        raise InputError("a quadratic cost is horizontal: it needs surfaces that are no walls")
    back = sparse.block_diag(list(np.linalg.inv(flat)), format="csr")
    away = (targets.points - origin[:, :2]).ravel()
    G = sparse.csr_array(program.A @ back).toarray()
    length = np.linalg.norm(G, axis=1)
    bounds = length > 1e-12  # a row without a horizontal part is a constant
    h = (program.row_high - G @ away)[bounds] / length[bounds]
    nearest = least_distance(G[bounds] / length[bounds, None], h)
    if nearest is None:
        return Solution("failed", np.zeros(0))
    return Solution("optimal", np.asarray(back @ (nearest + away)))


def _nearest_linear(
    program: Program, origin: np.ndarray, bases: np.ndarray, targets: Targets
) -> Program:
    """Return the program that minimises sum u over the same rows and |p_xy - target| <= u."""
    size = 2 * len(origin)
    flat = sparse.block_diag([each[:, :2].T for each in bases])
    apart = -sparse.identity(size)
    away = (targets.points - origin[:, :2]).ravel()
    before = sparse.hstack([program.A, sparse.csr_array((len(program.row_high), size))])
    distances = sparse.vstack([sparse.hstack([sign * flat, apart]) for sign in (1.0, -1.0)])
    return Program(
        cost=np.append(np.zeros(size), np.ones(size)),
        low=np.append(program.low, np.zeros(size)),
        high=np.append(program.high, np.full(size, np.inf)),
        A=sparse.csr_array(sparse.vstack([before, distances])),
        row_low=np.append(program.row_low, np.full(2 * size, -np.inf)),
        row_high=np.concatenate([program.row_high, away, -away]),
    )


def _with_margin(program: Program, margin: float) -> Program:
    """Return the program with its least slack fixed instead of maximised, and without cost."""
    return Program(
        cost=program.cost[:-1],
        low=program.low[:-1],
        high=program.high[:-1],
        A=sparse.csr_array(program.A[:, :-1]),
        row_low=program.row_low,
        row_high=program.row_high - margin,  # in metres: every row has slack 1
    )
