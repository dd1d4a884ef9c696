"""Footsteps that a robot made on terrain: what was planned, and where the feet came down."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from jaxleas.footsteps import FootstepPlan, PlannedFootstep


@dataclass(frozen=True, eq=False)
class WalkedFootstep:
    """A footstep that was measured.

    Attributes:
        time: time at its end [s].
        pair: index of the pair that swung; None where not one pair alone did.
        expected: index of the pair that was expected to swing.
        command: command during it.
        feet: positions of the feet at its end [m].
        com: position of the centre of mass at its end [m].
        yaw: heading at its end [rad].
        planned: the footstep as it was planned; None without a planner, or if it was to stand.
        controller: name of the controller that made it, "" without a planner.
    """

    time: float
    pair: int | None
    expected: int
    command: Float[np.ndarray, "3"]
    feet: Float[np.ndarray, "E 3"]
    com: Float[np.ndarray, "3"]
    yaw: float
    planned: PlannedFootstep | None
    controller: str = ""


def first_of(plan: FootstepPlan | None) -> PlannedFootstep | None:
    """Return the footstep that a plan begins with."""
    return plan.footsteps[0] if plan is not None and plan.footsteps else None
