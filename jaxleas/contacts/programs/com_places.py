"""Places for the centre of mass in given steps, or the half-space that shows there is none.

All steps of a plan are judged together: nearly always one of 25 points over the sole is valid, and
the rest are linear programs of four variables, solved together.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse

from jaxleas.contacts.programs.constraints import StepConstraints
from jaxleas.contacts.programs.linear_program import Program, solve
from jaxleas.dynamics import maximise

FITS = 1e-7
"""A place for the centre of mass may violate its constraints by this [m] (certificate: 1e-6)."""
_MOST_MARGIN = 0.05  # [m]
_ABOVE = np.array([0.0, 0.0, 0.75])  # above the feet: where the search for a place begins [m]
_AXIS = np.linspace(-0.9, 0.9, 5)
_OVER_SOLE = np.stack(np.meshgrid(_AXIS, _AXIS), axis=-1).reshape(25, 2)  # as shares of its size
_FLAT = 1e-12

Cut = tuple[Float[np.ndarray, " 3"], float]
"""g and h: g . d <= h holds for every possible step d, but not for the given one."""


@dataclass(frozen=True, eq=False)
class _Asked:
    """Constraints with one row for each centre of mass: A c <= b, c relative to the standing foot.

    Rows of zeros with b = 1 pad to the longest; `split` counts the rows of the standing foot.
    """

    A: Float[np.ndarray, "q f 3"]
    b: Float[np.ndarray, "q f"]
    split: Int[np.ndarray, " q"]
    size: Int[np.ndarray, " q"]


def place_coms(
    constraints: list[StepConstraints],
    displacements: Float[np.ndarray, "n 3"],
    half_sizes: Float[np.ndarray, "n 2 2"],
    turns: Float[np.ndarray, "n 2 3 3"],
) -> tuple[Float[np.ndarray, "n 2 3"], dict[int, list[Cut]]]:
    """Return places for c_k0 and c_k1, relative to the standing foot, and the cuts of some steps.

    Args:
        constraints: constraints on the steps with their `com`.
        displacements: displacement of each landing foot from the standing one [m].
        half_sizes: half length and half width of the standing and of the landing sole [m].
        turns: rotations of the standing and of the landing foot.

    Returns:
        Places [m], and, by index, the cuts of each step that leaves no place.
    """
    asked = _assemble(constraints, displacements)
    middles = np.stack([0.0 * displacements, displacements], axis=1).reshape(-1, 3)
    soles = half_sizes.reshape(-1, 1, 2)
    places, found = _over_soles(asked, middles[:, :2], soles, turns.reshape(-1, 3, 3))
    cuts: dict[int, list[Cut]] = {}
    open_ = np.flatnonzero(~found)
    if len(open_):
        start = np.repeat(0.5 * displacements, 2, axis=0)[open_] + _ABOVE
        for row, place, weights in zip(open_, *_largest_margins(asked, open_, start), strict=True):
            places[row] = place
            if weights is not None:
                constraint = constraints[row // 2]
                cuts.setdefault(int(row // 2), []).append(_cut(constraint.com[row % 2], weights))
    return places.reshape(-1, 2, 3), cuts


def _assemble(constraints: list[StepConstraints], displacements: np.ndarray) -> _Asked:
    pairs = [pair for constraint in constraints for pair in constraint.com]
    sizes = np.array([(len(standing.b), len(landing.b)) for standing, landing in pairs])
    count, longest = len(pairs), int(sizes.sum(axis=1).max())
    A, b = np.zeros((count, longest, 3)), np.ones((count, longest))
    for row, (standing, landing) in enumerate(pairs):
        split, end = sizes[row, 0], sizes[row].sum()
        A[row, :split], A[row, split:end] = standing.A, landing.A
        b[row, :split] = standing.b
        b[row, split:end] = landing.b + landing.A @ displacements[row // 2]
    return _Asked(A, b, sizes[:, 0], sizes.sum(axis=1))


def _over_soles(
    asked: _Asked, middles: np.ndarray, half_sizes: np.ndarray, turns: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return the place over each sole, of 25, with most vertical room, and whether it is valid."""
    points = (_OVER_SOLE * half_sizes) @ turns[:, :2, :2].transpose(0, 2, 1) + middles[:, None]
    slack = asked.b[:, :, None] - asked.A[:, :, :2] @ points.transpose(0, 2, 1)
    slope = asked.A[:, :, 2, None]
    level = np.abs(slope) <= _FLAT
    height = slack / np.where(level, 1.0, slope)
    high = np.where(slope > _FLAT, height, np.inf).min(axis=1)
    low = np.where(slope < -_FLAT, height, -np.inf).max(axis=1)
    inside = np.where(level, slack, 0.0).min(axis=1) >= 0.0
    bounded = np.isfinite(high) & np.isfinite(low) & inside
    room = np.where(bounded, high, 0.0) - np.where(bounded, low, np.inf)
    rows, best = np.arange(len(room)), room.argmax(axis=1)
    found = room[rows, best] >= 0.0
    z = np.where(found, 0.5 * (high[rows, best] + low[rows, best]), 0.0)
    return np.concatenate([points[rows, best], z[:, None]], axis=1), found


