"""Footstep plans: commands, what they are expected to do, and why there is none."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float

Status = Literal["reached", "horizon", "budget", "stand"]
"""The goal is reached; the horizon is; the budget of expansions ended first; no command is safe."""
Refusal = Literal["unknown motion", "map", "landing", "step height", "climbing", "swing"]
REFUSALS: dict[Refusal, str] = {
    "unknown motion": "longer than any stride in the data",
    "map": "leaves the map",
    "landing": "lands too near an edge, or on no ground",
    "step height": "steps higher or lower than the swing",
    "climbing": "steps up or down too fast",
    "swing": "swings through the ground",
}


@dataclass(frozen=True, eq=False)
class PlannedFootstep:
    """One footstep of a plan.

    Attributes:
        pair: index of the pair that swings.
        command: forward and sideways speed [m/s] and turning rate [rad/s] to command.
        com: x and y of the centre of mass afterwards [m].
        yaw: heading afterwards [rad].
        feet: positions of the feet afterwards [m].
    """

    pair: int
    command: Float[np.ndarray, "3"]
    com: Float[np.ndarray, "2"]
    yaw: float
    feet: Float[np.ndarray, "E 3"]


@dataclass(frozen=True)
class Miss:
    """The refused landing that came nearest to a safe cell.

    Attributes:
        foot: name of the foot.
        place: x and y where it would land [m].
        short: distance by which it is too near an edge [m].
    """

    foot: str
    place: tuple[float, float]
    short: float


@dataclass(frozen=True, eq=False)
class FootstepPlan:
    """A plan, or the reason why there is none.

    Attributes:
        status: how the search ended.
        footsteps: footsteps, none where the robot shall stand.
        cost: cost of the plan: footsteps, and those that are left at least.
        gap: most by which a plan of the same search could cost less.
        expansions: number of states whose commands were tried.
        refused: number of footsteps refused, by reason.
        miss: refused landing that came nearest to a safe cell, if one was refused.
        controller: name of the controller that is to walk it; "" where that is known elsewhere.
    """

    status: Status
    footsteps: tuple[PlannedFootstep, ...]
    cost: float
    gap: float
    expansions: int
    refused: dict[Refusal, int] = field(default_factory=dict)
    miss: Miss | None = None
    controller: str = ""

    @property
    def command(self) -> Float[np.ndarray, "3"]:
        """Command of the first footstep; zero, to stand, where there is none."""
        return self.footsteps[0].command if self.footsteps else np.zeros(3)

    def in_words(self) -> str:
        """Return the result as a sentence."""
        if self.status == "reached" and not self.footsteps:
            return "the goal is reached: stand"
        if self.footsteps:
            found = {"reached": "to the goal", "horizon": "to the horizon"}
            return f"{len(self.footsteps)} footsteps {found.get(self.status, 'in the budget')}"
        counted = [f"{n} {REFUSALS[reason]}" for reason, n in self.refused.items() if n]
        sentence = f"no safe command: stand ({'; '.join(counted)})"
        if self.miss is None:
            return sentence
        x, y = self.miss.place
        return (
            f"{sentence}; the nearest: foot {self.miss.foot} at ({x:.2f}, {y:.2f}) m is"
            f" {100 * self.miss.short:.1f} cm short of safe"
        )
