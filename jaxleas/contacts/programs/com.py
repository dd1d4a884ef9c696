"""The centre of mass, eliminated: displacements between the feet that leave it a place.

c_k0 and c_k1 occur in step k alone, so that they only constrain the displacement d = p_m -
p_o between the feet: that (p_o + C_o) and (p_m + C_m) intersect, C_o and C_m being where the centre
of mass may lie from either foot. By Farkas, d must satisfy g . d <= h_o(g) + h_m(-g) for every
direction g, where h is the support function. Planners start with a few directions and add, for a
step they propose, the one that refutes it; so they work on footholds only, and remain exact.
"""

from functools import cache

import numpy as np

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import StepConstraints, rotation
from jaxleas.geometry import Polytope
from jaxleas.types import InputError

DIRECTIONS = 96


def with_first_cuts(
    problem: ContactProblem, constraints: list[StepConstraints], count: int
) -> list[StepConstraints]:
    """Return the steps with those of a fixed set of cuts that cut something off their reach.

    Args:
        problem: the contact problem.
        constraints: constraints on the problem's steps.
        count: number of steps, from the first, that get cuts: those whose constraints are complete.
    """
    if problem.model != "two_com":
        return constraints
    poses = foot_yaws(problem, constraints)
    cut = [
        constraint.with_cuts(*_first_cuts(problem, constraint, *yaws))
        for constraint, yaws in zip(constraints[:count], poses, strict=False)
    ]
    return [*cut, *constraints[count:]]


def foot_yaws(
    problem: ContactProblem, constraints: list[StepConstraints]
) -> list[tuple[float, float]]:
    """Return the yaws [rad] of the standing and of the landing foot in each step."""
    steps = zip(constraints, problem.steps, strict=True)
    return [(constraint.link.yaw, step.yaw) for constraint, step in steps]


def _first_cuts(
    problem: ContactProblem, constraint: StepConstraints, standing_yaw: float, yaw: float
) -> tuple[np.ndarray, np.ndarray]:
    other = constraint.link.effector
    directions = _directions()  # in the standing foot's frame
    turned = -directions @ rotation(yaw - standing_yaw)  # in the landing foot's
    reach = problem.polytopes.reach(constraint.foot, other).vertices
    far = (directions @ reach.T).max(axis=1)
    kept_normals, kept_bounds = [], []
    for over in (0, 1):
        corners = [
            _com_corners(problem, name, number == over)
            for number, name in enumerate((other, constraint.foot))
        ]
        bound = (directions @ corners[0].T).max(axis=1) + (turned @ corners[1].T).max(axis=1)
        cuts = bound < far - 1e-6
        kept_normals.append(directions[cuts] @ rotation(standing_yaw).T)
        kept_bounds.append(bound[cuts])
    return np.concatenate(kept_normals), np.concatenate(kept_bounds)


def _com_corners(problem: ContactProblem, name: str, over: bool) -> np.ndarray:
    """Return corners of where the centre of mass may be from a foot, over it or not."""
    polytope = problem.polytopes.com[name]
    if not over:
        return polytope.vertices
    return _corners_over(polytope, problem.half_sizes[name])


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