def _largest_margins(
    asked: _Asked, rows: np.ndarray, start: np.ndarray
) -> tuple[list[np.ndarray], list[np.ndarray | None]]:
    """Maximise t over A c + t <= b; where t stays negative the duals are a proof by Farkas.

    Returns:
        A place for each of `rows`, and the weights of the constraints that refute it, or None.
    """
    A, b = asked.A[rows], asked.b[rows]
    room = b - (A @ start[:, :, None])[:, :, 0]
    least = np.minimum(room.min(axis=1), 0.0)
    real = (np.arange(A.shape[1]) < asked.size[rows, None]).astype(float)
    constraints = np.concatenate([A, real[:, :, None]], axis=2)
    cap = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (len(rows), 1, 4))
    constraints = np.concatenate([constraints, cap], axis=1)
    bounds = np.concatenate([room - least[:, None] * real, (_MOST_MARGIN - least)[:, None]], axis=1)
    answer = maximise(cap[:, 0], constraints, bounds)
    places: list[np.ndarray] = []
    weights: list[np.ndarray | None] = []
    for each, row in enumerate(rows):
        exact = None
        if answer.solved[each]:
            exact = _exactly(constraints[each], bounds[each], answer.active[each])
        if exact is None:
            place, weight = _by_highs(A[each], b[each], int(asked.size[row]))
        else:
            place, weight = start[each] + exact[0][:3], exact[1][:-1]
            if least[each] + exact[0][3] >= -FITS:
                weight = None
        places.append(place)
        weights.append(weight)
    return places, weights


def _exactly(
    constraints: np.ndarray, bounds: np.ndarray, active: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """Solve once more on the final basis; None unless both sides of duality hold."""
    basis = constraints[active]
    if (active < 0).any() or abs(np.linalg.det(basis)) < 1e-10:
        return None
    y = np.linalg.solve(basis, bounds[active])
    multipliers = np.linalg.solve(basis.T, np.array([0.0, 0.0, 0.0, 1.0]))
    if (constraints @ y - bounds).max() > 0.1 * FITS or multipliers.min() < -1e-9:
        return None
    weights = np.zeros(len(bounds))
    weights[active] = np.maximum(multipliers, 0.0)
    return y, weights


def _by_highs(A: np.ndarray, b: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray | None]:
    program = Program(
        cost=np.array([0.0, 0.0, 0.0, 1.0]),
        low=np.array([-np.inf, -np.inf, -np.inf, -_MOST_MARGIN]),
        high=np.full(4, np.inf),
        A=sparse.csr_array(np.concatenate([A[:size], -np.ones((size, 1))], axis=1)),
        row_low=np.full(size, -np.inf),
        row_high=b[:size],
    )
    solution = solve(program)
    if solution.status != "optimal":  # numerical trouble: there is an optimum
        raise ArithmeticError(f"the centre of mass's program ended as '{solution.status}'")
    if solution.x[3] <= FITS:
        return solution.x[:3], None
    return solution.x[:3], np.pad(np.maximum(-solution.duals, 0.0), (0, len(b) - size))


def _cut(pair: tuple, weights: np.ndarray) -> Cut:
    """Return g . d <= h: the weighted sum of the constraints, in which c cancels."""
    standing, landing = pair
    split, end = len(standing.b), len(standing.b) + len(landing.b)
    normal = weights[:split] @ standing.A
    bound = weights[:end] @ np.concatenate([standing.b, landing.b])
    length = max(float(np.linalg.norm(normal)), 1e-9)
    return normal / length, float(bound) / length
