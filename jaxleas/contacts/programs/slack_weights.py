"""Weights on SL1M's slacks: which surface of each step is preferred (T 5.3.4, as a prospect)."""

from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.from_guide import nearest_below
from jaxleas.contacts.problem import ContactProblem, Phase
from jaxleas.contacts.programs.mixed_integer import Candidates
from jaxleas.contacts.reference import reference_foothold
from jaxleas.robots import load_robot
from jaxleas.types import InputError

SlackWeights = Literal["uniform", "guide"]


def slack_weights(
    problem: ContactProblem, candidates: Candidates, weights: SlackWeights
) -> list[Float[np.ndarray, " c"]]:
    """Return the weight of each candidate's slack, phase by phase.

    "uniform" is SL1M as published. With "guide" the surface under the place where the foot would
    stand beside the root weighs as much as all candidates of its step together: it is selected
    wherever the step can be made onto it (an exact penalty), so that the guide path chooses.

    Args:
        problem: the contact problem.
        candidates: candidates of each phase.
        weights: kind of weights.

    Raises:
        InputError: a phase lacks the root that the guide's choice needs.
    """
    rows = [np.ones(len(names)) for names in candidates]
    if weights == "uniform":
        return rows
    for index, (row, names, phase) in enumerate(zip(rows, candidates, problem.phases, strict=True)):
        if phase.root is None:
            raise InputError(
                f"phase {index} has no root, which slack weights by the guide need: ask for"
                " uniform ones"
            )
        if len(names) > 1:
            row[_preferred(problem, names, phase)] = len(names)
    return rows


def _preferred(problem: ContactProblem, names: tuple[str, ...], phase: Phase) -> int:
    """Return the candidate nearest to the foot's place beside the root; the highest of equals."""
    assert phase.root is not None
    place = reference_foothold(load_robot(problem.robot), phase.foot, phase.root, phase.yaw)
    found = [nearest_below(problem.surfaces[name], place) for name in names]
    return min(range(len(names)), key=lambda number: (found[number][1], -found[number][0][2]))
