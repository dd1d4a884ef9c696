"""Weights on SL1M's slacks: which surface of each step is preferred (T 5.3.4, as a prospect)."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.from_guide import nearest_below
from jaxleas.contacts.problem import ContactProblem, Step
from jaxleas.contacts.programs.mixed_integer import Candidates
from jaxleas.contacts.reference import reference_foothold
from jaxleas.robots import load_robot
from jaxleas.types import InputError

SlackWeights = Literal["uniform", "guide"]


def slack_weights(
    problem: ContactProblem, candidates: Candidates, weights: SlackWeights
) -> list[Float[np.ndarray, " c"]]:
    """Return the weight of each candidate's slack, step by step.

    "uniform" is SL1M as published. With "guide" the surface under the place where the foot would
    stand beside the root weighs as much as all candidates of its step together: it is selected
    wherever the step can be made onto it (an exact penalty), so that the guide path chooses.

    Args:
        problem: the contact problem.
        candidates: candidates of each step.
        weights: kind of weights.

    Raises:
        InputError: a step lacks the root that the guide's choice needs.
    """
    rows = [np.ones(len(names)) for names in candidates]
    if weights == "uniform":
        return rows
    for index, (row, names, step) in enumerate(zip(rows, candidates, problem.steps, strict=True)):
        if step.root is None:
            raise InputError(
                f"step {index} has no root, which slack weights by the guide need: ask for"
                " uniform ones"
            )
        if len(names) > 1:
            row[_preferred(problem, names, step)] = len(names)
    return rows


def _preferred(problem: ContactProblem, names: tuple[str, ...], step: Step) -> int:
    """Return the candidate nearest to the foot's place beside the root; the highest of equals."""
    assert step.root is not None
    place = reference_foothold(load_robot(problem.robot), step.foot, step.root, step.yaw)
    found = [nearest_below(problem.surfaces[name], place) for name in names]
    return min(range(len(names)), key=lambda number: (found[number][1], -found[number][0][2]))
