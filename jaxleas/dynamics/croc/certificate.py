"""What a solution of a transition is worth, found by code that did not produce it.

From the free point the curve is evaluated anew at many instants; of each, HiGHS finds the forces
that keep the largest distance from all limits. The forces of the solution are weighed, too.
"""

import itertools
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.interpolate import BPoly
from scipy.optimize import linprog

from jaxleas.dynamics.croc.definition import generator_columns, lean_of
from jaxleas.dynamics.croc.sampled_curve import moment
from jaxleas.dynamics.croc.transitions import Discretisation, Transitions
from jaxleas.types import JaxleasError

SAMPLES = 50
_REACH_UNIT = 0.1  # [m]
_GRAVITY = 9.81  # [m/s^2]
_INSIDE = 7  # instants of a piece at which a curve of forces is weighed


@dataclass(frozen=True)
class Certificate:
    """Margins of one curve at many instants, and the errors of the forces that came with it.

    Attributes:
        times: instants [s]; where two phases meet, both are checked.
        phases: phase of each instant.
        force: largest possible slack of forces at each instant [1]; minus infinity without any.
        reach: slack of reach [1].
        acceleration: slack of the acceleration [1].
        imbalance: largest error of the given forces' wrench [body weights, body weights m].
        outside: largest violation of a limit by the given forces [body weights]; 0 for none.
    """

    times: Float[np.ndarray, " K"]
    phases: np.ndarray
    force: Float[np.ndarray, " K"]
    reach: Float[np.ndarray, " K"]
    acceleration: Float[np.ndarray, " K"]
    imbalance: float
    outside: float

    @property
    def margin(self) -> float:
        """The least slack of all instants [1]."""
        return float(min(each.min() for each in (self.force, self.reach, self.acceleration)))

    @property
    def weakest(self) -> tuple[str, float]:
        """The name of the least slack, and its instant [s]."""
        slacks = {"force": self.force, "reach": self.reach, "acceleration": self.acceleration}
        name = min(slacks, key=lambda each: slacks[each].min())
        return name, float(self.times[slacks[name].argmin()])


def certify_transition(
    transition: Transitions,
    discretisation: Discretisation,
    free_point: Float[np.ndarray, " 3"],
    forces: Float[np.ndarray, "S W P 3"],
) -> Certificate:
    """Return the margins of a curve at 50 instants, and what its forces are worth.

    Args:
        transition: one transition, without a batch axis.
        discretisation: where it was checked.
        free_point: free control point in the world [m].
        forces: forces of the solution [body weights].

    Raises:
        JaxleasError: HiGHS found no answer.
    """
    ends = np.cumsum(transition.durations)
    begins = ends - np.asarray(transition.durations)
    even = np.linspace(0.0, ends[-1], SAMPLES)
    found: list[tuple[float, int, float, float, float]] = []
    for phase, (begin, end) in enumerate(zip(begins, ends, strict=True)):
        inside = even[(even > begin) & (even < end)]
        times = np.concatenate([[begin], inside, [end]])
        state = moment(transition, discretisation.degree, free_point, times)
        rows, bounds = _reach_at(transition, phase, (times - begin) / (end - begin))
        reach = (bounds - np.einsum("krc,kc->kr", rows, state.com)).min(axis=1) / _REACH_UNIT
        most = transition.limits.acceleration - np.abs(state.acceleration).max(axis=1)
        for k, time in enumerate(times):
            force = _best_force(transition, discretisation, phase, state.wrench[k])
            found.append((time, phase, force, reach[k], most[k] / _GRAVITY))
    times, phases, force, reach, acceleration = np.array(found).T
    imbalance, outside = _weigh(transition, discretisation, free_point, forces)
    return Certificate(times, phases.astype(int), force, reach, acceleration, imbalance, outside)


def _reach_at(transition: Transitions, phase: int, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows of reach at fractions of a phase: of the nearest instant that is given."""
    rows, bounds = (np.asarray(part)[phase] for part in transition.reach)
    nearest = np.rint(at * (len(rows) - 1)).astype(int)
    is_row = np.abs(rows).max(axis=-1) > 0.0
    return rows[nearest], np.where(is_row, bounds, np.inf)[nearest]


def _best_force(
    transition: Transitions, discretisation: Discretisation, phase: int, wrench: np.ndarray
) -> float:
    points, normals, ahead, standing = (np.asarray(part)[phase] for part in transition.supports)
    limits = transition.limits
    columns, margin, load = generator_columns(
        points[standing],
        normals[standing],
        ahead[standing],
        limits.friction,
        discretisation.generators,
    )
    lean = lean_of(limits.friction, discretisation.generators)
    count = columns.shape[1]
    answer = linprog(
        np.append(np.zeros(count), -1.0),
        A_ub=np.column_stack([load, np.full(len(load), lean + 1.0)]),
        b_ub=np.full(len(load), limits.force),
        A_eq=np.column_stack([columns, margin]),
        b_eq=wrench,
        bounds=[(0.0, None)] * count + [(None, None)],
        method="highs",
    )
    if answer.status == 2:
        return -np.inf
    if answer.status != 0:
        raise JaxleasError(f"HiGHS could not decide an instant: {answer.message}")
    return float(answer.x[-1])


def _weigh(
    transition: Transitions,
    discretisation: Discretisation,
    free_point: np.ndarray,
    forces: np.ndarray,
) -> tuple[float, float]:
    """Return the largest error of the forces' balance, and how far they leave their limits."""
    ends = np.cumsum(transition.durations)
    worst = outside = 0.0
    for phase, end in enumerate(ends):
        begin = end - transition.durations[phase]
        times, given = _forces_at(discretisation, forces[phase], begin, end)
        needed = moment(transition, discretisation.degree, free_point, times).wrench
        points, normals, _, standing = (np.asarray(part)[phase] for part in transition.supports)
        push = given[:, standing]
        torque = np.cross(points[standing], push)
        error = np.concatenate([push.sum(axis=1), torque.sum(axis=1)], axis=1) - needed
        worst = max(worst, float(np.abs(error).max()))
        along = np.einsum("kpi,pi->kp", push, normals[standing])
        across = np.linalg.norm(push - along[..., None] * normals[standing], axis=2)
        most = transition.limits.friction * along
        outside = max(outside, float((across - most).max()))
        outside = max(outside, float((along - transition.limits.force).max()))
    return worst, max(outside, 0.0)


def _forces_at(
    discretisation: Discretisation, forces: np.ndarray, begin: float, end: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return instants of a phase and the forces there; curves of forces are evaluated."""
    if discretisation.kind == "instants":
        return np.linspace(begin, end, len(forces)), forces
    cuts = np.linspace(begin, end, discretisation.pieces + 1)
    pieces = forces.reshape(discretisation.pieces, -1, *forces.shape[1:])
    times = [np.linspace(a, b, _INSIDE) for a, b in itertools.pairwise(cuts)]
    values = [
        BPoly(piece[:, None], [a, b])(at)
        for piece, a, b, at in zip(pieces, cuts[:-1], cuts[1:], times, strict=True)
    ]
    return np.concatenate(times), np.concatenate(values)
