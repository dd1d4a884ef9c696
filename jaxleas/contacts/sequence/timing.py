"""Times of landings: those of the guide path, or as many seconds a step."""

import logging
from pathlib import Path

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.plan import ContactPlan
from jaxleas.contacts.problem import ContactProblem
from jaxleas.types import GuidePath, InputError

_LOG = logging.getLogger("jaxleas")
SHORTEST = 0.1
"""Shortest time between two landings [s]: guide paths say nothing of two at one configuration."""
ON_GUIDE = 1e-4
"""Distance up to which a step's root is a configuration of the guide path [m]."""


def steady_times(steps: int, step_time: float) -> Float[np.ndarray, " L"]:
    """Return the times of landings that follow each other evenly [s]."""
    if not (np.isfinite(step_time) and step_time > 0.0):
        raise InputError(f"--step-time {step_time:g} must be a positive number of seconds")
    return step_time * np.arange(1.0, steps + 1.0)


def guide_times(rows: list[int], guide: GuidePath) -> Float[np.ndarray, " L"]:
    """Return the times of a guide path's configurations since its start [s].

    Args:
        rows: index of the configuration at each landing.
        guide: guide path.

    Raises:
        InputError: the path has fewer configurations.
    """
    if max(rows, default=0) >= len(guide):
        raise InputError(
            f"the plan lands at configuration {max(rows)}, and the guide path has {len(guide)}: is"
            " it that of the plan?"
        )
    return np.asarray(guide.time, np.float64)[rows] - float(guide.time[0])


def rows_of_steps(problem: ContactProblem, guide: GuidePath, count: int) -> list[int]:
    """Return the configuration of a guide path that each step of a problem was made of.

    Raises:
        InputError: a step has no root, or one that does not lie on the guide path.
    """
    rows, first = [], 0
    for number, step in enumerate(problem.steps[:count]):
        if step.root is None:
            raise InputError(f"step {number} has no root: no guide path says when it is made")
        apart = np.linalg.norm(guide.position[first:] - step.root, axis=1)
        if not len(apart) or apart.min() > ON_GUIDE:
            raise InputError(
                f"the root of step {number} does not lie on the guide path after the step before:"
                " the problem was made of another one"
            )
        first += int(np.argmin(apart)) + 1
        rows.append(first - 1)
    return rows


def rows_of_postures(plan: ContactPlan) -> list[int]:
    """Return the configuration of the guide path at which each contact of a plan was made."""
    return [each.configuration for each in plan.postures or () if each.moved is not None]


def apart(path: str | Path, times: Float[np.ndarray, " L"]) -> Float[np.ndarray, " L"]:
    """Return times that follow each other by `SHORTEST` at least; where they were moved is said.

    Args:
        path: file of the plan, for messages.
        times: times of the landings [s].
    """
    steps = SHORTEST * np.arange(len(times))
    moved = np.maximum.accumulate(np.maximum(times - steps, SHORTEST)) + steps
    late = float(np.max(moved - times, initial=0.0))
    if late > 1e-9:
        _LOG.warning(
            "%s: landings less than %g s apart are spread: up to %.2f s later than the guide path",
            *(path, SHORTEST, late),
        )
    return moved
