"""Many programs, one after another, in one compiled loop."""

from typing import NamedTuple

import numpy as np

from jaxleas.dynamics.croc.kernel import State, solve
from jaxleas.dynamics.croc.kernel_matrices import compiled
from jaxleas.dynamics.croc.kernel_newton import Newton, Problem


class Answers(NamedTuple):
    """Where answers are written; see `Solutions`."""

    margin: np.ndarray
    free_point: np.ndarray
    forces: np.ndarray
    ended: np.ndarray
    iterations: np.ndarray


@compiled
def solve_all(batch: Problem, limits: np.ndarray, answers: Answers, asked: float) -> None:
    """Solve programs and write their answers.

    Args:
        batch: programs, whose arrays have a leading axis, but for the limit.
        limits: largest normal force of each program.
        answers: arrays to write.
        asked: margin of which it is only asked whether it can be reached; NaN for the largest.
    """
    phases, instants = batch.push_share.shape[1:]
    points, faces = batch.faces.shape[2:4]
    size = phases * instants * points * faces
    size += batch.reach_bounds[0].size + batch.acceleration_bounds[0].size
    newton = Newton(
        np.zeros((phases, instants, points, 6)),
        np.zeros((phases, instants, points, 3)),
        np.zeros((phases, instants, 6, 6)),
        np.zeros((phases, instants, 5, 6)),
        np.zeros((4, 4)),
        np.zeros((phases, instants, points, 3)),
        np.zeros(4),
        np.zeros((phases, instants, points, 3)),
    )
    state = State(
        np.zeros(4),
        np.zeros((phases, instants, points, 3)),
        np.zeros((phases, instants, 6)),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(size),
        np.zeros(1),
    )
    for n in range(len(limits)):
        problem = Problem(
            batch.arms[n],
            batch.faces[n],
            batch.standing[n],
            limits[n],
            batch.push[n],
            batch.push_share[n],
            batch.turn[n],
            batch.turn_slope[n],
            batch.reach_rows[n],
            batch.reach_share[n],
            batch.reach_bounds[n],
            batch.acceleration_rows[n],
            batch.acceleration_share[n],
            batch.acceleration_bounds[n],
        )
        answers.ended[n], answers.iterations[n] = solve(problem, newton, state, asked)
        answers.margin[n] = state.x[3]
        answers.free_point[n] = state.x[:3]
        answers.forces[n] = state.forces
