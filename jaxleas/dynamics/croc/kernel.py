"""The interior point method of one program, in compiled loops; `interior_point` explains it."""

from typing import NamedTuple

import numpy as np

from jaxleas.dynamics.croc.kernel_matrices import (
    add_gram,
    add_wrench,
    compiled,
    factor_in_place,
    pulled_back,
    solve_backwards,
    solve_forwards,
    vectorised,
)
from jaxleas.dynamics.croc.kernel_newton import Newton, Problem, factorise, find_direction
from jaxleas.dynamics.croc.solution import (
    BOLD,
    CAUTIOUS,
    CLOSE,
    MOST_ITERATIONS,
    NARROWEST,
    NEAR,
    RESIDUAL,
    ROOM,
    TOLERANCE,
    UNBOUNDED,
    WORSE,
    Ended,
)

_CONVERGED = int(Ended.CONVERGED)
_DECIDED = int(Ended.DECIDED)
_NOT_CONVERGED = int(Ended.NOT_CONVERGED)
_UNSUPPORTED = int(Ended.UNSUPPORTED)


class State(NamedTuple):
    """An iterate, and room for the next one."""

    x: np.ndarray  # [4]; free point and margin
    forces: np.ndarray  # [S, W, P, 3]
    imbalance: np.ndarray  # [S, W, 6]
    slack: np.ndarray  # one entry of each inequality, and so are the following
    dual: np.ndarray
    inverse: np.ndarray
    weight: np.ndarray
    change: np.ndarray
    dual_change: np.ndarray
    target: np.ndarray
    dual_error: np.ndarray  # [1]; share of the first duals' error that is left


@compiled
def solve(problem: Problem, newton: Newton, state: State, asked: float) -> tuple[int, int]:
    """Leave the answer in the state; return how the search ended, and its iterations.

    Args:
        problem: program.
        newton: room for its factors.
        state: room for its iterates.
        asked: margin of which it is only asked whether it can be reached; NaN for the largest.
    """
    if not _begin(problem, newton, state):
        return _UNSUPPORTED, 0
    slack, dual, target = state.slack, state.dual, state.target
    gap = _dot(slack, dual)
    count = 0
    for i in range(len(dual)):
        count += dual[i] > 0.0
    iterations = 0
    state.dual_error[0] = 1.0
    is_decided = False
    while gap >= TOLERANCE and iterations < MOST_ITERATIONS:
        is_decided = _is_decided(state, gap, asked)
        if is_decided:
            break
        for i in range(len(slack)):
            state.inverse[i] = 1.0 / slack[i]
            state.weight[i] = dual[i] * state.inverse[i]
        factorise(problem, state.weight, newton)
        _weigh(problem, state)
        find_direction(problem, newton, state.imbalance, target, False)
        _change(problem, newton.step, newton.force_steps, state.change)
        aim = _foreseen(state, gap) / count
        for i in range(len(target)):
            if dual[i] > 0.0:
                missing = aim - state.change[i] * state.dual_change[i]
                target[i] = missing * state.inverse[i]
        find_direction(problem, newton, state.imbalance, target, True)
        _change(problem, newton.step, newton.force_steps, state.change)
        next_gap = _advance(newton, state, gap)
        iterations += 1
        if not next_gap < WORSE * max(gap, NEAR):
            break
        gap = next_gap
    error = _weigh(problem, state)
    if is_decided and error < RESIDUAL:
        return _DECIDED, iterations
    is_right = gap < CLOSE and error < RESIDUAL
    return (_CONVERGED if is_right else _NOT_CONVERGED), iterations


@compiled
def _is_decided(state: State, gap: float, asked: float) -> bool:
    """Return whether an iterate proves that a margin can, or cannot, be reached.

    Iterates are feasible, so that theirs is; and once the duals are, too, the gap bounds all.
    """
    if state.x[3] > asked + CLOSE:
        return True
    return state.dual_error[0] < UNBOUNDED and state.x[3] + gap < asked - CLOSE


@compiled
def _begin(problem: Problem, newton: Newton, state: State) -> bool:
    """Write the first iterate; return whether the supports can bear a wrench at all."""
    phases, instants, points = newton.softness.shape[:3]
    soft, needed = np.zeros(6), np.empty(6)
    soft[0] = soft[2] = soft[5] = 1.0
    factor = newton.balance[0, 0]
    state.forces[:] = 0.0
    newton.force_steps[:] = 0.0
    state.x[:] = 0.0
    for s in range(phases):
        factor[:] = 0.0
        for p in range(points):
            if problem.standing[s, p]:
                add_gram(factor, problem.arms[s, p], soft)
        if not factor_in_place(factor) > NARROWEST:
            return False
        for w in range(instants):
            for i in range(3):
                needed[i], needed[3 + i] = problem.push[s, w, i], problem.turn[s, w, i]
            solve_forwards(factor, needed)
            solve_backwards(factor, needed)
            for p in range(points):
                if problem.standing[s, p]:
                    for i in range(3):
                        state.forces[s, w, p, i] = pulled_back(problem.arms[s, p], needed, i)
    # As changes from nothing, forces give their own slacks; then limits are added.
    _change(problem, state.x, state.forces, state.slack)
    standing = _add_limits(problem, state.slack, state.target)
    least = np.inf
    for i in range(len(state.slack)):
        if state.target[i] > 0.0:
            least = min(least, state.slack[i])
    state.x[3] = least - ROOM
    total = 0.0
    for i in range(len(state.slack)):
        if state.target[i] > 0.0:
            state.slack[i] -= state.x[3]
            total += 1.0 / state.slack[i]
        else:
            state.slack[i] = 1.0
    for i in range(len(state.slack)):
        state.dual[i] = state.target[i] / (total * state.slack[i])
    return standing > 0 and np.isfinite(total)


