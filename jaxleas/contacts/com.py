"""The centre of mass, eliminated: which displacements leave it a place, and which place.

c_k0 and c_k1 occur in phase k alone, so that they only ask something of the displacement d = p_m -
p_o between the feet: that (p_o + C_o) and (p_m + C_m) intersect, C_o and C_m being where the centre
of mass may lie from either foot. By Farkas, d must satisfy g . d <= h_o(g) + h_m(-g) for every
direction g, where h is the support function. Planners start with a few directions and add, for a
step they propose, the one that refutes it; so they work on footholds only, and remain exact.
"""

from functools import cache

import numpy as np
from jaxtyping import Float
from scipy import sparse

from jaxleas.contacts.linear_program import Program, solve
from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.steps import HalfSpaces, Step, rotation
from jaxleas.geometry.polytopes import Polytope
from jaxleas.types.errors import InputError

FITS = 1e-7
"""A place for the centre of mass may violate its constraints by this [m] (certificate: 1e-6)."""
DIRECTIONS = 96
_GRID = np.linspace(-0.9, 0.9, 5)  # places over the sole that are tried first
_MOST_MARGIN = 0.05  # [m]


def place_com(
    step: Step,
    displacement: Float[np.ndarray, " 3"],
    half_size: tuple[float, float],
    turns: tuple[Float[np.ndarray, "3 3"], Float[np.ndarray, "3 3"]],
) -> tuple[Float[np.ndarray, "n 3"], list[tuple[Float[np.ndarray, " 3"], float]]]:
    """Return places for the centre of mass, relative to the standing foot, or cuts.

    Args:
        step: with its `com`.
        displacement: of the landing foot from the standing one [m].
        half_size: of the sole [m].
        turns: rotations of the standing and of the landing foot.

    Returns:
        c_k0 and c_k1 - p_o [m], and cuts (g, h): g . d <= h holds for every possible step, but not
        for this one. Without cuts, the places are good.
    """
    places, cuts = np.zeros((len(step.com), 3)), []
    for number, (standing, landing) in enumerate(step.com):
        A = np.concatenate([standing.A, landing.A])
        b = np.concatenate([standing.b, landing.b + landing.A @ displacement])
        middle = displacement if number else np.zeros(3)
        place = _try_over_sole(A, b, middle[:2], half_size, turns[number])
        if place is None:
            place, cut = _place_or_cut(A, b, standing, landing)
            if cut is not None:
                cuts.append(cut)
        places[number] = place
    return places, cuts


def _try_over_sole(
    A: np.ndarray,
    b: np.ndarray,
    middle: np.ndarray,
    half_size: tuple[float, float],
    turn: np.ndarray,
) -> np.ndarray | None:
    """Return the place over the sole with the longest vertical room, if any of 25 has some."""
    x, y = np.meshgrid(_GRID * half_size[0], _GRID * half_size[1])
    points = middle + np.stack([x.ravel(), y.ravel()], axis=1) @ turn[:2, :2].T
    slack = b[:, None] - A[:, :2] @ points.T
    slope = A[:, 2]
    up, down = slope > 1e-12, slope < -1e-12
    if not up.any() or not down.any():
        return None
    high = (slack[up] / slope[up, None]).min(axis=0)
    low = (slack[down] / slope[down, None]).max(axis=0)
    room = np.where((slack[~up & ~down] >= 0.0).all(axis=0), high - low, -np.inf)
    best = int(np.argmax(room))
    if room[best] < 0.0:
        return None
    return np.array([*points[best], 0.5 * (high[best] + low[best])])


