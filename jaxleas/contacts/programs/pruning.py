"""Presolve: candidate surfaces that no step can reach, or from which none leads on, go."""

import numpy as np
from jaxtyping import Bool

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.steps import INITIAL, Step

SAFETY = 1e-6
"""A surface goes only if a step to it would violate a half-space by more than this [m]."""


def prune(problem: ContactProblem, steps: list[Step]) -> list[tuple[str, ...]]:
    """Return the candidates of each phase that may take part in a plan.

    A pair of surfaces is impossible if one half-space of the step's polytope separates them; a
    surface goes if it is in no possible pair with the phase before, then (backwards) after. An
    empty tuple for phase k proves that phase k cannot be made.
    """
    pairs = [_possible_pairs(problem, steps, index) for index in range(len(steps))]
    alive: list[np.ndarray] = [np.ones(len(phase.candidates), bool) for phase in problem.phases]
    for index, step in enumerate(steps):
        before = np.ones(1, bool) if step.standing == INITIAL else alive[step.standing]
        alive[index] = np.any(pairs[index][before], axis=0)
        if not alive[index].any():
            break
    else:
        for index in reversed(range(len(steps))):
            standing = steps[index].standing
            if standing != INITIAL:
                alive[standing] &= pairs[index][:, alive[index]].any(axis=1)
    return [
        tuple(name for name, keep in zip(phase.candidates, kept, strict=True) if keep)
        for phase, kept in zip(problem.phases, alive, strict=True)
    ]


def _possible_pairs(
    problem: ContactProblem, steps: list[Step], index: int
) -> Bool[np.ndarray, "before now"]:
    """Return which pairs of (surface stood on, surface stepped on) no half-space separates."""
    step, phase = steps[index], problem.phases[index]
    low_now, _ = _ranges(problem, phase.candidates, step)
    if step.standing == INITIAL:
        other = "RF" if step.foot == "LF" else "LF"
        high_before = (step.A @ problem.initial[other].position)[None, :]
    else:
        _, high_before = _ranges(problem, problem.phases[step.standing].candidates, step)
    least = low_now[None, :, :] - high_before[:, None, :]  # of each row over the pair
    return np.all(least <= step.b + SAFETY, axis=-1)


def _ranges(
    problem: ContactProblem, names: tuple[str, ...], step: Step
) -> tuple[np.ndarray, np.ndarray]:
    corners = [problem.surfaces[name].vertices for name in names]
    starts = np.cumsum([0, *(len(each) for each in corners)])[:-1]
    along = np.concatenate(corners) @ step.A.T
    return np.minimum.reduceat(along, starts), np.maximum.reduceat(along, starts)