@compiled
def _add_limits(problem: Problem, slack: np.ndarray, is_there: np.ndarray) -> int:
    """Add constants to slacks; write 1 where there is an inequality, 0 where a point is missing."""
    phases, points, faces = problem.faces.shape[:3]
    instants = problem.push_share.shape[1]
    at = count = 0
    for s in range(phases):
        for _ in range(instants):
            for p in range(points):
                for f in range(faces):
                    is_there[at] = 1.0 if problem.standing[s, p] else 0.0
                    slack[at] += problem.limit if f == faces - 1 else 0.0
                    at += 1
                count += problem.standing[s, p]
    for bounds in (problem.reach_bounds, problem.acceleration_bounds):
        for g in range(bounds.shape[0]):
            for i in range(bounds.shape[1]):
                for r in range(bounds.shape[2]):
                    slack[at] += bounds[g, i, r]
                    is_there[at] = 1.0
                    at += 1
    return count


@compiled
def _change(problem: Problem, step: np.ndarray, forces: np.ndarray, change: np.ndarray) -> None:
    """Write the changes of all slacks for a step of x and margin and of all forces."""
    phases, instants, points = forces.shape[:3]
    faces = problem.faces.shape[2]
    at = 0
    for s in range(phases):
        for w in range(instants):
            for p in range(points):
                if problem.standing[s, p]:
                    x, y, z = forces[s, w, p]
                    for f in range(faces):
                        face = problem.faces[s, p, f]
                        change[at + f] = face[0] * x + face[1] * y + face[2] * z - step[3]
                else:
                    change[at : at + faces] = 0.0
                at += faces
    _change_rows(problem.reach_rows, problem.reach_share, step, change[at:])
    at += problem.reach_bounds.size
    _change_rows(problem.acceleration_rows, problem.acceleration_share, step, change[at:])


@vectorised
def _change_rows(rows: np.ndarray, share: np.ndarray, step: np.ndarray, change: np.ndarray) -> None:
    groups, instants = share.shape
    width = rows.shape[2]
    along = np.empty(width)
    at = 0
    for g in range(groups):
        a, b, c = rows[g, 0], rows[g, 1], rows[g, 2]
        for r in range(width):
            along[r] = a[r] * step[0] + b[r] * step[1] + c[r] * step[2]
        for i in range(instants):
            here = change[at : at + width]
            for r in range(width):
                here[r] = -share[g, i] * along[r] - step[3]
            at += width


@compiled
def _weigh(problem: Problem, state: State) -> float:
    """Write the error of all balances; return the largest."""
    phases, instants, points = state.forces.shape[:3]
    x, worst = state.x, 0.0
    for s in range(phases):
        for w in range(instants):
            found, slope = state.imbalance[s, w], problem.turn_slope[s, w]
            for i in range(3):
                j, k = (i + 1) % 3, (i + 2) % 3
                found[i] = -problem.push[s, w, i] - problem.push_share[s, w] * x[i]
                found[3 + i] = -problem.turn[s, w, i] - slope[j] * x[k] + slope[k] * x[j]
            for p in range(points):
                if problem.standing[s, p]:
                    add_wrench(found, problem.arms[s, p], state.forces[s, w, p], 1.0)
            for i in range(6):
                worst = max(worst, abs(found[i]))
    return worst


@vectorised
def _foreseen(state: State, gap: float) -> float:
    """Write the changes of the duals; return the gap to aim at after a step to the boundary."""
    slack_fall = slack_rise = eased = both = 0.0
    for i in range(len(state.slack)):
        moved, z = state.change[i], state.dual[i]
        ratio = moved * state.inverse[i]
        slack_fall, slack_rise = max(slack_fall, -ratio), max(slack_rise, ratio)
        dual_moved = -z - state.weight[i] * moved
        state.dual_change[i] = dual_moved
        eased += z * moved
        both += moved * dual_moved
    primal, dual = 1.0 / max(1.0, slack_fall), 1.0 / (1.0 + slack_rise)
    left = gap + primal * eased + dual * (-gap - eased) + primal * dual * both
    return (left / gap) ** 3 * gap


@vectorised
def _advance(newton: Newton, state: State, gap: float) -> float:
    """Move the iterate most of the way to the boundary; return its gap."""
    primal = dual = 0.0
    for i in range(len(state.slack)):
        z = state.dual[i]
        moved = state.target[i] - z - state.weight[i] * state.change[i]
        state.dual_change[i] = moved
        primal = max(primal, -state.change[i] * state.inverse[i])
        dual = max(dual, -moved / (z if z > 0.0 else 1.0))
    share = BOLD if gap < NEAR else CAUTIOUS
    primal, dual = share / max(share, primal), share / max(share, dual)
    state.dual_error[0] *= 1.0 - dual
    left = 0.0
    for i in range(len(state.slack)):
        state.slack[i] += primal * state.change[i]
        state.dual[i] += dual * state.dual_change[i]
        left += state.slack[i] * state.dual[i]
    if left < WORSE * max(gap, NEAR):
        for i in range(4):
            state.x[i] += primal * newton.step[i]
        forces, steps = state.forces.reshape(-1), newton.force_steps.reshape(-1)
        for i in range(len(forces)):
            forces[i] += primal * steps[i]
    return left


@vectorised
def _dot(first: np.ndarray, second: np.ndarray) -> float:
    total = 0.0
    for i in range(len(first)):
        total += first[i] * second[i]
    return total
