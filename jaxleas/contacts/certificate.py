"""The certificate: every constraint of a problem, recomputed for a plan in metres.

Shares no code with the planners: it reads the problem's value and does plain arithmetic, step by
step, exactly as the format states the constraints (docs/contacts.md).
"""

import math
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.types import InputError

_Foot = tuple[str, np.ndarray, float]  # name, position [m], yaw [rad]
TOLERANCE = 1e-6
"""A plan that violates a constraint by more than this is rejected [m]."""


@dataclass(frozen=True)
class Violation:
    """The worst constraint of a plan.

    Attributes:
        metres: amount by which it is violated [m].
        step: index of the step that violates it.
        constraint: name of the constraint, in a few words.
    """

    metres: float
    step: int
    constraint: str

    @property
    def phase(self) -> int:
        """The former name of `step`."""
        return self.step

    @property
    def certified(self) -> bool:
        """Whether the plan satisfies every constraint."""
        return self.metres <= TOLERANCE


def certify(problem: ContactProblem, plan: ContactPlan) -> Violation:
    """Return the constraint that `plan` violates most.

    Raises:
        InputError: the plan does not fit this problem (number of steps, surfaces, com).
    """
    footholds = _require_fitting(problem, plan)
    stances = {name: (pose.position, pose.yaw) for name, pose in problem.initial.items()}
    worst = Violation(-math.inf, 0, "")
    for index, (step, point) in enumerate(zip(problem.steps, footholds, strict=True)):
        others = {name: stance for name, stance in stances.items() if name != step.foot}
        landing = step.foot, point, step.yaw
        found = _on_surface(problem.surfaces[plan.surfaces[index]].vertices, point)
        for name, (standing, yaw) in others.items():
            found += _step(problem, landing, (name, standing, yaw))
        if problem.model == "two_com":
            assert plan.com is not None
            ((name, (standing, yaw)),) = others.items()
            for number in (0, 1):
                feet = (name, standing, yaw), landing
                found += _com(problem, plan.com[index, number], number, feet)
        stances[step.foot] = (point, step.yaw)
        metres, constraint = max(found)
        if metres > worst.metres:
            worst = Violation(float(metres), index, constraint)
    return worst


def _on_surface(corners: np.ndarray, point: np.ndarray) -> list[tuple[float, str]]:
    arms = corners[1:] - corners[0]
    normal = np.cross(arms[:-1], arms[1:]).sum(axis=0)  # a fan of triangles
    normal /= math.sqrt(float(normal @ normal))
    outward = np.cross(np.roll(corners, -1, axis=0) - corners, normal)
    beyond = ((point - corners) * outward).sum(axis=1) / np.sqrt((outward * outward).sum(axis=1))
    return [
        (abs(float(normal @ (point - corners.mean(axis=0)))), "foot on the surface's plane"),
        (float(beyond.max()), "foot within the surface's edges"),
    ]


def _step(problem: ContactProblem, landing: _Foot, standing: _Foot) -> list[tuple[float, str]]:
    (foot, point, yaw), (other, place, standing_yaw) = landing, standing
    if problem.model == "feet":  # A_{o_in_m} R_k^T (p_o - p_m) <= b
        name, local = f"{other}_in_{foot}", _turn_back(place - point, yaw)
    else:  # A_{m_in_o} R_{k-1}^T (p_m - p_o) <= b
        name, local = f"{foot}_in_{other}", _turn_back(point - place, standing_yaw)
    reach = problem.polytopes.relative[name]
    return [(_excess(reach.normals, reach.offsets, local), f"reach of the step from {other}")]


def _com(
    problem: ContactProblem,
    com: np.ndarray,
    number: int,
    feet: tuple[_Foot, ...],
) -> list[tuple[float, str]]:
    found = []
    for name, position, yaw in feet:
        reach, local = problem.polytopes.com[name], _turn_back(com - position, yaw)
        text = f"reach of the centre of mass c{number} from {name}"
        found.append((_excess(reach.normals, reach.offsets, local), text))
    name, position, yaw = feet[number]  # c0 over the standing foot, c1 over the landed one
    local = _turn_back(com - position, yaw)
    half_length, half_width = problem.half_sizes[name]
    over = max(abs(local[0]) - half_length, abs(local[1]) - half_width)
    found.append((float(over), f"centre of mass c{number} over {name}"))
    return found


def _turn_back(vector: np.ndarray, yaw: float) -> np.ndarray:
    cosine, sine = math.cos(yaw), math.sin(yaw)
    x, y, z = vector
    return np.array([cosine * x + sine * y, -sine * x + cosine * y, z])


def _excess(A: np.ndarray, b: np.ndarray, point: np.ndarray) -> float:
    return float(((A @ point - b) / np.sqrt((A * A).sum(axis=1))).max())


def _require_fitting(problem: ContactProblem, plan: ContactPlan) -> Float[np.ndarray, "n 3"]:
    count = len(problem.steps)
    if not plan.feasible or plan.footholds is None:
        hint = "; a proof to check is written by --planner astar" * (plan.status == "infeasible")
        raise InputError(f"this plan is '{plan.status}' and has no footholds to check{hint}")
    if len(plan.surfaces) != count or plan.footholds.shape != (count, 3):
        raise InputError(
            f"the plan has {len(plan.surfaces)} surfaces and {len(plan.footholds)} footholds,"
            f" the problem {count} steps"
        )
    for index, (name, step) in enumerate(zip(plan.surfaces, problem.steps, strict=True)):
        if name not in step.candidates:
            raise InputError(
                f"step {index} of the plan stands on '{name}', which is not among the problem's"
                f" candidates there: {', '.join(step.candidates)}"
            )
    if problem.model == "two_com" and (plan.com is None or plan.com.shape != (count, 2, 3)):
        raise InputError("the plan lacks 'com', two positions per step, which model two_com needs")
    numbers = [plan.footholds] if plan.com is None else [plan.footholds, plan.com]
    if not all(np.isfinite(each).all() for each in numbers):
        raise InputError("the plan holds a number that is not finite")
    return plan.footholds
