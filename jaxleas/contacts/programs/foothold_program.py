"""The linear program of footholds on chosen surfaces, with the most distance to spare."""

import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import INITIAL, Link, StepConstraints
from jaxleas.contacts.programs.linear_program import Program, Rows, SolverStatus, solve
from jaxleas.contacts.programs.nearest import Targets, nearest_to
from jaxleas.contacts.surfaces import ContactSurface

MOST_MARGIN = 0.02
"""Greatest distance to spare that the program aims for [m]."""
LEAST_MARGIN = -1e-7
"""Footholds that violate a constraint by more than this [m] are rejected (certificate: 1e-6)."""
KEPT_MARGIN = 1e-6
"""Distance to spare that a cost must leave, where possible: the solver's tolerance [m]."""


@dataclass(frozen=True, eq=False)
class Feet:
    """Footholds without regard to the centre of mass.

    Attributes:
        status: "optimal" when there are footholds, "infeasible" when there are provably none.
        footholds: foothold of each step [m].
        blamed: steps of an infeasible problem whose surfaces together are impossible.
    """

    status: SolverStatus
    footholds: Float[np.ndarray, "n 3"] | None = None
    blamed: tuple[int, ...] = ()


def standing_point(
    problem: ContactProblem, link: Link, footholds: Float[np.ndarray, "n 3"]
) -> Float[np.ndarray, " 3"]:
    """Return where the foot of a link stands, which does not move [m]."""
    if link.standing != INITIAL:
        return footholds[link.standing]
    return problem.initial[link.effector].position


def place_feet(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    surfaces: tuple[str, ...],
    deadline: float = np.inf,
    targets: Targets | None = None,
) -> Feet:
    """Solve for two coordinates in the plane of each surface, and the least slack.

    Args:
        problem: contact problem.
        constraints: constraints on the steps, with or without cuts.
        surfaces: name of the surface of each step.
        deadline: time by `time.perf_counter` after which to stop [s].
        targets: places to minimise the distance to; None: maximise the least slack.
    """
    planes = [problem.surfaces[name] for name in surfaces]
    origin = np.array([plane.vertices.mean(axis=0) for plane in planes])
    bases = np.stack([plane.basis for plane in planes])
    rows, owners = _rows(problem, constraints, planes, origin)
    program = _most_slack(rows, len(planes))
    solution = solve(program, deadline - time.perf_counter())
    if solution.status != "optimal":
        return Feet(solution.status)
    margin = float(solution.x[-1])
    if margin < LEAST_MARGIN:
        return Feet("infeasible", blamed=_to_blame(solution.duals, owners))
    if targets is not None:
        margin = min(margin, KEPT_MARGIN)
        solution = nearest_to(targets, program, margin, origin, bases, deadline)
        if solution.status != "optimal":
            return Feet(solution.status)
    local = solution.x[: 2 * len(planes)].reshape(-1, 1, 2)
    return Feet("optimal", origin + (local @ bases)[:, 0, :])


def _rows(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    planes: list[ContactSurface],
    origin: Float[np.ndarray, "n 3"],
) -> tuple[Rows, list[tuple[int, int]]]:
    """Return the program's rows, and the steps that each concerns.

    These are the step that lands, and the one whose landing another foot stands on (or INITIAL).
    """
    count = len(planes)
    columns = np.arange(2 * count).reshape(count, 2)
    slack = np.array([2 * count])
    rows = Rows(2 * count + 1)
    owners: list[tuple[int, int]] = []
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
    return rows, owners


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
