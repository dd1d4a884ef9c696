"""The Newton step of one program, in compiled loops; `newton` is the same for batches in JAX.

All slacks of a program are one vector: those of forces in the order [S, W, P, F], then those of
each block in the order [G, L, R].
"""

from typing import NamedTuple

import numpy as np

from jaxleas.dynamics.croc.kernel_matrices import (
    add_gram,
    add_wrench,
    compiled,
    factor_in_place,
    invert_symmetric,
    pulled_back,
    solve_backwards,
    solve_forwards,
    times_symmetric,
    vectorised,
)
from jaxleas.dynamics.croc.solution import PROXIMAL


class Problem(NamedTuple):
    """One program; see `Programs`. Rows of blocks are [G, 3, R]."""

    arms: np.ndarray
    faces: np.ndarray
    standing: np.ndarray
    limit: float
    push: np.ndarray
    push_share: np.ndarray
    turn: np.ndarray
    turn_slope: np.ndarray
    reach_rows: np.ndarray
    reach_share: np.ndarray
    reach_bounds: np.ndarray
    acceleration_rows: np.ndarray
    acceleration_share: np.ndarray
    acceleration_bounds: np.ndarray


class Newton(NamedTuple):
    """Factors of a program's Newton matrix and the step found with them; see `newton.Factors`."""

    softness: np.ndarray  # [S, W, P, 6]
    pull: np.ndarray  # [S, W, P, 3]
    balance: np.ndarray  # [S, W, 6, 6]
    arrow: np.ndarray  # [S, W, 5, 6]; the last is the right side
    head: np.ndarray  # [4, 4]
    wanted: np.ndarray  # [S, W, P, 3]
    step: np.ndarray  # [4]; x and margin
    force_steps: np.ndarray  # [S, W, P, 3]


@compiled
def factorise(problem: Problem, weight: np.ndarray, newton: Newton) -> None:
    """Eliminate forces, then balances, from the Newton matrix."""
    phases, instants, points = newton.softness.shape[:3]
    faces = problem.faces.shape[2]
    head = newton.head
    head[:] = 0.0
    at = phases * instants * points * faces
    _add_rows(problem.reach_rows, problem.reach_share, weight[at:], head)
    at += problem.reach_bounds.size
    _add_rows(problem.acceleration_rows, problem.acceleration_share, weight[at:], head)
    bent = np.empty(3)
    at = 0
    for s in range(phases):
        for w in range(instants):
            balance, arrow = newton.balance[s, w], newton.arrow[s, w]
            balance[:] = 0.0
            arrow[:4] = 0.0
            for p in range(points):
                if problem.standing[s, p]:
                    soft, pull = newton.softness[s, w, p], newton.pull[s, w, p]
                    head[3, 3] += _soften(problem.faces[s, p], weight[at : at + faces], soft, pull)
                    add_gram(balance, problem.arms[s, p], soft)
                    times_symmetric(soft, pull, bent)
                    add_wrench(arrow[3], problem.arms[s, p], bent, -1.0)
                    head[3, 3] -= pull[0] * bent[0] + pull[1] * bent[1] + pull[2] * bent[2]
                at += faces
            factor_in_place(balance)
            a, b, c = problem.turn_slope[s, w]
            for i in range(3):
                arrow[i, i] = problem.push_share[s, w]
            arrow[0, 4], arrow[0, 5] = c, -b
            arrow[1, 3], arrow[1, 5] = -c, a
            arrow[2, 3], arrow[2, 4] = b, -a
            for i in range(4):
                solve_forwards(balance, arrow[i])
                for k in range(i + 1):
                    for j in range(6):
                        head[i, k] += arrow[i, j] * arrow[k, j]
    factor_in_place(head)


@compiled
def _soften(faces: np.ndarray, weight: np.ndarray, soft: np.ndarray, pull: np.ndarray) -> float:
    """Write the inverse of a point's block, and its coupling with the margin; return its sum."""
    soft[:] = 0.0
    soft[0] = soft[2] = soft[5] = PROXIMAL
    pull[:] = 0.0
    total = 0.0
    for f in range(len(faces)):
        w, a, b, c = weight[f], faces[f, 0], faces[f, 1], faces[f, 2]
        soft[0] += w * a * a
        soft[1] += w * a * b
        soft[2] += w * b * b
        soft[3] += w * a * c
        soft[4] += w * b * c
        soft[5] += w * c * c
        pull[0] += w * a
        pull[1] += w * b
        pull[2] += w * c
        total += w
    invert_symmetric(soft)
    return total


