"""The margin of one transition by its definition, with a general solver: slow, and a twin.

Forces are sums of generators here, shifted along the normal by the margin, where the fast solvers
have faces; how the curve depends on its free point comes from evaluating it. HiGHS solves.
"""

import itertools
from dataclasses import dataclass

import highspy
import numpy as np
import scipy.sparse as sparse
from jaxtyping import Float
from scipy.optimize import linprog

from jaxleas.dynamics.croc.sampled_curve import bernstein_points, moment
from jaxleas.dynamics.croc.transitions import Discretisation, Transitions
from jaxleas.dynamics.friction import friction_generators
from jaxleas.types import JaxleasError

_WEIGHT = 9.81  # [m/s^2]; force over mass of a body at rest
_REACH_UNIT = 0.1  # [m]


@dataclass(frozen=True)
class Reference:
    """The margin of one transition and the free point that reaches it; minus infinity if none."""

    margin: float
    free_point: Float[np.ndarray, " 3"] | None


def margin_by_definition(transition: Transitions, discretisation: Discretisation) -> Reference:
    """Return the largest margin of one transition.

    Args:
        transition: one transition, without a batch axis.
        discretisation: degree of the curve, and where it is checked.

    Raises:
        JaxleasError: HiGHS found no answer.
    """
    parts = _Parts(transition, discretisation)
    for phase in range(len(transition.durations)):
        parts.add_phase(phase)
    return parts.solve()


