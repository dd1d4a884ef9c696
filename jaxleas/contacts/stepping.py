"""How a guide path becomes steps: which configurations are kept, and which surfaces count."""

from dataclasses import dataclass
from typing import Literal

from jaxleas.contacts.problem import Model
from jaxleas.types import InputError

Candidates = Literal["window", "rom"]
EVERY = 14
"""Every N-th configuration is kept, N_ref of T 5.2.3: 28 cm at 2 cm per configuration."""
WINDOW = 0.8
"""Edge of the square around the root in which a foot may land (T 5.2.3) [m]."""


@dataclass(frozen=True)
class Stepping:
    """How a guide path becomes steps.

    Attributes:
        model: "two_com" or "feet"; by default "two_com" for two feet with polytopes of the centre
            of mass, and "feet" for any others.
        every: number N: every N-th configuration is kept.
        candidates: "window": parts of surfaces in a square around the root, turned with it; "rom":
            parts of surfaces in the range of motion of the leg that moves.
        window: length of the edges of the square [m].
        first_foot: name of the foot that moves first; the robot's first foot by default.

    Raises:
        InputError: a number is out of range.
    """

    model: Model | None = None
    every: int = EVERY
    candidates: Candidates = "window"
    window: float = WINDOW
    first_foot: str | None = None

    def __post_init__(self) -> None:
        if self.every < 1:
            raise InputError(
                f"every {self.every} must be at least 1: every N-th configuration is kept"
            )
        if not 0.0 < self.window < 100.0:
            raise InputError(f"window {self.window} must be an edge in metres, 0.8 is usual")


DEFAULT_STEPPING = Stepping()


def kept_configurations(length: int, every: int) -> list[int]:
    """Return the configurations of a guide that steps are made of: every N-th, and the last.

    Args:
        length: number of configurations of the guide.
        every: number N: every N-th configuration is kept.
    """
    return [*range(every, length - 1, every), length - 1]


class NoGroundError(InputError):
    """The scene has nothing to stand on at one of the kept configurations.

    Attributes:
        step: step that finds no candidate; -1 if the feet have no place to start from.
    """

    def __init__(self, message: str, step: int) -> None:
        super().__init__(message)
        self.step = step

    def __reduce__(self) -> tuple:
        return type(self), (str(self), self.step)
