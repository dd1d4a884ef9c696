"""The sampling-based planner's answer for one guide path."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

How = Literal["start", "kept", "stepped", "repositioned"]
Ending = Literal["reached", "trunk", "no_start", "no_contact", "repositions", "time_limit"]
"""Why a plan ends: at the last configuration; the trunk touches the scene; no stance to start from;
no foot finds a contact that leads on; too many repositions; no time left."""


@dataclass(frozen=True, eq=False)
class SamplingPlan:
    """Postures with all feet in contact along a guide path, and how far they reach.

    Attributes:
        ending: why the plan ends; "reached" is success.
        reason: reason why the plan stopped, a sentence; empty on success.
        last_index: index in the guide path of the last configuration reached; -1 if none.
        last_kept: index of that configuration among the kept configurations.
        kept: number of kept configurations.
        index: index of each posture's configuration in the guide path.
        how: way in which each posture came about.
        moved: limb that was moved for each posture; -1 for none (or all, at the start).
        soles: positions of all soles, in the order of the robot's feet, in the world [m].
        rotations: rotations of the feet in the world.
        surfaces: names of the surfaces of all feet.
        com: centre of mass in the world [m].
        robustness: robustness of equilibrium of each posture [N].
        repositions: number of postures that are repositions.
        seconds: time spent on this guide path, an equal share where several were planned together
            [s].
    """

    ending: Ending
    reason: str
    last_index: int
    last_kept: int
    kept: int
    index: Int[np.ndarray, " S"]
    how: tuple[How, ...]
    moved: Int[np.ndarray, " S"]
    soles: Float[np.ndarray, "S F 3"]
    rotations: Float[np.ndarray, "S F 3 3"]
    surfaces: tuple[tuple[str, ...], ...]
    com: Float[np.ndarray, "S 3"]
    robustness: Float[np.ndarray, " S"]
    repositions: int
    seconds: float

    def __len__(self) -> int:
        """Return the number of postures."""
        return len(self.index)

    @property
    def success(self) -> bool:
        """Whether the last configuration was reached."""
        return self.ending == "reached"

    @property
    def reached(self) -> float:
        """Share of the guide path that was reached (T 4.1.4)."""
        return (self.last_kept + 1) / self.kept

    @property
    def steps(self) -> int:
        """Number of contacts made after the start."""
        return int((self.moved >= 0).sum())
