"""Many small linear programs at once: the simplex method on condensed tableaux, in NumPy.

A general solver spends a millisecond on overhead; the problems here have three to six variables
and some tens of inequalities, and come in hundreds.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

_PIVOT = 1e-10  # smaller entries of a tableau count as zero
_SPREAD = 1e-9  # relative; breaks ties, which symmetric feet produce by the dozen


@dataclass(frozen=True)
class SmallLpSolution:
    """Answers to N linear programs.

    Attributes:
        variables: point y of each maximum.
        active: indices of the V inequalities whose plane each y lies on; -1 where there are fewer.
        solved: whether the search ended at a maximum; otherwise it was unbounded or out of pivots.
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
    for more digits, solve again for the planes in `active`.

    Args:
        objective: objectives to maximise.
        rows: left-hand sides of the inequalities.
        bounds: right-hand sides of the inequalities, none negative.
        most_pivots: maximum number of pivots per problem.
    """
    count, height, width = rows.shape
    shaken = bounds + _SPREAD * np.maximum(bounds.max(axis=1, initial=0.0), 1e-3)[:, None] * (
        1.0 + (np.arange(height) * 0.6180339887 % 1.0)
    )
    # Tableau: slack = bounds - rows y; the last row is the objective, the last column the constant.
    tableau = np.empty((count, height + 1, width + 1))
    tableau[:, :height, :width] = -rows
    tableau[:, :height, width] = shaken
    tableau[:, height, :width] = objective
    tableau[:, height, width] = 0.0
    # Names of variables: 0 .. height - 1 are slacks, height + v is variable v.
    search = _Search(
        tableau,
        basic=np.broadcast_to(np.arange(height), (count, height)).copy(),
        nonbasic=np.broadcast_to(height + np.arange(width), (count, width)).copy(),
        name=np.arange(count),
    )
    answer = SmallLpSolution(
        np.zeros((count, width)), np.full((count, width), -1), np.zeros(count, dtype=bool)
    )
    for _ in range(most_pivots):
        search = search.pivot(answer)
        if not len(search.name):
            break
    return answer


@dataclass
class _Search:
    """The tableaux of unfinished problems, with the names of their variables."""

    tableau: np.ndarray
    basic: np.ndarray
    nonbasic: np.ndarray
    name: np.ndarray

    def pivot(self, answer: SmallLpSolution) -> "_Search":
        """Exchange one variable in each problem; write the answers of finished problems."""
        height, width = self.basic.shape[1], self.nonbasic.shape[1]
        gain = self.tableau[:, height, :width]
        # A nonbasic slack may only grow; a free variable moves either way, and enters first.
        attraction = np.where(self.nonbasic >= height, np.abs(gain) * 1e6, gain)
        column = attraction.argmax(axis=1)
        each = np.arange(len(column))
        done = attraction[each, column] <= _PIVOT
        if done.any():
            self._among(done)._write(answer)
            going = ~done
            return self._among(going)._exchange(column[going])
        return self._exchange(column)

    def _exchange(self, column: np.ndarray) -> "_Search":
        tableau, basic, nonbasic = self.tableau, self.basic, self.nonbasic
        height, width, each = basic.shape[1], nonbasic.shape[1], np.arange(len(column))
        entering = tableau[each, :, column]  # [problems, height + 1]
        sign = np.where(entering[:, height:] < 0.0, 1.0, -1.0)
        # Only slacks limit the step: a basic free variable may take any value.
        fall = np.where(basic < height, entering[:, :height] * sign, 0.0)
        constants = tableau[:, :height, width]
        step = np.where(fall > _PIVOT, constants / np.maximum(fall, _PIVOT), np.inf)
        row = step.argmin(axis=1)
        bounded = step[each, row] < np.inf
        if not bounded.all():  # unbounded: left unsolved
            return self._among(bounded)._exchange(column[bounded])
        pivot_row = tableau[each, row]
        pivot_row /= pivot_row[each, column][:, None]
        share = entering
        left_share = share[each, row]
        share[each, row] = 0.0
        tableau -= share[:, :, None] * pivot_row[:, None, :]
        pivot_row *= -1.0
        pivot_row[each, column] = 1.0 / left_share
        tableau[each, row] = pivot_row
        # The column of the leaving variable, divided by the pivot.
        share /= left_share[:, None]
        share[each, row] = pivot_row[each, column]
        tableau[each, :, column] = share
        basic[each, row], nonbasic[each, column] = nonbasic[each, column], basic[each, row]
        return self

    def _among(self, which: np.ndarray) -> "_Search":
        return _Search(
            self.tableau[which], self.basic[which], self.nonbasic[which], self.name[which]
        )

    def _write(self, answer: SmallLpSolution) -> None:
        height, width = self.basic.shape[1], self.nonbasic.shape[1]
        problem, row = np.nonzero(self.basic >= height)
        variable = self.basic[problem, row] - height
        answer.variables[self.name[problem], variable] = self.tableau[problem, row, width]
        answer.active[self.name] = np.where(self.nonbasic < height, self.nonbasic, -1)
        answer.solved[self.name] = True