@vectorised
def _add_rows(rows: np.ndarray, share: np.ndarray, weight: np.ndarray, head: np.ndarray) -> None:
    """Add the 4 x 4 block of x and margin that limits on x alone make."""
    groups, instants = share.shape
    width = rows.shape[2]
    once, twice = np.empty(width), np.empty(width)
    at = 0
    for g in range(groups):
        once[:] = 0.0
        twice[:] = 0.0
        total = 0.0
        for i in range(instants):
            s = share[g, i]
            here = weight[at : at + width]
            for r in range(width):
                w = here[r]
                total += w
                once[r] += s * w
                twice[r] += s * s * w
            at += width
        head[3, 3] += total
        for i in range(3):
            a = rows[g, i]
            value = 0.0
            for r in range(width):
                value += once[r] * a[r]
            head[3, i] += value
            for k in range(i + 1):
                b = rows[g, k]
                value = 0.0
                for r in range(width):
                    value += twice[r] * a[r] * b[r]
                head[i, k] += value


@compiled
def find_direction(
    problem: Problem, newton: Newton, imbalance: np.ndarray, target: np.ndarray, aimed: bool
) -> None:
    """Write the step of x and margin, and of all forces.

    Args:
        problem: program.
        newton: factors; its step is overwritten.
        imbalance: error of the balances, [S, W, 6].
        target: wanted product of slack and dual, over the slack.
        aimed: whether there is a target; zero otherwise.
    """
    phases, instants, points = newton.softness.shape[:3]
    faces = problem.faces.shape[2]
    step, bent = newton.step, np.empty(3)
    step[:] = 0.0
    step[3] = 1.0
    if aimed:
        at = phases * instants * points * faces
        _gather_rows(problem.reach_rows, problem.reach_share, target[at:], step)
        at += problem.reach_bounds.size
        _gather_rows(problem.acceleration_rows, problem.acceleration_share, target[at:], step)
    at = 0
    for s in range(phases):
        for w in range(instants):
            right = newton.arrow[s, w, 4]
            right[:] = imbalance[s, w]
            for p in range(points):
                wanted = newton.wanted[s, w, p]
                wanted[:] = 0.0
                if aimed and problem.standing[s, p]:
                    for f in range(faces):
                        k = target[at + f]
                        step[3] -= k
                        for i in range(3):
                            wanted[i] += k * problem.faces[s, p, f, i]
                    times_symmetric(newton.softness[s, w, p], wanted, bent)
                    add_wrench(right, problem.arms[s, p], bent, 1.0)
                    for i in range(3):
                        step[3] += newton.pull[s, w, p, i] * bent[i]
                at += faces
            solve_forwards(newton.balance[s, w], right)
            for i in range(4):
                for j in range(6):
                    step[i] += newton.arrow[s, w, i, j] * right[j]
    solve_forwards(newton.head, step)
    solve_backwards(newton.head, step)
    _find_force_steps(problem, newton)


@vectorised
def _gather_rows(rows: np.ndarray, share: np.ndarray, target: np.ndarray, step: np.ndarray) -> None:
    """Subtract the part of limits on x alone from the right side of the step."""
    groups, instants = share.shape
    width = rows.shape[2]
    once = np.empty(width)
    at = 0
    for g in range(groups):
        once[:] = 0.0
        for i in range(instants):
            here = target[at : at + width]
            for r in range(width):
                once[r] += share[g, i] * here[r]
                step[3] -= here[r]
            at += width
        for i in range(3):
            a = rows[g, i]
            value = 0.0
            for r in range(width):
                value += once[r] * a[r]
            step[i] -= value


@compiled
def _find_force_steps(problem: Problem, newton: Newton) -> None:
    """Write the steps of all forces, from the step of x and margin."""
    phases, instants, points = newton.softness.shape[:3]
    rest, driven, step = np.empty(6), np.empty(3), newton.step
    for s in range(phases):
        for w in range(instants):
            for j in range(6):
                rest[j] = newton.arrow[s, w, 4, j]
                for i in range(4):
                    rest[j] -= newton.arrow[s, w, i, j] * step[i]
            solve_backwards(newton.balance[s, w], rest)
            for p in range(points):
                if problem.standing[s, p]:
                    for i in range(3):
                        driven[i] = newton.pull[s, w, p, i] * step[3] + newton.wanted[s, w, p, i]
                        driven[i] -= pulled_back(problem.arms[s, p], rest, i)
                    soft = newton.softness[s, w, p]
                    times_symmetric(soft, driven, newton.force_steps[s, w, p])
