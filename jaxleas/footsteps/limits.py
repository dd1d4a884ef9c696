"""What footsteps are kept within: speeds where they climb, and changes of the command."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

CLIMBS = 0.02
"""Rise or drop of a footstep from which on it climbs [m]."""
STEEP, STEEPER = 0.065, 0.6
"""Rise or drop from which on a footstep is slower still [m], and its speed over that of others."""
SWAYS = 0.5
"""Share of the largest forward speed up to which a robot does not sway, however it changes."""


@dataclass(frozen=True)
class Limits:
    """What footsteps are kept within.

    Attributes:
        fastest: largest speed that is tried, over the controller's largest.
        climbing: largest speed, commanded and afterwards, where a foot steps up or down, over the
            controller's largest.
        doubt: what each footstep before adds to the buffer of a landing [m].
        jump: largest change of the command from one footstep to the next: sum over its parts, each
            over the controller's largest.
        sway: largest difference of two changes of the forward speed in turn, over the controller's
            largest; where it is nowhere above `SWAYS`, any.
    """

    fastest: float = 1.0
    climbing: float = 1.0
    doubt: float = 0.0
    jump: float = np.inf
    sway: float = np.inf

    def slow_enough(
        self,
        rise: Float[np.ndarray, " K"],
        share: Float[np.ndarray, " K"],
        speed: Float[np.ndarray, " K"],
        largest: float,
    ) -> Bool[np.ndarray, " K"]:
        """Return whether footsteps are slow enough for how far they step up or down.

        Args:
            rise: largest rise or drop of their feet [m].
            share: commanded speed over the controller's largest.
            speed: speed afterwards [m/s].
            largest: the controller's largest forward speed [m/s].
        """
        slower = np.where((rise > STEEP) & (self.climbing < 1.0), STEEPER, 1.0)
        most = self.climbing * largest if self.climbing < 1.0 else np.inf
        slow = (share <= slower * self.climbing + 1e-9) & (speed <= slower * most)
        return slow | (rise <= CLIMBS)

    def steady(
        self,
        shares: Float[np.ndarray, "C 3"],
        before: Float[np.ndarray, "P 3"],
        earlier: Float[np.ndarray, "P 3"],
    ) -> Bool[np.ndarray, "P C"]:
        """Return whether commands go on from those before them steadily enough.

        Args:
            shares: commands over the controller's largest speeds.
            before: commands before them, likewise.
            earlier: commands before those, likewise.
        """
        change = shares - before[:, None]
        turn = change[..., 0] - (before - earlier)[:, None, 0]
        steady = np.abs(change).sum(axis=2) <= self.jump + 1e-9
        fastest = np.maximum(shares[:, 0], np.maximum(before, earlier)[:, :1])
        return steady & ((np.abs(turn) <= self.sway + 1e-9) | (fastest <= SWAYS + 1e-9))
