"""Presolve: drop candidate surfaces that no step can reach, or from which none leads on."""

import numpy as np
from jaxtyping import Bool

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.constraints import INITIAL, Link, StepConstraints

SAFETY = 1e-6
"""A surface is dropped only if a step to it would violate a half-space by more than this [m]."""


def prune(problem: ContactProblem, constraints: list[StepConstraints]) -> list[tuple[str, ...]]:
    """Return the candidates of each step that may take part in a plan.

    A pair of surfaces is impossible if one half-space of the step's polytope separates them. A
    surface is dropped if, for a foot that stands, it is in no possible pair with the step in which
    that foot landed; then likewise backwards. An empty tuple for step k proves that the step
    cannot be made.
    """
    pairs = [
        [_possible_pairs(problem, step.candidates, link) for link in constraint.links]
        for step, constraint in zip(problem.steps, constraints, strict=True)
    ]
    alive: list[np.ndarray] = [np.ones(len(step.candidates), bool) for step in problem.steps]
    for index, constraint in enumerate(constraints):
        for link, possible in zip(constraint.links, pairs[index], strict=True):
            before = np.ones(1, bool) if link.standing == INITIAL else alive[link.standing]
            alive[index] &= np.any(possible[before], axis=0)
        if not alive[index].any():
            break
    else:
        for index in reversed(range(len(constraints))):
            for link, possible in zip(constraints[index].links, pairs[index], strict=True):
                if link.standing != INITIAL:
                    alive[link.standing] &= possible[:, alive[index]].any(axis=1)
    return [
        tuple(name for name, keep in zip(step.candidates, kept, strict=True) if keep)
        for step, kept in zip(problem.steps, alive, strict=True)
    ]


def _possible_pairs(
    problem: ContactProblem, candidates: tuple[str, ...], link: Link
) -> Bool[np.ndarray, "before now"]:
    """Return which pairs of (surface stood on, surface stepped on) no half-space separates."""
    low_now, _ = _ranges(problem, candidates, link)
    if link.standing == INITIAL:
        high_before = (link.A @ problem.initial[link.effector].position)[None, :]
    else:
        _, high_before = _ranges(problem, problem.steps[link.standing].candidates, link)
    least = low_now[None, :, :] - high_before[:, None, :]  # for each row, over the pair
    return np.all(least <= link.b + SAFETY, axis=-1)


def _ranges(
    problem: ContactProblem, names: tuple[str, ...], link: Link
) -> tuple[np.ndarray, np.ndarray]:
    corners = [problem.surfaces[name].vertices for name in names]
    starts = np.cumsum([0, *(len(each) for each in corners)])[:-1]
    along = np.concatenate(corners) @ link.A.T
    return np.minimum.reduceat(along, starts), np.maximum.reduceat(along, starts)
