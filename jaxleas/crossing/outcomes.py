"""What becomes of a robot that crosses terrain."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float

from jaxleas.crossing.walked_footsteps import WalkedFootstep
from jaxleas.footsteps import FootstepPlan

Outcome = Literal["reached", "no path", "fell", "time", "interrupted"]
"""It stands at the goal; no command was safe, and it stands; it fell; its time was over; a person
stopped it."""


@dataclass(frozen=True, eq=False)
class Crossing:
    """What became of one robot.

    Attributes:
        outcome: how it ended.
        time: time of the end [s].
        cause: what showed a fall, one of `jaxleas.controllers.FALLS`; "" otherwise.
        com: last position of the centre of mass [m].
        yaw: last heading [rad].
        footsteps: footsteps that it made.
        seconds: time that each decision took [s].
        last_plan: last plan, which says why there is no path; None without a planner.
    """

    outcome: Outcome
    time: float
    cause: str
    com: Float[np.ndarray, "3"]
    yaw: float
    footsteps: tuple[WalkedFootstep, ...]
    seconds: tuple[float, ...]
    last_plan: FootstepPlan | None
