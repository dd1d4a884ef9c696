"""How a robot is walked across terrain: its search, its map, and the time it gets."""

from dataclasses import dataclass, replace

from jaxleas.footsteps import SearchSettings, settings_for
from jaxleas.types import InputError


@dataclass(frozen=True)
class WalkSettings:
    """How a robot is walked to a goal.

    Attributes:
        horizon: number of footsteps that are planned at each contact.
        clearance: cost of a landing nearer to an edge than 7 cm, in footsteps per metre.
        buffer: distance of a foot's centre from edges [m]; by default 1.5 cm, within which
            a landing is unsafe, and the 95 % quantile of the error of its prediction.
        fastest: largest commanded speed, as a share of the controller's largest.
        climbing: largest commanded speed where a foot steps up or down, likewise.
        jump: largest change of the command between footsteps: the sum of its parts, each as a share
            of the controller's largest.
        sway: largest difference between two successive changes of the forward speed, as a share of
            the controller's largest.
        doubt: length that is added to the buffer of a landing for each planned footstep before it
            [m].
        seconds: time after which the walk ends [s].
    """

    horizon: int = 8
    clearance: float = 10.0
    buffer: float | None = None
    fastest: float = 1.0
    climbing: float = 0.5
    jump: float = 0.6
    sway: float = 1.0
    doubt: float = 0.002
    seconds: float = 120.0

    def __post_init__(self) -> None:
        if not 0.0 < self.seconds <= LONGEST:
            raise InputError(
                f"a walk of {self.seconds:g} s: give more than 0 s, and at most {LONGEST:g} s"
            )
        if self.buffer is not None and not self.buffer >= 0.0:
            raise InputError(f"the buffer of a foot is {self.buffer:g} m: give at least 0 m")

    @property
    def search(self) -> SearchSettings:
        """How commands are searched: exactly up to a horizon of two."""
        return replace(
            settings_for(self.horizon),
            clearance=self.clearance,
            fastest=self.fastest,
            climbing=self.climbing,
            jump=self.jump,
            sway=self.sway,
            concessions=CONCESSIONS,
            doubt=self.doubt,
        )


CONCESSIONS = (0.75, 0.5, 0.25)
"""Shares of the buffer that a walking robot keeps where it has no safe command."""
LONGEST = 3600.0
"""Longest walk: what is logged of it takes a gigabyte [s]."""
