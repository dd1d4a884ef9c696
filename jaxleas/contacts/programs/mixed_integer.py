"""The mixed-integer program of T app. B.2, assembled: one surface per step, footholds on it."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import INITIAL, StepConstraints
from jaxleas.contacts.programs.linear_program import Program, Rows
from jaxleas.contacts.programs.nearest import Targets

Formulation = Literal["hull", "big_m"]
LOOSER, SPARE = 1.5, 0.05
"""A big-M is this many times the smallest possible value, plus this much [m]: HiGHS may end with
"solve error" where one is exactly tight."""
Candidates = list[tuple[str, ...]]


def assemble(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    candidates: Candidates,
    formulation: Formulation,
    targets: Targets | None = None,
    excluded: list[tuple[str, ...]] | None = None,
) -> tuple[Program, list[np.ndarray]]:
    """Build the program.

    "hull": p_k = sum_jv l_jv V_jv, sum_v l_jv = z_j, sum_j z_j = 1, l >= 0, z binary: the convex
    hull of each step's candidates, hence the tightest relaxation of the choice. "big_m" (T 5.3,
    5.4): S_j p <= s_j + M (1 - z_j), |d_j . p - e_j| <= M (1 - z_j), each M the most by which a
    corner of another candidate violates the row.

    Args:
        problem: the contact problem.
        constraints: constraints on the problem's steps, with cuts.
        candidates: candidates of each step, pruned; none is empty.
        formulation: form of the constraint "p lies on surface j".
        targets: places to minimise the L1 distance to; None: any feasible point.
        excluded: choices of surfaces that are known to fail.

    Returns:
        The program, and the columns of each step's choice variables (empty where there is one
        candidate).
    """
    sizes = [_columns(problem, names, formulation) for names in candidates]
    starts = np.cumsum([0, *sizes])
    extra = 0 if targets is None else 2 * len(constraints)
    total = int(starts[-1]) + extra
    rows, low, high = Rows(total), np.full(total, -np.inf), np.full(total, np.inf)
    integer, choices = np.zeros(total, bool), []
    for index, (constraint, names) in enumerate(zip(constraints, candidates, strict=True)):
        begin = int(starts[index])
        add = _add_hull if formulation == "hull" else _add_big_m
        chosen = add(problem, names, rows, begin, low)
        low[chosen], high[chosen], integer[chosen] = 0.0, 1.0, True
        choices.append(chosen)
        add_constraint(problem, constraint, rows, begin, starts)
    cost = np.zeros(total)
    if targets is not None:
        cost[int(starts[-1]) :] = 1.0
        _add_targets(rows, starts, targets)
    for surfaces in excluded or []:
        _exclude(rows, candidates, choices, surfaces)
    row_low, row_high = rows.bounds()
    return Program(cost, low, high, rows.matrix(), row_low, row_high, integer), choices


def chosen_surfaces(
    x: Float[np.ndarray, " n"], choices: list[np.ndarray], candidates: Candidates
) -> tuple[str, ...]:
    """Return the surface of each step in a solution."""
    return tuple(
        names[int(np.argmax(x[columns]))] if len(columns) else names[0]
        for columns, names in zip(choices, candidates, strict=True)
    )


def _columns(problem: ContactProblem, names: tuple[str, ...], formulation: Formulation) -> int:
    chosen = len(names) if len(names) > 1 else 0
    if formulation == "big_m":
        return 3 + chosen
    return 3 + chosen + sum(len(problem.surfaces[name].vertices) for name in names)


def _add_hull(
    problem: ContactProblem, names: tuple[str, ...], rows: Rows, begin: int, low: np.ndarray
) -> np.ndarray:
    """Add p = sum l V; sum_v l_jv = z_j; sum z = 1 (or sum l = 1 with a single candidate)."""
    corners = [problem.surfaces[name].vertices for name in names]
    weights = begin + 3 + np.arange(sum(len(each) for each in corners))
    low[weights] = 0.0
    none = np.zeros(3)
    rows.add([(begin + np.arange(3), -np.eye(3)), (weights, np.concatenate(corners).T)], none, none)
    one = np.ones(1)
    if len(names) == 1:
        rows.add([(weights, np.ones((1, len(weights))))], one, one)
        return np.zeros(0, int)
    chosen = weights[-1] + 1 + np.arange(len(names))
    owner = np.repeat(np.arange(len(names)), [len(each) for each in corners])
    belongs = (np.arange(len(names))[:, None] == owner).astype(float)
    none = np.zeros(len(names))
    rows.add([(weights, belongs), (chosen, -np.eye(len(names)))], none, none)
    rows.add([(chosen, np.ones((1, len(names))))], one, one)
    return chosen


def _add_big_m(
    problem: ContactProblem, names: tuple[str, ...], rows: Rows, begin: int, low: np.ndarray
) -> np.ndarray:
    surfaces = [problem.surfaces[name] for name in names]
    every = np.concatenate([surface.vertices for surface in surfaces])
    position = begin + np.arange(3)
    one = np.ones(1)
    chosen = begin + 3 + np.arange(len(names) if len(names) > 1 else 0)
    for number, surface in enumerate(surfaces):
        A = np.concatenate([surface.edge_normals, surface.normal[None], -surface.normal[None]])
        b = np.concatenate([surface.edge_offsets, [surface.offset, -surface.offset]])
        if len(names) == 1:
            rows.add([(position, A)], b)
            continue
        big = LOOSER * np.maximum((A @ every.T).max(axis=1) - b, 0.0) + SPARE
        rows.add([(position, A), (chosen[number : number + 1], big[:, None])], b + big)
    if len(names) > 1:
        rows.add([(chosen, np.ones((1, len(names))))], one, one)
    return chosen


def add_constraint(
    problem: ContactProblem, constraint: StepConstraints, rows: Rows, begin: int, starts: np.ndarray
) -> None:
    """Add A (p_m - p_o) <= b for each foot o that stands.

    Args:
        problem: the contact problem.
        constraint: constraints on the step.
        rows: rows to append to.
        begin: column of p_m's first coordinate.
        starts: column of the first coordinate of each step's foothold.
    """
    for link in constraint.links:
        blocks, bound = [(begin + np.arange(3), link.A)], link.b
        if link.standing == INITIAL:
            bound = bound + link.A @ problem.initial[link.effector].position
        else:
            blocks.append((int(starts[link.standing]) + np.arange(3), -link.A))
        rows.add(blocks, bound)


def _add_targets(rows: Rows, starts: np.ndarray, targets: Targets) -> None:
    """Add |p_xy - target| <= u, in either direction."""
    for index, point in enumerate(targets.points):
        xy = int(starts[index]) + np.arange(2)
        apart = int(starts[-1]) + 2 * index + np.arange(2)
        for sign in (1.0, -1.0):
            rows.add([(xy, sign * np.eye(2)), (apart, -np.eye(2))], sign * point)


def _exclude(
    rows: Rows, candidates: Candidates, choices: list[np.ndarray], surfaces: tuple[str, ...]
) -> None:
    """Require that at least one step chooses another surface."""
    columns = [
        chosen[names.index(name)]
        for names, chosen, name in zip(candidates, choices, surfaces, strict=True)
        if len(chosen) and name in names
    ]
    rows.add([(np.array(columns, int), np.ones((1, len(columns))))], np.array([len(columns) - 1.0]))
