"""How long a search may take: in seconds, in connections tried, or both."""

import time
from dataclasses import dataclass, field

from jaxleas.types import InputError


@dataclass
class Budget:
    """A limit on the time of a search, on its connections, or on both.

    A number of connections makes two methods, or two machines, comparable; seconds bound the wait.

    Attributes:
        seconds: wall time [s].
        connections: maximum number of connections to try; None for as many as the time allows.
        used: number of connections asked for so far.
    """

    seconds: float
    connections: int | None = None
    used: int = 0
    _begin: float = field(default_factory=time.monotonic)

    def __post_init__(self) -> None:
        if not 0.0 < self.seconds < float("inf"):
            raise InputError(f"a limit of {self.seconds} s: give a number of seconds above 0")
        if self.connections is not None and self.connections < 1:
            raise InputError(f"{self.connections} connections: give at least 1")

    @property
    def elapsed(self) -> float:
        """Time since the budget was made [s]."""
        return time.monotonic() - self._begin

    @property
    def spent(self) -> bool:
        """Whether the search must end."""
        over = self.connections is not None and self.used >= self.connections
        return over or self.elapsed >= self.seconds
