"""The clock of a gait: which feet stand, which swing, and how far."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float


@dataclass(frozen=True, eq=False)
class Schedule:
    """What a gait's clock asks of N robots' E feet.

    Attributes:
        swings: whether a foot is to swing.
        progress: how much of its swing is done, 0 to 1; 0 for a foot that stands.
    """

    swings: Bool[np.ndarray, "N E"]
    progress: Float[np.ndarray, "N E"]

    @property
    def all_stand(self) -> Bool[np.ndarray, " N"]:
        """Whether no foot of a robot is to swing."""
        return np.logical_not(self.swings.any(axis=1))


def schedule(
    phase: Float[np.ndarray, " N"], offsets: Float[np.ndarray, " E"], duty: float
) -> Schedule:
    """Return what the feet are to do.

    Args:
        phase: place in the gait cycle, 0 to 1.
        offsets: place in the cycle at which each foot's stance begins, when the phase is 0.
        duty: share of the cycle during which a foot stands, which comes first.
    """
    local = (phase[:, None] + offsets) % 1.0
    swings = local >= duty
    return Schedule(swings, np.where(swings, (local - duty) / (1.0 - duty), 0.0))
