"""Footholds on chosen surfaces and the centre of mass above them, by cuts in turn."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.contacts.problem import ContactProblem
from jaxleas.contacts.programs.com import foot_yaws
from jaxleas.contacts.programs.com_places import place_coms
from jaxleas.contacts.programs.constraints import StepConstraints, rotation
from jaxleas.contacts.programs.foothold_program import place_feet, standing_point
from jaxleas.contacts.programs.linear_program import SolverStatus
from jaxleas.contacts.programs.nearest import Targets

MAX_ROUNDS = 200


@dataclass(frozen=True, eq=False)
class Placement:
    """Footholds on given surfaces, or the result that there are none.

    Attributes:
        status: "optimal" when there are footholds, "infeasible" when there are provably none.
        constraints: constraints on the steps as given, with the cuts that were found on the way.
        footholds: foothold of each step [m].
        com: places of the centre of mass in each step [m]; None for the model "feet".
        blamed: steps of an infeasible problem whose surfaces together are impossible, whatever the
            surfaces of the others.
    """

    status: SolverStatus
    constraints: list[StepConstraints]
    footholds: Float[np.ndarray, "n 3"] | None = None
    com: Float[np.ndarray, "n 2 3"] | None = None
    blamed: tuple[int, ...] = ()


def place(
    problem: ContactProblem,
    constraints: list[StepConstraints],
    surfaces: tuple[str, ...],
    deadline: float = np.inf,
    targets: Targets | None = None,
) -> Placement:
    """Place each foot on its surface, with the most distance to spare or nearest to targets.

    Args:
        problem: the contact problem.
        constraints: constraints on the steps from `make_constraints`, with or without cuts.
        surfaces: name of the surface of each step.
        deadline: time by `time.perf_counter` after which to stop [s].
        targets: places to minimise the distance to; None: maximise the least slack.
    """
    for _ in range(MAX_ROUNDS):
        feet = place_feet(problem, constraints, surfaces, deadline, targets)
        if feet.footholds is None:
            return Placement(feet.status, constraints, blamed=feet.blamed)
        com, constraints, found = put_com(problem, constraints, feet.footholds)
        if not found:
            return Placement("optimal", constraints, feet.footholds, com)
    return Placement("failed", constraints)


def put_com(
    problem: ContactProblem, constraints: list[StepConstraints], footholds: Float[np.ndarray, "n 3"]
) -> tuple[Float[np.ndarray, "n 2 3"] | None, list[StepConstraints], int]:
    """Put the centre of mass over given footholds.

    Returns:
        Its places [m], the steps with cuts for those that leave no place, and how many such
        steps there are.
    """
    if problem.model != "two_com":
        return None, constraints, 0
    stood = np.array(
        [standing_point(problem, constraint.link, footholds) for constraint in constraints]
    )
    turns = np.array([[rotation(yaw) for yaw in yaws] for yaws in foot_yaws(problem, constraints)])
    half_sizes = np.array(
        [
            [problem.half_sizes[name] for name in (constraint.link.effector, constraint.foot)]
            for constraint in constraints
        ]
    )
    places, cuts = place_coms(constraints, footholds - stood, half_sizes, turns)
    constraints = list(constraints)
    for index, found in cuts.items():
        normals, bounds = zip(*found, strict=True)
        constraints[index] = constraints[index].with_cuts(np.array(normals), np.array(bounds))
    return stood[:, None] + places, constraints, len(cuts)
