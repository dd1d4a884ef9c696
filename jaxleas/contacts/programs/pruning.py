"""Presolve: drop candidate surfaces that no step can reach, or from which none leads on."""

import numpy as np
from jaxtyping import Bool

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.steps import INITIAL, Link, Step

SAFETY = 1e-6
"""A surface is dropped only if a step to it would violate a half-space by more than this [m]."""


def prune(problem: ContactProblem, steps: list[Step]) -> list[tuple[str, ...]]:
    """Return the candidates of each phase that may take part in a plan.

    A pair of surfaces is impossible if one half-space of the step's polytope separates them. A
    surface is dropped if, for a foot that stands, it is in no possible pair with the phase in which
    that foot landed; then likewise backwards. An empty tuple for phase k proves that the phase
    cannot be made.
    """
    pairs = [
        [_possible_pairs(problem, phase.candidates, link) for link in step.links]
        for phase, step in zip(problem.phases, steps, strict=True)
    ]
    alive: list[np.ndarray] = [np.ones(len(phase.candidates), bool) for phase in problem.phases]
    for index, step in enumerate(steps):
        for link, possible in zip(step.links, pairs[index], strict=True):
            before = np.ones(1, bool) if link.standing == INITIAL else alive[link.standing]
            alive[index] &= np.any(possible[before], axis=0)
        if not alive[index].any():
            break
    else:
        for index in reversed(range(len(steps))):
            for link, possible in zip(steps[index].links, pairs[index], strict=True):
                if link.standing != INITIAL:
                    alive[link.standing] &= possible[:, alive[index]].any(axis=1)
    return [
        tuple(name for name, keep in zip(phase.candidates, kept, strict=True) if keep)
        for phase, kept in zip(problem.phases, alive, strict=True)
    ]


def _possible_pairs(
    problem: ContactProblem, candidates: tuple[str, ...], link: Link
) -> Bool[np.ndarray, "before now"]:
    """Return which pairs of (surface stood on, surface stepped on) no half-space separates."""
    low_now, _ = _ranges(problem, candidates, link)
    if link.standing == INITIAL:
        high_before = (link.A @ problem.initial[link.effector].position)[None, :]
    else:
        _, high_before = _ranges(problem, problem.phases[link.standing].candidates, link)
    least = low_now[None, :, :] - high_before[:, None, :]  # for each row, over the pair
    return np.all(least <= link.b + SAFETY, axis=-1)


def _ranges(
    problem: ContactProblem, names: tuple[str, ...], link: Link
) -> tuple[np.ndarray, np.ndarray]:
    corners = [problem.surfaces[name].vertices for name in names]
    starts = np.cumsum([0, *(len(each) for each in corners)])[:-1]
    along = np.concatenate(corners) @ link.A.T
    return np.minimum.reduceat(along, starts), np.maximum.reduceat(along, starts)
