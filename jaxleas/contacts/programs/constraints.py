"""The displacements that one step allows from the standing feet, as half-spaces in the world."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, Self

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem

INITIAL = -1
"""Index that means "where the foot stood before the first step" among indices of steps."""

Family = Literal["step", "com_reach", "com_over"]
"""Families of constraints on a step: relative reach of the feet (T eq. B.3), reach of the centre of
mass (B.2), centre of mass over a foot (B.1)."""


@dataclass(frozen=True, eq=False)
class HalfSpaces:
    """The set {x : A x <= b}, unit rows [m]."""

    A: Float[np.ndarray, "n 3"]
    b: Float[np.ndarray, " n"]


@dataclass(frozen=True, eq=False)
class Link:
    """The relation between the landing foot m and one standing foot o: A (p_m - p_o) <= b.

    Attributes:
        effector: name of the effector that stands.
        standing: index of the step in which it landed, or INITIAL.
        yaw: heading with which it stands [rad].
        A: unit rows, in world axes.
        b: bounds of the rows [m].
    """

    effector: str
    standing: int
    yaw: float
    A: Float[np.ndarray, "n 3"]
    b: Float[np.ndarray, " n"]


@dataclass(frozen=True, eq=False)
class StepConstraints:
    """The constraints on a landing foot m from all standing feet.

    With two feet there must also be a centre of mass c with c - p_o in `com[i][0]` and c - p_m
    in `com[i][1]`, for each i. Cuts that this implies are appended to the rows of the link.

    Attributes:
        foot: name of the effector that moves.
        links: relation to each effector that stands.
        com: sets for c_k0 and c_k1; empty for the model "feet".
    """

    foot: str
    links: tuple[Link, ...]
    com: tuple[tuple[HalfSpaces, HalfSpaces], ...] = ()

    @property
    def link(self) -> Link:
        """The relation to the other one of two feet."""
        (only,) = self.links
        return only

    @property
    def size(self) -> int:
        """Number of rows of all links."""
        return sum(len(link.b) for link in self.links)

    def with_cuts(self, A: Float[np.ndarray, "c 3"], b: Float[np.ndarray, " c"]) -> Self:
        """Return the constraints, of two feet, with further rows on the displacement."""
        link = self.link
        rows, bounds = np.concatenate([link.A, A]), np.concatenate([link.b, b])
        return replace(self, links=(replace(link, A=rows, b=bounds),))


def make_constraints(
    problem: ContactProblem, relaxed: Mapping[Family, float] | None = None
) -> list[StepConstraints]:
    """Return the constraints on each step.

    Model "feet" (published SL1M code): A_{o_in_m} R_k^T (p_o - p_m) <= b, for each foot o that
    stands; model "two_com" (T eq. B.3): A_{m_in_o} R_{k-1}^T (p_m - p_o) <= b, and two positions of
    the centre of mass.

    Args:
        problem: the contact problem.
        relaxed: amount by which the *last* step may violate each family of constraints [m].
    """
    stances = {name: (INITIAL, pose.yaw) for name, pose in problem.initial.items()}
    constraints = []
    for index, step in enumerate(problem.steps):
        more = (relaxed or {}) if index == len(problem) - 1 else {}
        links = []
        for name, (standing, yaw) in stances.items():
            if name == step.foot:
                continue
            reach = _reach(problem, step.foot, step.yaw, name, yaw)
            links.append(Link(name, standing, yaw, reach.A, reach.b + more.get("step", 0.0)))
        com = ()
        if problem.model == "two_com":
            (other,) = links
            feet = ((other.effector, rotation(other.yaw)), (step.foot, rotation(step.yaw)))
            com = tuple(_com(problem, feet, over, more) for over in (0, 1))
        constraints.append(StepConstraints(step.foot, tuple(links), com))
        stances[step.foot] = (index, step.yaw)
    return constraints


def rotation(yaw: float) -> Float[np.ndarray, "3 3"]:
    """Return the rotation by `yaw` [rad] about the vertical, from the foot's frame to the world."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    return np.array([[cosine, -sine, 0.0], [sine, cosine, 0.0], [0.0, 0.0, 1.0]])


def _reach(
    problem: ContactProblem, foot: str, yaw: float, other: str, other_yaw: float
) -> HalfSpaces:
    if problem.model == "feet":
        reach = problem.polytopes.reach(other, foot)
        return HalfSpaces(-reach.normals @ rotation(yaw).T, reach.offsets)
    reach = problem.polytopes.reach(foot, other)
    return HalfSpaces(reach.normals @ rotation(other_yaw).T, reach.offsets)


def _com(
    problem: ContactProblem,
    feet: tuple[tuple[str, np.ndarray], ...],
    over: int,
    more: Mapping[Family, float],
) -> tuple[HalfSpaces, HalfSpaces]:
    """Return where c may be from each foot; it lies over foot number `over`."""
    sole = np.array([[1.0, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
    sets = []
    for number, (name, turn) in enumerate(feet):
        reach = problem.polytopes.com[name]
        A, b = reach.normals, reach.offsets + more.get("com_reach", 0.0)
        if number == over:
            sides = np.repeat(problem.half_sizes[name], 2) + more.get("com_over", 0.0)
            A, b = np.concatenate([A, sole]), np.concatenate([b, sides])
        sets.append(HalfSpaces(A @ turn.T, b))
    return sets[0], sets[1]