def _place_or_cut(
    A: np.ndarray, b: np.ndarray, standing: HalfSpaces, landing: HalfSpaces
) -> tuple[np.ndarray, tuple[np.ndarray, float] | None]:
    """Minimise the worst violation; where it stays positive, the duals are Farkas's proof."""
    program = Program(
        cost=np.array([0.0, 0.0, 0.0, 1.0]),
        low=np.array([-np.inf, -np.inf, -np.inf, -_MOST_MARGIN]),
        high=np.full(4, np.inf),
        A=sparse.csr_array(np.concatenate([A, -np.ones((len(A), 1))], axis=1)),
        row_low=np.full(len(b), -np.inf),
        row_high=b,
    )
    solution = solve(program)
    if solution.outcome != "optimal":  # numerical trouble: there is an optimum
        raise ArithmeticError(f"the centre of mass's program ended as '{solution.outcome}'")
    if solution.x[3] <= FITS:
        return solution.x[:3], None
    weights = np.maximum(-solution.duals, 0.0)
    split = len(standing.b)
    normal = weights[:split] @ standing.A
    bound = weights @ np.concatenate([standing.b, landing.b])
    length = max(float(np.linalg.norm(normal)), 1e-9)
    return solution.x[:3], (normal / length, float(bound) / length)


def with_first_cuts(problem: ContactProblem, steps: list[Step], count: int) -> list[Step]:
    """Return the steps with those of a fixed set of cuts that cut something off their reach.

    Args:
        problem: the contact problem.
        steps: of its phases.
        count: how many get cuts, from the first on: all those whose constraints are complete.
    """
    if problem.model != "two_com":
        return steps
    poses = foot_yaws(problem, steps)
    cut = [
        step.with_cuts(*_first_cuts(problem, step, *yaws))
        for step, yaws in zip(steps[:count], poses, strict=False)
    ]
    return [*cut, *steps[count:]]


def foot_yaws(problem: ContactProblem, steps: list[Step]) -> list[tuple[float, float]]:
    """Return the yaws [rad] of the standing and of the landing foot in each phase."""
    yaws = []
    for step, phase in zip(steps, problem.phases, strict=True):
        other = "RF" if step.foot == "LF" else "LF"
        before = problem.initial[other] if step.standing < 0 else problem.phases[step.standing]
        yaws.append((before.yaw, phase.yaw))
    return yaws


def _first_cuts(
    problem: ContactProblem, step: Step, standing_yaw: float, yaw: float
) -> tuple[np.ndarray, np.ndarray]:
    other = "RF" if step.foot == "LF" else "LF"
    directions = _directions()  # in the standing foot's frame
    turned = -directions @ rotation(yaw - standing_yaw)  # in the landing foot's
    reach = problem.polytopes.foot_corners[other]
    far = (directions @ reach.T).max(axis=1)
    kept_normals, kept_bounds = [], []
    for over in (0, 1):
        corners = [
            _com_corners(problem, name, number == over)
            for number, name in enumerate((other, step.foot))
        ]
        bound = (directions @ corners[0].T).max(axis=1) + (turned @ corners[1].T).max(axis=1)
        cuts = bound < far - 1e-6
        kept_normals.append(directions[cuts] @ rotation(standing_yaw).T)
        kept_bounds.append(bound[cuts])
    return np.concatenate(kept_normals), np.concatenate(kept_bounds)


def _com_corners(problem: ContactProblem, name: str, over: bool) -> np.ndarray:
    """Return the corners of where the centre of mass may be from a foot, over it or not."""
    polytope = problem.polytopes.com[name]
    if not over:
        return polytope.vertices
    return _corners_over(polytope, problem.foot_half_size)


@cache
def _corners_over(polytope: Polytope, half_size: tuple[float, float]) -> np.ndarray:
    sides = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    try:
        return polytope.cut(sides, np.repeat(half_size, 2)).vertices
    except InputError:  # empty or flat: the whole reach is an outer bound, if a poor one
        return polytope.vertices


@cache
def _directions() -> np.ndarray:
    """Return unit vectors spread evenly over the sphere (a Fibonacci lattice)."""
    index = np.arange(DIRECTIONS) + 0.5
    z = 1.0 - 2.0 * index / DIRECTIONS
    angle = np.pi * (1.0 + 5.0**0.5) * index
    radius = np.sqrt(1.0 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)