class _Parts:
    """Rows of the linear program, gathered phase by phase; unknowns: x, margin, generators."""

    def __init__(self, transition: Transitions, discretisation: Discretisation) -> None:
        self.transition, self.discretisation = transition, discretisation
        self.middle = np.asarray(transition.start.com, np.float64)
        self.upper: list[tuple[np.ndarray, np.ndarray]] = []  # rows on x and margin <= bounds
        self.balances: list[tuple[np.ndarray, np.ndarray, np.ndarray]] = []
        self.loads: list[np.ndarray] = []  # normal parts of the generators of each balance

    def add_phase(self, phase: int) -> None:
        ends = np.cumsum(self.transition.durations)
        begin, end = ends[phase] - self.transition.durations[phase], ends[phase]
        for first, last in self._pieces(begin, end):
            self._add_reach(phase, *self._points(first, last, self.discretisation.degree, "com"))
            self._add_acceleration(
                *self._points(first, last, self.discretisation.degree - 2, "acceleration")
            )
            wrench = self._points(first, last, 2 * self.discretisation.degree - 3, "wrench")
            self._add_forces(phase, *wrench)

    def _pieces(self, begin: float, end: float) -> list[tuple[float, float]]:
        is_whole = self.discretisation.kind == "instants"
        cuts = np.linspace(begin, end, (1 if is_whole else self.discretisation.pieces) + 1)
        return list(itertools.pairwise(cuts))

    def _points(
        self, first: float, last: float, degree: int, name: str
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return a quantity at x = middle, [K, D], and its slopes in x, [3, K, D]."""
        is_sampled = self.discretisation.kind == "instants"
        count = self.discretisation.instants if is_sampled else degree + 1
        at = np.linspace(0.0, 1.0, count)
        found = []
        for shift in np.concatenate([np.zeros((1, 3)), np.eye(3)]):
            times = first + at * (last - first)
            state = moment(self.transition, self.discretisation.degree, self.middle + shift, times)
            values = getattr(state, name)
            found.append(values if is_sampled else bernstein_points(values, at))
        return found[0], np.array(found[1:]) - found[0]

    def _add_reach(self, phase: int, com: np.ndarray, slope: np.ndarray) -> None:
        rows, bounds = (np.asarray(part)[phase] for part in self.transition.reach)
        for k in range(len(com)):
            row, bound = rows[k % len(rows)], bounds[k % len(bounds)]
            there = np.abs(row).max(axis=1) > 0.0
            left = np.column_stack([row @ slope[:, k].T, np.full(len(row), _REACH_UNIT)])
            self.upper.append((left[there], (bound - row @ com[k])[there]))

    def _add_acceleration(self, value: np.ndarray, slope: np.ndarray) -> None:
        most = self.transition.limits.acceleration
        for k in range(len(value)):
            for sign in (1.0, -1.0):
                left = np.column_stack([sign * slope[:, k].T, np.full(3, _WEIGHT)])
                self.upper.append((left, most - sign * value[k]))

    def _add_forces(self, phase: int, wrench: np.ndarray, slope: np.ndarray) -> None:
        points, normals, ahead, standing = (
            np.asarray(part)[phase] for part in self.transition.supports
        )
        limits = self.transition.limits
        columns, lean, load = generator_columns(
            points[standing],
            normals[standing],
            ahead[standing],
            limits.friction,
            self.discretisation.generators,
        )
        for k in range(len(wrench)):
            left = np.column_stack([-slope[:, k].T, lean])
            self.balances.append((left, columns, wrench[k]))
            self.loads.append(load)

    def solve(self) -> Reference:
        sizes = [columns.shape[1] for _, columns, _ in self.balances]
        rows = sparse.vstack([sparse.csr_matrix(left) for left, _ in self.upper])
        width = sum(sizes)
        height = sum(len(left) for left, _ in self.upper)
        upper = [sparse.hstack([rows, sparse.csr_matrix((height, width))])]
        bounds = [np.concatenate([right for _, right in self.upper])]
        # normal . f <= limit - margin, where f leans on the normal by its share of the margin, too.
        loads = sparse.block_diag(self.loads)
        lean = lean_of(self.transition.limits.friction, self.discretisation.generators)
        share = np.full(sum(len(load) for load in self.loads), lean + 1.0)
        upper.append(sparse.hstack([np.zeros((len(share), 3)), share[:, None], loads]))
        bounds.append(np.full(len(share), self.transition.limits.force))
        equal = sparse.hstack(
            [
                np.concatenate([left for left, _, _ in self.balances]),
                sparse.block_diag([columns for _, columns, _ in self.balances]),
            ]
        )
        cost = np.zeros(4 + width)
        cost[3] = -1.0
        answer = linprog(
            cost,
            A_ub=sparse.vstack(upper).tocsr(),
            b_ub=np.concatenate(bounds),
            A_eq=equal.tocsr(),
            b_eq=np.concatenate([right for _, _, right in self.balances]),
            bounds=[(None, None)] * 4 + [(0.0, None)] * width,
            method="highs",
        )
        if answer.status == 2:
            return Reference(-np.inf, None)
        if answer.status != 0:
            raise JaxleasError(
                f"HiGHS {highspy.Highs().version()} could not decide a transition: {answer.message}"
            )
        return Reference(float(answer.x[3]), self.middle + answer.x[:3])


def generator_columns(
    points: np.ndarray, normals: np.ndarray, ahead: np.ndarray, friction: float, count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the wrenches of generators, [6, P K], of the margin, [6], and normal parts, [P, P K].

    A force is as far from all faces of its pyramid as t, where f - t normal / sin a is in it; a is
    the angle between a face and the normal.
    """
    generators = friction_generators(normals, friction, ahead, count)
    lean = normals * lean_of(friction, count)
    wrenches = np.concatenate([generators, np.cross(points[:, None], generators)], axis=2)
    margin = np.concatenate([lean.sum(axis=0), np.cross(points, lean).sum(axis=0)])
    load = np.zeros((len(points), len(points), count))
    for point in range(len(points)):
        load[point, point] = generators[point] @ normals[point]
    return wrenches.reshape(-1, 6).T, margin, load.reshape(len(points), -1)


def lean_of(friction: float, generators: int) -> float:
    """Return the distance along the normal by which a pyramid moves for a margin of one."""
    inside = friction * np.cos(np.pi / generators)
    return float(np.sqrt(1.0 + inside * inside) / inside)
