"""Footholds as near as possible to targets, among those that a linear program allows."""

import time
from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy import sparse

from jaxleas.contacts.programs.least_distance import least_distance
from jaxleas.contacts.programs.linear_program import Program, Solution, solve
from jaxleas.types import InputError


@dataclass(frozen=True, eq=False)
class Targets:
    """Places that footholds should be near, horizontally.

    Attributes:
        points: x, y of the target of each step [m].
        cost: "linear": sum of |x - x'| + |y - y'|; "quadratic": sum of squared distances.
    """

    points: Float[np.ndarray, "n 2"]
    cost: Literal["linear", "quadratic"] = "linear"


def nearest_to(
    targets: Targets,
    program: Program,
    margin: float,
    origin: Float[np.ndarray, "n 3"],
    bases: Float[np.ndarray, "n 2 3"],
    deadline: float,
) -> Solution:
    """Return the footholds nearest to targets that keep a distance to spare.

    Args:
        targets: places to be near to.
        program: program that maximises the least slack, its last variable.
        margin: least slack that is kept [m].
        origin: origin of the coordinates in the surface of each step [m].
        bases: unit vectors of these coordinates.
        deadline: time by `time.perf_counter` after which to stop [s].
    """
    kept = _with_margin(program, margin)
    if targets.cost == "quadratic":
        return _nearest_quadratic(kept, origin, bases, targets)
    linear = _nearest_linear(kept, origin, bases, targets)
    return solve(linear, deadline - time.perf_counter())


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
