"""Many small linear programs at once: the simplex method on condensed tableaux, in NumPy.

A general solver spends a millisecond on calling, preparing and answering; the problems here have
three to six variables and some tens of inequalities, and come in hundreds.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

_PIVOT = 1e-10  # smaller entries of a tableau count as zero
_SPREAD = 1e-9  # relative; shakes ties apart, which symmetric feet produce by the dozen


@dataclass(frozen=True)
class SmallLpSolution:
    """Answers to N linear programs.

    Attributes:
        variables: y, where each maximum is attained.
        active: the V inequalities whose plane each y lies on; -1 where there are fewer.
        solved: whether the search ended at a maximum (else: unbounded, or given up).
    """

    variables: Float[np.ndarray, "N V"]
    active: Int[np.ndarray, "N V"]
    solved: Bool[np.ndarray, " N"]


def maximise(
    objective: Float[np.ndarray, "N V"],
    rows: Float[np.ndarray, "N R V"],
    bounds: Float[np.ndarray, "N R"],
    most_pivots: int = 80,
) -> SmallLpSolution:
    """Maximise objective . y subject to rows y <= bounds; y is free, and y = 0 is feasible.

    Each tableau holds the slacks as affine functions of the nonbasic variables; a free variable
    that has entered never leaves. Bounds are spread apart by 1e-9 of their size against cycling:
    whoever needs more digits solves again for the planes in `active`.

    Args:
        objective: what to maximise.
        rows: left-hand sides.
        bounds: right-hand sides, none negative.
        most_pivots: after which a problem is given up.
    """
    count, height, width = rows.shape
    shaken = bounds + _SPREAD * np.maximum(bounds.max(axis=1, initial=0.0), 1e-3)[:, None] * (
        1.0 + (np.arange(height) * 0.6180339887 % 1.0)
    )
    # Tableau: slack = bounds - rows y; the last row is the objective, the last column the constant.
    tableau = np.zeros((count, height + 1, width + 1))
    tableau[:, :height, :width] = -rows
    tableau[:, :height, width] = shaken
    tableau[:, height, :width] = objective
    # Names: 0 .. height - 1 are slacks, height + v is variable v.
    basic = np.broadcast_to(np.arange(height), (count, height)).copy()
    nonbasic = np.broadcast_to(height + np.arange(width), (count, width)).copy()
    solved = np.zeros(count, dtype=bool)
    live = np.arange(count)
    for _ in range(most_pivots):
        live = _pivot(tableau, basic, nonbasic, solved, live)
        if not len(live):
            break
    variables = np.zeros((count, width))
    problem, row = np.nonzero(basic >= height)
    variables[problem, basic[problem, row] - height] = tableau[problem, row, width]
    return SmallLpSolution(variables, np.where(nonbasic < height, nonbasic, -1), solved)


def _pivot(
    tableau: np.ndarray,
    basic: np.ndarray,
    nonbasic: np.ndarray,
    solved: np.ndarray,
    live: np.ndarray,
) -> np.ndarray:
    """Exchange one variable in each live problem; return those that are still undecided."""
    height, width = basic.shape[1], nonbasic.shape[1]
    some = tableau[live] if len(live) < len(tableau) else tableau
    gain = some[:, height, :width]
    free = nonbasic[live] >= height
    # A nonbasic slack may only grow; a free variable moves either way, and goes first.
    attraction = np.where(free, np.abs(gain) * 1e6, gain)
    column = attraction.argmax(axis=1)
    each = np.arange(len(live))
    going = attraction[each, column] > _PIVOT
    if not going.all():
        solved[live[~going]] = True
        live, column = live[going], column[going]
        if not len(live):
            return live
        some, free, each = some[going], free[going], np.arange(len(live))
    sign = np.where(some[each, height, column] < 0.0, -1.0, 1.0)
    entering = some[each, :, column]  # [live, height + 1]
    fall = entering[:, :height] * sign[:, None]
    # Only slacks limit the way: a basic free variable may take any value.
    limits = (fall < -_PIVOT) & (basic[live] < height)
    with np.errstate(divide="ignore", invalid="ignore"):
        step = np.where(limits, some[:, :height, width] / -fall, np.inf)
    row = step.argmin(axis=1)
    bounded = np.isfinite(step[each, row])
    if not bounded.all():  # unbounded: left unsolved
        live, column, row = live[bounded], column[bounded], row[bounded]
        some, entering = some[bounded], entering[bounded]
        each = np.arange(len(live))
        if not len(live):
            return live
    pivot_row = some[each, row]  # [live, width + 1]
    pivot = pivot_row[each, column]
    share = entering / pivot[:, None]
    share[each, row] = 0.0
    updated = some - share[:, :, None] * pivot_row[:, None, :]
    updated[each, :, column] = share
    pivot_row = -pivot_row / pivot[:, None]
    pivot_row[each, column] = 1.0 / pivot
    updated[each, row] = pivot_row
    tableau[live] = updated
    left = basic[live, row]
    basic[live, row] = nonbasic[live, column]
    nonbasic[live, column] = left
    return live
