"""The contact sequence: stances with durations, and what lands between them."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from jaxleas.robots import Effector
from jaxleas.types import Contact, InputError, Stance, SupportPhase


@dataclass(frozen=True, eq=False)
class Landing:
    """A contact that is made or moved, with the time at which it is there again.

    Attributes:
        contact: the new contact.
        time: time since the start of the sequence [s].
    """

    contact: Contact
    time: float


@dataclass(frozen=True, eq=False)
class ContactSequence:
    """A contact plan in time.

    Between two landings all effectors stand at first; then the next one moves.

    Attributes:
        robot: name of the robot.
        half_sizes: half length and half width of each effector [m], in the robot's order.
        initial: contacts before the first landing.
        landings: landings in order of time.
        standing: share of the time between two landings in which all effectors stand, 0 to 1.
        described: effectors of the robot by name, where the robot is known.
    """

    robot: str
    half_sizes: Mapping[str, tuple[float, float]]
    initial: Stance
    landings: tuple[Landing, ...]
    standing: float
    described: Mapping[str, Effector] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0.0 < self.standing < 1.0:
            raise InputError(
                f"standing {self.standing:g} must lie between 0 and 1: the share of each step in"
                " which all effectors stand"
            )
        if not self.landings:
            raise InputError("a contact sequence needs a landing: the plan makes no step")

    @property
    def effectors(self) -> tuple[str, ...]:
        """Names of the effectors, in the robot's order."""
        return tuple(self.half_sizes)

    @property
    def lift_offs(self) -> Float[np.ndarray, " L"]:
        """Time at which the effector of each landing begins to move [s]."""
        times = np.array([each.time for each in self.landings])
        before = np.concatenate([[0.0], times[:-1]])
        return before + self.standing * (times - before)

    @property
    def phases(self) -> tuple[SupportPhase, ...]:
        """Stances with durations: all stand, one moves, in turn; at the end all stand."""
        phases = []
        stance, time = self.initial, 0.0
        for landing, lift_off in zip(self.landings, self.lift_offs.tolist(), strict=True):
            effector = landing.contact.effector
            phases.append(SupportPhase(stance, lift_off - time))
            without = stance.breaking(effector) if effector in stance else stance
            phases.append(SupportPhase(without, landing.time - lift_off))
            stance, time = stance.making(landing.contact), landing.time
        return (*phases, SupportPhase(stance, phases[-2].duration))

    @property
    def duration(self) -> float:
        """Duration of all phases [s]."""
        return sum(each.duration for each in self.phases)
