"""A guide path: timed root poses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float


@dataclass(frozen=True)
class GuidePath:
    """A guide path of one query, as plain NumPy values.

    Attributes:
        time: since the start [s].
        position: of the root in the world [m].
        yaw: heading [rad].
        velocity: of the root in the world [m/s].
        valid: whether the configuration satisfies the conditions it was judged by.
    """

    time: Float[np.ndarray, " T"]
    position: Float[np.ndarray, "T 3"]
    yaw: Float[np.ndarray, " T"]
    velocity: Float[np.ndarray, "T 3"]
    valid: Bool[np.ndarray, " T"]

    def __len__(self) -> int:
        """Return the number of configurations."""
        return len(self.time)

    @property
    def length(self) -> float:
        """Distance travelled by the root [m]."""
        return float(np.linalg.norm(np.diff(self.position, axis=0), axis=1).sum())
