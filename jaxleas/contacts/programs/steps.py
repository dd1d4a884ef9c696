"""What one step may be: the displacement from the standing foot, as half-spaces in the world."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem, FootPose

INITIAL = -1
"""Stands for "where the foot stood before the first phase" among indices of phases."""

Family = Literal["step", "com_reach", "com_over"]
"""Families of constraints on a step: relative reach of the feet (T eq. B.3), reach of the centre of
mass (B.2), centre of mass over a foot (B.1)."""


@dataclass(frozen=True, eq=False)
class HalfSpaces:
    """The set {x : A x <= b}, unit rows [m]."""

    A: Float[np.ndarray, "n 3"]
    b: Float[np.ndarray, " n"]


@dataclass(frozen=True, eq=False)
class Step:
    """The relation between a landing foot m and the standing foot o, in world axes.

    There must be a centre of mass c with c - p_o in `com[i][0]` and c - p_m in `com[i][1]`, for
    each i; and A (p_m - p_o) <= b. Cuts that the former implies are appended to the latter.

    Attributes:
        foot: that moves.
        standing: phase in which the other foot landed, or INITIAL.
        A: unit rows.
        b: [m].
        com: for c_k0 and c_k1; empty for the model "feet".
    """

    foot: str
    standing: int
    A: Float[np.ndarray, "n 3"]
    b: Float[np.ndarray, " n"]
    com: tuple[tuple[HalfSpaces, HalfSpaces], ...] = ()

    def with_cuts(self, A: Float[np.ndarray, "c 3"], b: Float[np.ndarray, " c"]) -> "Step":
        """Return the step with further rows on the displacement."""
        return replace(self, A=np.concatenate([self.A, A]), b=np.concatenate([self.b, b]))


def make_steps(
    problem: ContactProblem, relaxed: Mapping[Family, float] | None = None
) -> list[Step]:
    """Return the step of each phase.

    Model "feet" (published SL1M code): A_{o_in_m} R_k^T (p_o - p_m) <= b; model "two_com" (T eq.
    B.3): A_{m_in_o} R_{k-1}^T (p_m - p_o) <= b, and two positions of the centre of mass.

    Args:
        problem: the contact problem.
        relaxed: families of constraints that the *last* phase may violate by so much [m].
    """
    stances = {foot: (INITIAL, pose) for foot, pose in problem.initial.items()}
    steps = []
    for index, phase in enumerate(problem.phases):
        other = "RF" if phase.foot == "LF" else "LF"
        standing, pose = stances[other]
        more = (relaxed or {}) if index == len(problem) - 1 else {}
        reach = _reach(problem, phase.foot, phase.yaw, other, pose.yaw)
        bound = reach.b + more.get("step", 0.0)
        com = ()
        if problem.model == "two_com":
            feet = ((other, rotation(pose.yaw)), (phase.foot, rotation(phase.yaw)))
            com = tuple(_com(problem, feet, over, more) for over in (0, 1))
        steps.append(Step(phase.foot, standing, reach.A, bound, com))
        stances[phase.foot] = (index, FootPose(np.zeros(3), phase.yaw))
    return steps


def rotation(yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation by `yaw` [rad] about the vertical, from the foot's frame to the world."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _reach(
    problem: ContactProblem, foot: str, yaw: float, other: str, other_yaw: float
) -> HalfSpaces:
    if problem.model == "feet":
        reach = problem.polytopes.foot[foot]
        return HalfSpaces(-reach.normals @ rotation(yaw).T, reach.offsets)
    reach = problem.polytopes.foot[other]
    return HalfSpaces(reach.normals @ rotation(other_yaw).T, reach.offsets)


def _com(
    problem: ContactProblem,
    feet: tuple[tuple[str, np.ndarray], ...],
    over: int,
    more: Mapping[Family, float],
) -> tuple[HalfSpaces, HalfSpaces]:
    """Return where c may be from each foot; it lies over foot number `over`."""
    sole = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    sides = np.repeat(problem.foot_half_size, 2) + more.get("com_over", 0.0)
    sets = []
    for number, (name, turn) in enumerate(feet):
        reach = problem.polytopes.com[name]
        A, b = reach.normals, reach.offsets + more.get("com_reach", 0.0)
        if number == over:
            A, b = np.concatenate([A, sole]), np.concatenate([b, sides])
        sets.append(HalfSpaces(A @ turn.T, b))
    return sets[0], sets[1]
